// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/FrameScene.h"
#include "render/scene/Image.h"
#include "render/scene/ResolveSettings.h"

#include <cstddef>

namespace punctum::render
{

/// Makes a picture of the visibility buffer: ids become colors by each store's words, which are brought to the
/// device as they change. RasterBackend tells of threads and errors.
class Shading
{
public:
    virtual ~Shading() = default;

    /// Forgets what addColors() added, as VisibilityBuffer::clear(), setTarget() and PointDrawing::reproject() do.
    virtual void clearColors() = 0;
    /// Adds the colors of a run of slots to the samples whose nearest point is at most 1 % nearer. Once all points
    /// have been drawn and then added, resolve() shows the means: high-quality shading (2022 paper, section 3.6).
    virtual void addColors(const FrameScene& scene, const ResolveSettings& settings, std::size_t layer,
                           SlotRange slots) = 0;

    /// Makes the picture: colors from each layer's store words, samples lit and averaged, holes closed.
    /// scene.layers as drawn.
    virtual void resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out) = 0;
    /// Whether there is a device that the picture can stay on; only then the three below do something.
    virtual bool keepsPicture() const noexcept { return false; }
    /// resolve() without bringing the picture over. Waits for nothing.
    virtual void resolveOnDevice(const FrameScene&, const ResolveSettings&) {}
    /// Brings the picture over that resolve() or resolveOnDevice() made last.
    virtual void readPicture(Image&) {}
    /// Copies it to a texture (OpenGL's name) of its size, RGBA8, row 0 at the top of the picture.
    virtual void copyPicture(unsigned /*texture*/) {}
    /// Waits until everything asked for is done.
    virtual void finish() = 0;
};

}  // namespace punctum::render
