// SPDX-License-Identifier: MIT
#include "core/las/ExtraBytesRange.h"

#include "core/las/FormatNeeds.h"
#include "core/las/Parallel.h"
#include "core/las/SourceFile.h"

#include <cmath>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr unsigned kMinBit = 2, kMaxBit = 4;
constexpr std::size_t kOptionsAt = 3;

template <typename T>
struct Extremes {
    bool any = false;
    T min{}, max{};

    void include(T v)
    {
        min = any ? std::min(min, v) : v;
        max = any ? std::max(max, v) : v;
        any = true;
    }
    void include(const Extremes& o)
    {
        if (!o.any) return;
        include(o.min);
        include(o.max);
    }
};

/// As an "anytype" of a descriptor (LAS 1.4 R15, table 24): the value in the 8-byte type of its kind.
template <typename T>
std::uint64_t anytype(T v)
{
    if constexpr (std::is_floating_point_v<T>)
        return std::bit_cast<std::uint64_t>(double(v));
    else if constexpr (std::is_signed_v<T>)
        return std::uint64_t(std::int64_t(v));
    else
        return std::uint64_t(v);
}

}  // namespace

std::vector<ExtraBytesRange> extraBytesRanges(const PointCloud& cloud, const SourceFile& source,
                                              const std::vector<PointRange>& points, Progress& progress)
{
    std::vector<ExtraBytesRange> ranges;
    const auto records = source.extraBytesRecords();
    const RecordLayout& layout = source.layout;
    const std::uint16_t standard = standardRecordLength(layout.format);
    std::vector<std::string> ignored;
    std::size_t field = 0;
    while (field < layout.fields.size() && layout.fields[field].offset < standard) ++field;
    const auto items = parseExtraBytes(records, standard, layout.length, ignored);
    for (std::size_t k = 0; k < items.size(); ++k) {
        const ExtraBytesItem& item = items[k];
        const std::size_t values = item.opaque ? 1 : item.values;
        const bool stated = !item.opaque && (item.descriptor.options() & (kMinBit | kMaxBit)) != 0;
        for (std::size_t c = 0; c < values; ++c, ++field) {
            if (!stated) continue;
            const auto column = findColumn(cloud, layout.fields[field].column);
            if (!column || column->type() != item.type || column->components() != 1) continue;
            visitScalar(item.type, [&](auto zero) {
                using T = decltype(zero);
                const auto* v = reinterpret_cast<const T*>(column->data());
                const bool hasNone = item.descriptor.hasNoData();
                const std::uint64_t none = item.descriptor.bits(kDescriptorNoDataAt, c);
                const auto found = reducePoints<Extremes<T>>(points, progress, [&](Extremes<T>& e, PointRange r) {
                    for (PointIndex i = r.first; i < r.last; ++i) {
                        if constexpr (std::is_floating_point_v<T>)
                            if (std::isnan(v[i])) continue;
                        if (hasNone && anytype(v[i]) == none) continue;
                        e.include(v[i]);
                    }
                });
                ranges.push_back({k, c, found.any, anytype(found.min), anytype(found.max)});
            });
        }
    }
    return ranges;
}

void setRange(std::byte* descriptor, const ExtraBytesRange& range)
{
    const auto options = std::to_integer<unsigned>(descriptor[kOptionsAt]);
    const std::uint64_t min = range.any ? range.min : 0, max = range.any ? range.max : 0;
    if ((options & kMinBit) != 0)
        std::memcpy(descriptor + kDescriptorMinAt + 8 * range.component, &min, sizeof min);
    if ((options & kMaxBit) != 0)
        std::memcpy(descriptor + kDescriptorMaxAt + 8 * range.component, &max, sizeof max);
}

}  // namespace punctum::las
