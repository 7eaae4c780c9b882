// SPDX-License-Identifier: MIT
#pragma once

#include "core/ground/BareSurface.h"
#include "core/ground/LowestPoints.h"

namespace punctum
{

/// The bare surface of a whole survey, in the squares of its lowest points, found window by window, which overlap:
/// the grids of the work take some hundred megabytes whatever the survey's size, the surface some 9 bytes a cell.
class GroundSurface
{
public:
    /// Keeps `lowest`, which must outlive it. Throws Cancelled.
    GroundSurface(const LowestPoints& lowest, const BareSurfaceSettings& settings, Progress& progress);

    /// Asks of places in one square after the other: each thread has one of its own.
    class Asker
    {
    public:
        explicit Asker(const GroundSurface& surface) : m_surface(&surface) {}
        /// Whether a point is ground.
        bool isGround(PointIndex point);

    private:
        const GroundSurface* m_surface;
        LowestPoints::Square m_square{INT64_MAX, INT64_MAX};
        const float* m_values = nullptr;
    };

private:
    /// Cells of a square with one more on each side, so that heights between cells need no other square.
    static constexpr int kWide = LowestPoints::kSide + 2;
    static constexpr std::size_t kValues = std::size_t(kWide) * std::size_t(kWide);

    void solve(std::int64_t x, std::int64_t y, std::int64_t side, const BareSurfaceSettings& settings,
               const Progress& progress);

    const LowestPoints* m_lowest;
    std::vector<float> m_values;  ///< of each square heights, then tolerances
};

}  // namespace punctum
