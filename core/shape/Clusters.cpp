// SPDX-License-Identifier: MIT
#include "core/shape/Clusters.h"

#include "core/Text.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/FilledAttribute.h"
#include "core/process/ObjectNumbers.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <atomic>
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

constexpr std::size_t kClusterCheck = 1 << 18;  ///< points between two looks at the cancel flag

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
    const auto places = KdOrder::of(cloud, progress);
    const KdOrder& order = *places;
    FilledAttribute ids(cloud, {.name = "ClusterId",
                                .description = "cluster, 0: none",
                                .type = ScalarType::U32,
                                .kind = AttributeKind::Category});
    JoinedSets sets(cloud.size());
    forEachWithin(
        order, tolerance, "Joining neighbors", progress,
        [&](const Neighborhood& n) {
            for (const std::uint32_t p : n.points)
                if (p < n.point && (within == nullptr || within->contains(p))) sets.join(n.point, p);
        },
        within);

    struct Cluster {
        std::uint32_t root, count;
    };
    const std::span<const std::uint32_t> members = order.points(1);
    const auto forMembers = [&](auto&& each) {
        for (std::size_t k = 0; k < members.size(); ++k) {
            if (k % kClusterCheck == 0) progress.check();
            if (within == nullptr || within->contains(members[k])) each(members[k]);
        }
    };
    std::vector<std::uint32_t> counts(cloud.size());
    forMembers([&](std::uint32_t p) { ++counts[sets.root(p)]; });
    std::vector<Cluster> clusters;
    for (std::size_t p = 0; p < counts.size(); ++p)
        if (counts[p] >= least) clusters.push_back({std::uint32_t(p), counts[p]});
    std::sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) {
        return a.count != b.count ? a.count > b.count : a.root < b.root;
    });
    std::fill(counts.begin(), counts.end(), 0u);
    const std::uint32_t first = firstNumber(ids, clusters.size(), within, progress);
    for (std::size_t k = 0; k < clusters.size(); ++k) counts[clusters[k].root] = first + std::uint32_t(k);
    forMembers([&](std::uint32_t p) { ids.set(p, double(counts[sets.root(p)])); });

    auto command = std::make_unique<AttributesCommand>("Clusters", std::vector<Attribute>{ids.attribute()});
    command->setFinding(grouped(clusters.size()) + (clusters.size() == 1 ? " cluster." : " clusters."));
    return command;
}

}  // namespace punctum
