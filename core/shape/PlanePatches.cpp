// SPDX-License-Identifier: MIT
#include "core/shape/PlanePatches.h"

#include "core/cells/JoinedLists.h"
#include "core/shape/Spread.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kLeastPatch = 4;        ///< points
constexpr int kPatchTries = 8;                ///< in a cell; what is left then is not flat
constexpr std::size_t kPatchCheck = 1 << 14;  ///< points or patches between two looks at the cancel flag

/// Finds the patches of one cell after another; one a thread.
class PatchFinder
{
public:
    PatchFinder(const WorldGrid& grid, const std::vector<std::uint32_t>& planes, const PlaneOptions& options)
        : m_grid(grid), m_planes(planes), m_options(options)
    {
    }

    /// Ends early when cancelled.
    void find(const CellKey& key, std::span<const std::uint32_t> points, std::vector<PlanePatch>& found,
              const Progress& progress)
    {
        m_left.clear();
        for (const std::uint32_t p : points)
            if (m_planes[p] != 0) m_left.push_back(p);
        for (int tries = 0; tries < kPatchTries && m_left.size() >= kLeastPatch; ++tries) {
            if (progress.cancelled()) return;
            const std::uint32_t seed = flattest();
            m_seed = m_grid.raw(seed);
            const PackedPlane own(m_planes[seed]);
            const Spread first = spreadOfSums(membersOf({}, own.normal(), progress));
            if (first.least != Spread::Vector{} && m_members.size() >= kLeastPatch) {
                const Spread refined = spreadOfSums(membersOf(first.mean, first.least, progress));
                if (refined.least != Spread::Vector{} && m_members.size() >= kLeastPatch)
                    found.push_back(patchOf(key, refined));
            }
            m_left.swap(m_others);
            std::erase(m_left, seed);
        }
    }

private:
    /// By how far neighbors are from its plane, then by chance, which goes by the place.
    std::uint32_t flattest() const
    {
        const auto rank = [&](std::uint32_t p) {
            return std::tuple(PackedPlane(m_planes[p]).level(), mixedBits(m_grid.worldSteps(p)), m_grid.raw(p));
        };
        std::uint32_t best = m_left[0];
        auto least = rank(best);
        for (const std::uint32_t p : m_left) {
            if (PackedPlane(m_planes[p]).level() > std::get<0>(least)) continue;
            const auto here = rank(p);
            if (here >= least) continue;
            least = here;
            best = p;
        }
        return best;
    }
    /// Those left that are in the plane; the rest become others. `middle`: from the seed. Sums are over whole
    /// steps, the same in any order.
    SpreadSums membersOf(const Spread::Vector& middle, const Spread::Vector& normal, const Progress& progress)
    {
        m_members.clear();
        m_others.clear();
        SpreadSums sums;
        const auto& scale = m_grid.scale();
        for (std::size_t k = 0; k < m_left.size(); ++k) {
            if (k % kPatchCheck == 0 && progress.cancelled()) break;
            const std::uint32_t p = m_left[k];
            const auto raw = m_grid.raw(p);
            std::array<double, 3> d{};
            double across = 0, cosine = 0;
            const auto its = PackedPlane(m_planes[p]).normal();
            for (std::size_t a = 0; a < 3; ++a) {
                d[a] = double(std::int64_t(raw[a]) - m_seed[a]);
                across += (d[a] * scale[a] - middle[a]) * normal[a];
                cosine += its[a] * normal[a];
            }
            if (std::fabs(across) <= m_options.tolerance && std::fabs(cosine) >= m_options.cosine) {
                sums.add(d[0], d[1], d[2]);
                m_members.push_back(p);
            } else {
                m_others.push_back(p);
            }
        }
        return sums.scaled(scale);
    }
    PlanePatch patchOf(const CellKey& key, const Spread& spread) const
    {
        PlanePatch patch;
        patch.key = key;
        patch.count = std::uint32_t(m_members.size());
        for (std::size_t a = 0; a < 3; ++a) {
            patch.middle[a] = double(m_seed[a]) * m_grid.scale()[a] + spread.mean[a];
            patch.normal[a] = float(spread.least[a]);
        }
        patch.spread = float((spread.l1() + spread.l2()) / 2);
        patch.deviation = float(std::sqrt(spread.l3()));
        return patch;
    }

    const WorldGrid& m_grid;
    const std::vector<std::uint32_t>& m_planes;
    const PlaneOptions& m_options;
    std::array<std::int32_t, 3> m_seed{};
    std::vector<std::uint32_t> m_left, m_members, m_others;
};

}  // namespace

PlanePatches::PlanePatches(const CellOrder& order, const std::vector<std::uint32_t>& planes,
                           const PlaneOptions& options, Progress& progress)
{
    std::vector<std::vector<PlanePatch>> found(order.buckets());
    tbb::enumerable_thread_specific<PatchFinder> finders(order.grid(), planes, options);
    order.forEachCell("Finding flat patches", progress,
                      [&](std::size_t bucket, const CellKey& key, std::span<const std::uint32_t> points) {
                          finders.local().find(key, points, found[bucket], progress);
                      });
    m_patches = joinedLists(std::move(found));
    makeTable(progress);
}

void PlanePatches::makeTable(Progress& progress)
{
    std::size_t places = 16;
    while (places < 2 * m_patches.size()) places *= 2;
    m_table.assign(places, kNoRegion);
    for (std::size_t k = 0; k < m_patches.size(); ++k) {
        if (k % kPatchCheck == 0) progress.check();
        if (k > 0 && m_patches[k].key == m_patches[k - 1].key) continue;
        std::size_t at = std::size_t(mixedBits(m_patches[k].key)) & (places - 1);
        while (m_table[at] != kNoRegion) at = (at + 1) & (places - 1);
        m_table[at] = std::uint32_t(k);
    }
}

std::pair<std::uint32_t, std::uint32_t> PlanePatches::of(const CellKey& key) const noexcept
{
    std::size_t at = std::size_t(mixedBits(key)) & (m_table.size() - 1);
    while (m_table[at] != kNoRegion && m_patches[m_table[at]].key != key) at = (at + 1) & (m_table.size() - 1);
    const std::uint32_t first = m_table[at];
    if (first == kNoRegion) return {0, 0};
    std::uint32_t last = first + 1;
    while (last < m_patches.size() && m_patches[last].key == key) ++last;
    return {first, last};
}

}  // namespace punctum
