// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>

namespace punctum
{

/// An upright slab about a line on the map: what a section view shows, as one looks at it with `from` on the left
/// and `to` on the right. A value.
///
/// Places are in `world`. Lengths are in view units, which are world units times `stretch` (trueLengths()):
/// meters in files of degrees.
struct Section {
    glm::dvec2 from{0.0}, to{0.0};
    double width = 1.0;  ///< half of it to each side of the line
    glm::dvec3 stretch{1.0};

    /// Whether the line has a length and the slab a width, and both are numbers.
    bool usable() const noexcept;
    double length() const noexcept;
    /// Directions of length 1, in view units: from left to right, and the way one looks.
    glm::dvec2 along() const noexcept;
    glm::dvec2 ahead() const noexcept;
    /// Of a place: how far it is right of `from`, and how far behind the line (negative: before it).
    glm::dvec2 placeOf(const glm::dvec3& world) const noexcept;
    /// The corners of the slab on the map: before from, before to, behind to, behind from.
    std::array<glm::dvec2, 4> corners() const noexcept;
    /// Its four sides; both ends of the line lie inside, whatever rounding does.
    std::array<ClipPlane, 4> sides() const noexcept;
    /// The same slab so much further ahead.
    Section walked(double distance) const noexcept;
    /// The same slab seen from its other side.
    Section turned() const noexcept;
    /// The box of the line between two heights.
    WorldBounds box(double low, double high) const noexcept;

    friend bool operator==(const Section&, const Section&) = default;
};

/// How many points there are beside hidden ones, and their least and greatest Z (world).
struct ShownHeights {
    PointIndex points = 0;
    double low = 0.0, high = 0.0;
    void include(const ShownHeights& other) noexcept;
};
/// `hidden`: hiddenPoints(); null: none. In parallel. Throws Cancelled.
ShownHeights shownHeights(const PointCloud& cloud, const PointSet* hidden, Progress& progress);

}  // namespace punctum
