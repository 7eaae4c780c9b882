// SPDX-License-Identifier: MIT
#include "render/progressive/FramePicture.h"

#include "render/progressive/Clock.h"

#include <algorithm>
#include <utility>

namespace punctum::render
{

void FramePicture::forgetBackend() noexcept
{
    m_imageThere = true;
    m_onDevice = false;
    m_colorCost.reset();
    m_seconds = 0;
}

void FramePicture::addColors(ViewClouds& clouds, const FrameScene& scene, const ResolveSettings& settings,
                             Shading& shading, double deadline)
{
    ResolveSettings colors = settings.ofPoints();
    if (m_colors != colors) {
        shading.clearColors();
        for (const auto& cloud : clouds) cloud->colored = 0;
        m_colors = std::move(colors);
    }
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        ViewCloud& cloud = *clouds[k];
        const Slot slots = cloud.store->slotCount();
        while (cloud.colored < slots) {
            const double began = now();
            const std::uint64_t left = slots - cloud.colored;
            const std::uint64_t run =
                std::max(m_colorCost.affordable(std::max(0.0, deadline - began)), FrameCostModel::kLeastRun);
            const Slot count = Slot(std::min(run, left));
            shading.addColors(scene, settings, k, {cloud.colored, cloud.colored + count});
            shading.finish();
            m_colorCost.observe(count, now() - began);
            cloud.colored += count;
            m_outdated = true;
            if (now() >= deadline) return;
        }
    }
}

void FramePicture::make(const FrameScene& scene, ResolveSettings settings, bool averaged, Shading& shading)
{
    // Sums of other colors than those of now are not shown, whatever has changed.
    settings.means = averaged && m_colors == settings.ofPoints();
    m_onDevice = m_keepOnDevice && shading.keepsPicture();
    m_imageThere = !m_onDevice;
    if (m_imageThere)
        shading.resolve(scene, settings, m_image);
    else
        shading.resolveOnDevice(scene, settings);
}

Image& FramePicture::makeHere(const FrameScene& scene, ResolveSettings settings, bool averaged, Shading& shading)
{
    const bool keep = std::exchange(m_keepOnDevice, false);
    make(scene, std::move(settings), averaged, shading);
    m_keepOnDevice = keep;
    return m_image;
}

double FramePicture::finish(Shading& shading, double began)
{
    if (!m_imageThere) shading.finish();
    m_outdated = false;
    const double seconds = now() - began;
    m_seconds = m_seconds == 0 ? seconds : 0.7 * m_seconds + 0.3 * seconds;
    return seconds;
}

const Image& FramePicture::image(Shading& shading)
{
    if (!std::exchange(m_imageThere, true)) shading.readPicture(m_image);
    return m_image;
}

}  // namespace punctum::render
