// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <cstdint>
#include <memory>

namespace punctum
{

class Progress;

/// A synthetic but lifelike airborne survey: terrain, buildings, trees with several returns, water, roads; RGB,
/// intensity, GPS time along flight lines, scan angles, classes, and two extra bytes attributes (Reflectance,
/// Deviation). LAS 1.4 point format 7, scale 0.001 m, in UTM-sized coordinates (WKT of EPSG:32633). The same points
/// and seed give the same cloud on every machine. About 10 points a square metre. In parallel; throws Error
/// (memory), Cancelled.
std::shared_ptr<PointCloud> makeSample(PointIndex points, std::uint64_t seed, Progress& progress);

}  // namespace punctum
