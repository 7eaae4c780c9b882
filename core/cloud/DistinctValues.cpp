// SPDX-License-Identifier: MIT
#include "core/cloud/DistinctValues.h"

#include "core/cloud/PointSet.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <unordered_map>

namespace punctum
{

namespace
{

constexpr PointIndex kTaskPoints = 1 << 16;
constexpr PointIndex kBitsBlock = 1024;

/// Values seen by one thread, by their bits.
struct Seen {
    struct One {
        PointIndex first = 0;  ///< a point that has it
        std::uint64_t points = 0;
    };
    std::unordered_map<std::uint32_t, One> values;
    bool tooMany = false;

    void add(std::uint32_t bits, PointIndex first, std::uint64_t points, std::size_t most)
    {
        if (tooMany || points == 0) return;
        One& one = values[bits];
        if (one.points == 0 || first < one.first) one.first = first;
        one.points += points;
        tooMany = values.size() > most;
    }
};

bool less(const DistinctValue& a, const DistinctValue& b)
{
    return a.value.index() == b.value.index() ? a.value < b.value : toDouble(a.value) < toDouble(b.value);
}

}  // namespace

DistinctValues distinctValues(const Attribute& attribute, std::size_t most, Progress& progress,
                              const PointSet* leftOut)
{
    const bool some = !attribute.columns[0]->absent().empty();  // files that lack the attribute
    const Seen all = tbb::parallel_reduce(
        tbb::blocked_range<PointIndex>(0, attribute.size(), kTaskPoints), Seen{},
        [&](const tbb::blocked_range<PointIndex>& r, Seen seen) {
            std::uint32_t bits[kBitsBlock];
            for (PointIndex first = r.begin(); first < r.end() && !seen.tooMany; first += kBitsBlock) {
                if (progress.cancelled()) return seen;
                const PointIndex last = std::min(r.end(), first + kBitsBlock);
                attribute.gatherBits(PointRange{first, last}, bits);
                // Neighbors mostly have the same value: runs of it are added at once.
                for (PointIndex i = first; i < last;) {
                    const std::uint32_t value = bits[i - first];
                    const PointIndex begin = i;
                    std::uint64_t points = 0;
                    for (; i < last && bits[i - first] == value; ++i)
                        points += (leftOut == nullptr || !leftOut->contains(i)) &&
                                          !(value == 0 && some && attribute.lacks(i))
                                      ? 1
                                      : 0;
                    seen.add(value, begin, points, most);
                }
            }
            return seen;
        },
        [&](Seen a, const Seen& b) {
            a.tooMany = a.tooMany || b.tooMany;
            for (const auto& [bits, one] : b.values) a.add(bits, one.first, one.points, most);
            return a;
        });
    progress.check();
    DistinctValues result;
    result.tooMany = all.tooMany;
    if (all.tooMany) return result;
    for (const auto& [bits, one] : all.values)
        result.values.push_back({bits, attribute.value(one.first), one.points});
    std::sort(result.values.begin(), result.values.end(), less);
    return result;
}

}  // namespace punctum
