// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "render/camera/Projection.h"
#include "render/progressive/DisplaySettings.h"
#include "render/progressive/ViewCloud.h"
#include "render/scene/FrameScene.h"
#include "render/scene/ResolveSettings.h"
#include "render/scene/TargetSize.h"

#include <optional>

namespace punctum::render
{

/// What a view shows its clouds by.
struct ViewLook {
    Camera camera;
    DisplaySettings display;
    std::optional<PicturePart> part;  ///< of a larger picture; none: all of it
    float partExtent = 0;             ///< of a part: EyeDomeSettings::extent of the whole
};

/// Samples a pixel that a display asks for: the next lower of kSampleCounts.
int samplesOf(const DisplaySettings& display) noexcept;
/// Makes what a frame draws of a view's clouds, a layer each; notes in them what their slots cost. `partly`: of
/// clouds whose slots lie in files, what the screen can show alone (Detail::OfScreen), as the backend can draw so.
/// Takes each cloud's mutex() shared.
void makeScene(ViewClouds& clouds, const ViewLook& look, const TargetSize& size, bool partly, FrameScene& scene);
/// How their points are colored at present; holes are closed while some are not drawn.
ResolveSettings colorsOf(const ViewClouds& clouds, const ViewLook& look);

}  // namespace punctum::render
