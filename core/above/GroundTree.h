// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace punctum
{

class Progress;

/// The points of the ground, seen from above: a kd-tree over X and Y (Bentley 1975) whose halves are exact, so that
/// it is the same however the points are ordered in their files, and on any number of threads.
///
/// 12 bytes a point of the ground, and some for the boxes. Every question may be asked from any thread.
class GroundTree
{
public:
    /// Raw coordinates.
    struct Place {
        std::int32_t x = 0, y = 0, z = 0;
        friend bool operator==(const Place&, const Place&) = default;
        friend bool operator<(const Place& a, const Place& b) noexcept
        {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        }
    };
    /// Box of raw coordinates; empty when min > max.
    struct Box {
        std::int32_t minX = INT32_MAX, minY = INT32_MAX, maxX = INT32_MIN, maxY = INT32_MIN;
    };
    /// A place of the ground, and how far it is, seen from above.
    struct Near {
        double squared = 0;
        Place place;
        friend bool operator<(const Near& a, const Near& b) noexcept
        {
            return a.squared != b.squared ? a.squared < b.squared : a.place < b.place;
        }
    };

    /// `scale`: units of length of a raw step along each axis. Throws Cancelled.
    GroundTree(const PointCloud& cloud, const PointSet& ground, const std::array<double, 3>& scale,
               Progress& progress);

    std::size_t size() const noexcept { return m_places.size(); }
    const std::array<double, 3>& scale() const noexcept { return m_scale; }
    const Box& bounds() const noexcept { return m_boxes[1]; }

    /// The k nearest, nearest first (of equally near ones the smaller coordinates); all where there are not so
    /// many.
    void nearest(std::int32_t x, std::int32_t y, std::size_t k, std::vector<Near>& found) const;

    /// Nodes are numbered from 1, the children of n are 2n and 2n + 1. Together the nodes of one level have all
    /// points, `most` or about so many each.
    std::size_t firstNodeOf(std::size_t most) const noexcept;
    /// The node of that level in whose part of the plane a place lies.
    std::size_t nodeAt(std::size_t firstNode, std::int32_t x, std::int32_t y) const noexcept;
    const Box& box(std::size_t node) const noexcept { return m_boxes[node]; }
    std::span<const Place> places(std::size_t node) const noexcept;
    /// Adds the points in a box, ends included, to `found`; false when they are more than `most`.
    bool within(const Box& box, std::size_t most, std::vector<Place>& found) const;

private:
    struct Split {
        std::int32_t value = 0;
        bool alongY = false;
    };
    std::size_t firstOf(std::size_t node) const noexcept;
    void split(std::size_t node, const Progress& progress);
    double squaredDistance(double x, double y, const Box& box) const noexcept;

    std::array<double, 3> m_scale{};
    std::vector<Place> m_places;
    std::size_t m_leaves = 1;  ///< a power of two
    std::vector<Split> m_splits;
    std::vector<Box> m_boxes;
};

}  // namespace punctum
