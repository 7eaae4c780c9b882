// SPDX-License-Identifier: MIT
#include "core/neighbors/LeafScan.h"

#include <algorithm>

namespace punctum
{

namespace
{

float squaredFrom(const LeafScan& scan, const std::int32_t d0, const std::int32_t d1, const std::int32_t d2)
{
    const auto x = float(d0), y = float(d1), z = float(d2);
    return x * x * scan.steps[0] + y * y * scan.steps[1] + z * z * scan.steps[2];
}

float squaredToPoint(const LeafScan& scan, std::size_t place)
{
    return squaredFrom(scan, scan.x[place] - scan.from[0], scan.y[place] - scan.from[1],
                       scan.z[place] - scan.from[2]);
}

float squaredToBox(const LeafScan& scan, std::size_t leaf)
{
    const std::int32_t* const group = scan.boxes + leaf / LeafScan::kTogether * 6 * LeafScan::kTogether;
    const std::size_t lane = leaf % LeafScan::kTogether;
    std::int32_t d[3];
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int32_t below = group[a * LeafScan::kTogether + lane] - scan.from[a];
        const std::int32_t above = scan.from[a] - group[(a + 3) * LeafScan::kTogether + lane];
        d[a] = std::max({below, above, 0});
    }
    return squaredFrom(scan, d[0], d[1], d[2]);
}

std::size_t scanLeavesBaseline(const LeafScan& scan, float limit, float* squared, std::uint32_t* places) noexcept
{
    std::size_t found = 0;
    for (std::size_t leaf = 0; leaf < scan.leaves; ++leaf) {
        if (squaredToBox(scan, leaf) > limit) continue;
        for (std::uint32_t k = 0; k < scan.counts[leaf]; ++k) {
            const std::uint32_t place = scan.firsts[leaf] + k;
            const float s = squaredToPoint(scan, place);
            squared[found] = s;
            places[found] = place;
            found += s <= limit;
        }
    }
    return found;
}

std::size_t countInLeavesBaseline(const LeafScan& scan, float sure, float limit, std::size_t enough,
                                  std::uint32_t* places, std::size_t* looks) noexcept
{
    std::size_t found = 0, open = 0;
    for (std::size_t leaf = 0; leaf < scan.leaves && found < enough; ++leaf) {
        if (squaredToBox(scan, leaf) > limit) continue;
        for (std::uint32_t k = 0; k < scan.counts[leaf]; ++k) {
            const std::uint32_t place = scan.firsts[leaf] + k;
            const float s = squaredToPoint(scan, place);
            places[open] = place;
            open += s > sure && s <= limit;
            found += s <= sure;
        }
    }
    *looks = open;
    return found;
}

void rankBaseline(float* squared, std::size_t count, std::uint32_t* ranks) noexcept
{
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t rank = 0;
        for (std::size_t j = 0; j < count; ++j) rank += squared[j] < squared[i];
        ranks[i] = rank;
    }
}

}  // namespace

LeafFunctions leafFunctionsBaseline() noexcept
{
    return {scanLeavesBaseline, countInLeavesBaseline, rankBaseline};
}

LeafFunctions leafFunctions() noexcept
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return leafFunctionsAvx2();
#endif
    return leafFunctionsBaseline();
}

}  // namespace punctum
