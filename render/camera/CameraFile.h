// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace punctum::render
{

/// Reads a camera from JSON text; all keys but one may be left out:
///
///     {"eye": [x, y, z],          world units; without it the camera keeps its angles and fits the clouds
///      "yaw": 0, "pitch": -35,    degrees; yaw 0 looks north and grows to the left, pitch -90 looks down
///      "fov": 45,                 full vertical angle in degrees
///      "pivot": [x, y, z],        what zoom and parallel size are measured from; default: ahead of the eye
///      "orthographic": false}     parallel instead of perspective
///
/// `fitted`: the camera that shows all clouds, which lie in `bounds`; what the text does not say, and the stretch,
/// is taken from it. Throws Error with one sentence. Any thread.
Camera readCamera(std::string_view text, const Camera& fitted, const WorldBounds& bounds, glm::dvec2 sizePx);
/// The same from a file, whose name is in the sentence then.
Camera readCameraFile(const std::filesystem::path& path, const Camera& fitted, const WorldBounds& bounds,
                      glm::dvec2 sizePx);

/// The same keys, on several lines, so that a camera can be kept and used again.
std::string cameraText(const Camera& camera);

}  // namespace punctum::render
