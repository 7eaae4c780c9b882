// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/FrameCostModel.h"
#include "render/progressive/ViewCloud.h"
#include "render/raster/Shading.h"

#include <utility>

namespace punctum::render
{

/// The picture of a view: when it is to be made, where it is, what making it costs, and the colors that were added
/// up for it.
///
/// Owned by ProgressiveRenderer; its thread. Errors: Error from the backend.
class FramePicture
{
public:
    /// It does not show what it should from now on.
    void outdate() noexcept { m_outdated = true; }
    bool outdated() const noexcept { return m_outdated; }
    /// Another backend makes the pictures.
    void forgetBackend() noexcept;
    /// What was added is not shown any more: words, or points, have become others.
    void forgetColors() { m_colors = {}; }

    /// Once all points are drawn: goes on adding colors until then, from the start when they have become others.
    void addColors(ViewClouds& clouds, const FrameScene& scene, const ResolveSettings& settings, Shading& shading,
                   double deadline);
    /// Makes the picture, or asks the device for it, on which it stays where keepOnDevice(). `averaged`: of added
    /// colors, where they are those of now.
    void make(const FrameScene& scene, ResolveSettings settings, bool averaged, Shading& shading);
    /// The same into memory, wherever the next one goes; something is to be put together with it.
    Image& makeHere(const FrameScene& scene, ResolveSettings settings, bool averaged, Shading& shading);
    /// Waits for it, and learns what it took since `began`; returns that.
    double finish(Shading& shading, double began);
    /// What making it costs, s.
    double seconds() const noexcept { return m_seconds; }

    void keepOnDevice(bool keep) noexcept { m_keepOnDevice = keep; }
    /// Whether the last picture stayed on the device.
    bool onDevice() const noexcept { return m_onDevice; }
    bool made() const noexcept { return m_onDevice || m_image.width > 0; }
    /// Brings it over where it is on the device.
    const Image& image(Shading& shading);

private:
    Image m_image;
    bool m_outdated = true;
    bool m_imageThere = true;  ///< else it is on the device alone
    bool m_onDevice = false;
    bool m_keepOnDevice = false;
    ResolveSettings m_colors;    ///< that colors were added with
    FrameCostModel m_colorCost;  ///< of addColors()
    double m_seconds = 0;
};

}  // namespace punctum::render
