// SPDX-License-Identifier: MIT
#pragma once

#include <QSize>

namespace punctum::ui
{

/// How the picture of a view is to be saved.
struct ScreenshotOptions {
    bool section = false;  ///< the section view instead of the main one
    QSize size{};          ///< px
    int samples = 4;       ///< a pixel: 1, 4, 8 or 16
    bool transparent = false;
    bool legend = false, scaleBar = false, northArrow = false, measurements = false;
    bool ruler = false;  ///< heights and distances of a section
    friend bool operator==(const ScreenshotOptions&, const ScreenshotOptions&) = default;
};

/// Of a picture's side, px.
inline constexpr int kLargestSide = 16384;

}  // namespace punctum::ui
