// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <glm/vec2.hpp>

#include <optional>

namespace punctum::ui
{

/// How far a camera may go: by where all is that is open, and how large.
struct ViewReach {
    glm::dvec3 middle{0.0};  ///< world
    double size = 0.0;  ///< its diagonal in view units (render::Camera); 0: nothing is known, and nothing limits

    static ViewReach of(const WorldBounds& bounds, const glm::dvec3& stretch) noexcept;
};

/// Turns the hand's movements into camera movements: turntable orbit, pan, zoom towards a point. Pure arithmetic,
/// no widgets; positions in px of the picture from its top left corner.
class Navigation
{
public:
    enum class Drag { None, Orbit, Pan };
    static constexpr double kTremble = 3.0;  ///< px: a mouse that moves less is clicked, not dragged

    void setSize(glm::dvec2 sizePx) noexcept { m_size = sizePx; }
    glm::dvec2 size() const noexcept { return m_size; }

    /// `depth`: along the view direction, view units, of what a pan moves with the mouse; 0: the pivot's.
    void begin(Drag drag, glm::dvec2 px, double depth = 0.0) noexcept;
    void end() noexcept { m_drag = Drag::None; }
    Drag drag() const noexcept { return m_drag; }
    /// Whether the mouse has left the place where it was pressed: a click moves nothing.
    bool moved() const noexcept { return m_moved; }
    /// The camera after the mouse came to `px`; nothing while no drag is on or the hand only trembles.
    bool move(glm::dvec2 px, render::Camera& camera) noexcept;

    /// `notches` of the wheel (forward: positive) towards `target`, which keeps its place on the screen; the pivot
    /// comes to lie in the middle of the picture at the target's depth. Zooming out ends where all that is open is
    /// a small part of the picture. Zooming in goes on through a target that is as near as can be; false then: the
    /// next notch wants another target. `point`: the target is a point, not a place where there is nothing.
    static bool zoom(double notches, const glm::dvec3& target, render::Camera& camera, const ViewReach& reach = {},
                     bool point = true) noexcept;

    /// Sideways by a share of the picture's height, as the pivot sees it.
    static render::Camera shifted(const render::Camera& camera, glm::dvec2 share) noexcept;

    /// Where the camera goes so that `point` becomes the pivot in the middle of the picture, at the distance
    /// that it has now.
    static render::Camera centered(const render::Camera& camera, const glm::dvec3& point) noexcept;

    /// Part `t` (0 to 1) of the way from one camera to another; the shorter way round.
    static render::Camera between(const render::Camera& from, const render::Camera& to, double t) noexcept;

private:
    glm::dvec2 m_size{1.0};
    glm::dvec2 m_start{0.0};
    glm::dvec2 m_last{0.0};
    double m_depth = 0.0;
    Drag m_drag = Drag::None;
    bool m_moved = false;
};

}  // namespace punctum::ui
