// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/TargetSize.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace punctum::render
{

struct LayerProjection;
struct LocalBox;

/// px, also beyond the edges of the picture.
struct ScreenRect {
    double left = 0, top = 0, right = 0, bottom = 0;
};

/// Where the places of a box come to lie, about: as along parallel lines, at the depth of its middle. None where
/// the box reaches behind the eye.
std::optional<ScreenRect> screenRect(const LayerProjection& projection, const LocalBox& box);

/// How many points would come to lie on each px of a picture if all were drawn, in cells of some px: told of
/// rectangles that have so many points each, anywhere in them, which may lie across each other in any number. From
/// that follows which share of the points is enough.
///
/// add() all, then share(). One thread; what does not change, any.
class ScreenDensity
{
public:
    static constexpr int kCell = 16;  ///< px

    explicit ScreenDensity(const TargetSize& size);
    void add(const ScreenRect& rect, double points);
    /// Call once, after all were added. `pointsAPixel`: as many are enough.
    void finish(double pointsAPixel);
    /// Mean share of the points that is enough where the rectangle lies in the picture, above 0 to 1.
    double share(const ScreenRect& rect) const noexcept;

private:
    struct Cells {
        std::size_t left, top, right, bottom;  ///< the last ones are beyond
    };
    Cells cellsOf(const ScreenRect& rect) const noexcept;
    double& at(std::size_t column, std::size_t row) noexcept { return m_sums[row * m_stride + column]; }
    double at(std::size_t column, std::size_t row) const noexcept { return m_sums[row * m_stride + column]; }

    std::size_t m_columns, m_rows, m_stride;
    /// At first how much each corner adds to all cells right of it and below; then the shares of all cells left of
    /// it and above, summed up.
    std::vector<double> m_sums;
};

}  // namespace punctum::render
