// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace punctum
{

class Progress;

/// The points of a cloud, or some of them, but for deleted ones, sorted into the leaves of a kd-tree (Bentley
/// 1975), each with its tight box. It serves two ends: near points lie together, so that the cloud can be worked on
/// piece by piece whatever its density; and the exact neighbors of a single point can be found across all pieces.
/// The splits are the medians of a sample, so that sorting is one parallel pass that can be cancelled, and the same
/// on any number of threads. Distances are true lengths (trueLengths()): a degree and a foot of height count as
/// what they are. They are computed from the raw integers in double: coordinates of any size keep their precision.
///
/// Coordinates never change, so nothing is locked after construction. Every question may be asked from any thread.
class KdOrder
{
public:
    using Raw = std::array<std::int32_t, 3>;
    using Place = std::array<double, 3>;  ///< raw coordinates that may lie between those of points, or outside

    /// Box of raw coordinates; empty when min > max.
    struct Box {
        Raw min{INT32_MAX, INT32_MAX, INT32_MAX};
        Raw max{INT32_MIN, INT32_MIN, INT32_MIN};
        bool empty() const noexcept { return min[0] > max[0]; }
        void include(const Box& other) noexcept;
        friend bool operator==(const Box&, const Box&) = default;
    };
    struct Found {
        double squared = 0;  ///< distance, squared
        std::uint32_t point = 0;
        friend bool operator<(const Found& a, const Found& b)
        {
            return a.squared < b.squared || (a.squared == b.squared && a.point < b.point);
        }
    };

    /// That of the cloud's points as they are now, made where the cloud keeps none: once for all who ask, whatever
    /// files the points are of, and anew only when points were deleted or restored. It is kept with the cloud until
    /// drop(), where it takes no more than a small share of the machine's memory. Throws as the constructor does.
    static std::shared_ptr<const KdOrder> of(const PointCloud& cloud, Progress& progress);
    /// The cloud keeps none any longer; who has one goes on.
    static void drop(const PointCloud& cloud) noexcept;
    /// drop(), where this one is so large (more than 256 MB) that the cloud better keeps none beside what a step
    /// makes after its search.
    void dropLarge(const PointCloud& cloud) const noexcept;

    /// Of the points in `only` alone; null: of all that are not deleted. Takes cloud.mutex() shared for a moment.
    /// Throws Cancelled, and Error when there are more than 2^32 points.
    KdOrder(const PointCloud& cloud, Progress& progress, const PointSet* only = nullptr);

    /// What it keeps.
    std::uint64_t bytes() const noexcept;
    /// Of the points in it.
    std::size_t size() const noexcept { return m_order.size(); }
    /// Nodes of the tree are numbered from 1 (the root); the children of n are 2n and 2n + 1.
    const Box& box(std::size_t node) const noexcept { return m_boxes[node]; }
    bool isLeaf(std::size_t node) const noexcept { return node >= m_leaves; }
    /// The points below a node.
    std::span<const std::uint32_t> points(std::size_t node) const noexcept;
    /// The leaves below a node: from the first to past the last.
    std::pair<std::size_t, std::size_t> leaves(std::size_t node) const noexcept
    {
        std::size_t first = node, end = node + 1;
        for (; first < m_leaves; end *= 2) first *= 2;
        return {first, end};
    }
    /// Nodes of one level that have about `most` points or fewer, and together all points.
    std::vector<std::size_t> tiles(std::size_t most) const;

    Raw raw(std::uint32_t point) const noexcept { return {m_axes[0][point], m_axes[1][point], m_axes[2][point]}; }
    /// From `origin`, which may lie between raw values, in units of length.
    std::array<float, 3> local(std::uint32_t point, const std::array<double, 3>& origin) const noexcept
    {
        return {float((double(m_axes[0][point]) - origin[0]) * m_scale[0]),
                float((double(m_axes[1][point]) - origin[1]) * m_scale[1]),
                float((double(m_axes[2][point]) - origin[2]) * m_scale[2])};
    }
    /// Units of length of a raw step along each axis.
    const std::array<double, 3>& scale() const noexcept { return m_scale; }
    /// What distances are told in.
    const TrueLengths& lengths() const noexcept { return m_lengths; }
    double squaredDistance(std::uint32_t a, std::uint32_t b) const noexcept
    {
        return squaredDistance(place(raw(a)), b);
    }
    /// Squared distance from a place to the nearest place of a box.
    double squaredDistance(const Place& from, const Box& box) const noexcept;
    static Place place(const Raw& raw) noexcept { return {double(raw[0]), double(raw[1]), double(raw[2])}; }

    /// The k points nearest to `point`, itself among them, nearest first (of equally near ones those of smaller
    /// index first); all points when there are not so many.
    void nearest(std::uint32_t point, std::size_t k, std::vector<Found>& found) const
    {
        nearest(place(raw(point)), k, found);
    }
    /// Those nearest to any place.
    void nearest(const Place& from, std::size_t k, std::vector<Found>& found) const;
    /// The points not further than `radius`, `point` itself among them, in no order. False when cancelled
    /// meanwhile.
    bool within(std::uint32_t point, double radius, std::vector<Found>& found, const Progress& progress) const
    {
        return within(place(raw(point)), radius, found, progress);
    }
    bool within(const Place& from, double radius, std::vector<Found>& found, const Progress& progress) const;
    /// Calls f(leaf) for each leaf with points in [min, max] (raw, may lie between values) that is not below
    /// `except`.
    template <typename F>
    void forLeavesIn(const std::array<double, 3>& min, const std::array<double, 3>& max, std::size_t except,
                     F&& f) const
    {
        std::array<std::size_t, 64> stack{1};
        for (std::size_t depth = 1; depth != 0;) {
            const std::size_t node = stack[--depth];
            const Box& b = m_boxes[node];
            bool apart = node == except || b.empty();
            for (std::size_t a = 0; a < 3; ++a)
                apart = apart || double(b.max[a]) < min[a] || double(b.min[a]) > max[a];
            if (apart) continue;
            if (isLeaf(node)) {
                f(node);
            } else {
                stack[depth++] = 2 * node + 1;
                stack[depth++] = 2 * node;
            }
        }
    }

private:
    struct Split {
        std::int32_t value = INT32_MAX;  ///< less than it: left
        std::uint8_t axis = 0;
    };
    double squaredDistance(const Place& from, std::uint32_t to) const noexcept
    {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double d = (from[a] - double(m_axes[a][to])) * m_scale[a];
            sum += d * d;
        }
        return sum;
    }
    std::vector<std::uint32_t> sampled(std::size_t n, const PointSet* only) const;
    void split(std::size_t node, std::uint32_t* first, std::uint32_t* last, const Progress& progress);
    std::vector<std::uint32_t> sortIntoBuckets(const PointSet* leftOut, const PointSet* only, Progress& progress);
    class BucketSorter;
    void sortBuckets(const std::vector<std::uint32_t>& starts, Progress& progress);
    std::array<double, 3> extents(const Box& box) const noexcept;

    std::array<std::shared_ptr<const Column>, 3> m_columns;
    std::array<const std::int32_t*, 3> m_axes{};
    TrueLengths m_lengths;
    std::array<double, 3> m_scale{};
    std::size_t m_leaves = 1;     ///< a power of two
    std::size_t m_buckets = 1;    ///< nodes of the level that the sample's medians lead to; a power of two
    std::vector<Split> m_splits;  ///< above that level; while it is made
    std::vector<Box> m_boxes;
    std::vector<std::uint32_t> m_order;
    std::vector<std::uint32_t> m_leafStart;
};

}  // namespace punctum
