// SPDX-License-Identifier: MIT
#include "render/surface/SurfaceContours.h"

#include "core/measure/Spacing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace punctum::render
{

namespace
{

/// Contours of a surface of one height range, about: as many as maps have of a hilly sheet.
constexpr double kWantedContours = 20;
/// Lines this far apart are drawn in full, and those so close not at all; px.
constexpr float kFullSpacing = 6.0f, kNoSpacing = 3.0f;
/// Of an index contour: its width in those of the others, and how dark both are.
constexpr float kIndexWidth = 1.6f;
constexpr float kIndexInk = 215, kPlainInk = 140;
/// Levels are floats: what differs by less is level.
constexpr float kRounding = 2e-6f;

/// Of levels that change by `slope` a px, lines `every` so many levels: 1 where they have room, 0 where they have
/// not.
float roomFor(float every, float slope) noexcept
{
    return std::clamp((every / slope - kNoSpacing) / (kFullSpacing - kNoSpacing), 0.0f, 1.0f);
}

/// Levels of some rows and columns, each the mean of those about it; NaN outside of the picture and where there is
/// no surface.
class MeanLevels
{
public:
    static constexpr int kRadius = kContourReach - 1;

    MeanLevels(const LevelPicture& picture, const PixelBlock& block)
        : m_picture(picture),
          m_block(block),
          m_columns(block.lastColumn - block.firstColumn),
          m_counts(std::size_t(m_columns)),
          m_alongRows(std::size_t(m_columns) * std::size_t(block.lastRow - block.firstRow + 2 * kRadius), NAN),
          m_means(std::size_t(m_columns) * std::size_t(block.lastRow - block.firstRow))
    {
        for (int y = block.firstRow - kRadius; y < block.lastRow + kRadius; ++y)
            if (y >= 0 && y < picture.height) averageRow(y);
        for (int y = block.firstRow; y < block.lastRow; ++y) averageColumns(y);
    }
    /// From the block's first column on.
    const float* row(int y) const noexcept
    {
        return m_means.data() + std::size_t(y - m_block.firstRow) * std::size_t(m_columns);
    }

private:
    float* rowOf(int y) noexcept
    {
        return m_alongRows.data() + std::size_t(y - m_block.firstRow + kRadius) * std::size_t(m_columns);
    }
    /// Adds pairs of levels that lie on both sides, so that the mean of even ground is its middle, beside an edge,
    /// too.
    static void addPairs(const float* before, const float* after, float* sums, float* counts, int columns) noexcept
    {
        for (int x = 0; x < columns; ++x) {
            const float pair = before[x] + after[x];
            const bool both = pair == pair;
            sums[x] += both ? pair : 0.0f;
            counts[x] += both ? 2.0f : 0.0f;
        }
    }
    void divide(float* sums) const noexcept
    {
        for (int x = 0; x < m_columns; ++x) sums[x] /= m_counts[std::size_t(x)];
    }
    void averageRow(int y)
    {
        const float* const levels = m_picture.levels.data() + std::size_t(y) * std::size_t(m_picture.width);
        float* const sums = rowOf(y);
        const auto range = [&](int beside) {
            return std::pair(std::max(m_block.firstColumn, beside),
                             std::min(m_block.lastColumn, m_picture.width - beside));
        };
        const auto [inside, end] = range(0);
        std::copy(levels + inside, levels + end, sums + (inside - m_block.firstColumn));
        std::fill(m_counts.begin(), m_counts.end(), 1.0f);
        for (int k = 1; k <= kRadius; ++k) {
            const auto [first, last] = range(k);
            const int at = first - m_block.firstColumn;
            addPairs(levels + first - k, levels + first + k, sums + at, m_counts.data() + at, last - first);
        }
        divide(sums);
    }
    void averageColumns(int y)
    {
        float* const sums = m_means.data() + std::size_t(y - m_block.firstRow) * std::size_t(m_columns);
        std::copy_n(rowOf(y), m_columns, sums);
        std::fill(m_counts.begin(), m_counts.end(), 1.0f);
        for (int k = 1; k <= kRadius; ++k) addPairs(rowOf(y - k), rowOf(y + k), sums, m_counts.data(), m_columns);
        divide(sums);
    }

    const LevelPicture& m_picture;
    PixelBlock m_block;
    int m_columns;
    std::vector<float> m_counts, m_alongRows, m_means;
};

/// The nearest whole number, of numbers that the sum tells apart: much quicker than std::round().
float nearestWhole(float level) noexcept
{
    constexpr float kWhole = 12582912.0f;  // 1.5 * 2^23: floats are whole numbers there
    return (level + kWhole) - kWhole;
}

/// By a level and those of the pixels to the left, to the right, above and below.
std::uint8_t inkOf(float level, float left, float right, float above, float below, float lineWidth) noexcept
{
    if (std::isnan(level)) return 0;
    // per px, between those neighbors that there are
    const auto slopeAlong = [&](float before, float after) {
        if (!std::isnan(before + after)) return (after - before) / 2;
        return !std::isnan(after) ? after - level : !std::isnan(before) ? level - before : 0.0f;
    };
    const float dx = slopeAlong(left, right), dy = slopeAlong(above, below);
    const float nearest = nearestWhole(level), away = std::abs(level - nearest);
    const float square = dx * dx + dy * dy, reach = lineWidth / 2 * kIndexWidth + 0.5f;
    if (!(away * away < reach * reach * square)) return 0;  // most pixels; NaN, too
    const float slope = std::sqrt(square);
    if (!(slope > kRounding * (1 + std::abs(level)))) return 0;
    const bool index = std::fmod(nearest, float(kIndexContour)) == 0;
    const float half = lineWidth / 2 * (index ? kIndexWidth : 1.0f);
    const float covered = std::clamp(half + 0.5f - away / slope, 0.0f, 1.0f);
    const float plain = kPlainInk * roomFor(1, slope);
    return std::uint8_t(covered * (index ? std::max(plain, kIndexInk * roomFor(kIndexContour, slope)) : plain) +
                        0.5f);
}

}  // namespace

double suitableInterval(double range) noexcept
{
    return range > 0 && std::isfinite(range) ? roundLength(range / kWantedContours) : 0;
}

void drawContours(const LevelPicture& picture, const PixelBlock& block, double lineWidth,
                  std::span<std::uint8_t> ink)
{
    const PixelBlock about{block.firstColumn - 1, block.lastColumn + 1, block.firstRow - 1, block.lastRow + 1};
    const MeanLevels levels(picture, about);
    for (int y = block.firstRow; y < block.lastRow; ++y) {
        const float *const above = levels.row(y - 1) + 1, *const row = levels.row(y) + 1,
                           *const below = levels.row(y + 1) + 1;
        std::uint8_t* const pixels =
            ink.data() + std::size_t(y) * std::size_t(picture.width) + std::size_t(block.firstColumn);
        for (int x = 0; x < block.lastColumn - block.firstColumn; ++x)
            pixels[x] = inkOf(row[x], row[x - 1], row[x + 1], above[x], below[x], float(lineWidth));
    }
}

}  // namespace punctum::render
