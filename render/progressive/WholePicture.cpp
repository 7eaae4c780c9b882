// SPDX-License-Identifier: MIT
#include "render/progressive/WholePicture.h"

#include "render/resolve/EyeDome.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace punctum::render
{

namespace
{

constexpr std::int64_t kMostSamples = std::int64_t(1) << 26;  ///< of a picture drawn whole: 512 MiB
constexpr int kTile = 2048;                                   ///< px

}  // namespace

WholePicture::WholePicture(ProgressiveRenderer& renderer, int width, int height, bool bruteForce)
    : m_renderer(&renderer), m_width(width), m_height(height), m_bruteForce(bruteForce), m_shown(renderer.display())
{
    if (std::int64_t(width) * height * m_shown.samples <= kMostSamples) return;
    m_extentWanted = m_shown.eyeDome > 0;
    m_margin = m_extentWanted ? 2 * m_shown.eyeDomeReach() : 0;
    m_columns = (width + side() - 1) / side();
    m_rows = (height + side() - 1) / side();
    m_image.resize(width, height);
}

int WholePicture::side() const noexcept
{
    return kTile - 2 * m_margin;
}

double WholePicture::share() const noexcept
{
    return m_extentWanted ? 0.0 : (m_tile + m_partShare) / (m_columns * m_rows);
}

FrameReport WholePicture::drawPart(double seconds)
{
    const FrameReport report = m_bruteForce ? m_renderer->renderBruteForce() : m_renderer->renderFrame(seconds);
    m_partShare = std::max(m_partShare, report.share);
    return report;
}

bool WholePicture::draw(double seconds)
{
    if (m_tile == m_columns * m_rows) return true;
    if (!std::exchange(m_begun, true)) {
        m_partShare = 0;
        m_extentWanted ? beginExtent() : beginTile();
    }
    if (!drawPart(seconds).converged && !m_bruteForce) return false;
    m_begun = false;
    if (std::exchange(m_extentWanted, false)) {
        keepExtent();
        return false;
    }
    keepTile();
    if (++m_tile < m_columns * m_rows) return false;
    if (tiled()) m_renderer->setPart(std::nullopt);
    return true;
}

void WholePicture::beginExtent()
{
    const double scale = double(kTile) / std::max(m_width, m_height);
    DisplaySettings small = m_shown;
    small.pointSize = std::max(1.0, m_shown.pointSize * scale);
    small.samples = 1;
    m_renderer->setPart(std::nullopt);
    m_renderer->setDisplay(small);
    m_renderer->setSize(std::max(1, int(m_width * scale)), std::max(1, int(m_height * scale)));
}

void WholePicture::keepExtent()
{
    m_renderer->depths(m_depths);
    const bool perspective = !m_renderer->camera().orthographic;
    for (float& depth : m_depths) depth = std::isfinite(depth) ? eyeDomeLevel(depth, perspective) : kNoLevel;
    m_extent = eyeDomeExtent(m_depths);
    m_renderer->setDisplay(m_shown);
}

void WholePicture::beginTile()
{
    if (!tiled()) {
        m_renderer->setPart(std::nullopt);
        m_renderer->setSize(m_width, m_height);
        return;
    }
    m_renderer->setSize(kTile, kTile);
    const int x = m_tile % m_columns * side(), y = m_tile / m_columns * side();
    m_renderer->setPart(PicturePart{x - m_margin, y - m_margin, m_width, m_height}, m_extent);
}

void WholePicture::keepTile()
{
    const Image& drawn = m_renderer->image();
    if (!tiled()) {
        m_covered = m_renderer->coveredShare();
        m_image = drawn;
        return;
    }
    const int x = m_tile % m_columns * side(), y = m_tile / m_columns * side();
    const int w = std::min(side(), m_width - x), h = std::min(side(), m_height - y);
    std::size_t covered = 0;
    m_renderer->depths(m_depths);
    for (int row = 0; row < h; ++row) {
        const auto from = std::size_t(row + m_margin) * kTile + std::size_t(m_margin),
                   to = std::size_t(y + row) * std::size_t(m_width) + std::size_t(x);
        std::copy_n(drawn.pixels.begin() + std::ptrdiff_t(from), w, m_image.pixels.begin() + std::ptrdiff_t(to));
        const float* const depths = m_depths.data() + from;
        covered += std::size_t(std::count_if(depths, depths + w, [](float depth) { return std::isfinite(depth); }));
    }
    m_covered += double(covered) / (double(m_width) * double(m_height));
}

}  // namespace punctum::render
