// SPDX-License-Identifier: MIT
#include "render/progressive/FrameCostModel.h"

#include <algorithm>

namespace punctum::render
{

namespace
{

/// Weight of the newest observation: follows a change of view within a few runs, smooths single hiccups.
constexpr double kNewest = 0.4;

}  // namespace

void FrameCostModel::observe(std::uint64_t points, double seconds) noexcept
{
    if (points == 0 || seconds <= 0) return;
    const double now = seconds / double(points);
    m_secondsPerPoint = known() ? m_secondsPerPoint + kNewest * (now - m_secondsPerPoint) : now;
}

std::uint64_t FrameCostModel::affordable(double seconds) const noexcept
{
    if (!known()) return kFirstRun;
    constexpr double kMost = 1e12;
    return std::uint64_t(std::clamp(seconds / m_secondsPerPoint, 1.0, kMost));
}

double FrameCostModel::cost(std::uint64_t points) const noexcept
{
    return m_secondsPerPoint * double(points);
}

}  // namespace punctum::render
