// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Surface.h"
#include "render/store/PointStore.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace punctum::render
{

/// One cloud of a view, and how far drawing it has come. For the parts of ProgressiveRenderer alone.
struct ViewCloud {
    std::shared_ptr<PointStore> store;
    bool loading = true;
    bool arranged = false;                      ///< as the picture's ids have it
    Slot cursor = 0;                            ///< next slot to draw; goes round
    Slot drawn = 0;                             ///< slots drawn in this pass, which shows the present view
    PointIndex filledAtStart = 0;               ///< points the store had when the pass began
    Slot colored = 0;                           ///< slots whose colors were added, see Shading::addColors()
    PointIndex filledAtRange = 0;               ///< points the store had when the range was last computed
    std::pair<double, double> range{0.0, 1.0};  ///< of the attribute it shows
    double spacing = 0;                         ///< pointSpacing() of ...
    glm::dvec3 spacingStretch{0};               ///< ... this view and ...
    PointIndex filledAtSpacing = 0;             ///< ... so many points

    std::shared_ptr<const SurfaceView> surface;  ///< of its ground; null: none is known

    /// What a slot costs on average, next to one in sight: others cost little, but not nothing.
    double weight = 1.0;

    /// Of stretches in sight a part is drawn (Detail::OfScreen), as the cloud lies beyond memory.
    bool partly = false;
    std::size_t arrivals = 0;   ///< PointStore::arrivals() that were looked at
    PointIndex newInSight = 0;  ///< where drawn partly: points in sight that came since the pass began
    double newestInSight = 0;   ///< when the last of them were seen to have come, by now()
    bool grownInSight = false;  ///< they are worth drawing again

    /// Another pass begins.
    void begin() noexcept
    {
        drawn = 0;
        filledAtStart = store->filled();
        newInSight = 0;
        grownInSight = false;
    }
    bool passDone() const noexcept { return drawn >= store->slotCount() || filledAtStart == 0; }
    /// Of its slots, drawn in this pass.
    double share() const noexcept { return double(drawn) / double(store->slotCount()); }
    /// It was drawn, and has got so many more points since that it is worth drawing again. Beyond memory that takes
    /// the disk, so that there are some dozen times, and some more of what is in sight.
    bool grown() const noexcept
    {
        const PointIndex all = store->cloud().size(), now = store->filled();
        const PointIndex some = partly ? std::min(all / 64, filledAtStart / 4) : 0;
        return passDone() && now != filledAtStart &&
               (now >= std::min(all, filledAtStart + some) || (partly && grownInSight));
    }
    bool complete() const noexcept { return passDone() && !grown(); }
};

/// In the order of the layers of the scene.
using ViewClouds = std::vector<std::unique_ptr<ViewCloud>>;

}  // namespace punctum::render
