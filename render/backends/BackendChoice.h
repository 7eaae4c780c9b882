// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/DisplaySettings.h"
#include "render/raster/Backend.h"

#include <optional>
#include <string>
#include <vector>

namespace punctum::render
{

/// What was found out about the backends of this machine.
struct BackendMeasurement {
    std::string device;  ///< OpenGL's device and driver version; empty: there is no OpenGL
    BackendKind fastest = BackendKind::Cpu;
    struct Rate {
        BackendKind kind;
        double pointsPerSecond;
    };
    std::vector<Rate> rates;  ///< of those that could be measured
};

/// What a view draws with, as far as it decides what is fast.
struct MeasuredLook {
    DisplaySettings display;    ///< samples, points, light, whether holes are closed; no attribute, range or clip
    bool keepOnDevice = false;  ///< pictures of devices stay there, as ProgressiveRenderer::keepOnDevice()
};

/// Draws frames in motion of a small made-up cloud by every backend that runs here, as a view with this look does:
/// some hundred milliseconds, mostly the drivers' compilers. Nothing is drawn when OpenGL's device is
/// `knownDevice`: then `rates` is empty. Never throws for a backend that does not work; it is left out.
///
/// Makes an OpenGL context of its own, and leaves none current in this thread: none may be when it is called.
BackendMeasurement measureBackends(const MeasuredLook& look = {},
                                   const std::optional<std::string>& knownDevice = std::nullopt);

}  // namespace punctum::render
