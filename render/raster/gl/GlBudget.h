// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/PointDrawing.h"
#include "render/raster/gl/GlVisibility.h"

#include <array>
#include <span>

namespace punctum::render
{

/// Lets the device find out how many points of a frame it has time for, without the processor waiting for it: its
/// clock is written to a buffer, a shader makes draw commands of it, and points are drawn by these (Schuetz et al.
/// 2019, section 3.4.1). Needs GlInfo::timesToBuffers.
///
/// Owned by the backend; the thread of its context. Changes bindings: callers hold a GlStateGuard. Throws Error.
class GlBudget
{
public:
    /// `traffic` outlives it and counts what goes to and fro.
    explicit GlBudget(GlTraffic& traffic) : m_traffic(traffic) {}
    enum class Moment { Start, FirstBegins, FirstDone, Done };
    /// Has the device note the time when everything asked for so far is done.
    void mark(Moment moment);

    /// Slots of one chunk that may be drawn.
    struct Piece {
        Slot first = 0;   ///< in the chunk
        Slot count = 0;   ///< at most so many are drawn
        Slot offset = 0;  ///< in the run that it is a part of
        Slot run = 0;     ///< slots of that run
        Slot step = 1;    ///< the run may end at multiples of it
    };
    /// Commands for these pieces, of one run after the other and rising, the first of each at offset 0, which the
    /// device cuts off where time ends. `firstSlots`: drawn between FirstBegins and FirstDone. `seconds`: from
    /// Start. Valid until the next call.
    const GlVisibility::Band& decide(std::span<const Piece> pieces, Slot firstSlots, std::uint32_t groupPoints,
                                     double seconds);
    /// Waits for Done.
    PointDrawing::Timed result() const;
    /// Where the clock is written: four times as 64 bits of nanoseconds, in the order of Moment.
    GlBuffer& clock();

private:
    GlTraffic& m_traffic;
    std::array<GlQuery, 4> m_queries;
    GlBuffer m_clock;
    GlVisibility::Band m_decided;
    GlProgram m_program;
    Slot m_firstSlots = 0;
};

}  // namespace punctum::render
