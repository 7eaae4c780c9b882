// SPDX-License-Identifier: MIT
#include "core/shape/Planes.h"

#include "core/Text.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Visibility.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Marking.h"
#include "core/process/ObjectNumbers.h"
#include "core/process/Values.h"
#include "core/shape/PlaneRegions.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

namespace punctum
{

namespace
{

constexpr double kBlurredCosine =
    0.5;  ///< at edges normals are those of both sides together: 45 degrees off, and noise

/// What is known of a point's plane becomes the number of its region, plus 1; 0: none. Counts points of regions.
class PointRegions
{
public:
    PointRegions(const PlanePatches& patches, const std::vector<PlaneRegion>& regions, const PlaneOptions& options,
                 std::vector<std::uint32_t>& planes)
        : m_patches(patches), m_regions(regions), m_options(options), m_planes(planes), m_counts(regions.size())
    {
    }
    std::vector<std::uint32_t> counts() const { return {m_counts.begin(), m_counts.end()}; }
    /// Of all points of a cell.
    void tell(const WorldGrid& grid, const CellKey& key, std::span<const std::uint32_t> points)
    {
        std::array<Near, kMostNear> near;
        const std::size_t count = regionsAbout(key, near);
        for (const std::uint32_t p : points) {
            const std::uint32_t region = count == 0 ? kNoRegion : nearest(grid, p, std::span(near).first(count));
            m_planes[p] = region + 1;  // kNoRegion: 0
            if (region != kNoRegion) m_counts[region].fetch_add(1, std::memory_order_relaxed);
        }
    }

private:
    static constexpr std::size_t kMostNear = 64;  ///< regions about a cell; far more than cells have room for
    struct Near {
        std::uint32_t region = 0;
        bool inside = false;  ///< it has a patch in the cell itself
    };
    std::size_t regionsAbout(const CellKey& key, std::array<Near, kMostNear>& near) const
    {
        std::size_t count = 0;
        forCellsAbout(key, [&](const CellKey& cell) {
            const auto [first, last] = m_patches.of(cell);
            for (std::uint32_t k = first; k < last; ++k) {
                const std::uint32_t region = m_patches.all()[k].region;
                if (region == kNoRegion) continue;
                std::size_t at = 0;
                while (at < count && near[at].region != region) ++at;
                if (at == kMostNear) continue;
                if (at == count) near[count++] = {region, false};
                near[at].inside = near[at].inside || cell == key;
            }
        });
        return count;
    }
    /// The nearest of the planes that a point may be of: from beside its cell only where its own plane agrees.
    std::uint32_t nearest(const WorldGrid& grid, std::uint32_t point, std::span<const Near> near) const
    {
        const auto raw = grid.raw(point);
        std::array<double, 3> place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = double(raw[a]) * grid.scale()[a];
        const PackedPlane own(m_planes[point]);
        const auto normal = own.normal();
        std::uint32_t best = kNoRegion;
        double least = m_options.tolerance;
        for (const Near& n : near) {
            const PlaneRegion& plane = m_regions[n.region];
            if (own.level() == 0 && !n.inside) continue;
            if (own.level() != 0 && plane.cosine(normal) < (n.inside ? kBlurredCosine : m_options.cosine)) continue;
            const double distance = plane.distance(place);
            if (distance > least || (distance == least && n.region >= best)) continue;
            least = distance;
            best = n.region;
        }
        return best;
    }

    const PlanePatches& m_patches;
    const std::vector<PlaneRegion>& m_regions;
    const PlaneOptions& m_options;
    std::vector<std::uint32_t>& m_planes;
    std::vector<std::atomic<std::uint32_t>> m_counts;
};

/// The region of each point, plus 1 (0: none), and how many points each region has.
struct FoundPlanes {
    std::vector<std::uint32_t> regionOf;
    std::vector<std::uint32_t> counts;
};

FoundPlanes findPlanes(const PointCloud& cloud, const PlaneOptions& options, const PointSet* within,
                       const PointSet* leftOut, Progress& progress)
{
    FoundPlanes found;
    {
        const auto order = within == nullptr ? KdOrder::of(cloud, progress)
                                             : std::make_shared<const KdOrder>(cloud, progress, within);
        found.regionOf = planesOfPoints(*order, std::size_t(cloud.size()), options, progress);
        order->dropLarge(cloud);
    }
    const WorldGrid grid(cloud, options.cell);
    const CellOrder cells(grid, leftOut, progress);
    PlanePatches patches(cells, found.regionOf, options, progress);
    const std::vector<PlaneRegion> regions = growPlanes(patches, options, progress);
    PointRegions points(patches, regions, options, found.regionOf);
    cells.forEachCell("Telling points of planes", progress,
                      [&](std::size_t, const CellKey& key, std::span<const std::uint32_t> those) {
                          points.tell(grid, key, those);
                      });
    found.counts = points.counts();
    return found;
}

/// The number of each region, from `first` on by how many points they have, those equal by their order; 0 for those
/// that have too few.
std::vector<std::uint32_t> numbersOf(const std::vector<std::uint32_t>& counts, std::size_t least,
                                     std::uint32_t first)
{
    std::vector<std::uint32_t> regions(counts.size());
    std::iota(regions.begin(), regions.end(), 0u);
    std::erase_if(regions, [&](std::uint32_t r) { return counts[r] < least; });
    std::stable_sort(regions.begin(), regions.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return counts[a] > counts[b]; });
    std::vector<std::uint32_t> numbers(counts.size());
    for (std::uint32_t k = 0; k < regions.size(); ++k) numbers[regions[k]] = first + k;
    return numbers;
}

}  // namespace

