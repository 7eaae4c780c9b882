// SPDX-License-Identifier: MIT
#include "core/las/Compatible.h"

#include "core/Error.h"
#include "core/las/ExtraBytes.h"
#include "core/las/SourceFile.h"
#include "core/task/LockedLoop.h"

#include <algorithm>
#include <cstring>
#include <mutex>

namespace punctum::las
{

namespace
{

constexpr std::size_t kRecordSize = 156;  ///< 8 bytes of LASzip's, then the LAS 1.4 header from byte 227 on
constexpr std::size_t kCountAt = 8 + at::kPointCount.offset - at::kWaveformStart.offset;
constexpr std::size_t kByReturnAt = 8 + at::kByReturn.offset - at::kWaveformStart.offset;
constexpr float kAngleStep = 0.006f;     ///< LASzip computes in floats, and so do we
constexpr std::size_t kPiece = 1 << 16;  ///< points that one task takes

/// Fields of a record in compatibility mode.
struct Stored {
    std::uint8_t returns = 0, classes = 0;
    std::int8_t rank = 0;
    std::int16_t angle = 0;
    std::uint8_t extraReturns = 0, extraClass = 0, extraFlags = 0;
};

/// What they mean: fields of formats 6 to 10 (LAS 1.4 R15, table 13).
struct Meant {
    std::uint8_t returns = 0, flags = 0, classification = 0;
    std::int16_t angle = 0;
};

/// Rounded as LASzip rounds.
int quantized(float x)
{
    return x >= 0 ? int(x + 0.5f) : int(x - 0.5f);
}

int stepsOf(std::int8_t rank)
{
    return quantized(float(rank) / kAngleStep);
}

Meant decoded(const Stored& s)
{
    const unsigned number = (s.returns & 7u) + (s.extraReturns >> 4u);
    const unsigned of = (s.returns >> 3u & 7u) + (s.extraReturns & 15u);
    Meant m;
    m.returns = std::uint8_t((number & 15u) | (of & 15u) << 4u);
    m.flags = std::uint8_t(s.classes >> 5u | (s.extraFlags & 7u) << 3u | (s.returns & 0xC0u));
    m.classification = std::uint8_t((s.classes & 31u) + s.extraClass);
    m.angle = std::int16_t(s.angle + stepsOf(s.rank));
    return m;
}

/// The older return number and number of returns that LASzip stores for these.
void classicReturns(unsigned number, unsigned of, unsigned& classicNumber, unsigned& classicOf)
{
    classicOf = std::min(of, 7u);
    if (of <= 7 || number <= 4)
        classicNumber = std::min(number, 7u);
    else  // the last returns of a pulse stay the last ones
        classicNumber = number >= of ? 7u : std::max(4u, 7u - (of - number));
}

/// Changes the fields, and only those, that mean something else than `meant` says.
void encode(const Meant& meant, Stored& s)
{
    const Meant now = decoded(s);
    if (now.returns != meant.returns) {
        unsigned number = 0, of = 0;
        classicReturns(meant.returns & 15u, meant.returns >> 4u, number, of);
        s.returns = std::uint8_t((s.returns & 0xC0u) | number | of << 3u);
        s.extraReturns = std::uint8_t(((meant.returns & 15u) - number) << 4u | ((meant.returns >> 4u) - of));
    }
    if (now.flags != meant.flags) {
        s.returns = std::uint8_t((s.returns & 0x3Fu) | (meant.flags & 0xC0u));
        s.classes = std::uint8_t((s.classes & 31u) | (meant.flags & 7u) << 5u);
        s.extraFlags = std::uint8_t((s.extraFlags & ~7u) | (meant.flags >> 3u & 7u));
    }
    if (now.classification != meant.classification) {
        const bool fits = meant.classification <= 31;
        s.classes = std::uint8_t((s.classes & 0xE0u) | (fits ? meant.classification : 0u));
        s.extraClass = fits ? std::uint8_t(0) : meant.classification;
    }
    if (now.angle != meant.angle) {
        s.rank = std::int8_t(std::clamp(quantized(float(meant.angle) * kAngleStep), -128, 127));
        s.angle = std::int16_t(meant.angle - stepsOf(s.rank));
    }
}

/// Where the fields are: pointers to those of the first point, and the bytes from one point to the next.
template <typename Byte>
struct StoredPlaces {
    std::array<Byte*, 7> first{};
    std::array<std::size_t, 7> step{};
    static constexpr std::array<std::size_t, 7> kBytes{1, 1, 1, 2, 1, 1, 1};

