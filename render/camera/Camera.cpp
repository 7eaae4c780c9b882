// SPDX-License-Identifier: MIT
#include "render/camera/Camera.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace punctum::render
{

namespace
{

constexpr double kRightAngle = std::numbers::pi / 2;

/// Whether all of the box is beyond one side of the picture, before the eye or behind it.
bool liesBeside(const Camera& camera, const WorldBounds& bounds, glm::dvec2 sizePx) noexcept
{
    const double tanY = std::tan(camera.fovY / 2), tanX = tanY * sizePx.x / std::max(sizePx.y, 1.0);
    std::array<int, 4> outside{};  // corners beyond each side of the picture
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 offset =
            (glm::dvec3(corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                        corner & 4 ? bounds.max.z : bounds.min.z) -
             camera.eye) *
            camera.stretch;
        const double x = glm::dot(offset, camera.right()), y = glm::dot(offset, camera.up()),
                     z = glm::dot(offset, camera.forward());
        outside[0] += x > z * tanX;
        outside[1] += -x > z * tanX;
        outside[2] += y > z * tanY;
        outside[3] += -y > z * tanY;
    }
    return std::find(outside.begin(), outside.end(), 8) != outside.end();
}

}  // namespace

glm::dvec3 Camera::right() const noexcept
{
    return {std::cos(yaw), std::sin(yaw), 0.0};
}

glm::dvec3 Camera::forward() const noexcept
{
    return {-std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch)};
}

glm::dvec3 Camera::up() const noexcept
{
    return glm::cross(right(), forward());
}

double Camera::pivotDepth() const noexcept
{
    const glm::dvec3 line = (pivot - eye) * stretch;
    const double depth = glm::dot(line, forward());
    return depth > 0 ? std::max(depth, 1e-12) : std::max(glm::length(line), 1e-12);
}

double Camera::nearDepth() const noexcept
{
    constexpr double kNearShare = 1e-3;  // of the pivot's depth
    return orthographic ? -std::numeric_limits<double>::infinity() : pivotDepth() * kNearShare;
}

double Camera::unitsPerPixel(double heightPx) const noexcept
{
    return 2.0 * std::tan(fovY / 2) * pivotDepth() / std::max(heightPx, 1.0);
}

void Camera::orbit(double deltaYaw, double deltaPitch) noexcept
{
    const double newPitch = std::clamp(pitch + deltaPitch, -kRightAngle, kRightAngle);
    const double turn = newPitch - pitch;
    // The pivot keeps its place in view coordinates: take the eye's offset there, turn the axes, put it back.
    const glm::dvec3 offset = (eye - pivot) * stretch;
    const glm::dvec3 inView(glm::dot(offset, right()), glm::dot(offset, up()), glm::dot(offset, forward()));
    yaw = std::remainder(yaw + deltaYaw, 2 * std::numbers::pi);
    pitch += turn;
    eye = pivot + (right() * inView.x + up() * inView.y + forward() * inView.z) / stretch;
}

void Camera::pan(glm::dvec2 deltaPx, double heightPx) noexcept
{
    const double unit = unitsPerPixel(heightPx);
    const glm::dvec3 move = (up() * deltaPx.y - right() * deltaPx.x) * unit / stretch;
    eye += move;
    pivot += move;
}

void Camera::zoomTowards(const glm::dvec3& target, double factor) noexcept
{
    eye = target + (eye - target) * factor;
    // The pivot follows along the line of sight, so that the next orbit turns about what is in the middle now.
    pivot = target + (pivot - target) * factor;
}

glm::dvec3 Camera::unproject(glm::dvec2 px, glm::dvec2 sizePx) const noexcept
{
    const double unit = unitsPerPixel(sizePx.y);
    return eye + (forward() * pivotDepth() + right() * ((px.x - sizePx.x / 2) * unit) -
                  up() * ((px.y - sizePx.y / 2) * unit)) /
                     stretch;
}

glm::dvec3 Camera::project(const glm::dvec3& world, glm::dvec2 sizePx) const noexcept
{
    const glm::dvec3 offset = (world - eye) * stretch;
    const double depth = glm::dot(offset, forward());
    const double scale = orthographic ? 1.0 / unitsPerPixel(sizePx.y)
                                      : sizePx.y / 2 / std::tan(fovY / 2) / (depth != 0 ? depth : 1e-300);
    return {sizePx.x / 2 + glm::dot(offset, right()) * scale, sizePx.y / 2 - glm::dot(offset, up()) * scale, depth};
}

