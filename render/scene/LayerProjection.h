// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/TargetSize.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>

namespace punctum::render
{

/// Widest point whose size follows its depth: nearer ones would be all of the picture.
constexpr float kMostGrownSize = 64.0f;  // px
/// 1.5 px: the narrowest circle that holds a sample wherever it lies.
constexpr int kLeastRoundSteps = 24;

/// Maps a store's local integers to the picture, in float, exact near the eye:
///     q = float(local - reference)
///     depth = dot(rowD.xyz, q) + rowD.w        along the view direction, > 0 in front
///     w     = perspective ? depth : 1
///     x_px  = (dot(rowX.xyz, q) + rowX.w) / w  from the left edge
///     y_px  = (dot(rowY.xyz, q) + rowY.w) / w  from the top edge
/// A point is drawn when depth >= nearDepth, as a square around (x_px, y_px). Its size and its left and top edge
/// are put on the grid of the samples (size = round(width * kSampleSteps), at least 1; left = floor((x_px - size /
/// 2) * kSampleSteps)): it covers each sample in (left, left + size], and so for y. Its width is pointSize px;
/// where sizeOverDepth is not 0, sizeOverDepth / depth px, but at least pointSize and at most mostSize.
///
/// Round points cover of their square the samples in the circle that touches its edges. Those narrower than
/// kLeastRoundSteps stay squares, because a circle would miss all samples at times.
struct LayerProjection {
    glm::ivec3 reference{0};
    glm::vec4 rowX{0}, rowY{0}, rowD{0};
    bool perspective = true;
    float nearDepth = 1e-6f;
    float pointSize = 1.0f;
    float sizeOverDepth = 0.0f;
    float mostSize = kMostGrownSize;
    bool round = false;
    /// Of the square (the least where it grows), in steps of 1/kSampleSteps px.
    int sizeInSteps() const noexcept
    {
        const float steps = pointSize * float(kSampleSteps) + 0.5f;
        return steps >= 1.0f ? int(std::min(steps, 1e6f)) : 1;
    }
    /// Likewise, of the widest point where the width follows the depth.
    int mostInSteps() const noexcept { return std::max(sizeInSteps(), int(mostSize * float(kSampleSteps))); }
    bool grows() const noexcept { return sizeOverDepth > 0.0f; }
    /// px that a point can reach beyond its middle to each side, and one more.
    float margin() const noexcept { return std::max(pointSize, grows() ? mostSize : 0.0f) / 2 + 1; }
    /// Whether every point is one sample's square, which is drawn fastest.
    bool singlePixels(int samples) const noexcept
    {
        return samples == 1 && !grows() && sizeInSteps() == kSampleSteps;
    }
};

}  // namespace punctum::render
