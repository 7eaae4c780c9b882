// SPDX-License-Identifier: MIT
#include "core/ground/LowestPoints.h"

#include "core/Error.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <unordered_set>

namespace punctum
{

namespace
{

constexpr std::size_t kSquareCells = std::size_t(LowestPoints::kSide) * std::size_t(LowestPoints::kSide);

/// Squares that any cloud may have, and those that it may have for each point: beyond, it is no surface.
constexpr std::size_t kSquaresAlways = 1 << 16;  // 64 million cells
constexpr std::size_t kPointsASquare = 8;

/// Farther than that a cell's number is no exact whole number.
constexpr double kFarthestCell = 1e15;

struct SquareHash {
    std::size_t operator()(const LowestPoints::Square& s) const noexcept
    {
        std::uint64_t h = std::uint64_t(s.x) * 0x9E3779B97F4A7C15u ^ std::uint64_t(s.y) * 0xC2B2AE3D27D4EB4Fu;
        h ^= h >> 29;
        h *= 0xBF58476D1CE4E5B9u;
        return std::size_t(h ^ (h >> 32));
    }
};

void lowerCell(std::int32_t& cell, std::int32_t z) noexcept
{
    const std::atomic_ref<std::int32_t> shared(cell);
    std::int32_t old = shared.load(std::memory_order_relaxed);
    while (z < old && !shared.compare_exchange_weak(old, z, std::memory_order_relaxed)) {
    }
}

}  // namespace

LowestPoints::LowestPoints(const PointCloud& cloud, const PointSet& used, const TrueLengths& lengths, double cell,
                           Progress& progress)
    : m_x(cloud.rawX()), m_y(cloud.rawY()), m_z(cloud.rawZ())
{
    const CoordinateScale& c = cloud.coordinates();
    for (int axis = 0; axis < 2; ++axis) {
        m_scale[std::size_t(axis)] = c.scale[axis] * lengths.stretch[axis] / cell;
        m_offset[std::size_t(axis)] = c.offset[axis] * lengths.stretch[axis] / cell;
        if (!(std::abs(m_scale[std::size_t(axis)]) * 0x1p31 + std::abs(m_offset[std::size_t(axis)]) <
              kFarthestCell))
            throw Error("The cells are too small for coordinates of this size; give larger ones.");
    }
    m_scale[2] = c.scale[2] * lengths.stretch[2];
    m_offset[2] = 0;

    using Squares = std::unordered_set<Square, SquareHash>;
    tbb::enumerable_thread_specific<Squares> found;
    std::atomic<std::size_t> count{0};
    const std::size_t most = kSquaresAlways + std::size_t(cloud.size()) / kPointsASquare;
    progress.begin("Looking for the ground's cells", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        Squares& mine = found.local();
        Square last{INT64_MAX, INT64_MAX};
        used.forEachInWords(firstWord, lastWord, [&](PointIndex i) {
            const Square square = squareOf(place(i));
            if (square == last) return;
            last = square;
            if (mine.size() <= most) mine.insert(square);
        });
    });
    for (const Squares& some : found) m_squares.insert(m_squares.end(), some.begin(), some.end());
    std::sort(m_squares.begin(), m_squares.end());
    m_squares.erase(std::unique(m_squares.begin(), m_squares.end()), m_squares.end());
    if (m_squares.size() > most)
        throw Error("The points lie too far apart for cells of this size; give larger ones.");

    m_table.assign(std::bit_ceil(2 * m_squares.size() + 1), 0);
    for (std::size_t k = 0; k < m_squares.size(); ++k) {
        std::size_t slot = SquareHash()(m_squares[k]) & (m_table.size() - 1);
        while (m_table[slot] != 0) slot = (slot + 1) & (m_table.size() - 1);
        m_table[slot] = std::uint32_t(k + 1);
    }

    m_lowest.assign(m_squares.size() * kSquareCells, INT32_MAX);
    progress.begin("Looking for the lowest points", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        Square last{INT64_MAX, INT64_MAX};
        std::int32_t* cells = nullptr;
        used.forEachInWords(firstWord, lastWord, [&](PointIndex i) {
            const Place at = place(i);
            const Square square = squareOf(at);
            if (!(square == last)) {
                last = square;
                cells = m_lowest.data() + find(square) * kSquareCells;
            }
            lowerCell(cells[std::size_t(at.y - square.y * kSide) * kSide + std::size_t(at.x - square.x * kSide)],
                      m_z[i]);
        });
    });
    // Heights are told from a round height below all of them: exact to a tenth of a millimeter as floats, and not
    // moved by how the file's integers are.
    std::int32_t least = INT32_MAX;
    for (const std::int32_t z : m_lowest) least = std::min(least, z);
    if (least != INT32_MAX) {
        const double z = c.offset.z * lengths.stretch.z;
        m_offset[2] = z - std::floor((double(least) * m_scale[2] + z) / 256) * 256;
    }
}

std::size_t LowestPoints::find(Square square) const noexcept
{
    std::size_t slot = SquareHash()(square) & (m_table.size() - 1);
    for (; m_table[slot] != 0; slot = (slot + 1) & (m_table.size() - 1))
        if (m_squares[m_table[slot] - 1] == square) return m_table[slot] - 1;
    return m_squares.size();
}

HeightGrid LowestPoints::window(std::int64_t x, std::int64_t y, int width, int height) const
{
    HeightGrid grid(width, height, HeightGrid::kNone);
    for (std::int64_t sy = squareOf(y); sy <= squareOf(y + height - 1); ++sy)
        for (std::int64_t sx = squareOf(x); sx <= squareOf(x + width - 1); ++sx) {
            const std::size_t k = find({sx, sy});
            if (k == m_squares.size()) continue;
            const std::int32_t* const cells = m_lowest.data() + k * kSquareCells;
            for (int v = 0; v < kSide; ++v)
                for (int u = 0; u < kSide; ++u) {
                    const std::int64_t gx = sx * kSide + u - x, gy = sy * kSide + v - y;
                    const std::int32_t z = cells[v * kSide + u];
                    if (z == INT32_MAX || gx < 0 || gy < 0 || gx >= width || gy >= height) continue;
                    grid.at(int(gx), int(gy)) = float(double(z) * m_scale[2] + m_offset[2]);
                }
        }
    return grid;
}

}  // namespace punctum
