// SPDX-License-Identifier: MIT
#pragma once

#include "core/shape/PlanePatches.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace punctum
{

/// A plane of many patches. Places as those of patches.
struct PlaneRegion {
    std::array<double, 3> middle{};
    std::array<double, 3> normal{};
    std::size_t points = 0;  ///< of its patches

    double distance(const std::array<double, 3>& place) const noexcept
    {
        double across = 0;
        for (std::size_t a = 0; a < 3; ++a) across += (place[a] - middle[a]) * normal[a];
        return std::fabs(across);
    }
    template <typename Number>
    double cosine(const std::array<Number, 3>& other) const noexcept
    {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) sum += normal[a] * double(other[a]);
        return std::fabs(sum);
    }
};

/// Grows planes over patches of cells that touch each other, from the flattest and fullest patch to the next that
/// is in no plane yet: a patch is taken where its normal agrees with the plane's and its middle is no further from
/// it than the tolerance. The plane is fitted anew while it grows, and what it then has left is given back. Planes
/// of fewer points than half of those asked for are none: edges are not in it yet. Tells each patch its region;
/// throws Cancelled. One thread: there are few patches.
std::vector<PlaneRegion> growPlanes(PlanePatches& patches, const PlaneOptions& options, Progress& progress);

/// The 27 cells about a cell and itself.
template <typename F>
void forCellsAbout(const CellKey& key, F&& f)
{
    for (std::uint32_t k = 0; k < 27; ++k)
        f(CellKey{key[0] + k % 3 - 1, key[1] + k / 3 % 3 - 1, key[2] + k / 9 - 1});
}

}  // namespace punctum
