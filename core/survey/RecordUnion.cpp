// SPDX-License-Identifier: MIT
#include "core/survey/RecordUnion.h"

#include "core/las/ExtraBytes.h"
#include "core/las/GeoKeys.h"
#include "core/survey/PackedFields.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace punctum
{

namespace
{

using las::ExtraBytesDescriptor;
using las::RecordLayout;

/// The format that has the fields of all of them.
std::uint8_t unitedFormat(std::span<const std::shared_ptr<const las::SourceFile>> files)
{
    bool extended = false, gps = false, color = false, nir = false, wave = false;
    for (const auto& file : files) {
        const std::uint8_t f = file->layout.shownFormat();
        extended |= las::isExtendedFormat(f);
        gps |= las::hasGpsTime(f);
        color |= las::hasColor(f);
        nir |= las::hasNir(f);
        wave |= las::hasWaveform(f);
    }
    if (extended) return std::uint8_t(wave ? (color || nir ? 10 : 9) : nir ? 8 : color ? 7 : 6);
    if (wave) return std::uint8_t(color ? 5 : 4);
    return std::uint8_t((gps ? 1 : 0) + (color ? 2 : 0));
}

/// What is the same in two descriptors that can share a column: all but the description and the range.
std::string keyOf(const las::ExtraBytesItem& item)
{
    constexpr std::size_t kBytes = 8;  // of a number in a descriptor
    const ExtraBytesDescriptor& d = item.descriptor;
    std::string key = d.name() + '\0' + char(item.type) + char(item.values) + char(d.options() & 0x19);
    const auto add = [&](bool has, std::size_t at) {
        if (has) key.append(reinterpret_cast<const char*>(d.bytes.data()) + at, kBytes * item.values);
    };
    add(d.hasNoData(), las::kDescriptorNoDataAt);
    add(d.hasScale(), las::kDescriptorScaleAt);
    add(d.hasOffset(), las::kDescriptorOffsetAt);
    return key;
}

/// As a union has it: without minimum and maximum, which are one file's.
ExtraBytesDescriptor withoutRange(ExtraBytesDescriptor d)
{
    d.bytes[3] &= std::byte(0xF9);
    std::fill(d.bytes.begin() + las::kDescriptorMinAt, d.bytes.begin() + las::kDescriptorScaleAt, std::byte(0));
    return d;
}

/// The name of the attribute that shows a field by itself; empty when none does.
std::string attributeOf(const RecordLayout& layout, std::int32_t field)
{
    for (std::size_t k = 0; k < layout.attributes.size(); ++k)
        if (layout.attributes[k].components == 1 && layout.attributeFields[k][0] == field)
            return layout.attributes[k].name;
    return {};
}

/// Whether a field holds a part of what LAS 1.4 has, in compatibility mode.
bool isStoredForm(const RecordLayout& layout, std::int32_t field)
{
    if (!layout.compatible) return false;
    const las::CompatibleFields& c = *layout.compatible;
    const std::int32_t parts[] = {c.returns,      c.classes,    c.rank,       c.angle,
                                  c.extraReturns, c.extraClass, c.extraFlags, c.nir};
    return std::find(std::begin(parts), std::end(parts), field) != std::end(parts);
}

class Uniter
{
public:
    Uniter(std::span<const std::shared_ptr<const las::SourceFile>> files, const CoordinateScale& coordinates)
        : m_files(files), m_coordinates(coordinates)
    {
    }

    RecordUnion unite(PointIndex points)
    {
        for (const auto& file : m_files) collectExtra(*file);
        RecordUnion all;
        m_format = unitedFormat(m_files);
        all.source = las::makeSource(m_format, records(), m_coordinates, encoding(), points);
        m_layout = &all.source->layout;
        // fields of each descriptor follow those of the standard, in order
        std::int32_t next = 0;
        while (std::size_t(next) < m_layout->fields.size() &&
               m_layout->fields[std::size_t(next)].offset < las::standardRecordLength(m_format))
            ++next;
        for (const Extra& extra : m_extra) {
            m_fieldOf.push_back(next);
            next += std::int32_t(extra.values);
        }
        for (std::size_t k = 0; k < m_files.size(); ++k) all.parts.push_back(linksOf(k));
        return all;
    }

private:
    struct Extra {
        ExtraBytesDescriptor descriptor;
        std::uint32_t values = 1;
    };
    /// Descriptor `extra` of the union describes `values` fields of a file, from `field` on.
    struct Use {
        std::int32_t field = 0;
        std::size_t extra = 0;
        std::uint32_t values = 1;
    };

    void collectExtra(const las::SourceFile& file)
    {
        const RecordLayout& layout = file.layout;
        const std::uint16_t standard = las::standardRecordLength(layout.format);
        std::vector<std::string> ignored;
        std::map<std::string, std::size_t> seen;  // how often each key came in this file
        std::int32_t field = 0;
        while (std::size_t(field) < layout.fields.size() && layout.fields[std::size_t(field)].offset < standard)
            ++field;
        std::vector<Use> uses;
        const auto descriptors = file.extraBytesRecords();
        for (const las::ExtraBytesItem& item :
             las::parseExtraBytes(descriptors, standard, layout.length, ignored)) {
            const std::uint32_t values = item.opaque ? 1 : item.values;
            if (!item.opaque && !isStoredForm(layout, field)) {
                const std::string key = keyOf(item);
                std::vector<std::size_t>& known = m_known[key];
                const std::size_t turn = seen[key]++;
                if (turn == known.size()) {
                    known.push_back(m_extra.size());
                    m_extra.push_back({withoutRange(item.descriptor), values});
                }
                uses.push_back({field, known[turn], values});
            }
            field += std::int32_t(values);
        }
        m_uses.push_back(std::move(uses));
    }

    /// Coordinate system and extra bytes.
    std::vector<las::Vlr> records() const
    {
        std::vector<las::Vlr> records;
        if (const las::SourceFile* const first = firstWithCrs())
            for (const auto* list : {&first->vlrs, &first->evlrs})
                for (const las::Vlr& vlr : *list)
                    if (vlr.user() == las::geo::kUser) records.push_back(vlr);
        std::vector<std::byte> bytes;
        for (const Extra& extra : m_extra)
            bytes.insert(bytes.end(), extra.descriptor.bytes.begin(), extra.descriptor.bytes.end());
        if (!bytes.empty())
            records.push_back(
                las::makeVlr("LASF_Spec", las::kExtraBytesRecordId, "Extra Bytes Record", std::move(bytes)));
        return records;
    }

    const las::SourceFile* firstWithCrs() const
    {
        for (const auto& file : m_files)
            if (!file->crs.empty()) return file.get();
        return nullptr;
    }

    std::uint16_t encoding() const
    {
        const auto timed = std::find_if(m_files.begin(), m_files.end(), [](const auto& file) {
            return las::hasGpsTime(file->layout.shownFormat());
        });
        std::uint16_t bits = 0;
        if (timed != m_files.end()) bits = (*timed)->header.globalEncoding() & las::encoding::kAdjustedGpsTime;
        const las::SourceFile* const first = firstWithCrs();
        if (las::isExtendedFormat(m_format) || (first != nullptr && first->header.says(las::encoding::kWkt)))
            bits |= las::encoding::kWkt;
        return bits;
    }

    RecordLinks linksOf(std::size_t part) const
    {
        const RecordLayout& own = m_files[part]->layout;
        RecordLinks links;
        links.fields.resize(own.fields.size() + own.derived.size());
        links.converted = las::isExtendedFormat(m_format) && !las::isExtendedFormat(own.shownFormat());
        const std::uint16_t standard = las::standardRecordLength(own.format);
        for (std::size_t k = 0; k < links.fields.size(); ++k) {
            const auto field = std::int32_t(k);
            const las::RecordField& f = own.field(field);
            std::string name = f.column;
            if (k >= own.fields.size()) {
                name.resize(name.size() - std::strlen(las::kDerivedEnding));
            } else if (own.compatible && field == own.compatible->nir) {
                name = "NIR";
            } else if (f.offset >= standard || isStoredForm(own, field) ||
                       (links.converted && isClassicField(name))) {
                continue;
            }
            link(own, field, m_layout->find(name), links.fields[k]);
        }
        for (const Use& use : m_uses[part])
            for (std::uint32_t v = 0; v < use.values; ++v)
                link(own, use.field + std::int32_t(v), m_fieldOf[use.extra] + std::int32_t(v),
                     links.fields[std::size_t(use.field) + v]);
        return links;
    }

    void link(const RecordLayout& own, std::int32_t field, std::int32_t column, FieldLink& link) const
    {
        if (column < 0) return;
        const las::RecordField &f = own.field(field), &c = m_layout->fields[std::size_t(column)];
        if (f.type != c.type || f.components != c.components) return;
        link = {column, attributeOf(own, field), attributeOf(*m_layout, column)};
    }

    std::span<const std::shared_ptr<const las::SourceFile>> m_files;
    CoordinateScale m_coordinates;
    std::uint8_t m_format = 0;
    std::vector<Extra> m_extra;
    std::map<std::string, std::vector<std::size_t>> m_known;  ///< into m_extra, by keyOf()
    std::vector<std::vector<Use>> m_uses;                     ///< of each file
    const RecordLayout* m_layout = nullptr;                   ///< of the union
    std::vector<std::int32_t> m_fieldOf;                      ///< first field of each of m_extra
};

}  // namespace

RecordUnion uniteRecords(std::span<const std::shared_ptr<const las::SourceFile>> files,
                         const CoordinateScale& coordinates, PointIndex points)
{
    return Uniter(files, coordinates).unite(points);
}

}  // namespace punctum
