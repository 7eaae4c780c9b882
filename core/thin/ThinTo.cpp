// SPDX-License-Identifier: MIT
#include "core/thin/ThinTo.h"

#include "core/cells/WorldGrid.h"
#include "core/process/Marking.h"
#include "core/task/Progress.h"
#include "core/thin/Choices.h"
#include "core/thin/Surface.h"
#include "core/thin/Thinned.h"
#include "core/thin/WantedNumber.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <limits>

namespace punctum
{

namespace
{

constexpr std::size_t kNodePoints = 16'384;  ///< the size of a node: a second of work in one thread at most
constexpr double kMargin = 4;                ///< spacings around a node in which others are seen
/// Of more points than so many for each one that is kept, those are looked at that an even choice leaves: what is
/// merged or overlaps then stays a matter of few points.
constexpr PointIndex kMostToOne = 16;

/// Something that is told of each node of an order, in parallel.
class NodeWork
{
public:
    NodeWork(const KdOrder& order, std::size_t neighbors)
        : m_order(order), m_neighbors(neighbors), m_nodes(order.tiles(kNodePoints))
    {
    }
    std::size_t nodes() const { return m_nodes.size(); }
    std::size_t points(std::size_t node) const { return m_order.points(m_nodes[node]).size(); }

    void run(const std::string& stage, double margin, Progress& progress,
             const std::function<void(std::size_t node, const SurfacePiece& piece)>& work) const
    {
        progress.begin(stage, m_order.size());
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, nodes(), 1),
            [&](const auto& range) {
                SurfacePiece piece;
                for (std::size_t k = range.begin(); k != range.end() && !progress.cancelled(); ++k) {
                    if (!piece.read(m_order, m_nodes[k], m_neighbors, margin, progress)) return;
                    work(k, piece);
                    progress.add(points(k));
                }
            },
            tbb::simple_partitioner());
        progress.check();
    }

private:
    const KdOrder& m_order;
    std::size_t m_neighbors;
    std::vector<std::size_t> m_nodes;
};

/// A point with what it is worth; of those worth the same, which goes first is by chance.
struct Worth {
    float worth;
    std::uint32_t point;
    bool operator<(const Worth& other) const
    {
        if (worth != other.worth) return worth > other.worth;
        const std::uint64_t a = mixedBits(std::uint64_t(point) + 1), b = mixedBits(std::uint64_t(other.point) + 1);
        return a < b;
    }
};

using WorthOf = bool (*)(const SurfacePiece&, double, WorthOfPoints&, const Progress&);

/// The `count` points that are worth most.
void chooseByWorth(const NodeWork& nodes, WorthOf worthOf, PointIndex count, double share, PointSet& kept,
                   Progress& progress)
{
    std::vector<std::vector<Worth>> found(nodes.nodes());
    nodes.run("Weighing points", kMargin, progress, [&](std::size_t k, const SurfacePiece& piece) {
        WorthOfPoints worth;
        if (!worthOf(piece, share * double(piece.own), worth, progress)) return;
        for (std::size_t p = 0; p < piece.own; ++p) found[k].push_back({worth[p], piece.points[p]});
    });
    std::vector<Worth> all;
    for (auto& some : found) {
        all.insert(all.end(), some.begin(), some.end());
        some = {};
    }
    progress.check();
    const auto end = all.begin() + std::ptrdiff_t(count);
    std::nth_element(all.begin(), end, all.end());
    std::for_each(all.begin(), end, [&](const Worth& w) { kept.insert(w.point); });
}

