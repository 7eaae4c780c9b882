// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/FrameCostModel.h"
#include "render/progressive/FrameReport.h"
#include "render/progressive/ViewCloud.h"
#include "render/raster/PointDrawing.h"

#include <vector>

namespace punctum::render
{

/// Says which slots a frame draws: runs of all clouds of the view, the one that is furthest behind first, so that
/// all converge together, until the frame's time is spent. Learns what drawing costs; a device that keeps the time
/// decides itself how many of the runs it has time for.
///
/// Owned by ProgressiveRenderer; its thread. Errors: Error from the backend.
class FrameScheduler
{
public:
    /// Draws exactly so many slots a frame (rounded up to windows of the order), whatever the time; 0, as at first:
    /// as many as there is time for.
    void setPointsAFrame(PointIndex points) noexcept { m_pointsAFrame = points; }
    PointIndex pointsAFrame() const noexcept { return m_pointsAFrame; }
    /// Another backend draws from now on.
    void forgetCosts() noexcept { m_cost.reset(); }

    /// Nothing of the clouds is drawn with the present view.
    static void beginPass(ViewClouds& clouds) noexcept;
    /// Clouds that were all drawn, but have got more points meanwhile, begin once more: those that are drawn
    /// partly, or the others. Returns whether one did. Which stretches of the former are drawn has to be found anew
    /// then.
    static bool beginGrown(ViewClouds& clouds, bool partly) noexcept;
    /// Some cloud is not drawn wholly.
    static bool partial(const ViewClouds& clouds) noexcept;

    /// A frame begins, and its time.
    void beginFrame(PointDrawing& drawing);
    /// When that was, by now().
    double frameBegan() const noexcept { return m_frameBegan; }
    /// Whether the device decides how much it draws.
    bool deviceDecides(const PointDrawing& drawing) const noexcept
    {
        return m_pointsAFrame == 0 && drawing.keepsTime();
    }
    /// Draws further slots until then. Clouds that are not drawn partly, were all drawn, but have got more points
    /// meanwhile, begin once more; returns whether one did.
    bool fill(ViewClouds& clouds, const FrameScene& scene, PointDrawing& drawing, double deadline);
    /// Slots drawn in this frame, as far as it is known: see pending().
    PointIndex filled() const noexcept { return m_filled; }
    /// Whether countTimed() has to tell yet how many slots the device drew in this frame.
    bool pending() const noexcept { return !m_timedRuns.empty(); }
    /// Asks the device, and notes what it took; returns when it was done, by now(). To be asked when the picture is
    /// there.
    double countTimed(ViewClouds& clouds, PointDrawing& drawing, FrameReport::Passes& passes);

private:
    void offerRuns(ViewClouds& clouds, const FrameScene& scene, PointDrawing& drawing, double deadline);

    FrameCostModel m_cost;
    PointIndex m_pointsAFrame = 0;
    PointIndex m_filled = 0;
    std::vector<PointDrawing::Run> m_timedRuns;  ///< that the device draws as many of as it has time for
    double m_frameBegan = 0;
};

}  // namespace punctum::render
