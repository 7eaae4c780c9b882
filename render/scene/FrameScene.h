// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/LayerClip.h"
#include "render/scene/LayerProjection.h"
#include "render/scene/PointIds.h"
#include "render/scene/VisibleStretches.h"
#include "render/store/PointStore.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace punctum::render
{

/// One cloud of the view. The store is borrowed and must outlive its use by the backend.
struct Layer {
    const PointStore* store = nullptr;
    PointId firstId = 0;
    LayerProjection projection;
    LayerClip clip{};
    /// Runs of slots are drawn where it says that something is in sight; null: everywhere.
    std::shared_ptr<const VisibleStretches> visible{};
};

/// What a frame draws: all layers as one camera sees them, and which classes are shown. Points that a store hides
/// are not drawn.
struct FrameScene {
    std::vector<Layer> layers;
    PointIds ids;  ///< which layer's slot each id stands for
    std::array<bool, 256> classVisible{};
    bool allClassesVisible = true;
    /// One more layer; it gets ids. Throws Error when there are not so many.
    void add(Layer layer)
    {
        layer.firstId = ids.take(layer.store->slotCount());
        layers.push_back(std::move(layer));
    }
    void clear() noexcept
    {
        layers.clear();
        ids.clear();
    }
    /// Whether points have to be asked for their class or whether they are hidden.
    bool filters() const noexcept
    {
        return !allClassesVisible ||
               std::any_of(layers.begin(), layers.end(), [](const Layer& l) { return l.store->hidesAny(); });
    }
};

}  // namespace punctum::render
