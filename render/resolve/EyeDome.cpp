// SPDX-License-Identifier: MIT
#include "render/resolve/EyeDome.h"

#include "render/scene/PointId.h"
#include "render/scene/TargetSize.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace punctum::render
{

float eyeDomeExtent(std::span<const float> levels)
{
    std::vector<float> sample;
    const std::size_t step = std::max<std::size_t>(1, levels.size() / kExtentValues);
    for (std::size_t k = 0; k < levels.size(); k += step)
        if (levels[k] < kNoLevel) sample.push_back(levels[k]);
    if (sample.size() < 2) return 0;
    const auto at = [&](float share) {
        const auto it = sample.begin() + std::ptrdiff_t(share * float(sample.size() - 1));
        std::nth_element(sample.begin(), it, sample.end());
        return *it;
    };
    const float low = at(kExtentLow);
    return at(kExtentHigh) - low;
}

EyeDomeShades::EyeDomeShades(std::span<const std::uint64_t> cells, const TargetSize& size,
                             const EyeDomeSettings& settings)
    : m_columns(size.width * size.samples), m_height(size.height), m_samples(size.samples), m_reach(settings.reach)
{
    if (!settings.on() || cells.empty()) return;
    m_levels.resize(cells.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 1 << 14), [&](const auto& r) {
        for (std::size_t k = r.begin(); k != r.end(); ++k) {
            const float depth = std::bit_cast<float>(std::uint32_t(cells[k] >> 32));
            m_levels[k] = PointId(cells[k]) == kNoPoint ? kNoLevel : eyeDomeLevel(depth, settings.perspective);
        }
    });
    m_extent = settings.extent > 0 ? settings.extent : eyeDomeExtent(m_levels);
    if (m_extent > 0)
        m_scale = eyeDomeScale(settings.strength, m_extent);
    else
        m_levels.clear();
}

void EyeDomeShades::shadesOf(int row, std::vector<float>& out) const
{
    const auto columns = std::size_t(m_columns);
    const float extent = m_extent, scale = m_scale;  // not members: what is written might be they
    std::vector<float> behind(columns);
    const float* const own = m_levels.data() + std::size_t(row) * columns;
    for (const int reach : {m_reach, 2 * m_reach})
        for (const auto& [dx, dy] : kEyeDomeNeighbors) {
            const int y = row + dy * reach, move = dx * reach * m_samples;
            if (y < 0 || y >= m_height || std::abs(move) >= m_columns) continue;
            // Plain loops over the columns, which the compiler makes vectors of.
            const float* const other = m_levels.data() + std::size_t(y) * columns + move;
            const int first = std::max(0, -move), last = std::min(m_columns, m_columns - move);
            for (int k = first; k < last; ++k)
                behind[std::size_t(k)] += std::min(std::max(own[k] - other[k], 0.0f), extent);
        }
    out.resize(columns);
    for (std::size_t k = 0; k < columns; ++k)
        out[k] = kEyeDomeDarkest + (1 - kEyeDomeDarkest) * exp2Of(-behind[k] * scale);
}

}  // namespace punctum::render
