// SPDX-License-Identifier: MIT
#include "core/process/ObjectNumbers.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <type_traits>

namespace punctum
{

namespace
{

constexpr PointIndex kNumbersPiece = 1 << 16;  ///< points between two looks at the cancel flag

/// The highest number that points outside of a set have, at least 0.
std::uint64_t highestOutside(const Attribute& ids, const PointSet& within, Progress& progress)
{
    progress.begin("Looking at numbers", within.size());
    const std::uint64_t highest = visitScalar(ids.type(), [&](auto zero) {
        using T = decltype(zero);
        if constexpr (std::is_floating_point_v<T>) return std::uint64_t(0);  // numbers are whole
        const auto values = ids.columns[0]->values<T>();
        return tbb::parallel_reduce(
            tbb::blocked_range<PointIndex>(0, within.size(), kNumbersPiece), std::uint64_t(0),
            [&](const auto& range, std::uint64_t most) {
                if (progress.cancelled()) return most;
                for (PointIndex i = range.begin(); i != range.end(); ++i)
                    if (values[i] > T(0) && !within.contains(i)) most = std::max(most, std::uint64_t(values[i]));
                progress.add(range.size());
                return most;
            },
            [](std::uint64_t a, std::uint64_t b) { return std::max(a, b); });
    });
    progress.check();
    return highest;
}

std::uint64_t mostOf(ScalarType type)
{
    return visitScalar(type, [](auto zero) {
        using T = decltype(zero);
        if constexpr (std::is_floating_point_v<T> || sizeof(T) > 4) return std::uint64_t(UINT32_MAX);
        return std::uint64_t(std::numeric_limits<T>::max());
    });
}

}  // namespace

std::uint32_t firstNumber(const FilledAttribute& ids, std::size_t objects, const PointSet* within,
                          Progress& progress)
{
    const Attribute& attribute = ids.attribute();
    const std::uint64_t kept = within == nullptr ? 0 : highestOutside(attribute, *within, progress);
    const std::uint64_t most = mostOf(attribute.type());
    if (objects > 0 && (kept > most || objects > most - kept))
        throw Error(attribute.name + " holds numbers up to " + grouped(most) + ", and " + grouped(kept + objects) +
                    " is needed; rename or remove it first.");
    return std::uint32_t(std::min<std::uint64_t>(kept, most - 1) + 1);
}

}  // namespace punctum
