// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/ViewCloud.h"
#include "render/raster/VisibilityBuffer.h"
#include "render/scene/FrameScene.h"

#include <utility>
#include <vector>

namespace punctum::render
{

/// Brings the words of a view's clouds up to date after another attribute, an edit, a selection: those of visible
/// points first, so that the next picture shows them, the rest in slices that keep the frame rate.
///
/// Owned by ProgressiveRenderer; its thread. Takes each cloud's mutex() shared while it reads columns. Errors:
/// Error from the backend.
class WordStream
{
public:
    /// Whether words of some cloud are not those of the present values.
    static bool anyStale(const ViewClouds& clouds) noexcept;
    /// Encodes colors anew whose depth was misjudged; returns whether there were any.
    static bool judgeColors(ViewClouds& clouds);

    /// Words of visible points may be out of date: points have come into sight, or values have changed.
    void outdate() noexcept { m_visibleOutdated = true; }
    bool outdated() const noexcept { return m_visibleOutdated; }
    /// Which points are hidden changes with the words that are to come: the view is drawn anew after them.
    void redrawAfter() noexcept { m_redrawAfter = true; }

    /// A frame begins, in which the rest streams if there is one; returns whether there is.
    bool begin(const ViewClouds& clouds) noexcept { return m_streaming = anyStale(clouds); }
    bool streaming() const noexcept { return m_streaming; }
    /// Whether end() has something to do once all is up to date.
    bool waiting() const noexcept { return m_streaming || m_redrawAfter; }
    /// All words are up to date; returns whether the view is to be drawn anew.
    bool end() noexcept
    {
        m_streaming = false;
        return std::exchange(m_redrawAfter, false);
    }

    /// Words of what the buffer shows; returns whether any had to be brought up to date.
    bool refreshVisible(ViewClouds& clouds, const FrameScene& scene, VisibilityBuffer& buffer);
    /// Others, until then; returns whether all words are up to date.
    static bool refreshRest(ViewClouds& clouds, double deadline);

private:
    std::vector<PointId> m_visible;  ///< kept, so that memory is not asked for each frame
    bool m_visibleOutdated = true;
    bool m_streaming = false;    ///< words were out of date in the last frame
    bool m_redrawAfter = false;  ///< classes changed while some are hidden
};

}  // namespace punctum::render
