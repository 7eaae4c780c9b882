// SPDX-License-Identifier: MIT
#include "core/above/GroundTree.h"

#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace punctum
{

namespace
{

constexpr std::size_t kGroundLeaf = 8;           ///< points of a leaf, about; measured
constexpr std::size_t kGroundBlockWords = 1024;  ///< words of a set that one task takes
constexpr std::size_t kGroundTask = 20'000;      ///< points below which a half is no task of its own

}  // namespace

GroundTree::GroundTree(const PointCloud& cloud, const PointSet& ground, const std::array<double, 3>& scale,
                       Progress& progress)
    : m_scale(scale)
{
    const std::vector<PointIndex> ranks = ground.ranks(kGroundBlockWords);
    m_places.resize(ranks.back());
    progress.begin("Sorting the ground", m_places.size());
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    tbb::parallel_for(std::size_t(0), ranks.size() - 1, [&](std::size_t block) {
        if (progress.cancelled()) return;
        PointIndex at = ranks[block];
        const std::size_t first = block * kGroundBlockWords;
        ground.forEachInWords(first, std::min(ground.words().size(), first + kGroundBlockWords), [&](PointIndex i) {
            m_places[at++] = {x[i], y[i], z[i]};
        });
    });
    progress.check();
    m_leaves = std::bit_ceil(std::max<std::size_t>(1, m_places.size() / kGroundLeaf));
    m_splits.resize(m_leaves);
    m_boxes.resize(2 * m_leaves);
    split(1, progress);
    progress.check();
}

std::size_t GroundTree::firstOf(std::size_t node) const noexcept
{
    // Nodes of a level share the points evenly; of the node after the level's last one, this is where all end.
    const auto level = std::size_t(std::bit_width(node) - 1);
    return std::size_t(std::uint64_t(node - (std::size_t(1) << level)) * m_places.size() >> level);
}

std::span<const GroundTree::Place> GroundTree::places(std::size_t node) const noexcept
{
    const auto level = std::size_t(std::bit_width(node) - 1), first = std::size_t(1) << level;
    const std::size_t begin = firstOf(node);
    return {m_places.data() + begin,
            std::size_t(std::uint64_t(node + 1 - first) * m_places.size() >> level) - begin};
}

void GroundTree::split(std::size_t node, const Progress& progress)
{
    if (progress.cancelled()) return;
    const std::span<const Place> own = places(node);
    Box& box = m_boxes[node];
    for (const Place& p : own)
        box = {std::min(box.minX, p.x), std::min(box.minY, p.y), std::max(box.maxX, p.x), std::max(box.maxY, p.y)};
    if (node >= m_leaves || own.empty()) return;
    const bool alongY =
        (double(box.maxY) - double(box.minY)) * m_scale[1] > (double(box.maxX) - double(box.minX)) * m_scale[0];
    Place* const first = m_places.data() + (own.data() - m_places.data());
    Place* const middle = m_places.data() + firstOf(2 * node + 1);
    Place* const last = first + own.size();
    // A halving of millions has to stop when it is asked to: by way of the comparison.
    const auto before = [&](const Place& a, const Place& b) {
        if (progress.cancelled()) throw Cancelled();
        return alongY ? std::tie(a.y, a.x, a.z) < std::tie(b.y, b.x, b.z) : a < b;
    };
    if (middle != last) {
        std::nth_element(first, middle, last, before);
        m_splits[node] = {alongY ? middle->y : middle->x, alongY};
    } else {
        m_splits[node] = {INT32_MAX, alongY};
    }
    const auto left = [this, node, &progress] { split(2 * node, progress); };
    const auto right = [this, node, &progress] { split(2 * node + 1, progress); };
    if (own.size() > kGroundTask) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

double GroundTree::squaredDistance(double x, double y, const Box& box) const noexcept
{
    const double dx = std::max({0.0, double(box.minX) - x, x - double(box.maxX)}) * m_scale[0];
    const double dy = std::max({0.0, double(box.minY) - y, y - double(box.maxY)}) * m_scale[1];
    return dx * dx + dy * dy;
}

void GroundTree::nearest(std::int32_t x, std::int32_t y, std::size_t k, std::vector<Near>& found) const
{
    found.clear();
    k = std::min(k, size());
    if (k == 0) return;
    const double atX = double(x), atY = double(y);
    struct Open {
        std::size_t node;
        double squared;
    };
    std::array<Open, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {1, 0.0};
    while (depth != 0) {
        Open open = stack[--depth];
        if (found.size() == k && open.squared > found.back().squared) continue;
        while (open.node < m_leaves) {
            const std::size_t left = 2 * open.node, right = left + 1;
            const double toLeft = squaredDistance(atX, atY, m_boxes[left]),
                         toRight = squaredDistance(atX, atY, m_boxes[right]);
            const Split& s = m_splits[open.node];
            const bool leftFirst = toLeft < toRight || (toLeft == toRight && (s.alongY ? y : x) < s.value);
            stack[depth++] = leftFirst ? Open{right, toRight} : Open{left, toLeft};
            open = leftFirst ? Open{left, toLeft} : Open{right, toRight};
        }
        for (const Place& p : places(open.node)) {
            const double dx = (double(p.x) - atX) * m_scale[0], dy = (double(p.y) - atY) * m_scale[1];
            const double squared = dx * dx + dy * dy;
            if (found.size() == k && squared > found.back().squared) continue;
            const Near candidate{squared, p};
            if (found.size() == k) {
                if (!(candidate < found.back())) continue;
                found.pop_back();
            }
            std::size_t at = found.size();
            found.push_back(candidate);
            for (; at > 0 && candidate < found[at - 1]; --at) found[at] = found[at - 1];
            found[at] = candidate;
        }
    }
}

std::size_t GroundTree::firstNodeOf(std::size_t most) const noexcept
{
    std::size_t first = 1;
    while (first < m_leaves && size() / first > most) first *= 2;
    return first;
}

std::size_t GroundTree::nodeAt(std::size_t firstNode, std::int32_t x, std::int32_t y) const noexcept
{
    std::size_t node = 1;
    while (node < firstNode) {
        const Split& s = m_splits[node];
        node = 2 * node + std::size_t((s.alongY ? y : x) >= s.value);
    }
    return node;
}

bool GroundTree::within(const Box& box, std::size_t most, std::vector<Place>& found) const
{
    const std::size_t limit = found.size() + most;
    std::array<std::size_t, 64> stack{1};
    for (std::size_t depth = 1; depth != 0;) {
        const std::size_t node = stack[--depth];
        const Box& b = m_boxes[node];
        if (b.minX > box.maxX || b.maxX < box.minX || b.minY > box.maxY || b.maxY < box.minY) continue;
        if (node < m_leaves) {
            stack[depth++] = 2 * node + 1;
            stack[depth++] = 2 * node;
            continue;
        }
        for (const Place& p : places(node)) {
            if (p.x < box.minX || p.x > box.maxX || p.y < box.minY || p.y > box.maxY) continue;
            if (found.size() == limit) return false;
            found.push_back(p);
        }
    }
    return true;
}

}  // namespace punctum
