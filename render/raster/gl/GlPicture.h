// SPDX-License-Identifier: MIT
#pragma once

#include "render/gl/GlObjects.h"
#include "render/raster/gl/GlVisibility.h"
#include "render/scene/Image.h"
#include "render/scene/ResolveSettings.h"

#include <array>
#include <vector>

namespace punctum::render
{

/// The picture on the device, and what is done to it as a whole: eye-dome lighting (EyeDome.h) and closing holes
/// (HoleFill.h), by the same steps as on the processor. Nothing comes back but what read() and depths() ask for.
///
/// Owned by the backend; the thread of its context. Changes bindings of the context: callers hold a GlStateGuard.
/// Members throw Error.
class GlPicture
{
public:
    /// `traffic` outlives it and counts what comes back.
    explicit GlPicture(GlTraffic& traffic) : m_traffic(traffic) {}
    /// The size is another one from now on.
    void reset();

    /// The picture, R32UI: colors packed as Rgba8, row 0 at the top. Made where there is none.
    GlId picture(const GlVisibility& visibility);
    /// RGBA32UI, for sums of colors between runs of resolve.comp.
    GlId sums(const GlVisibility& visibility);
    /// Finds out what shade.glsl needs, and binds it for programs that have it: texture units 3 and 4.
    void prepareLight(GlVisibility& visibility, const EyeDomeSettings& settings);
    /// In the picture, by what the visibility buffer has.
    void closeHoles(GlVisibility& visibility);
    void read(Image& out);
    /// To a texture of the picture's size, RGBA8.
    void copyTo(GlId texture, const TargetSize& size);
    /// As VisibilityBuffer::depths().
    void depths(GlVisibility& visibility, std::vector<float>& out);
    /// As VisibilityBuffer::nearestIds().
    void nearestIds(GlVisibility& visibility, std::vector<PointId>& out);

private:
    GlTexture texture(unsigned format, int width, int height, int layers = 0) const;
    /// Depths of pixels, into m_depths.
    void makeDepths(GlVisibility& visibility);

    GlTraffic& m_traffic;
    GlTexture m_picture, m_other;  ///< the picture, and room for a pass that makes it anew
    GlTexture m_sums;
    GlTexture m_levels, m_extent;              ///< of eye-dome lighting; empty until it is on
    GlTexture m_depths, m_otherDepths, m_ids;  ///< of pixels; empty until they are needed
    std::array<GlProgram, kSampleCounts.size()> m_levelPrograms, m_nearest,
        m_nearestIds;  ///< made when first needed
    GlProgram m_extentProgram, m_holes, m_show;
};

}  // namespace punctum::render