    Stored get(std::size_t i) const
    {
        Stored s;
        void* const to[] = {&s.returns,      &s.classes,    &s.rank,      &s.angle,
                            &s.extraReturns, &s.extraClass, &s.extraFlags};
        for (std::size_t k = 0; k < 7; ++k) std::memcpy(to[k], first[k] + i * step[k], kBytes[k]);
        return s;
    }
    void put(std::size_t i, const Stored& s) const
    {
        const void* const from[] = {&s.returns,      &s.classes,    &s.rank,      &s.angle,
                                    &s.extraReturns, &s.extraClass, &s.extraFlags};
        for (std::size_t k = 0; k < 7; ++k) std::memcpy(first[k] + i * step[k], from[k], kBytes[k]);
    }
};

std::array<std::int32_t, 7> fieldsOf(const CompatibleFields& c)
{
    return {c.returns, c.classes, c.rank, c.angle, c.extraReturns, c.extraClass, c.extraFlags};
}

int findField(const RecordLayout& layout, const char* name, ScalarType type)
{
    const int k = layout.find(name);
    return k >= 0 && layout.fields[std::size_t(k)].type == type && layout.fields[std::size_t(k)].components == 1
               ? k
               : -1;
}

/// Attributes of format `like`, on the fields of `layout` and what is derived from them.
void replaceAttributes(RecordLayout& layout, const CompatibleFields& c, const CoordinateScale& coordinates)
{
    std::vector<std::string> none;
    const RecordLayout like = makeLayout(c.format, standardRecordLength(c.format), {}, coordinates, none);
    const auto placeOf = [&](const std::string& column) -> std::int32_t {
        for (std::size_t k = 0; k < layout.derived.size(); ++k)
            if (layout.derived[k].column == column + kDerivedEnding) return std::int32_t(layout.fields.size() + k);
        if (column == "NIR") return c.nir;
        return layout.find(column);
    };
    std::vector<Attribute> attributes = like.attributes;
    std::vector<std::array<std::int32_t, 3>> places;
    for (const auto& fields : like.attributeFields)
        places.push_back({placeOf(like.fields[std::size_t(fields[0])].column), -1, -1});

    const auto used = fieldsOf(c);
    for (std::size_t k = 0; k < layout.attributes.size(); ++k) {
        const std::int32_t field = layout.attributeFields[k][0];
        if (layout.attributes[k].standard || field == c.nir ||
            std::find(used.begin(), used.end(), field) != used.end())
            continue;
        attributes.push_back(layout.attributes[k]);
        places.push_back(layout.attributeFields[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) attributes[k].unit = layout.attributes[k].unit;
    layout.attributes = std::move(attributes);
    layout.attributeFields = std::move(places);
}

}  // namespace

bool useCompatibility(const SourceFile& source, RecordLayout& layout, std::vector<std::string>& warnings)
{
    const Vlr* record = source.findVlr(kCompatibleUser, kCompatibleRecordId);
    if (record == nullptr || isExtendedFormat(layout.format)) return false;
    CompatibleFields c;
    c.returns = layout.find("Returns");
    c.classes = layout.find("Classes");
    c.rank = layout.find("ScanAngle");
    c.angle = findField(layout, "LAS 1.4 scan angle", ScalarType::I16);
    c.extraReturns = findField(layout, "LAS 1.4 extended returns", ScalarType::U8);
    c.extraClass = findField(layout, "LAS 1.4 classification", ScalarType::U8);
    c.extraFlags = findField(layout, "LAS 1.4 flags and channel", ScalarType::U8);
    c.nir = findField(layout, "LAS 1.4 NIR band", ScalarType::U16);
    const auto fields = fieldsOf(c);
    const bool all = std::all_of(fields.begin(), fields.end(), [](std::int32_t f) { return f >= 0; });
    switch (layout.format) {
        case 1:
            c.format = 6;
            break;
        case 3:
            c.format = c.nir >= 0 ? 8 : 7;
            break;
        case 4:
            c.format = 9;
            break;
        case 5:
            c.format = c.nir >= 0 ? 10 : 0;
            break;
        default:
            break;
    }
    if (!all || c.format == 0 || record->data.size() != kRecordSize) {
        warnings.push_back(
            "The file claims to hold LAS 1.4 in compatibility mode, but lacks the fields for it; what is stored is "
            "shown.");
        return false;
    }
    std::uint16_t at = layout.length;
    const auto derive = [&](const char* column, ScalarType type) {
        layout.derived.push_back({std::string(column) + kDerivedEnding, at, type, 1});
        at = std::uint16_t(at + sizeOf(type));
    };
    derive("Returns", ScalarType::U8);
    derive("Flags", ScalarType::U8);
    derive("Classification", ScalarType::U8);
    derive("ScanAngle", ScalarType::I16);
    replaceAttributes(layout, c, source.coordinates);
    layout.compatible = c;
    return true;
}

void decodeCompatible(const RecordLayout& layout, std::span<std::byte* const> columns, std::size_t count)
{
    if (!layout.compatible) return;
    StoredPlaces<std::byte> places;
    const auto fields = fieldsOf(*layout.compatible);
    for (std::size_t k = 0; k < 7; ++k) {
        places.first[k] = columns[std::size_t(fields[k])];
        places.step[k] = places.kBytes[k];
    }
    std::byte* const* const to = columns.data() + layout.fields.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Meant m = decoded(places.get(i));
        std::memcpy(to[0] + i, &m.returns, 1);
        std::memcpy(to[1] + i, &m.flags, 1);
        std::memcpy(to[2] + i, &m.classification, 1);
        std::memcpy(to[3] + 2 * i, &m.angle, 2);
    }
}

void expandCompatible(const RecordLayout& layout, const std::byte* record, std::byte* expanded)
{
    std::memcpy(expanded, record, layout.length);
    StoredPlaces<const std::byte> places;
    const auto fields = fieldsOf(*layout.compatible);
    for (std::size_t k = 0; k < 7; ++k) places.first[k] = record + layout.fields[std::size_t(fields[k])].offset;
    const Meant m = decoded(places.get(0));
    const void* const from[] = {&m.returns, &m.flags, &m.classification, &m.angle};
    for (std::size_t k = 0; k < 4; ++k)
        std::memcpy(expanded + layout.derived[k].offset, from[k], layout.derived[k].bytes());
}

void storeCompatible(const PointCloud& cloud)
{
    if (cloud.source() == nullptr || !cloud.source()->layout.compatible) return;
    const RecordLayout& layout = cloud.source()->layout;
    const std::unique_lock lock(cloud.mutex());
    const auto column = [&](const RecordField& f) -> std::byte* {
        for (const auto& c : cloud.columns())
            if (c->name() == f.column && c->type() == f.type) return c->data();
        return nullptr;
    };
    StoredPlaces<std::byte> places;
    const auto fields = fieldsOf(*layout.compatible);
    for (std::size_t k = 0; k < 7; ++k) {
        places.first[k] = column(layout.fields[std::size_t(fields[k])]);
        places.step[k] = places.kBytes[k];
        if (places.first[k] == nullptr) return;
    }
    const std::byte* from[4];
    for (std::size_t k = 0; k < 4; ++k) {
        from[k] = column(layout.derived[k]);
        if (from[k] == nullptr) return;
    }
    forPiecesLocked(lock, cloud.size(), kPiece, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i != last; ++i) {
            Meant m;
            std::memcpy(&m.returns, from[0] + i, 1);
            std::memcpy(&m.flags, from[1] + i, 1);
            std::memcpy(&m.classification, from[2] + i, 1);
            std::memcpy(&m.angle, from[3] + 2 * i, 2);
            Stored s = places.get(i);
            encode(m, s);
            places.put(i, s);
        }
    });
}

