// SPDX-License-Identifier: MIT
#include "ui/view/Navigation.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum::ui
{

namespace
{

constexpr double kZoomPerNotch = 0.8;  // of the distance that is left after one notch of the wheel

// Distances from what is looked at, as shares of the size of all that is open.
constexpr double kFarthest = 20.0;    // all is a twentieth of the picture then
constexpr double kNearest = 1e-6;     // of a point: a millimeter where all is a kilometer wide
constexpr double kNearestGap = 1e-3;  // of a place where there is nothing, from which on zooming is flying

/// The largest part of zooming out by `factor` (> 1) after which the eye is still in reach.
double withinReach(double factor, const glm::dvec3& target, const render::Camera& camera, const ViewReach& reach)
{
    const auto away = [&](double f) {
        return glm::length((target + (camera.eye - target) * f - reach.middle) * camera.stretch);
    };
    const double limit = std::max(kFarthest * reach.size, away(1.0));
    if (away(factor) <= limit) return factor;
    double low = 1.0, high = factor;
    for (int step = 0; step < 40; ++step) {
        const double middle = (low + high) / 2;
        (away(middle) <= limit ? low : high) = middle;
    }
    return low;
}

/// Puts the pivot on the line of sight.
void setPivotDepth(render::Camera& camera, double depth)
{
    camera.pivot = camera.eye + camera.forward() * depth / camera.stretch;
}

}  // namespace

ViewReach ViewReach::of(const WorldBounds& bounds, const glm::dvec3& stretch) noexcept
{
    if (bounds.empty()) return {};
    return {(bounds.min + bounds.max) * 0.5, glm::length((bounds.max - bounds.min) * stretch)};
}

void Navigation::begin(Drag drag, glm::dvec2 px, double depth) noexcept
{
    m_drag = drag;
    m_depth = depth;
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
        // Seen in parallel, depth does not count.
        const double share = m_depth > 0.0 && !camera.orthographic ? m_depth / camera.pivotDepth() : 1.0;
        camera.pan(delta * share, m_size.y);
    }
    return true;
}

bool Navigation::zoom(double notches, const glm::dvec3& target, render::Camera& camera, const ViewReach& reach,
                      bool point) noexcept
{
    double factor = std::pow(kZoomPerNotch, std::clamp(notches, -10.0, 10.0));
    if (reach.size > 0.0 && factor > 1.0) factor = withinReach(factor, target, camera, reach);
    const double nearest = reach.size * (point ? kNearest : kNearestGap);
    const glm::dvec3 way = (target - camera.eye) * camera.stretch;
    const double distance = glm::length(way);
    if (camera.orthographic) {
        // There is nothing to go through: what counts is how much a px covers.
        if (factor < 1.0) factor = std::min(1.0, std::max(factor, reach.size * kNearest / camera.pivotDepth()));
        camera.zoomTowards(target, factor);
        // The picture does not change as the eye moves along the line of sight: it goes to where the pivot is in
        // the middle of the picture at the target's depth, so that the next orbit turns about what is seen.
        const double scale = camera.pivotDepth();
        const glm::dvec3 ahead = camera.forward() / camera.stretch;
        camera.pivot = camera.eye + ahead * glm::dot((target - camera.eye) * camera.stretch, camera.forward());
        camera.eye = camera.pivot - ahead * scale;
        return true;
    }
    if (factor < 1.0 && distance * factor < nearest) {
        const glm::dvec3 direction = distance > 0.0 ? way / distance : camera.forward();
        camera.eye += direction * (distance + nearest) / camera.stretch;
        setPivotDepth(camera, reach.size * kNearestGap);
        return false;
    }
    camera.zoomTowards(target, factor);
    const double depth = glm::dot((target - camera.eye) * camera.stretch, camera.forward());
    if (depth > 0.0) setPivotDepth(camera, depth);
    return true;
}

render::Camera Navigation::shifted(const render::Camera& camera, glm::dvec2 share) noexcept
{
    render::Camera result = camera;
    result.pan(-share, 1.0);
    return result;
}

render::Camera Navigation::centered(const render::Camera& camera, const glm::dvec3& point) noexcept
{
    render::Camera result = camera;
    // Seen in parallel, the depth of the pivot is the scale and nothing else.
    const double depth =
        camera.orthographic
            ? camera.pivotDepth()
            : std::max(glm::dot((point - camera.eye) * camera.stretch, camera.forward()), camera.nearDepth());
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
