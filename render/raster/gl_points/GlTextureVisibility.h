// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/gl/GlVisibility.h"

namespace punctum::render
{

/// The visibility buffer as a framebuffer: point id (R32UI) and reversed depth (D32F, points.vert.glsl) per sample,
/// row 0 at the top of the picture. Sums of colors are exact up to 65,793 points in one sample.
class GlTextureVisibility final : public GlVisibility
{
public:
    /// `bandSamples`: the most samples whose ids go into one list.
    GlTextureVisibility(std::size_t bandSamples, GlTraffic& traffic) : GlVisibility(bandSamples, traffic) {}

    void bindForReading(const Band& band) override;
    /// For drawing into.
    void bindFramebuffer() const;
    /// For adding colors, while shaders read ids and depths.
    void bindSums() const;

protected:
    void makeStorage(const GlInfo& info) override;
    std::string accessors() const override;
    void emptyCells() override;
    void emptySums() override;

private:
    GlTexture storage(unsigned format) const;
    unsigned target() const noexcept;

    GlTexture m_ids, m_depths;
    GlTexture m_sums;  ///< red, green, blue and the number of points, as floats; none until colors are added
    GlFramebuffer m_framebuffer, m_sumsFramebuffer;
};

}  // namespace punctum::render
