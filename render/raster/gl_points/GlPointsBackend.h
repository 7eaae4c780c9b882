// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/gl/GlBackend.h"

namespace punctum::render
{

/// The backend of Schuetz et al. 2019, section 3: GL_POINTS into a buffer of ids and depths, multisampled where
/// several samples are asked for. GlBackend says which context it needs.
///
/// What is out of sight is left out by stretches of the file (VisibleStretches): runs of slots are drawn in pieces.
///
/// Differs from the CPU backend where two points of one sample are equally deep (the one drawn first stays, not the
/// smaller id), and by last bits of float arithmetic. Points smaller than 1 px are drawn with 1 px, and points
/// larger than the device can draw (255 px and more) with its largest size.
///
/// Throws Error when there is no such context.
std::unique_ptr<RasterBackend> makeGlPointsBackend(const GlLimits& limits = {});

}  // namespace punctum::render
