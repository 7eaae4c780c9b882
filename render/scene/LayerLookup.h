// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/FrameScene.h"

namespace punctum::render
{

/// Finds the layer of a point id. Remembers the last answer, since neighboring pixels mostly show the same cloud.
class LayerLookup
{
public:
    explicit LayerLookup(const FrameScene& scene) : m_scene(&scene) {}

    std::size_t layerOf(PointId id) noexcept
    {
        const auto& layers = m_scene->layers;
        if (id - layers[m_last].firstId < layers[m_last].store->slotCount()) return m_last;
        m_last = 0;
        while (m_last + 1 < layers.size() && layers[m_last + 1].firstId <= id) ++m_last;
        return m_last;
    }

private:
    const FrameScene* m_scene;
    std::size_t m_last = 0;
};

}  // namespace punctum::render
