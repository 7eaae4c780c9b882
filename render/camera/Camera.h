// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Section.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <string_view>

namespace punctum::render
{

/// Where a picture is taken from: a turntable camera, z up. A value; no thread rules.
///
/// Frames: positions in `world` (double, CRS units), angles in radians, screen positions in px from the top left
/// corner of the picture. yaw 0 looks north (+y), growing yaw turns the view to the left (counter-clockwise seen
/// from above); pitch 0 is level, -pi/2 looks straight down. Lengths that are seen (depths, sizes of a px) are in
/// view units: world units times `stretch`, which makes degrees and meters, or meters and feet, comparable.
struct Camera {
    glm::dvec3 eye{0.0};
    double yaw = 0.0;
    double pitch = -0.6;
    double fovY = 0.785398163397448;  ///< full vertical angle (45 degrees), perspective only
    glm::dvec3 pivot{0.0};            ///< what orbit() turns about and zooming is measured from
    /// Parallel instead of perspective: all is as large as it is at the pivot's depth in perspective, and what lies
    /// behind the eye is seen, too.
    bool orthographic = false;
    glm::dvec3 stretch{1.0};  ///< view units of a world unit along each axis: see trueLengths()

    glm::dvec3 right() const noexcept;
    glm::dvec3 up() const noexcept;
    glm::dvec3 forward() const noexcept;
    /// Distance of the pivot along the view direction; never below a tiny positive number.
    double pivotDepth() const noexcept;
    /// Depth from which on something is drawn: what is nearer would hide all else. Seen in parallel, where the eye
    /// has no place, it is minus infinity.
    double nearDepth() const noexcept;
    /// View units that one px covers at the pivot's depth, for a picture of this height.
    double unitsPerPixel(double heightPx) const noexcept;

    /// Turns about the pivot by these angles; pitch stops at straight up and down.
    void orbit(double deltaYaw, double deltaPitch) noexcept;
    /// Moves sideways so that what lies at the pivot's depth follows the mouse by deltaPx.
    void pan(glm::dvec2 deltaPx, double heightPx) noexcept;
    /// Moves towards (factor < 1) or away from (factor > 1) a world point that keeps its place on the screen.
    void zoomTowards(const glm::dvec3& target, double factor) noexcept;
    /// World point at the pivot's depth under a px.
    glm::dvec3 unproject(glm::dvec2 px, glm::dvec2 sizePx) const noexcept;
    /// px of a world point, z: depth along the view direction (<= 0: behind).
    glm::dvec3 project(const glm::dvec3& world, glm::dvec2 sizePx) const noexcept;
    /// How many px wide or high, whichever is more, the part of a box that lies in the picture may be; 0: nothing
    /// of it is in the picture.
    double seenSize(const WorldBounds& bounds, glm::dvec2 sizePx) const noexcept;
    /// Puts the pivot in the middle of the box and the eye where the whole box fills the picture. Keeps angles.
    void fit(const WorldBounds& bounds, glm::dvec2 sizePx) noexcept;
    /// Standard views: "top", "bottom", "front", "back", "left", "right", "iso". False for another name. Leaves
    /// the projection as it is: see seenInParallel().
    bool setView(std::string_view name) noexcept;

    friend bool operator==(const Camera&, const Camera&) = default;
};

/// Whether a standard view is orthographic where nobody asks for perspective: plans and elevations are, from which
/// one reads lengths; "iso" is not.
bool seenInParallel(std::string_view view) noexcept;

/// A parallel view of a section, upright and filled by what lies between two heights (world). `exaggeration`:
/// heights look so many times as high.
Camera sectionCamera(const Section& section, double low, double high, glm::dvec2 sizePx,
                     double exaggeration = 1.0) noexcept;

}  // namespace punctum::render
