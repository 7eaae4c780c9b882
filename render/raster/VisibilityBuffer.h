// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/PointId.h"
#include "render/scene/TargetSize.h"

#include <optional>
#include <vector>

namespace punctum::render
{

/// Depth and point id of each sample of a picture: its size, emptying it, and what is read out of it. PointDrawing
/// draws into it, Shading makes a picture of it; RasterBackend tells of threads and errors.
class VisibilityBuffer
{
public:
    virtual ~VisibilityBuffer() = default;

    /// A new, empty buffer.
    virtual void setTarget(const TargetSize& size) = 0;
    virtual TargetSize target() const noexcept = 0;
    virtual void clear() = 0;

    /// Ids in the buffer, each at least once (the same id may come again), in no order.
    virtual void visibleIds(std::vector<PointId>& out) = 0;
    /// Depth of each pixel's nearest sample, along the view direction in view units (Camera), rows from the top;
    /// infinity where there is no point.
    virtual void depths(std::vector<float>& out) = 0;
    /// Id of each pixel's nearest sample, rows from the top; kNoPoint where there is no point.
    virtual void nearestIds(std::vector<PointId>& out) = 0;

    /// Sample nearest to (x, y) px with a point within `radius` px.
    struct Hit {
        PointId id = kNoPoint;
        float depth = 0;  ///< along the view direction, view units
    };
    virtual std::optional<Hit> pick(int x, int y, int radius) = 0;
    /// Share of pixels with at least one point.
    virtual double coveredShare() = 0;
};

}  // namespace punctum::render
