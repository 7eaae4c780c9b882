// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace punctum::render
{

/// Which contours the picture of a surface has.
struct SurfaceContours {
    double interval = 0;  ///< between two of them, in units of Z of the file; 0: there are none
    double width = 1.2;   ///< px; index contours are wider

    bool on() const noexcept { return interval > 0; }
    friend bool operator==(const SurfaceContours&, const SurfaceContours&) = default;
};

/// Each so manieth contour, counted from the height 0, is an index contour: wider and darker.
inline constexpr int kIndexContour = 5;

/// The interval by which a surface whose heights have this range gets about twenty contours: 1, 2 or 5 times a
/// power of ten. 0 where there is no range.
double suitableInterval(double range) noexcept;

/// A picture of heights. Each is told as a *level*: how many intervals it is above one of the index contours, so
/// that whole numbers are contours. NaN: no surface.
struct LevelPicture {
    std::span<const float> levels;
    int width = 0, height = 0;
};

/// The ink of a pixel goes by the levels of pixels up to so far beside it.
inline constexpr int kContourReach = 3;

/// Columns and rows from the first to before the last.
struct PixelBlock {
    int firstColumn = 0, lastColumn = 0, firstRow = 0, lastRow = 0;
};

/// How much contours darken the pixels of a block, 0 to 255: by the distance of a pixel's middle from the next
/// contour, as the slope of the levels about it tells it. So lines are equally wide at any distance and on any
/// slope. Where they would be closer than a few px they fade, and where the surface is level there are none. The
/// levels are means of 5 x 5 px, as what is smaller is noise to lines. `ink`: of the whole picture. Any thread.
void drawContours(const LevelPicture& picture, const PixelBlock& block, double lineWidth,
                  std::span<std::uint8_t> ink);

}  // namespace punctum::render
