// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/LayerClip.h"
#include "render/scene/LayerProjection.h"
#include "render/scene/PointId.h"
#include "render/scene/VisibleStretches.h"
#include "render/store/PointStore.h"

#include <algorithm>
#include <array>
#include <memory>
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
    std::array<bool, 256> classVisible{};
    bool allClassesVisible = true;
    /// Whether points have to be asked for their class or whether they are hidden.
    bool filters() const noexcept
    {
        return !allClassesVisible ||
               std::any_of(layers.begin(), layers.end(), [](const Layer& l) { return l.store->hidesAny(); });
    }
};

}  // namespace punctum::render
