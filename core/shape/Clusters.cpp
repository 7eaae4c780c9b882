// SPDX-License-Identifier: MIT
#include "core/shape/Clusters.h"

#include "core/Text.h"
#include "core/cloud/PointRanks.h"
#include "core/cloud/Slabs.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Marking.h"
#include "core/process/ObjectNumbers.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace punctum
{

namespace
{

/// Sets of points, joined from many threads. The first point of a set is its root in the end, whoever came first.
class JoinedSets
{
public:
    explicit JoinedSets(std::size_t count) : m_parent(count)
    {
        for (std::size_t i = 0; i < count; ++i) m_parent[i].store(std::uint32_t(i), std::memory_order_relaxed);
    }
    bool isRoot(std::uint32_t point) const { return m_parent[point].load(std::memory_order_relaxed) == point; }
    std::uint32_t root(std::uint32_t point)
    {
        for (;;) {
            std::uint32_t parent = m_parent[point].load(std::memory_order_relaxed);
            if (parent == point) return point;
            const std::uint32_t above = m_parent[parent].load(std::memory_order_relaxed);
            if (above == parent) return parent;
            m_parent[point].compare_exchange_weak(parent, above, std::memory_order_relaxed);
            point = above;
        }
    }
    void join(std::uint32_t a, std::uint32_t b)
    {
        for (;;) {
            a = root(a);
            b = root(b);
            if (a == b) return;
            if (a < b) std::swap(a, b);
            std::uint32_t expected = a;
            if (m_parent[a].compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
        }
    }

private:
    std::vector<std::atomic<std::uint32_t>> m_parent;
};

/// Calls each(range) for slabs of all points, in parallel. Throws Cancelled.
template <typename Each>
void forPieces(const PointCloud& cloud, const char* stage, Progress& progress, const Each& each)
{
    progress.begin(stage, cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        each(pointsOfWords(cloud.size(), firstWord, lastWord));
    });
}

/// The sets that have points: their roots, and how many points each has.
struct FoundSets {
    PointSet roots;
    PointRanks ranks;  ///< of the roots
    std::vector<std::uint32_t> counts;

    explicit FoundSets(PointSet all) : roots(std::move(all)), ranks(roots), counts(ranks.count()) {}
    FoundSets(const FoundSets&) = delete;  // the ranks are those of this set's words
    FoundSets& operator=(const FoundSets&) = delete;
    FoundSets(FoundSets&&) noexcept = default;  // which keeps them where they are
    FoundSets& operator=(FoundSets&&) = delete;
    ~FoundSets() = default;
};

FoundSets countSets(const PointCloud& cloud, JoinedSets& sets, const PointSet* leftOut, Progress& progress)
{
    PointSet roots(cloud.size());
    forPieces(cloud, "Looking at clusters", progress, [&](const PointRange& range) {
        for (PointIndex i = range.first; i < range.last; ++i)
            if ((leftOut == nullptr || !leftOut->contains(i)) && sets.isRoot(std::uint32_t(i)))
                roots.insertShared(i);
    });
    FoundSets found(std::move(roots));
    forPieces(cloud, "Counting points of clusters", progress, [&](const PointRange& range) {
        // Points that follow each other are often of one set, on which all threads would write.
        std::uint32_t last = 0, run = 0;
        const auto count = [&] {
            if (run > 0) std::atomic_ref(found.counts[found.ranks(last)]).fetch_add(run, std::memory_order_relaxed);
            run = 0;
        };
        for (PointIndex i = range.first; i < range.last; ++i) {
            if (leftOut != nullptr && leftOut->contains(i)) continue;
            const std::uint32_t root = sets.root(std::uint32_t(i));
            if (root != last) count();
            last = root;
            ++run;
        }
        count();
    });
    return found;
}

}  // namespace

const StepDescription& ClustersStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "clusters",
        .title = "Clusters",
        .group = StepGroup::Objects,
        .help =
            "Gives points that hang together, by steps no longer than the tolerance, the same number as ClusterId: "
            "1 "
            "for the largest cluster, and so on; 0 for points of clusters that are too small. Of some points "
            "alone, the others are not looked at, and numbers go on from theirs.",
        .source = "Rusu 2009",
        .parameters = {{.key = "tolerance",
                        .label = "Tolerance",
                        .help = "How far points of a cluster may be from the nearest other one.",
                        .fit = {.spacings = 2},
                        .min = 1e-9,
                        .max = 1e9,
                        .unit = StepParameter::Unit::Length},
                       {.key = "points",
                        .label = "Points at least",
                        .help = "Clusters of fewer points get no number.",
                        .type = Type::Integer,
                        .preset = "10",
                        .min = 1,
                        .max = 4e9}},
        .shows = "ClusterId"};
    return about;
}

std::unique_ptr<Command> ClustersStep::make(const PointCloud& cloud, const StepValues& values,
                                            const PointSet* within, Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    const double tolerance = *realValue(values, "tolerance");
    const auto least = std::uint32_t(*integerValue(values, "points"));
    FilledAttribute ids(cloud, {.name = "ClusterId",
                                .description = "cluster, 0: none",
                                .type = ScalarType::U32,
                                .kind = AttributeKind::Category});
    const auto leftOut = pointsOutside(cloud, within);
    JoinedSets sets(cloud.size());
    {
        const auto order = KdOrder::of(cloud, progress);
        forEachWithin(
            *order, tolerance, "Joining neighbors", progress,
            [&](const Neighborhood& n) {
                for (const std::uint32_t p : n.points)
                    if (p < n.point && (within == nullptr || within->contains(p))) sets.join(n.point, p);
            },
            within);
        order->dropLarge(cloud);
    }
    FoundSets found = countSets(cloud, sets, leftOut.get(), progress);

    // Roots are in the order of their ranks.
    std::vector<std::uint32_t> clusters;
    for (std::uint32_t rank = 0; rank < found.counts.size(); ++rank)
        if (found.counts[rank] >= least) clusters.push_back(rank);
    std::stable_sort(clusters.begin(), clusters.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return found.counts[a] > found.counts[b]; });
    std::uint32_t next = firstNumber(ids, clusters.size(), within, progress);
    std::vector<std::uint32_t>& numbers = found.counts;
    std::fill(numbers.begin(), numbers.end(), 0u);
    for (const std::uint32_t rank : clusters) numbers[rank] = next++;
    forPieces(cloud, "Numbering clusters", progress, [&](const PointRange& range) {
        for (PointIndex i = range.first; i < range.last; ++i)
            if (leftOut == nullptr || !leftOut->contains(i))
                ids.set(i, double(numbers[found.ranks(sets.root(std::uint32_t(i)))]));
    });

    auto command = std::make_unique<AttributesCommand>("Clusters", std::vector<Attribute>{ids.attribute()});
    command->setFinding(grouped(clusters.size()) + (clusters.size() == 1 ? " cluster." : " clusters."));
    return command;
}

}  // namespace punctum