std::shared_ptr<PointCloud> nativeCloud(const PointCloud& cloud, std::optional<std::uint8_t> format)
{
    if (cloud.source() == nullptr || !cloud.source()->layout.compatible) return nullptr;
    if (!format || !isExtendedFormat(*format)) return nullptr;
    const SourceFile& old = *cloud.source();
    const CompatibleFields& c = *old.layout.compatible;
    auto source = std::make_shared<SourceFile>(old);

    // The header of 1.4, whose latter part the record has kept. Records that were VLRs stay such.
    const Vlr record = *old.findVlr(kCompatibleUser, kCompatibleRecordId);
    Header& h = source->header;
    const std::size_t standard = h.standardEnd();
    const std::vector<std::byte> user(h.bytes.begin() + std::ptrdiff_t(standard), h.bytes.end());
    h.bytes.resize(std::min(standard, at::kWaveformStart.offset));
    h.bytes.insert(h.bytes.end(), record.data.begin() + 8, record.data.end());
    h.bytes.insert(h.bytes.end(), user.begin(), user.end());
    h.set(at::kVersionMinor, 4);
    h.set(at::kHeaderSize, std::uint16_t(h.bytes.size()));
    h.set(at::kEvlrStart, 0);
    h.set(at::kEvlrCount, std::uint32_t(source->evlrs.size()));
    if (old.header.versionMinor() >= 3) h.set(at::kWaveformStart, old.header.get(at::kWaveformStart));
    h.set(at::kLegacyCount, 0);
    for (std::size_t k = 0; k < 5; ++k) h.set(at::kLegacyByReturn[k], 0);

    // Extra bytes without those that held fields of 1.4.
    auto hidden = fieldsOf(c);
    const auto isHidden = [&](std::size_t k) {
        const auto field = std::int32_t(k);
        return field == c.nir || std::find(hidden.begin(), hidden.end(), field) != hidden.end();
    };
    const std::uint16_t classic = standardRecordLength(old.layout.format);
    std::vector<std::string> ignored;
    std::size_t shorter = 0;
    for (auto* list : {&source->vlrs, &source->evlrs}) {
        std::erase_if(*list, [](const Vlr& v) { return v.is(kCompatibleUser, kCompatibleRecordId); });
        for (Vlr& vlr : *list) {
            if (!vlr.is("LASF_Spec", kExtraBytesRecordId)) continue;
            std::vector<std::byte> kept;
            for (std::size_t at = 0; at + ExtraBytesDescriptor::kSize <= vlr.data.size();
                 at += ExtraBytesDescriptor::kSize) {
                ExtraBytesDescriptor d;
                std::memcpy(d.bytes.data(), vlr.data.data() + at, ExtraBytesDescriptor::kSize);
                const int field = old.layout.find(d.name());
                if (field >= 0 && isHidden(std::size_t(field))) continue;
                kept.insert(kept.end(), d.bytes.begin(), d.bytes.end());
            }
            vlr.data = std::move(kept);
        }
        std::erase_if(*list, [](const Vlr& v) { return v.is("LASF_Spec", kExtraBytesRecordId) && v.data.empty(); });
    }
    for (std::size_t k = 0; k < old.layout.fields.size(); ++k)
        if (old.layout.fields[k].offset >= classic && isHidden(k)) shorter += old.layout.fields[k].bytes();
    const auto length = std::uint16_t(standardRecordLength(c.format) + old.layout.length - classic - shorter);
    h.set(at::kVlrCount, std::uint32_t(source->vlrs.size()));
    h.set(at::kPointFormat, std::uint8_t(c.format | (old.compressed ? 0x80 : 0)));
    h.set(at::kRecordLength, length);
    source->layout = makeLayout(c.format, length, source->extraBytesRecords(), old.coordinates, ignored);

    auto native = std::make_shared<PointCloud>(cloud.size(), cloud.coordinates());
    const auto named = [&](const std::string& name) -> std::shared_ptr<Column> {
        for (const auto& column : cloud.columns())
            if (column->name() == name) return column;
        return nullptr;
    };
    for (const RecordField& f : source->layout.fields) {
        auto derived = named(f.column + kDerivedEnding);
        if (derived == nullptr && f.column == "NIR" && c.nir >= 0)
            derived = named(old.layout.fields[std::size_t(c.nir)].column);
        if (derived == nullptr) {
            auto column = named(f.column);
            if (column == nullptr && f.offset >= standardRecordLength(c.format)) continue;  // it was removed
            if (column == nullptr) throw Error("The cloud lacks " + f.column + " and cannot be converted.");
            native->addColumn(std::move(column));
            continue;
        }
        auto copy = std::make_shared<Column>(f.column, f.type, cloud.size(), f.components);
        std::memcpy(copy->data(), derived->data(), std::size_t(cloud.size()) * copy->elementBytes());
        native->addColumn(std::move(copy));
    }
    // What was added since: not of the file, nor derived.
    for (const auto& column : cloud.columns())
        if (old.layout.find(column->name()) < 0 && !old.layout.isDerived(column->name())) native->addColumn(column);
    for (const Attribute& a : cloud.attributes())
        if (!a.standard) native->addAttribute(a);
    native->setDeleted(cloud.deleted());
    native->setUnits(cloud.units());
    native->setSource(std::move(source));
    return native;
}

void setCompatibleCounts(Vlr& record, PointIndex points, std::span<const std::uint64_t, 16> byReturn)
{
    if (record.data.size() != kRecordSize) return;
    const std::uint64_t count = points;
    std::memcpy(record.data.data() + kCountAt, &count, sizeof count);
    std::memcpy(record.data.data() + kByReturnAt, byReturn.data() + 1, 15 * sizeof(std::uint64_t));
}

}  // namespace punctum::las
