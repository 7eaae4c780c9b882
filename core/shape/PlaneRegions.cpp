// SPDX-License-Identifier: MIT
#include "core/shape/PlaneRegions.h"

#include "core/shape/Spread.h"

#include <tbb/parallel_sort.h>

#include <numeric>
#include <tuple>

namespace punctum
{

namespace
{

constexpr double kFittedAnew = 1.2;  ///< times the points of the last fit
constexpr double kFlatShare = 0.1;   ///< of the tolerance: patches that are flatter than this go by their points
constexpr std::size_t kGrowCheck = 1 << 10;  ///< patches between two looks at the cancel flag

/// The patches of a plane that grows, and the plane.
class GrowingPlane
{
public:
    GrowingPlane(const PlaneOptions& options, const PlanePatch& seed) : m_options(options), m_from(seed.middle)
    {
        add(seed);
        m_plane.middle = seed.middle;
        for (std::size_t a = 0; a < 3; ++a) m_plane.normal[a] = double(seed.normal[a]);
        m_fitted = m_sums.count;
    }
    bool fits(const PlanePatch& patch) const
    {
        return m_plane.cosine(patch.normal) >= m_options.cosine &&
               m_plane.distance(patch.middle) <= m_options.tolerance;
    }
    void add(const PlanePatch& patch)
    {
        // The points of a patch as a disk of its normal and spread.
        const auto count = double(patch.count);
        std::array<double, 3> d{}, n{};
        for (std::size_t a = 0; a < 3; ++a) {
            d[a] = patch.middle[a] - m_from[a];
            n[a] = double(patch.normal[a]);
        }
        const auto along = double(patch.spread);
        const double across = double(patch.deviation) * double(patch.deviation) - along;
        m_sums.count += count;
        std::size_t k = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            m_sums.sum[a] += count * d[a];
            for (std::size_t b = a; b < 3; ++b, ++k)
                m_sums.products[k] += count * (d[a] * d[b] + across * n[a] * n[b] + (a == b ? along : 0));
        }
    }
    void clear() { m_sums = {}; }
    bool isStale() const { return m_sums.count >= kFittedAnew * m_fitted; }
    void fit()
    {
        m_fitted = m_sums.count;
        const Spread spread = spreadOfSums(m_sums);
        if (spread.least == Spread::Vector{}) return;
        for (std::size_t a = 0; a < 3; ++a) m_plane.middle[a] = m_from[a] + spread.mean[a];
        m_plane.normal = spread.least;
    }
    PlaneRegion plane() const
    {
        PlaneRegion plane = m_plane;
        plane.points = std::size_t(m_sums.count);
        return plane;
    }

private:
    const PlaneOptions& m_options;
    std::array<double, 3> m_from;
    SpreadSums m_sums;
    double m_fitted = 0;
    PlaneRegion m_plane;
};

/// Patches in the order in which planes start from them, which goes by places.
std::vector<std::uint32_t> seedsOf(const PlanePatches& patches, const PlaneOptions& options,
                                   const Progress& progress)
{
    const auto all = patches.all();
    const double least = kFlatShare * options.tolerance * kFlatShare * options.tolerance;
    const auto rank = [&](std::uint32_t k) {
        const PlanePatch& p = all[k];
        const double variance = double(p.deviation) * double(p.deviation) + least;
        return std::tuple(variance / double(p.count), p.key, p.middle);
    };
    std::vector<std::uint32_t> seeds(all.size());
    std::iota(seeds.begin(), seeds.end(), 0u);
    tbb::parallel_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (progress.cancelled()) throw Cancelled();
        return rank(a) < rank(b);
    });
    return seeds;
}

}  // namespace

std::vector<PlaneRegion> growPlanes(PlanePatches& patches, const PlaneOptions& options, Progress& progress)
{
    const auto all = patches.all();
    progress.begin("Growing planes", all.size());
    std::vector<PlaneRegion> regions;
    std::vector<std::uint32_t> members;
    std::size_t looked = 0;
    for (const std::uint32_t seed : seedsOf(patches, options, progress)) {
        progress.add(1);
        if (++looked % kGrowCheck == 0) progress.check();
        if (all[seed].region != kNoRegion) continue;
        const auto region = std::uint32_t(regions.size());
        GrowingPlane plane(options, all[seed]);
        members.assign(1, seed);
        all[seed].region = region;
        for (std::size_t next = 0; next < members.size(); ++next) {
            if (++looked % kGrowCheck == 0) progress.check();
            forCellsAbout(all[members[next]].key, [&](const CellKey& key) {
                const auto [first, last] = patches.of(key);
                for (std::uint32_t k = first; k < last; ++k) {
                    if (all[k].region != kNoRegion || !plane.fits(all[k])) continue;
                    all[k].region = region;
                    members.push_back(k);
                    plane.add(all[k]);
                }
            });
            if (plane.isStale()) plane.fit();
        }
        plane.fit();
        plane.clear();
        for (const std::uint32_t k : members) {
            if (plane.fits(all[k]))
                plane.add(all[k]);
            else
                all[k].region = kNoRegion;
        }
        plane.fit();
        if (2 * plane.plane().points >= options.points) {
            regions.push_back(plane.plane());
        } else {
            for (const std::uint32_t k : members)
                if (all[k].region == region) all[k].region = kNoRegion;
        }
    }
    return regions;
}

}  // namespace punctum
