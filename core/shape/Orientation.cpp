// SPDX-License-Identifier: MIT
#include "core/shape/Orientation.h"

#include "core/neighbors/Neighbors.h"
#include "core/task/Progress.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

namespace punctum
{

namespace
{

constexpr std::size_t kTreeNeighbors = 9;         ///< the point itself among them
constexpr std::size_t kMostTreeEdges = 32 << 20;  ///< of a band: some 400 MB
constexpr std::size_t kWeightBins = 4096;
constexpr std::size_t kEdgesAtATime = 1 << 16;  ///< between two looks at the cancel flag

struct TreeEdge {
    float weight;
    std::uint32_t a, b;  ///< a < b
    friend bool operator<(const TreeEdge& l, const TreeEdge& r)
    {
        if (l.weight != r.weight) return l.weight < r.weight;
        return l.a != r.a ? l.a < r.a : l.b < r.b;
    }
};

/// Sets of points that hang together; each knows whether it is turned against its set's first one.
class TurnedSets
{
public:
    explicit TurnedSets(std::size_t count) : m_parent(count), m_turned(count)
    {
        for (std::size_t i = 0; i < count; ++i) m_parent[i] = std::uint32_t(i);
    }
    struct Root {
        std::uint32_t root;
        bool turned;
    };
    /// Shortens the way; one thread.
    Root find(std::uint32_t point)
    {
        std::uint32_t root = point;
        bool turned = false;
        while (m_parent[root] != root) {
            turned ^= m_turned[root] != 0;
            root = m_parent[root];
        }
        bool rest = turned;
        while (m_parent[point] != root && point != root) {
            const std::uint32_t next = m_parent[point];
            const bool step = m_turned[point] != 0;
            m_parent[point] = root;
            m_turned[point] = rest;
            rest ^= step;
            point = next;
        }
        return {root, turned};
    }
    /// The root alone; any thread, while nothing is united.
    std::uint32_t rootOf(std::uint32_t point) const
    {
        while (m_parent[point] != point) point = m_parent[point];
        return point;
    }
    void unite(std::uint32_t a, std::uint32_t b, bool opposite)
    {
        const Root ra = find(a), rb = find(b);
        if (ra.root == rb.root) return;
        const std::uint32_t first = std::min(ra.root, rb.root), second = std::max(ra.root, rb.root);
        m_parent[second] = first;
        m_turned[second] = opposite ^ ra.turned ^ rb.turned;
    }

private:
    std::vector<std::uint32_t> m_parent;
    std::vector<std::uint8_t> m_turned;
};

float cosineOf(const std::array<float, 3>& a, const std::array<float, 3>& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool hasDirection(const std::array<float, 3>& n)
{
    return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

std::size_t binOf(float weight)
{
    return std::min(kWeightBins - 1, std::size_t(std::max(0.0f, weight) * float(kWeightBins)));
}

}  // namespace

void orientBySpanningTree(const KdOrder& order, NormalColumns& normals, std::size_t pointCount, const PointSet* of,
                          Progress& progress)
{
    const auto forEdges = [&](const std::string& stage, auto&& each) {
        const auto visit = [&](const Neighborhood& n) {
            const auto own = normals.normal(n.point);
            if (!hasDirection(own)) return;
            for (const std::uint32_t other : n.points) {
                if (other == n.point || (of != nullptr && !of->contains(other))) continue;
                const auto theirs = normals.normal(other);
                if (!hasDirection(theirs)) continue;
                each(TreeEdge{1 - std::fabs(cosineOf(own, theirs)), std::min(n.point, other),
                              std::max(n.point, other)});
            }
        };
        forEachNearest(order, kTreeNeighbors, stage, progress, visit, of);
    };
    TurnedSets sets(pointCount);
    // Bands of weight that have about as many edges as there is room for; one band where there are few.
    std::vector<std::size_t> ends{kWeightBins};
    if (order.size() * (kTreeNeighbors - 1) > kMostTreeEdges) {
        std::vector<std::atomic<std::uint64_t>> bins(kWeightBins);
        forEdges("Weighing edges", [&](const TreeEdge& e) { ++bins[binOf(e.weight)]; });
        ends.clear();
        std::uint64_t sum = 0;
        for (std::size_t bin = 0; bin < kWeightBins; ++bin) {
            sum += bins[bin];
            if (sum < kMostTreeEdges && bin + 1 < kWeightBins) continue;
            ends.push_back(bin + 1);
            sum = 0;
        }
    }
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
        tbb::enumerable_thread_specific<std::vector<TreeEdge>> found;
        forEdges("Following neighbors", [&](const TreeEdge& e) {
            const std::size_t bin = binOf(e.weight);
            if (bin < begin || bin >= end || sets.rootOf(e.a) == sets.rootOf(e.b)) return;
            found.local().push_back(e);
        });
        std::vector<TreeEdge> edges;
        for (auto& some : found) {
            edges.insert(edges.end(), some.begin(), some.end());
            std::vector<TreeEdge>().swap(some);
        }
        progress.check();
        tbb::parallel_sort(edges.begin(), edges.end());
        for (std::size_t k = 0; k < edges.size(); ++k) {
            if (k % kEdgesAtATime == 0) progress.check();
            const TreeEdge& e = edges[k];
            sets.unite(e.a, e.b, cosineOf(normals.normal(e.a), normals.normal(e.b)) < 0);
        }
        begin = end;
    }
    // The highest of each set; of equally high ones the first.
    std::vector<std::uint32_t> highest(pointCount, UINT32_MAX);
    std::vector<std::uint8_t> turned(pointCount);
    const auto forPoints = [&](auto&& each) {
        std::size_t count = 0;
        for (std::size_t p = 0; p < pointCount; ++p) {
            if (++count % kEdgesAtATime == 0) progress.check();
            if (of == nullptr || of->contains(p)) each(std::uint32_t(p));
        }
    };
    forPoints([&](std::uint32_t p) {
        std::uint32_t& top = highest[sets.find(p).root];
        if (top == UINT32_MAX || order.raw(p)[2] > order.raw(top)[2]) top = p;
    });
    forPoints([&](std::uint32_t p) {
        const auto own = sets.find(p);
        const std::uint32_t top = highest[own.root];
        turned[p] = own.turned ^ sets.find(top).turned ^ (normals.normal(top)[2] < 0);
    });
    forPoints([&](std::uint32_t p) {
        if (turned[p] == 0) return;
        const auto n = normals.normal(p);
        normals.set(p, {0 - n[0], 0 - n[1], 0 - n[2]});
    });
}

}  // namespace punctum
