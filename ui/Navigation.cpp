// SPDX-License-Identifier: MIT
#include "ui/Navigation.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum::ui
{

namespace
{
constexpr double kZoomPerNotch = 0.8;  // of the distance that is left after one notch of the wheel
}  // namespace

void Navigation::begin(Drag drag, glm::dvec2 px) noexcept
{
    m_drag = drag;
    m_start = m_last = px;
    m_moved = false;
}

bool Navigation::move(glm::dvec2 px, render::Camera& camera) noexcept
{
    if (m_drag == Drag::None) return false;
    if (!m_moved && glm::length(px - m_start) < kTremble) return false;
    m_moved = true;
    const glm::dvec2 delta = px - m_last;
    m_last = px;
    if (delta == glm::dvec2(0.0)) return false;
    if (m_drag == Drag::Orbit) {
        // Half a turn for the shorter side of the picture, so that the hand's feel does not depend on its shape.
        const double radians = std::numbers::pi / std::max(1.0, std::min(m_size.x, m_size.y));
        camera.orbit(-delta.x * radians, -delta.y * radians);
    } else {
        camera.pan(delta, m_size.y);
    }
    return true;
}

void Navigation::zoom(double notches, const glm::dvec3& target, render::Camera& camera) noexcept
{
    camera.zoomTowards(target, std::pow(kZoomPerNotch, std::clamp(notches, -10.0, 10.0)));
}

render::Camera Navigation::centered(const render::Camera& camera, const glm::dvec3& point) noexcept
{
    render::Camera result = camera;
    const double depth =
        std::max(glm::dot((point - camera.eye) * camera.stretch, camera.forward()), camera.pivotDepth() * 1e-3);
    result.pivot = point;
    result.eye = point - camera.forward() * depth / camera.stretch;
    return result;
}

render::Camera Navigation::between(const render::Camera& from, const render::Camera& to, double t) noexcept
{
    if (t >= 1.0) return to;
    const double s = t * t * (3.0 - 2.0 * t);
    render::Camera result = to;
    const double turn = std::remainder(to.yaw - from.yaw, 2.0 * std::numbers::pi);
    result.yaw = from.yaw + turn * s;
    result.pitch = std::lerp(from.pitch, to.pitch, s);
    result.pivot = from.pivot + (to.pivot - from.pivot) * s;
    // The eye goes round the pivot, not straight through what is being looked at.
    const double depth = std::lerp(from.pivotDepth(), to.pivotDepth(), s);
    const glm::dvec3 aside =
        (from.eye + from.forward() * from.pivotDepth() / from.stretch - from.pivot) * (1.0 - s) +
        (to.eye + to.forward() * to.pivotDepth() / to.stretch - to.pivot) * s;
    result.eye = result.pivot + aside - result.forward() * depth / result.stretch;
    return result;
}

}  // namespace punctum::ui