const StepDescription& PlanesStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    static const StepDescription about{
        .name = "planes",
        .title = "Planes",
        .group = StepGroup::Objects,
        .help =
            "Gives points that lie in one plane, and hang together, the same number as PlaneId: 1 for the plane of "
            "most points, and so on; 0 for points of none. Of some points alone, the others are not looked at, and "
            "numbers go on from theirs.",
        .source = "Rabbani et al. 2006, Vo et al. 2015",
        .parameters = {{.key = "tolerance",
                        .label = "Tolerance",
                        .help = "The furthest that points may be from their plane.",
                        .fit = {.spacings = 0.2, .meters = 0.1},
                        .min = 1e-9,
                        .max = 1e9,
                        .unit = Unit::Length},
                       {.key = "angle",
                        .label = "Angle",
                        .help = "The most by which the surface may turn from its plane.",
                        .preset = "15",
                        .min = 0.1,
                        .max = 80,
                        .unit = Unit::Degrees},
                       {.key = "points",
                        .label = "Points at least",
                        .help = "Planes of fewer points get no number.",
                        .type = Type::Integer,
                        .preset = "100",
                        .min = 3,
                        .max = 4e9},
                       {.key = "cell",
                        .label = "Cell",
                        .help =
                            "Side of the cells in which flat patches are found first. Those of cells that touch "
                            "hang together, so that planes reach over gaps up to this.",
                        .fit = {.spacings = 5},
                        .min = 1e-9,
                        .max = 1e9,
                        .advanced = true,
                        .unit = Unit::Length},
                       {.key = "neighbors",
                        .label = "Neighbors",
                        .help =
                            "How many nearest points tell where a point's surface looks; more for rough points.",
                        .type = Type::Integer,
                        .preset = "12",
                        .min = 4,
                        .max = 200,
                        .advanced = true}},
        .shows = "PlaneId"};
    return about;
}

std::unique_ptr<Command> PlanesStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    PlaneOptions options;
    options.neighbors = std::size_t(*integerValue(values, "neighbors"));
    options.tolerance = *realValue(values, "tolerance");
    options.cosine = std::cos(*realValue(values, "angle") * std::numbers::pi / 180);
    options.cell = *realValue(values, "cell");
    options.points = std::size_t(*integerValue(values, "points"));
    const auto leftOut = pointsOutside(cloud, within);
    const FoundPlanes found = findPlanes(cloud, options, within, leftOut.get(), progress);

    FilledAttribute ids(cloud, {.name = "PlaneId",
                                .description = "plane, 0: none",
                                .type = ScalarType::U32,
                                .kind = AttributeKind::Category});
    const auto planes = std::size_t(std::count_if(found.counts.begin(), found.counts.end(),
                                                  [&](std::uint32_t count) { return count >= options.points; }));
    const std::vector<std::uint32_t> numbers =
        numbersOf(found.counts, options.points, firstNumber(ids, planes, within, progress));
    std::atomic<std::size_t> inPlanes = 0;
    progress.begin("Numbering planes", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        std::size_t count = 0;
        for (PointIndex i = range.first; i < range.last; ++i) {
            if (leftOut && leftOut->contains(i)) continue;
            const std::uint32_t region = found.regionOf[i];
            const std::uint32_t number = region == 0 ? 0 : numbers[region - 1];
            ids.set(i, double(number));
            count += number != 0;
        }
        inPlanes += count;
    });

    auto command = std::make_unique<AttributesCommand>("Planes", std::vector<Attribute>{ids.attribute()});
    command->setFinding(planes == 0 ? "No planes."
                                    : grouped(planes) + (planes == 1 ? " plane of " : " planes of ") +
                                          pointsText(inPlanes) + ".");
    return command;
}

}  // namespace punctum
