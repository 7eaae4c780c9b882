// SPDX-License-Identifier: MIT
#include "core/ground/GridMorphology.h"

#include "core/task/Progress.h"

#include <tbb/enumerable_thread_specific.h>

#include <utility>

namespace punctum
{

namespace
{

struct LowerHeight {
    static constexpr float kOutside = std::numeric_limits<float>::infinity();
    static float of(float a, float b) noexcept { return b < a ? b : a; }
};
struct HigherHeight {
    static constexpr float kOutside = -std::numeric_limits<float>::infinity();
    static float of(float a, float b) noexcept { return b > a ? b : a; }
};

/// A piece of a grid with a rim, in which octagons are worked out while it is in the processor's cache. Steps write
/// where they read: the extreme of cells from (0, 0) on is kept at the first of them, so that the piece's corner
/// moves with each.
template <typename Extreme>
class OctagonPiece
{
public:
    /// Takes cells from (x, y) on; those outside of the grid count as nothing.
    void take(const HeightGrid& from, int x, int y, int width, int height)
    {
        m_width = width;
        m_height = height;
        m_z.resize(std::size_t(width) * std::size_t(height));
        const int first = std::clamp(-x, 0, width), last = std::clamp(from.width - x, first, width);
        for (int v = 0; v < height; ++v) {
            float* const out = row(v);
            if (y + v < 0 || y + v >= from.height) {
                std::fill_n(out, width, Extreme::kOutside);
                continue;
            }
            std::fill(out, out + first, Extreme::kOutside);
            std::copy_n(from.row(y + v) + (x + first), last - first, out + first);
            std::fill(out + last, out + width, Extreme::kOutside);
        }
    }

    /// The extreme of so many cells in a line: each step doubles what a cell stands for.
    void alongLine(int cells, int dx, int dy)
    {
        int have = 1;
        for (; 2 * have <= cells; have *= 2) shift(have * dx, have * dy);
        if (have < cells) shift((cells - have) * dx, (cells - have) * dy);
    }

    /// Gives each cell the extreme of itself and its four neighbors, into the grid from (x, y) on. The first one's
    /// place in the piece: (left, low).
    void crossInto(HeightGrid& to, int x, int y, int width, int height, int left, int low) const
    {
        for (int v = 0; v < height; ++v) {
            const float *const mid = row(low + v) + left, *const below = mid - m_width,
                               *const above = mid + m_width;
            float* const out = to.row(y + v) + x;
            for (int u = 0; u < width; ++u)
                out[u] = Extreme::of(Extreme::of(mid[u], Extreme::of(mid[u - 1], mid[u + 1])),
                                     Extreme::of(below[u], above[u]));
        }
    }

private:
    float* row(int y) { return m_z.data() + std::size_t(y) * std::size_t(m_width); }
    const float* row(int y) const { return m_z.data() + std::size_t(y) * std::size_t(m_width); }

    /// dy >= 0; dx < 0: what is kept moves to the right.
    void shift(int dx, int dy)
    {
        for (int y = 0; y + dy < m_height; ++y) {
            float* const out = row(y);
            const float* const in = row(y + dy) + dx;
            const int first = std::max(0, -dx), last = m_width - std::max(0, dx);
            for (int x = first; x < last; ++x) out[x] = Extreme::of(out[x], in[x]);
        }
    }

    int m_width = 0, m_height = 0;
    std::vector<float> m_z;
};

/// The extremes in octagons of `radius` cells (at least 1): a square, a diamond of two diagonals, and a cross that
/// fills in the cells between these.
template <typename Extreme>
void octagonInto(HeightGrid& to, const HeightGrid& from, int radius, const Progress& progress)
{
    constexpr int kTileWidth = 256, kTileHeight = 128;
    const int square = radius / 2, diamond = radius - square;
    tbb::enumerable_thread_specific<OctagonPiece<Extreme>> pieces;
    const int across = (from.width + kTileWidth - 1) / kTileWidth,
              up = (from.height + kTileHeight - 1) / kTileHeight;
    tbb::parallel_for(0, across * up, [&](int tile) {
        progress.check();
        OctagonPiece<Extreme>& piece = pieces.local();
        const int x = tile % across * kTileWidth, y = tile / across * kTileHeight;
        const int width = std::min(kTileWidth, from.width - x), height = std::min(kTileHeight, from.height - y);
        piece.take(from, x - radius, y - radius, width + 2 * radius, height + 2 * radius);
        piece.alongLine(2 * square + 1, 0, 1);
        piece.alongLine(2 * square + 1, 1, 0);
        piece.alongLine(diamond, 1, 1);
        piece.alongLine(diamond, -1, 1);
        // What belongs to a cell now lies `square` cells below and left of it, and diamond - 1 below that: the
        // diagonals go up from there.
        piece.crossInto(to, x, y, width, height, diamond, 1);
    });
}

/// Each cell gets the lowest of itself and its four or (`square`) eight neighbors.
void erodeInto(HeightGrid& to, const HeightGrid& from, bool square)
{
    const int w = from.width, h = from.height;
    forRows(w, h, [&](int first, int last) {
        std::vector<float> upright(std::size_t(w), 0.0f);
        for (int y = first; y < last; ++y) {
            const float* const mid = from.row(y);
            const float* const below = from.row(std::max(0, y - 1));
            const float* const above = from.row(std::min(h - 1, y + 1));
            float* const out = to.row(y);
            float* const column = upright.data();
            for (int x = 0; x < w; ++x) column[x] = LowerHeight::of(mid[x], LowerHeight::of(below[x], above[x]));
            const float* const side = square ? column : mid;
            for (int x = 1; x < w - 1; ++x)
                out[x] = LowerHeight::of(column[x], LowerHeight::of(side[x - 1], side[x + 1]));
            out[0] = w > 1 ? LowerHeight::of(column[0], side[1]) : column[0];
            if (w > 1) out[w - 1] = LowerHeight::of(column[w - 1], side[w - 2]);
        }
    });
}

}  // namespace

HeightGrid openedBy(const HeightGrid& grid, int radius, const Progress& progress)
{
    HeightGrid low = grid, result = grid;
    octagonInto<LowerHeight>(low, grid, radius, progress);
    octagonInto<HigherHeight>(result, low, radius, progress);
    return result;
}

HeightGrid closedBy(const HeightGrid& grid, int radius, const Progress& progress)
{
    HeightGrid high = grid, result = grid;
    octagonInto<HigherHeight>(high, grid, radius, progress);
    octagonInto<LowerHeight>(result, high, radius, progress);
    return result;
}

const HeightGrid& GrowingOpenings::next(const Progress& progress)
{
    progress.check();
    erodeInto(m_spare, m_low, m_radius % 2 == 1);
    std::swap(m_spare.z, m_low.z);
    ++m_radius;
    octagonInto<HigherHeight>(m_spare, m_low, m_radius, progress);
    return m_spare;
}

}  // namespace punctum
