// SPDX-License-Identifier: MIT
#pragma once

#include "app/Console.h"
#include "render/camera/Camera.h"

#include <filesystem>

namespace punctum::app
{

/// Reads a camera from a JSON file; all keys but one may be left out:
///
///     {"eye": [x, y, z],          world units; without it the camera keeps its angles and fits the clouds
///      "yaw": 0, "pitch": -35,    degrees; yaw 0 looks north and grows to the left, pitch -90 looks down
///      "fov": 45,                 full vertical angle in degrees
///      "pivot": [x, y, z],        what zoom and parallel size are measured from; default: ahead of the eye
///      "orthographic": false}     parallel instead of perspective
///
/// `fitted`: the camera that shows all clouds, from which the rest is taken. Throws Error.
render::Camera readCamera(const std::filesystem::path& path, const render::Camera& fitted,
                          const WorldBounds& bounds, glm::dvec2 sizePx);

/// The same keys, so that a camera can be kept and used again.
Json jsonOf(const render::Camera& camera);

}  // namespace punctum::app
