// SPDX-License-Identifier: MIT
#pragma once

#include "core/sample/Scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace punctum::sample
{

/// One return of a laser pulse. Lengths in metres in the scene's frame.
struct Return {
    double x = 0, y = 0, z = 0;
    std::uint8_t code = 1;
    Color color;
    double reflectance = 0.3;  ///< of the surface times its share of the pulse
    double spread = 0;         ///< 0: a hard, flat target; 1: leaves
};

/// What comes back of one pulse, first to last.
struct Echo {
    static constexpr int kMost = 4;
    std::array<Return, kMost> returns;
    int count = 0;

    void add(const Return& r)
    {
        if (count < kMost) returns[std::size_t(count++)] = r;
    }
};

/// Sends a pulse that would reach flat ground at (x, y), leaning `slope` metres to the east for every metre down
/// (so that at height h above the ground it is h * slope further west).
Echo sendPulse(const Scene& scene, double x, double y, double slope, Random& random);

/// The plan of the flight: north-south lines side by side with overlapping swaths, cut into blocks that can be
/// flown in any order, each by its own thread.
struct FlightPlan {
    struct Line {
        double middle = 0;  ///< x under the aircraft
        double west = 0, east = 0;
    };
    struct Block {
        std::uint32_t line = 0;
        double start = 0, length = 0;  ///< metres flown since the line's start
        std::uint64_t points = 0;      ///< it has to bring home
        std::uint64_t first = 0;       ///< points of the blocks before it
    };
    double side = 0;
    double height = 0;  ///< above the ground
    double halfSwath = 0;
    double halfSpacing = 0;  ///< beyond it a neighboring line sees the same ground
    double pulseGap = 0;     ///< metres between pulses along and across, before it is fitted
    std::vector<Line> lines;
    std::vector<Block> blocks;

    /// y of a place so many metres along a line; lines are flown north and south by turns.
    double northing(const Block& block, double along) const { return block.line % 2 == 0 ? along : side - along; }
    double slope(const Line& line, double x) const { return (x - line.middle) / height; }
};

}  // namespace punctum::sample
