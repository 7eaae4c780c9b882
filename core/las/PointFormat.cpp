// SPDX-License-Identifier: MIT
#include "core/las/PointFormat.h"

#include "core/Error.h"
#include "core/cloud/NormalParts.h"
#include "core/las/ExtraBytes.h"
#include "core/las/SourceFile.h"

#include <bit>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

namespace punctum::las
{

namespace
{

constexpr std::uint16_t kStandardLengths[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Builds a layout field by field, in the order of the record.
class LayoutMaker
{
public:
    explicit LayoutMaker(std::uint8_t format, std::uint16_t length)
    {
        m_layout.format = format;
        m_layout.length = length;
        m_names = {"RGB", "Normal"};
    }

    int field(const std::string& column, ScalarType type, std::uint32_t components = 1)
    {
        RecordField f{column, std::uint16_t(m_at), type, std::uint16_t(components)};
        m_at += f.bytes();
        m_names.insert(column);
        m_layout.fields.push_back(std::move(f));
        return int(m_layout.fields.size()) - 1;
    }
    Attribute& attribute(const std::string& name, AttributeKind kind, int fieldIndex)
    {
        Attribute a;
        a.name = name;
        a.kind = kind;
        a.standard = true;
        m_names.insert(name);
        m_layout.attributes.push_back(std::move(a));
        m_layout.attributeFields.push_back({fieldIndex, -1, -1});
        return m_layout.attributes.back();
    }
    Attribute& plain(const std::string& name, ScalarType type, AttributeKind kind = AttributeKind::Scalar)
    {
        return attribute(name, kind, field(name, type));
    }
    void bits(const std::string& name, int fieldIndex, int shift, int width,
              AttributeKind kind = AttributeKind::Category)
    {
        Attribute& a = attribute(name, kind, fieldIndex);
        a.bitShift = std::uint8_t(shift);
        a.bitWidth = std::uint8_t(width);
    }
    /// A name nothing has yet: "Intensity (extra)" when the format itself has it, else "name#2".
    std::string freeName(const std::string& wanted)
    {
        std::string name = wanted.empty() ? "ExtraBytes" : wanted;
        if (m_standardNames.contains(name)) name += " (extra)";
        const std::string base = name;
        // Many equal names are looked up from where the last one was found.
        int& n = m_lastNumber[base];
        while (m_names.contains(name)) name = base + "#" + std::to_string(n = std::max(n + 1, 2));
        return name;
    }
    void endOfStandard() { m_standardNames = m_names; }
    std::uint32_t at() const { return m_at; }
    RecordLayout take() { return std::move(m_layout); }

private:
    RecordLayout m_layout;
    std::uint32_t m_at = 0;
    std::set<std::string> m_names;
    std::set<std::string> m_standardNames;
    std::map<std::string, int> m_lastNumber;
};

void addCoordinates(LayoutMaker& make, const CoordinateScale& coordinates)
{
    const char* names[] = {"X", "Y", "Z"};
    for (int k = 0; k < 3; ++k) {
        Attribute& a = make.plain(names[k], ScalarType::I32);
        a.scaled = true;
        a.scale = coordinates.scale[k];
        a.offset = coordinates.offset[k];
    }
}

void addCore(LayoutMaker& make, bool extended)
{
    make.plain("Intensity", ScalarType::U16);
    const int returns = make.field("Returns", ScalarType::U8);
    const int flags = make.field(extended ? "Flags" : "Classes", ScalarType::U8);
    make.bits("ReturnNumber", returns, 0, extended ? 4 : 3);
    make.bits("NumberOfReturns", returns, extended ? 4 : 3, extended ? 4 : 3);
    make.bits("ScanDirectionFlag", extended ? flags : returns, 6, 1);
    make.bits("EdgeOfFlightLine", extended ? flags : returns, 7, 1);
    if (extended)
        make.plain("Classification", ScalarType::U8, AttributeKind::Class);
    else
        make.bits("Classification", flags, 0, 5, AttributeKind::Class);
    const int firstFlag = extended ? 0 : 5;
    make.bits("Synthetic", flags, firstFlag, 1);
    make.bits("KeyPoint", flags, firstFlag + 1, 1);
    make.bits("Withheld", flags, firstFlag + 2, 1);
    if (extended) {
        make.bits("Overlap", flags, 3, 1);
        make.bits("ScannerChannel", flags, 4, 2);
        const int user = make.field("UserData", ScalarType::U8);
        Attribute& angle = make.plain("ScanAngle", ScalarType::I16);
        angle.scaled = true;
        angle.scale = kScanAngleStep;
        angle.unit = "deg";
        make.attribute("UserData", AttributeKind::Category, user);
    } else {
        make.plain("ScanAngle", ScalarType::I8).unit = "deg";
        make.plain("UserData", ScalarType::U8, AttributeKind::Category);
    }
    make.plain("PointSourceId", ScalarType::U16, AttributeKind::Category);
}

void addWaveform(LayoutMaker& make)
{
    make.plain("WaveformDescriptorIndex", ScalarType::U8, AttributeKind::Category);
    make.plain("WaveformOffset", ScalarType::U64);
    make.plain("WaveformSize", ScalarType::U32);
    make.plain("WaveformReturnLocation", ScalarType::F32).unit = "ps";
    make.plain("WaveformX", ScalarType::F32);
    make.plain("WaveformY", ScalarType::F32);
    make.plain("WaveformZ", ScalarType::F32);
}

/// Whether values are numbers of things, by the name: TreeId, treeID, "tree id", but not Grid.
bool namesIds(std::string_view name)
{
    if (name.size() < 2) return false;
    const char i = name[name.size() - 2], d = name.back();
    if ((i != 'i' && i != 'I') || (d != 'd' && d != 'D')) return false;
    if (name.size() == 2) return true;
    const auto before = static_cast<unsigned char>(name[name.size() - 3]);
    return std::isalpha(before) == 0 || (i == 'I' && std::islower(before) != 0);
}

void addExtra(LayoutMaker& make, const std::string& name, AttributeKind kind, ScalarType type,
              std::uint32_t components, const ExtraBytesItem* item, std::size_t k,
              std::vector<std::string>& warnings)
{
    const std::string unique = make.freeName(name);
    Attribute& a = make.attribute(unique, kind, make.field(unique, type, components));
    a.standard = false;
    if (item == nullptr) return;
    const ExtraBytesDescriptor& d = item->descriptor;
    a.description = d.description();
    if (item->opaque) return;
    if (d.hasScale() || d.hasOffset()) {
        const double scale = d.hasScale() ? d.number(kDescriptorScaleAt, k) : 1.0;
        const double offset = d.hasOffset() ? d.number(kDescriptorOffsetAt, k) : 0.0;
        if (!std::isfinite(scale) || scale == 0.0 || !std::isfinite(offset)) {
            warnings.push_back("The scale or offset of the extra bytes attribute " + unique +
                               " cannot be used; its stored values are shown.");
        } else {
            a.scaled = true;
            a.scale = scale;
            a.offset = offset;
        }
    }
    if (kind == AttributeKind::Scalar && !a.scaled && !isFloating(type) && namesIds(name))
        a.kind = AttributeKind::Category;
    if (d.hasNoData()) {
        const std::uint64_t bits = d.bits(kDescriptorNoDataAt, k);
        if (isFloating(type))
            a.noData = std::bit_cast<double>(bits);
        else if (type == ScalarType::I8 || type == ScalarType::I16 || type == ScalarType::I32 ||
                 type == ScalarType::I64)
            a.noData = std::int64_t(bits);
        else
            a.noData = bits;
    }
}

}  // namespace

int RecordLayout::find(std::string_view column) const noexcept
{
    for (std::size_t k = 0; k < fields.size(); ++k)
        if (fields[k].column == column) return int(k);
    return -1;
}

bool RecordLayout::isDerived(std::string_view column) const noexcept
{
    for (const RecordField& f : derived)
        if (f.column == column) return true;
    return false;
}

std::uint16_t standardRecordLength(std::uint8_t format) noexcept
{
    return format <= kLastPointFormat ? kStandardLengths[format] : std::uint16_t(0);
}

RecordLayout makeLayout(std::uint8_t format, std::uint16_t length, std::span<const Vlr* const> extraBytesRecords,
                        const CoordinateScale& coordinates, std::vector<std::string>& warnings)
{
    const std::uint16_t standard = standardRecordLength(format);
    if (standard == 0) throw Error("Point format " + std::to_string(format) + " is not supported.");
    if (length < standard)
        throw Error("The point records are " + std::to_string(length) + " bytes long, but point format " +
                    std::to_string(format) + " needs " + std::to_string(standard) + ".");

    LayoutMaker make(format, length);
    addCoordinates(make, coordinates);
    addCore(make, isExtendedFormat(format));
    if (hasGpsTime(format)) make.plain("GpsTime", ScalarType::F64).unit = "s";
    if (hasColor(format))
        for (const char* name : {"Red", "Green", "Blue"}) make.plain(name, ScalarType::U16);
    if (hasNir(format)) make.plain("NIR", ScalarType::U16);
    if (hasWaveform(format)) addWaveform(make);
    make.endOfStandard();

    for (const ExtraBytesItem& item : parseExtraBytes(extraBytesRecords, standard, length, warnings)) {
        const std::string name = item.descriptor.name();
        if (item.opaque) {
            addExtra(make, name, AttributeKind::Opaque, ScalarType::U8, item.values, &item, 0, warnings);
            continue;
        }
        for (std::uint32_t k = 0; k < item.values; ++k)
            addExtra(make, item.values == 1 ? name : name + "[" + std::to_string(k) + "]", AttributeKind::Scalar,
                     item.type, 1, &item, k, warnings);
    }
    if (make.at() < length)
        addExtra(make, "ExtraBytes", AttributeKind::Opaque, ScalarType::U8, length - make.at(), nullptr, 0,
                 warnings);
    return make.take();
}

void makeColumns(PointCloud& cloud, const RecordLayout& layout)
{
    for (const RecordField& f : layout.fields)
        cloud.addColumn(std::make_shared<Column>(f.column, f.type, cloud.size(), f.components));
    for (const RecordField& f : layout.derived)
        cloud.addColumn(std::make_shared<Column>(f.column, f.type, cloud.size(), f.components));
    for (std::size_t k = 0; k < layout.attributes.size(); ++k) {
        Attribute a = layout.attributes[k];
        for (std::size_t c = 0; c < a.columns.size(); ++c)
            if (const int field = layout.attributeFields[k][c]; field >= 0)
                a.columns[c] = cloud.columns()[std::size_t(field)];
        cloud.addAttribute(std::move(a));
    }
    addComposite(cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    addNormalVector(cloud);
}

}  // namespace punctum::las
