// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <glm/vec2.hpp>

#include <optional>

namespace punctum::ui
{

/// Turns the hand's movements into camera movements: turntable orbit, pan, zoom towards a point. Pure arithmetic,
/// no widgets; positions in px of the picture from its top left corner.
class Navigation
{
public:
    enum class Drag { None, Orbit, Pan };
    static constexpr double kTremble = 3.0;  ///< px: a mouse that moves less is clicked, not dragged

    void setSize(glm::dvec2 sizePx) noexcept { m_size = sizePx; }
    glm::dvec2 size() const noexcept { return m_size; }

    void begin(Drag drag, glm::dvec2 px) noexcept;
    void end() noexcept { m_drag = Drag::None; }
    Drag drag() const noexcept { return m_drag; }
    /// Whether the mouse has left the place where it was pressed: a click moves nothing.
    bool moved() const noexcept { return m_moved; }
    /// The camera after the mouse came to `px`; nothing while no drag is on or the hand only trembles.
    bool move(glm::dvec2 px, render::Camera& camera) noexcept;

    /// `notches` of the wheel (forward: positive) towards `target`, which keeps its place on the screen.
    static void zoom(double notches, const glm::dvec3& target, render::Camera& camera) noexcept;

    /// Where the camera goes so that `point` becomes the pivot in the middle of the picture, at the distance
    /// that it has now.
    static render::Camera centered(const render::Camera& camera, const glm::dvec3& point) noexcept;

    /// Part `t` (0 to 1) of the way from one camera to another; the shorter way round.
    static render::Camera between(const render::Camera& from, const render::Camera& to, double t) noexcept;

private:
    glm::dvec2 m_size{1.0};
    glm::dvec2 m_start{0.0};
    glm::dvec2 m_last{0.0};
    Drag m_drag = Drag::None;
    bool m_moved = false;
};

}  // namespace punctum::ui
