// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "render/camera/Camera.h"

#include <functional>

namespace punctum::render
{

/// How large what lies in a box (world) is in a picture of this size, at most, of what the clip leaves: px, 0 where
/// it is out of sight. For ReadingOrder::look(). A value: any thread, and nothing of it is shared.
std::function<double(const WorldBounds&)> sightOf(const Camera& camera, const glm::dvec2& sizePx, Clip clip);

}  // namespace punctum::render
