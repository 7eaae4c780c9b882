// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/gl/GlVisibility.h"

namespace punctum::render
{

/// The visibility buffer as a framebuffer: point id (R32UI) and reversed depth (D32F, points.vert.glsl) per sample,
/// row 0 at the top of the picture.
class GlTextureVisibility final : public GlVisibility
{
public:
    /// `bandSamples`: the most samples whose ids go into one list.
    explicit GlTextureVisibility(std::size_t bandSamples) : GlVisibility(bandSamples) {}

    void clear() override;
    void bindForReading(const Band& band) override;
    /// For drawing into.
    void bindFramebuffer() const;

protected:
    void makeStorage(const GlInfo& info) override;
    std::string accessors() const override;

private:
    GlTexture m_ids, m_depths;
    GlFramebuffer m_framebuffer;
};

}  // namespace punctum::render
