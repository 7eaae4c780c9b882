// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>

namespace punctum::ui
{

/// The time of one frame, which the views of a window have together: what one of them does not need, or needs
/// beyond its share, is the others' gain or loss. Begins when it is made. One thread.
class FrameShares
{
public:
    using Clock = std::chrono::steady_clock;

    explicit FrameShares(double seconds) : m_end(Clock::now() + std::chrono::duration<double>(seconds)) {}

    /// For the next one of `waiting` views: an even share of what is left at `now`; 0: nothing is.
    double next(long waiting, Clock::time_point now = Clock::now()) const
    {
        return std::max(std::chrono::duration<double>(m_end - now).count(), 0.0) / double(waiting);
    }

private:
    std::chrono::time_point<Clock, std::chrono::duration<double>> m_end;
};

}  // namespace punctum::ui
