// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/FrameScene.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace punctum::render
{

/// Draws points into the visibility buffer: those that were visible, seen anew, and further runs of slots. What is
/// drawn when is the business of ProgressiveRenderer; RasterBackend tells of threads and errors.
///
/// The nearest point wins; at equal depth the smaller id does.
class PointDrawing
{
public:
    virtual ~PointDrawing() = default;

    /// Keeps what is visible, seen anew: clears, and draws the points that were in the buffer.
    virtual void reproject(const FrameScene& scene) = 0;
    /// Clears, and draws these points: reproject() where ids have other meanings than those in the buffer. Brings
    /// to a device all positions that changed.
    virtual void redraw(const FrameScene& scene, std::span<const PointId> ids) = 0;
    /// Draws a run of slots of one layer.
    virtual void draw(const FrameScene& scene, std::size_t layer, SlotRange slots) = 0;
    /// Whether draw() knows of stretches that are not drawn in all windows (Detail::OfScreen).
    virtual bool drawsPartly() const noexcept { return false; }
    /// Waits until everything asked for is done: makes clocks around draw() mean something.
    virtual void finish() = 0;

    /// Whether the device itself can find out how many slots it has time for: drawTimed().
    virtual bool keepsTime() const noexcept { return false; }
    /// What drawTimed() has time for counts from here.
    virtual void startClock() {}
    /// Slots of one layer; may end early at multiples of `step` from its first slot.
    struct Run {
        std::size_t layer = 0;
        SlotRange range;
        Slot step = 1;
    };
    /// Draws the first run whole, and of the others, one after the other, as many slots as the device will have
    /// done `seconds` after startClock(), going by what the first took (Schuetz et al. 2019, section 3.4.1). Waits
    /// for nothing: timed() tells afterwards. Where points have to be brought to the device first, that ends early.
    virtual void drawTimed(const FrameScene&, std::span<const Run>, double /*seconds*/) {}
    struct Timed {
        std::uint64_t drawn = 0;  ///< slots, of all runs
        double before = 0;        ///< seconds from startClock() to its beginning
        double seconds = 0;       ///< that took on the device ...
        double done = 0;          ///< ... and from startClock() to its end
    };
    /// What the last drawTimed() came to. Waits for it: to be asked when the picture is there.
    virtual Timed timed() { return {}; }
};

}  // namespace punctum::render