/// As many clusters in all nodes together as points are wanted; of each cluster one point.
void chooseByDeviation(const NodeWork& nodes, PointIndex count, double share, PointSet& kept, Progress& progress)
{
    struct Split {
        float error;
        std::uint32_t node, number;
        bool operator<(const Split& other) const
        {
            if (error != other.error) return error > other.error;
            // In turns, where none is more in need than another.
            return number != other.number ? number < other.number : node < other.node;
        }
    };
    std::vector<std::vector<float>> errors(nodes.nodes());
    std::vector<std::size_t> clusters(nodes.nodes());
    nodes.run("Finding clusters", 0, progress, [&](std::size_t k, const SurfacePiece& piece) {
        DeviationClusters node(piece, share * double(piece.own));
        clusters[k] = node.clusters();
        const double most = 4 * share * double(piece.own) + 1;
        while (double(node.clusters()) < most) {
            if (node.clusters() % 64 == 0 && progress.cancelled()) return;
            const float error = node.split();
            if (error < 0) break;
            errors[k].push_back(error);
        }
    });
    std::vector<Split> splits;
    PointIndex there = 0;
    for (std::uint32_t k = 0; k < nodes.nodes(); ++k) {
        there += clusters[k];
        for (std::uint32_t s = 0; s < errors[k].size(); ++s) splits.push_back({errors[k][s], k, s});
    }
    progress.check();
    std::vector<std::size_t> wanted = clusters;
    if (there < count) {
        const auto more = std::min(std::size_t(count - there), splits.size());
        std::nth_element(splits.begin(), splits.begin() + std::ptrdiff_t(more), splits.end());
        for (std::size_t s = 0; s < more; ++s) ++wanted[splits[s].node];
    }
    splits = {};
    std::vector<std::vector<std::uint32_t>> chosen(nodes.nodes());
    nodes.run("Choosing points", 0, progress, [&](std::size_t k, const SurfacePiece& piece) {
        DeviationClusters node(piece, share * double(piece.own));
        while (node.clusters() < wanted[k]) {
            if (node.clusters() % 64 == 0 && progress.cancelled()) return;
            if (node.split() < 0) break;
        }
        chosen[k] = node.representatives();
    });
    // More nodes than points are wanted: some nodes keep none.
    std::vector<Worth> all;
    for (const auto& some : chosen)
        for (const std::uint32_t p : some) all.push_back({0, p});
    const auto end = all.begin() + std::ptrdiff_t(std::min<std::size_t>(count, all.size()));
    std::nth_element(all.begin(), end, all.end());
    std::for_each(all.begin(), end, [&](const Worth& w) { kept.insert(w.point); });
}

StepDescription describeThinTo()
{
    using Type = StepParameter::Type;
    StepDescription about{
        .name = "thin-to",
        .title = "Thin to what a surface needs",
        .group = StepGroup::Thinning,
        .help =
            "Keeps exactly so many points, more where the surface bends and fewer where it is flat, by their "
            "normals "
            "or splats.",
        .source = "Goswami et al. 2013, section 3.3",
        .parameters = {{.key = "method",
                        .label = "Method",
                        .help =
                            "Normal deviation: cells are split where normals differ most (fastest). Entropy: "
                            "points are merged where normals agree. k-clustering: splats that do not overlap, less "
                            "those that lie in the plane of others.",
                        .type = Type::Choice,
                        .preset = "normal-deviation",
                        .choices = {"normal-deviation", "entropy", "k-clustering"}}}};
    addWantedNumber(about.parameters);
    about.parameters.push_back(
        {.key = "k",
         .label = "Neighbors",
         .help = "How many nearest points a normal is fitted to, the point itself among them.",
         .type = Type::Integer,
         .preset = "12",
         .min = 3,
         .max = 100,
         .advanced = true});
    for (StepParameter& parameter : thinnedParameters()) about.parameters.push_back(std::move(parameter));
    return about;
}

}  // namespace

const StepDescription& ThinToStep::description() const
{
    static const StepDescription about = describeThinTo();
    return about;
}

std::unique_ptr<Command> ThinToStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    const auto leftOut = pointsOutside(cloud, within);
    const PointIndex all = cloud.size() - (leftOut ? leftOut->count() : 0);
    const PointIndex count = wantedNumber(values, cloud, leftOut.get());
    if (count == all) return nullptr;
    auto kept = std::make_shared<PointSet>(cloud.size());
    if (count > 0) {
        const std::string method = textValue(values, "method");
        const bool even = method != "normal-deviation" && all / count >= kMostToOne;
        std::shared_ptr<const KdOrder> order;
        if (even) {
            const auto some = chooseByNumber(cloud, count * kMostToOne, leftOut.get(), progress);
            order = std::make_shared<KdOrder>(cloud, progress, some.get());
        } else if (within != nullptr) {
            PointSet some = *leftOut;
            some.invert();
            order = std::make_shared<KdOrder>(cloud, progress, &some);
        } else {
            order = KdOrder::of(cloud, progress);
        }
        const NodeWork nodes(*order, std::size_t(*integerValue(values, "k")));
        const double share = double(count) / double(order->size());
        if (method == "entropy")
            chooseByWorth(nodes, worthByEntropy, count, share, *kept, progress);
        else if (method == "k-clustering")
            chooseByWorth(nodes, worthByClustering, count, share, *kept, progress);
        else
            chooseByDeviation(nodes, count, share, *kept, progress);
    }
    return thinTo("Thin to " + textValue(values, "method"), cloud, *kept, leftOut.get(), values, progress);
}

}  // namespace punctum