double Camera::seenSize(const WorldBounds& bounds, glm::dvec2 sizePx) const noexcept
{
    if (bounds.empty()) return 0.0;
    bool behind = false, before = false;
    glm::dvec2 low(1e300), high(-1e300);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 px =
            project({corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                     corner & 4 ? bounds.max.z : bounds.min.z},
                    sizePx);
        (px.z > 0 || orthographic ? before : behind) = true;
        low = glm::min(low, glm::dvec2(px));
        high = glm::max(high, glm::dvec2(px));
    }
    if (!before) return 0.0;
    // A box that reaches behind the eye has no outline; it is near, and large, unless it lies beside the picture.
    if (behind) return liesBeside(*this, bounds, sizePx) ? 0.0 : std::max(sizePx.x, sizePx.y);
    low = glm::max(low, glm::dvec2(0.0));
    high = glm::min(high, sizePx);
    return low.x > high.x || low.y > high.y ? 0.0 : std::max(high.x - low.x, high.y - low.y);
}

void Camera::fit(const WorldBounds& bounds, glm::dvec2 sizePx) noexcept
{
    if (bounds.empty()) return;
    pivot = bounds.min + (bounds.max - bounds.min) * 0.5;
    const glm::dvec3 half = (bounds.max - pivot) * stretch;
    constexpr double kMargin = 1.04;
    const double tanY = std::tan(fovY / 2) / kMargin;
    const double tanX = tanY * sizePx.x / std::max(sizePx.y, 1.0);
    const glm::dvec3 axes[3] = {right(), up(), forward()};
    // In view axes around the pivot, a corner (u, w) is inside when |u - eyeU| <= tan * (w - eyeW). So of all
    // corners: eyeU >= max(u - tan w) + tan eyeW and eyeU <= min(u + tan w) - tan eyeW; both hold up to a largest
    // eyeW, where eyeU is what lies between. Seen in parallel, w does not count.
    double eyeDepth = 0.0, eyeAcross[2] = {0.0, 0.0};
    double low[2], high[2];
    for (int axis = 0; axis < 2; ++axis) {
        const double tan = axis == 0 ? tanX : tanY;
        low[axis] = 1e300;
        high[axis] = -1e300;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 c((corner & 1 ? 1 : -1) * half.x, (corner & 2 ? 1 : -1) * half.y,
                               (corner & 4 ? 1 : -1) * half.z);
            const double u = glm::dot(c, axes[axis]);
            const double w = orthographic ? 0.0 : glm::dot(c, axes[2]);
            low[axis] = std::min(low[axis], u + tan * w);
            high[axis] = std::max(high[axis], u - tan * w);
        }
        eyeDepth = std::min(eyeDepth, (low[axis] - high[axis]) / (2 * tan));
    }
    for (int axis = 0; axis < 2; ++axis) eyeAcross[axis] = (low[axis] + high[axis]) / 2;
    const double distance = eyeDepth < 0 ? -eyeDepth : 1.0;
    eye = pivot + (axes[0] * eyeAcross[0] + axes[1] * eyeAcross[1] - axes[2] * distance) / stretch;
}

bool Camera::setView(std::string_view name) noexcept
{
    const double distance = glm::length((pivot - eye) * stretch);
    struct View {
        std::string_view name;
        double yaw, pitch;
    };
    constexpr View kViews[] = {
        {"top", 0, -kRightAngle},          {"bottom", 0, kRightAngle}, {"front", 0, 0},
        {"back", 2 * kRightAngle, 0},      {"left", -kRightAngle, 0},  {"right", kRightAngle, 0},
        {"iso", kRightAngle / 2, -0.6155},
    };
    const auto* view = std::find_if(std::begin(kViews), std::end(kViews), [&](auto& v) { return v.name == name; });
    if (view == std::end(kViews)) return false;
    yaw = view->yaw;
    pitch = view->pitch;
    eye = pivot - forward() * distance / stretch;
    return true;
}

bool seenInParallel(std::string_view view) noexcept
{
    return view != "iso";
}

Camera sectionCamera(const Section& section, double low, double high, glm::dvec2 sizePx,
                     double exaggeration) noexcept
{
    const glm::dvec2 along = section.along();
    Camera camera;
    camera.orthographic = true;
    camera.yaw = std::atan2(along.y, along.x);
    camera.pitch = 0.0;
    camera.stretch = section.stretch * glm::dvec3(1.0, 1.0, exaggeration);
    camera.fit(section.box(low, high), sizePx);
    return camera;
}

}  // namespace punctum::render
