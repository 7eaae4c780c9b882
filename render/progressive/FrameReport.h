// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <cstdint>

namespace punctum::render
{

/// What one call of ProgressiveRenderer::renderFrame() did.
struct FrameReport {
    double seconds = 0;      ///< from call to return
    PointIndex filled = 0;   ///< slots drawn in the fill pass
    double share = 0;        ///< of all slots drawn with the present camera, 0 to 1
    bool converged = false;  ///< image equals the brute-force image and nothing streams
    /// Points of all clouds that a full picture looks at, about. `partly`: not all in sight, but as many as the
    /// screen can show (Detail::OfScreen); the image is that of these then.
    PointIndex asked = 0;
    bool partly = false;
    /// When converged: of points that have come in sight while a cloud loads, none is missing in the picture.
    bool current = false;
    /// Seconds of its parts. Where the device keeps the time, of reprojecting and filling by its clock.
    struct Passes {
        double reproject = 0;  ///< what was visible, drawn anew
        double fill = 0;       ///< further slots
        double resolve = 0;    ///< colors, light, holes; the picture brought over, where it is
        double stream = 0;     ///< words of another attribute, or after a change
    } passes;
    std::uint64_t bytesUp = 0;    ///< brought to the device ...
    std::uint64_t bytesDown = 0;  ///< ... and back; 0 where the processor draws
};

}  // namespace punctum::render
