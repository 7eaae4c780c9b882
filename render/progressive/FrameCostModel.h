// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum::render
{

/// What a frame may take while the view moves, unless the user wishes otherwise: sixty pictures a second.
inline constexpr double kFrameMilliseconds = 16.6;
inline constexpr double kFrameSeconds = kFrameMilliseconds * 1e-3;

/// Learns what drawing points costs, and says how many fit into the time that is left (Schuetz et al. 2019,
/// section 3.4.1). Pure arithmetic: no clock, no GL.
class FrameCostModel
{
public:
    /// Points a first run draws when nothing is known yet.
    static constexpr std::uint64_t kFirstRun = 100'000;
    /// A frame always draws at least so many, whatever its time: it must come on.
    static constexpr std::uint64_t kLeastRun = 65'536;

    void observe(std::uint64_t points, double seconds) noexcept;
    /// Points that can be drawn in this time; at least 1.
    std::uint64_t affordable(double seconds) const noexcept;
    /// Estimated seconds for that many points; 0 when nothing is known.
    double cost(std::uint64_t points) const noexcept;
    bool known() const noexcept { return m_secondsPerPoint > 0; }
    void reset() noexcept { m_secondsPerPoint = 0; }

private:
    double m_secondsPerPoint = 0;
};

}  // namespace punctum::render
