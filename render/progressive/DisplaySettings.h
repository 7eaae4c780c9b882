// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "render/color/ColorMap.h"
#include "render/color/Tone.h"
#include "render/scene/ResolveSettings.h"
#include "render/surface/SurfaceContours.h"
#include "render/surface/SurfaceLook.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace punctum::render
{

/// What the width of a point on the screen goes by.
enum class PointSizing {
    Pixels,   ///< the same everywhere
    World,    ///< a length in the world: near points are larger
    Density,  ///< a length in the world, too: the spacing of the cloud's points, so that surfaces close
};

/// What the user chose to see; belongs to the view, not to a cloud.
struct DisplaySettings {
    std::string attribute;  ///< name; a cloud without it keeps what it shows (first: see firstAttribute)
    std::string colorMap;   ///< Scalar attributes; empty: suitableColorMap()
    std::optional<std::pair<double, double>> range;  ///< Scalar; none: 2nd to 98th percentile of what is shown; a
                                                     ///< cloud without the attribute has its own
    std::array<Rgba8, 256> palette{};                ///< Class; defaults to asprsClasses()
    std::array<bool, 256> classVisible{};            ///< defaults to all
    Clip clip;                                       ///< what lies outside is not drawn; at most kMostClipPlanes
    std::vector<ClipPlane> cuts;  ///< beside the clip's planes; what they cut off counts in ranges
    PointSizing sizing = PointSizing::Pixels;
    double pointSize = 1.0;  ///< Pixels: px
    double worldSize = 0.1;  ///< World: view units (Camera)
    double spacings = 1.0;   ///< Density: width in spacings; 1: the squares of neighbors touch
    bool round = false;      ///< points are circles (where they are 1.5 px wide or more)
    bool averaged = false;   ///< a sample shows the mean color of all points within 1 % of its nearest one's depth
    NormalLook normals = NormalLook::Lit;     ///< Vector
    ColorTone tone;                           ///< Color
    int bands = 0;                            ///< Scalar: steps of the color map; 0: smooth
    double eyeDome = 0.0;                     ///< strength of eye-dome lighting, 1 as usual; 0: none
    bool fillHoles = false;                   ///< closes small holes of frames that are not finished (HoleFill.h)
    SurfaceLook surface = SurfaceLook::None;  ///< of the clouds that have one: ProgressiveRenderer::setSurface()
    SurfaceContours contours;                 ///< of the surface
    bool pointsOnTop = false;                 ///< points behind the surface are seen through it
    /// Points of these classes are not seen where the surface is, but for selected ones.
    std::bitset<256> surfaceReplaces{};
    int samples = 1;  ///< a pixel; the next lower of kSampleCounts
    Rgba8 backgroundTop{38, 44, 52, 255};
    Rgba8 backgroundBottom{16, 18, 22, 255};

    DisplaySettings();
    friend bool operator==(const DisplaySettings&, const DisplaySettings&) = default;
    /// Width of the smallest points, px.
    double leastPixels() const noexcept { return sizing == PointSizing::Pixels ? pointSize : 1.0; }
    /// How far away eye-dome lighting looks for neighbors, px: so far that they are not of the same point.
    int eyeDomeReach() const noexcept { return std::clamp(int(std::lround(leastPixels())), 1, 64); }
};

}  // namespace punctum::render
