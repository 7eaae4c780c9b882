// SPDX-License-Identifier: MIT
// ProgressiveRenderer: from what is visible to the picture.
#include "render/progressive/Entry.h"

#include <algorithm>

namespace punctum::render
{

void ProgressiveRenderer::addColors(const ResolveSettings& settings, double deadline)
{
    ResolveSettings colors = settings.ofPoints();
    if (m_colors != colors) {
        m_backend->clearColors();
        for (const auto& entry : m_entries) entry->colored = 0;
        m_colors = std::move(colors);
    }
    for (std::size_t k = 0; k < m_entries.size(); ++k) {
        Entry& entry = *m_entries[k];
        const Slot slots = entry.store->slotCount();
        while (entry.colored < slots) {
            const double started = now();
            const auto run = std::clamp<std::uint64_t>(m_colorCost.affordable(std::max(0.0, deadline - started)),
                                                       kLeastRun, slots - entry.colored + kLeastRun);
            const Slot count = Slot(std::min<std::uint64_t>(run, slots - entry.colored));
            m_backend->addColors(m_scene, settings, k, {entry.colored, entry.colored + count});
            m_backend->finish();
            m_colorCost.observe(count, now() - started);
            entry.colored += count;
            m_resolveNeeded = true;
            if (now() >= deadline) return;
        }
    }
}

void ProgressiveRenderer::resolveImage(ResolveSettings settings)
{
    double started = now();
    // Sums of other colors than those of now are not shown, whatever has changed.
    settings.means = m_display.averaged && m_colors == settings.ofPoints();
    m_onDevice = m_keepOnDevice && m_backend->keepsPicture();
    m_imageThere = !m_onDevice;
    if (m_imageThere)
        m_backend->resolve(m_scene, settings, m_image);
    else
        m_backend->resolveOnDevice(m_scene, settings);
    if (!m_timedRuns.empty()) {
        countTimed();
        started = std::max(started, m_fillDone);  // the device was still drawing
    }
    if (settings.closeHoles && !partial()) {  // it has drawn all: the picture is finished, and nothing is guessed
        settings.closeHoles = false;
        return resolveImage(settings);
    }
    if (!m_imageThere) m_backend->finish();
    m_resolveNeeded = false;
    const double seconds = now() - started;
    m_resolveSeconds = m_resolveSeconds == 0 ? seconds : 0.7 * m_resolveSeconds + 0.3 * seconds;
    m_passes.resolve = seconds;
}

const Image& ProgressiveRenderer::image()
{
    if (!std::exchange(m_imageThere, true)) m_backend->readPicture(m_image);
    return m_image;
}

bool ProgressiveRenderer::copyPicture(unsigned texture)
{
    if (!m_onDevice || m_targetChanged) return false;
    m_backend->copyPicture(texture);
    m_backend->finish();
    return true;
}

}  // namespace punctum::render
