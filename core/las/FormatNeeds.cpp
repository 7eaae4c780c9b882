// SPDX-License-Identifier: MIT
#include "core/las/FormatNeeds.h"

#include "core/Text.h"
#include "core/las/Parallel.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>

namespace punctum::las
{

namespace
{

/// How many points have each kind of value that a format cannot hold.
struct Misfits {
    enum Kind { Class, Returns, Overlap, Channel, Angle, Gps, Color, Nir, Waveform, kKinds };
    std::array<std::uint64_t, kKinds> counts{};

    void include(const Misfits& o)
    {
        for (std::size_t k = 0; k < kKinds; ++k) counts[k] += o.counts[k];
    }
    std::vector<Loss> list() const
    {
        static const Loss kWhat[kKinds] = {
            {"a class above 31", "becomes class 1 (unclassified)"},
            {"more than 7 returns", "become 7: the last one is number 7, the others 6 at most"},
            {"the overlap flag", "is left out"},
            {"a scanner channel", "is left out"},
            {"a scan angle that is no whole degree", "is rounded"},
            {"a GPS time", "is left out"},
            {"colors", "are left out"},
            {"near infrared", "is left out"},
            {"a waveform", "is left out"},
        };
        std::vector<Loss> all;
        for (std::size_t k = 0; k < kKinds; ++k)
            if (counts[k] != 0) all.push_back({kWhat[k].what, kWhat[k].becomes, counts[k]});
        return all;
    }
};

std::uint64_t countUsed(const std::vector<std::shared_ptr<const Column>>& columns, PointRange r)
{
    std::uint64_t n = 0;
    for (PointIndex i = r.first; i < r.last; ++i) {
        bool used = false;
        for (const auto& c : columns) {
            const std::byte* p = c->data() + i * c->elementBytes();
            used = used || std::any_of(p, p + c->elementBytes(), [](std::byte b) { return b != std::byte(0); });
        }
        n += used ? 1 : 0;
    }
    return n;
}

void countHighClasses(Misfits& m, const Column& classes, PointRange r)
{
    const auto* p = reinterpret_cast<const std::uint8_t*>(classes.data());
    std::uint64_t n = 0;
    for (PointIndex i = r.first; i < r.last; ++i) n += p[i] > kHighestOldClass;
    m.counts[Misfits::Class] += n;
}

/// What formats 0-5 cannot say of a record of the formats 6-10, but for the class.
void countExtended(Misfits& m, const PackedColumns& packed, PointRange r)
{
    const auto* returns = reinterpret_cast<const std::uint8_t*>(packed.returns->data());
    const auto* flags = reinterpret_cast<const std::uint8_t*>(packed.flags->data());
    const auto* classes = reinterpret_cast<const std::uint8_t*>(packed.classes->data());
    const auto* angles = reinterpret_cast<const std::int16_t*>(packed.angle->data());
    for (PointIndex i = r.first; i < r.last; ++i) {
        m.counts[Misfits::Returns] += (returns[i] & 15) > kMostOldReturns || (returns[i] >> 4) > kMostOldReturns;
        // class 12 says the same
        m.counts[Misfits::Overlap] += (flags[i] & 8) != 0 && classes[i] != kOverlapClass;
        m.counts[Misfits::Channel] += (flags[i] & 0x30) != 0;
        const long degrees = std::lround(angles[i] * kScanAngleStep);
        m.counts[Misfits::Angle] +=
            degrees < -128 || degrees > 127 || std::lround(double(degrees) / kScanAngleStep) != angles[i];
    }
}

/// Whether a column of the standard's name and type is there that is no field of the source's record.
bool wasAdded(const PointCloud& cloud, const SourceFile& source, const char* name, ScalarType type)
{
    const auto c = findColumn(cloud, name);
    return c != nullptr && c->type() == type && c->components() == 1 && source.layout.find(name) < 0;
}

}  // namespace

std::uint8_t oldestMinor(std::uint8_t format) noexcept
{
    if (isExtendedFormat(format)) return 4;
    if (hasWaveform(format)) return 3;
    return format >= 2 ? 2 : 0;
}

std::uint8_t newestMinor(std::uint8_t format) noexcept
{
    return isExtendedFormat(format) ? kNewestMinor : 4;
}

std::uint8_t formatIn(std::uint8_t format, std::uint8_t minor) noexcept
{
    constexpr std::uint8_t kExtended[] = {6, 6, 7, 7, 9, 10}, kClassic[] = {1, 3, 3, 4, 5};
    if (minor > newestMinor(format)) return kExtended[format];
    if (isExtendedFormat(format) && minor < oldestMinor(format)) format = kClassic[format - 6];
    if (hasWaveform(format) && minor < 3) format = format == 4 ? 1 : 3;
    return format;
}

std::string Loss::text() const
{
    if (points == 0) return what;
    return grouped(points) + (points == 1 ? " point has " : " points have ") + what;
}

std::shared_ptr<const Column> findColumn(const PointCloud& cloud, std::string_view name)
{
    for (const auto& c : cloud.columns())
        if (c->name() == name) return c;
    return nullptr;
}

PackedColumns packedColumns(const PointCloud& cloud, const SourceFile& source)
{
    PackedColumns packed;
    packed.extended = isExtendedFormat(source.layout.format);
    packed.returns = findColumn(cloud, "Returns");
    packed.flags = findColumn(cloud, packed.extended ? "Flags" : "Classes");
    packed.angle = findColumn(cloud, "ScanAngle");
    packed.classes = findColumn(cloud, "Classification");
    const bool whole =
        packed.classes && packed.classes->type() == ScalarType::U8 && packed.classes->components() == 1;
    if (!whole || (!packed.extended && source.layout.find("Classification") >= 0)) packed.classes = nullptr;
    return packed;
}

std::uint8_t FormatNeeds::formatFor(std::uint8_t format) const noexcept
{
    if ((extended || nir) && !isExtendedFormat(format)) format = formatIn(format, kNewestMinor);
    if (gps && !hasGpsTime(format)) ++format;  // 0 -> 1, 2 -> 3
    if (color && !hasColor(format)) {
        constexpr std::uint8_t kColored[] = {2, 3, 2, 3, 5, 5, 7, 7, 8, 10, 10};
        format = kColored[format];
    }
    if (nir && !hasNir(format)) format = hasWaveform(format) ? 10 : 8;
    return format;
}

FormatNeeds findNeeds(const PointCloud& cloud, const SourceFile& source, const std::vector<PointRange>& kept,
                      Progress& progress)
{
    FormatNeeds needs;
    const PackedColumns packed = packedColumns(cloud, source);
    if (!packed.extended && packed.classes) {
        const auto found = reducePoints<Misfits>(
            kept, progress, [&](Misfits& m, PointRange r) { countHighClasses(m, *packed.classes, r); });
        for (const Loss& loss : found.list()) needs.reasons.push_back(loss.text());
        needs.extended = !needs.reasons.empty();
    }
    const std::uint8_t format = source.layout.format;
    const auto added = [&](const char* name, ScalarType type) { return wasAdded(cloud, source, name, type); };
    if (!hasGpsTime(format) && added("GpsTime", ScalarType::F64)) {
        needs.gps = true;
        needs.reasons.emplace_back("GPS times were added");
    }
    if (!hasColor(format) && added("Red", ScalarType::U16) && added("Green", ScalarType::U16) &&
        added("Blue", ScalarType::U16)) {
        needs.color = true;
        needs.reasons.emplace_back("colors were added");
    }
    if (!hasNir(format) && added("NIR", ScalarType::U16)) {
        needs.nir = true;
        needs.reasons.emplace_back("near infrared was added");
    }
    return needs;
}

std::vector<Loss> findLosses(const PointCloud& cloud, const SourceFile& source, const std::vector<PointRange>& kept,
                             std::uint8_t to, Progress& progress)
{
    const std::uint8_t from = source.layout.format;
    const auto dropped = [&](auto has, std::initializer_list<const char*> names) {
        std::vector<std::shared_ptr<const Column>> columns;
        if (has(from) && !has(to))
            for (const char* name : names)
                if (auto c = findColumn(cloud, name)) columns.push_back(std::move(c));
        return columns;
    };
    const std::pair<Misfits::Kind, std::vector<std::shared_ptr<const Column>>> parts[] = {
        {Misfits::Gps, dropped(hasGpsTime, {"GpsTime"})},
        {Misfits::Color, dropped(hasColor, {"Red", "Green", "Blue"})},
        {Misfits::Nir, dropped(hasNir, {"NIR"})},
        {Misfits::Waveform,
         dropped(hasWaveform, {"WaveformDescriptorIndex", "WaveformOffset", "WaveformSize",
                               "WaveformReturnLocation", "WaveformX", "WaveformY", "WaveformZ"})}};
    const PackedColumns packed = packedColumns(cloud, source);
    const bool old = !isExtendedFormat(to);
    const bool nothing =
        std::all_of(std::begin(parts), std::end(parts), [](const auto& part) { return part.second.empty(); });
    if (nothing && (!old || (!packed.extended && !packed.classes))) return {};

    const auto misfits = reducePoints<Misfits>(kept, progress, [&](Misfits& m, PointRange r) {
        for (const auto& [kind, columns] : parts)
            if (!columns.empty()) m.counts[kind] += countUsed(columns, r);
        if (old && packed.classes) countHighClasses(m, *packed.classes, r);
        if (old && packed.extended) countExtended(m, packed, r);
    });
    return misfits.list();
}

}  // namespace punctum::las
