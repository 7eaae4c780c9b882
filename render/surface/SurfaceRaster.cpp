// SPDX-License-Identifier: MIT
#include "render/surface/SurfaceRaster.h"

#include "render/resolve/Background.h"
#include "render/surface/TileEdges.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace punctum::render
{

namespace
{

/// Bands for each thread: enough that none waits long for the others, and few, since each band looks at all nodes
/// of the tiles that reach into it.
constexpr int kBandsAThread = 4;
constexpr int kLeastBandRows = 16;
/// Points so little behind the surface are shown: they are what it is made of, and grids cut corners.
constexpr double kSlackPx = 3.0;
/// So far beside a triangle pixels are its own: each tile rounds the heights of nodes on a common edge for itself.
constexpr double kEdgePx = 0.002;
/// Contours are of a dark brown, as on maps.
constexpr Rgba8 kInk{58, 38, 22, 255};

struct Projected {
    double x = 0, y = 0, depth = 0;
};

/// Of raw coordinates.
Projected project(const SurfaceLayer& layer, double x, double y, double z) noexcept
{
    const glm::dvec3 q = layer.frame.toLocal(glm::dvec3(x, y, z)) - glm::dvec3(layer.projection.reference);
    const LayerProjection& p = layer.projection;
    const auto row = [&](const glm::vec4& r) { return glm::dot(glm::dvec3(r), q) + double(r.w); };
    const double depth = row(p.rowD), w = p.perspective ? depth : 1.0;
    return {row(p.rowX) / w, row(p.rowY) / w, depth};
}

bool isCutOff(const SurfaceLayer& layer, double x, double y, double z) noexcept
{
    const LayerClip& clip = layer.clip;
    if (!clip.on && clip.planeCount == 0) return false;
    const glm::dvec3 local = layer.frame.toLocal(glm::dvec3(x, y, z));
    for (int a = 0; a < 3; ++a)
        if (local[a] < double(clip.low[a]) || local[a] > double(clip.high[a])) return true;
    const glm::dvec3 q = local - glm::dvec3(layer.projection.reference);
    for (std::size_t k = 0; k < clip.planeCount; ++k)
        if (glm::dot(glm::dvec3(clip.planes[k]), q) + double(clip.planes[k].w) < 0) return true;
    return false;
}

/// Muted greens, tans and near white, as maps have heights.
glm::vec3 tintOf(double share) noexcept
{
    static constexpr std::array<std::array<float, 3>, 5> kStops{{{0.48f, 0.62f, 0.52f},
                                                                 {0.66f, 0.74f, 0.56f},
                                                                 {0.85f, 0.80f, 0.60f},
                                                                 {0.80f, 0.66f, 0.52f},
                                                                 {0.95f, 0.93f, 0.91f}}};
    const double at = std::clamp(share, 0.0, 1.0) * double(kStops.size() - 1);
    const std::size_t k = std::min(std::size_t(at), kStops.size() - 2);
    const float part = float(at - double(k));
    glm::vec3 color;
    for (int c = 0; c < 3; ++c)
        color[c] = kStops[k][std::size_t(c)] * (1 - part) + kStops[k + 1][std::size_t(c)] * part;
    return color;
}

}  // namespace

void SurfaceRaster::Rectangle::include(const Rectangle& other) noexcept
{
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    firstColumn = std::min(firstColumn, other.firstColumn);
    lastColumn = std::max(lastColumn, other.lastColumn);
    firstRow = std::min(firstRow, other.firstRow);
    lastRow = std::max(lastRow, other.lastRow);
}

SurfaceRaster::Rectangle SurfaceRaster::Rectangle::cutTo(const Rectangle& other) const noexcept
{
    return {std::max(firstColumn, other.firstColumn), std::min(lastColumn, other.lastColumn),
            std::max(firstRow, other.firstRow), std::min(lastRow, other.lastRow)};
}

SurfaceRaster::Placed SurfaceRaster::place(const SurfaceLayer& layer, const SurfaceTile& tile, double least,
                                           double most, double cellPx) const
{
    Placed placed;
    placed.step = 0;
    if (tile.empty()) return placed;
    const bool perspective = layer.projection.perspective;
    Projected low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; ++corner) {
        const Projected p =
            project(layer, corner & 1 ? tile.box.maxX : tile.box.minX, corner & 2 ? tile.box.maxY : tile.box.minY,
                    tile.base + (corner & 4 ? most : least));
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.depth, p.depth)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.depth, p.depth)};
    }
    const double near = layer.projection.nearDepth;
    if (high.depth < near) return placed;
    if (perspective && low.depth < near) {  // around the eye: anywhere
        low.x = low.y = -1;
        high.x = m_width;
        high.y = m_height;
    }
    // where it keeps to coarser neighbors, it can reach further than its own heights do
    const double margin = (high.y - low.y) / 2 + 2 * cellPx;
    if (high.x < 0 || low.x > m_width || high.y + margin < 0 || low.y - margin > m_height) return placed;
    const double side = (tile.box.maxX - tile.box.minX) * layer.view->steps[0];
    const double cell = side / SurfaceTile::kCells * layer.pixelsPerUnit /
                        (perspective ? std::max(low.depth, side / SurfaceTile::kCells) : 1.0);
    placed.step = 1;
    while (placed.step < SurfaceTile::kCells && cell * placed.step * 2 <= cellPx) placed.step *= 2;
    // far beyond what an int holds, just before the eye
    const auto whole = [](double px) { return std::clamp(px, -1e6, 1e6); };
    const auto first = [&](double px) { return std::max(0, int(std::floor(whole(px))) - 1); };
    const auto last = [&](double px, int size) { return std::clamp(int(std::ceil(whole(px))) + 1, 0, size); };
    placed.pixels = {first(low.x), last(high.x, m_width), first(low.y), last(high.y, m_height)};
    return placed;
}

void SurfaceRaster::placeAll(std::span<const SurfaceLayer> layers, double cellPx)
{
    m_placed.clear();
    m_cells.resize(layers.size());
    std::vector<Placed> all;
    for (std::size_t l = 0; l < layers.size(); ++l) {
        const auto& tiles = layers[l].view->tiles;
        all.resize(tiles.size());
        m_cells[l].resize(tiles.size());
        tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t t) {
            all[t] = place(layers[l], *tiles[t], tiles[t]->least, tiles[t]->most, cellPx);
            all[t].layer = l;
            all[t].tile = t;
            const double cell = (tiles[t]->box.maxX - tiles[t]->box.minX) / SurfaceTile::kCells;
            m_cells[l][t] = all[t].step * cell;
        });
        std::copy_if(all.begin(), all.end(), std::back_inserter(m_placed),
                     [](const Placed& placed) { return placed.step != 0; });
    }
    tbb::parallel_for(std::size_t(0), m_placed.size(), [&](std::size_t k) {
        Placed& placed = m_placed[k];
        const SurfaceLayer& layer = layers[placed.layer];
        const SurfaceTile& tile = *layer.view->tiles[placed.tile];
        const TileEdges edges(*layer.view, m_cells[placed.layer]);
        placed.keepsToOthers = edges.hasCoarserNeighbor(placed.tile);
        if (!placed.keepsToOthers) return;
        double least = tile.least, most = tile.most;
        const double cell = m_cells[placed.layer][placed.tile];
        const auto include = [&](double x, double y) {
            const double above = edges.height(placed.tile, x, y) - tile.base;
            if (std::isnan(above)) return;
            least = std::min(least, above);
            most = std::max(most, above);
        };
        for (int i = 0; i <= SurfaceTile::kCells / placed.step; ++i) {
            include(tile.box.minX + i * cell, tile.box.minY);
            include(tile.box.minX + i * cell, tile.box.maxY);
            include(tile.box.minX, tile.box.minY + i * cell);
            include(tile.box.maxX, tile.box.minY + i * cell);
        }
        placed.pixels = place(layer, tile, least, most, cellPx).pixels;
    });
}

bool SurfaceRaster::isSameView(std::span<const SurfaceLayer> layers, const TargetSize& size, double cellPx,
                               SurfaceLook look, const SurfaceContours& contours) const noexcept
{
    const auto sameProjection = [](const LayerProjection& a, const LayerProjection& b) {
        return a.reference == b.reference && a.rowX == b.rowX && a.rowY == b.rowY && a.rowD == b.rowD &&
               a.perspective == b.perspective && a.nearDepth == b.nearDepth;
    };
    const auto sameClip = [](const LayerClip& a, const LayerClip& b) {
        return a.on == b.on && a.low == b.low && a.high == b.high && a.planeCount == b.planeCount &&
               a.planes == b.planes;
    };
    // the colors of all tiles go by the least and the greatest height
    const auto sameFrame = [](const SurfaceView& a, const SurfaceView& b) {
        return a.low == b.low && a.high == b.high && a.steps == b.steps && a.neighbors == b.neighbors &&
               a.tiles.size() == b.tiles.size();
    };
    return size.width == m_width && size.height == m_height && cellPx == m_cellPx && look == m_look &&
           contours == m_contours &&
           std::equal(layers.begin(), layers.end(), m_layers.begin(), m_layers.end(),
                      [&](const SurfaceLayer& a, const SurfaceLayer& b) {
                          return sameProjection(a.projection, b.projection) && sameClip(a.clip, b.clip) &&
                                 a.frame.origin == b.frame.origin && a.frame.shift == b.frame.shift &&
                                 a.pixelsPerUnit == b.pixelsPerUnit && a.zScale == b.zScale &&
                                 a.zOffset == b.zOffset && sameFrame(*a.view, *b.view);
                      });
}

/// Where tiles were or are that look otherwise than in the last draw(): those that were replaced, and those that
/// keep to one of them, or to one that does, and so on, always with smaller cells (TileEdges).
SurfaceRaster::Rectangle SurfaceRaster::changedPixels(std::span<const SurfaceLayer> layers,
                                                      const std::vector<Placed>& before,
                                                      const std::vector<std::vector<double>>& cellsBefore) const
{
    std::vector<std::vector<std::uint8_t>> changed(layers.size());
    for (std::size_t l = 0; l < layers.size(); ++l) {
        const SurfaceView& view = *layers[l].view;
        const SurfaceView& old = *m_layers[l].view;
        changed[l].assign(view.tiles.size(), 0);
        std::vector<std::size_t> found;
        for (std::size_t t = 0; t < view.tiles.size(); ++t)
            if (view.tiles[t] != old.tiles[t]) found.push_back(t);
        for (const std::size_t t : found) changed[l][t] = 1;
        while (!found.empty()) {
            const std::size_t tile = found.back();
            found.pop_back();
            const double cell = std::max(m_cells[l][tile], cellsBefore[l][tile]);
            for (const std::uint32_t other : view.neighbors->of(tile)) {
                if (changed[l][other] != 0 || m_cells[l][other] >= cell) continue;
                changed[l][other] = 1;
                found.push_back(other);
            }
        }
    }
    Rectangle pixels;
    for (const std::vector<Placed>* all : std::array{&before, &m_placed})
        for (const Placed& placed : *all)
            if (changed[placed.layer][placed.tile] != 0) pixels.include(placed.pixels);
    return pixels;
}

void SurfaceRaster::draw(std::span<const SurfaceLayer> layers, const TargetSize& size, double cellPx,
                         SurfaceLook look, const SurfaceContours& contours)
{
    const bool same = isSameView(layers, size, cellPx, look, contours);
    m_width = size.width;
    m_height = size.height;
    if (!layers.empty()) {
        m_perspective = layers[0].projection.perspective;
        m_nearestSlack = kSlackPx / layers[0].pixelsPerUnit;
    }
    const std::vector<Placed> before = std::exchange(m_placed, {});
    const std::vector<std::vector<double>> cellsBefore = std::exchange(m_cells, {});
    m_cellPx = NAN;  // the same view as none until all is drawn
    placeAll(layers, cellPx);
    m_drawn = same ? changedPixels(layers, before, cellsBefore) : Rectangle{0, m_width, 0, m_height};
    m_layers.assign(layers.begin(), layers.end());
    m_look = look;
    m_contours = contours;
    const std::size_t pixels = std::size_t(m_width) * std::size_t(m_height);
    m_colors.resize(pixels);
    m_depths.resize(pixels);
    m_levels.resize(contours.on() ? pixels : 0);
    m_ink.resize(m_levels.size());
    if (contours.on() && !layers.empty()) {
        // in the middle of the heights, where floats are exact enough, and on an index contour
        const SurfaceLayer& first = layers[0];
        const double middle = (first.view->low + first.view->high) / 2 * first.zScale + first.zOffset;
        m_levelZero = kIndexContour * std::round(middle / contours.interval / kIndexContour);
    }

    const int rows = m_drawn.empty() ? 0 : m_drawn.lastRow - m_drawn.firstRow;
    const int wanted = kBandsAThread * tbb::this_task_arena::max_concurrency();
    const int bandRows = std::max(kLeastBandRows, (rows + wanted - 1) / wanted);
    const int bands = (rows + bandRows - 1) / bandRows;
    std::vector<std::vector<std::uint32_t>> inBand(std::size_t(std::max(bands, 0)));
    for (std::size_t k = 0; k < m_placed.size(); ++k) {
        const Rectangle seen = m_placed[k].pixels.cutTo(m_drawn);
        if (seen.empty()) continue;
        for (int band = (seen.firstRow - m_drawn.firstRow) / bandRows;
             m_drawn.firstRow + band * bandRows < seen.lastRow; ++band)
            inBand[std::size_t(band)].push_back(std::uint32_t(k));
    }
    tbb::parallel_for(0, bands, [&](int band) {
        std::vector<Node> nodes;
        Rectangle within = m_drawn;
        within.firstRow += band * bandRows;
        within.lastRow = std::min(m_drawn.lastRow, within.firstRow + bandRows);
        for (int y = within.firstRow; y < within.lastRow; ++y) {
            const auto first = std::ptrdiff_t(y) * m_width + within.firstColumn;
            const int columns = within.lastColumn - within.firstColumn;
            std::fill_n(m_depths.begin() + first, columns, INFINITY);
            if (contours.on()) std::fill_n(m_levels.begin() + first, columns, NAN);
        }
        for (const std::uint32_t k : inBand[std::size_t(band)]) drawTile(layers, m_placed[k], within, look, nodes);
    });
    if (contours.on()) drawInk();
    m_cellPx = cellPx;
}

float SurfaceRaster::levelOf(const SurfaceLayer& layer, double z) const noexcept
{
    return float((z * layer.zScale + layer.zOffset) / m_contours.interval - m_levelZero);
}

void SurfaceRaster::drawInk()
{
    constexpr std::size_t kRows = 32;  // a block, each of which looks at some rows about it, too
    if (m_drawn.empty()) return;
    const Rectangle reached = Rectangle{m_drawn.firstColumn - kContourReach, m_drawn.lastColumn + kContourReach,
                                        m_drawn.firstRow - kContourReach, m_drawn.lastRow + kContourReach}
                                  .cutTo({0, m_width, 0, m_height});
    const LevelPicture levels{m_levels, m_width, m_height};
    tbb::parallel_for(tbb::blocked_range<int>(reached.firstRow, reached.lastRow, kRows),
                      [&](const tbb::blocked_range<int>& rows) {
                          drawContours(levels, {reached.firstColumn, reached.lastColumn, rows.begin(), rows.end()},
                                       m_contours.width, m_ink);
                      });
}

/// The surface with its contours.
Rgba8 SurfaceRaster::seen(std::size_t pixel) const noexcept
{
    const Rgba8 color = m_colors[pixel];
    const int ink = m_ink.empty() ? 0 : m_ink[pixel];
    if (ink == 0) return color;
    const auto mix = [&](std::uint8_t surface, std::uint8_t line) {
        return std::uint8_t((surface * (255 - ink) + line * ink + 127) / 255);
    };
    return {mix(color.r, kInk.r), mix(color.g, kInk.g), mix(color.b, kInk.b), color.a};
}

void SurfaceRaster::drawTile(std::span<const SurfaceLayer> layers, const Placed& placed, const Rectangle& within,
                             SurfaceLook look, std::vector<Node>& nodes)
{
    const SurfaceLayer& layer = layers[placed.layer];
    const SurfaceView& view = *layer.view;
    const SurfaceTile& tile = *view.tiles[placed.tile];
    const TileEdges edges(view, m_cells[placed.layer]);
    const bool perspective = layer.projection.perspective;
    const double cell = (tile.box.maxX - tile.box.minX) / SurfaceTile::kCells;
    const int step = placed.step, row = SurfaceTile::kCells / step + 1;
    nodes.resize(std::size_t(row) * std::size_t(row));
    // from the northwest, 45 degrees high, as maps are lit
    const glm::dvec3 light(-0.5, 0.5, std::sqrt(0.5));
    const double range = std::max(view.high - view.low, 1e-9);
    for (int j = 0; j < row; ++j)
        for (int i = 0; i < row; ++i) {
            const int ni = i * step, nj = j * step;
            Node& node = nodes[std::size_t(j) * std::size_t(row) + std::size_t(i)];
            const bool onEdge = i == 0 || j == 0 || i == row - 1 || j == row - 1;
            const double x = tile.box.minX + ni * cell, y = tile.box.minY + nj * cell;
            const double height = placed.keepsToOthers && onEdge ? edges.height(placed.tile, x, y)
                                                                 : tile.base + double(tile.height(ni, nj));
            const float z = float(height - tile.base);
            node.w = NAN;
            if (std::isnan(height) || isCutOff(layer, x, y, height)) continue;
            const Projected p = project(layer, x, y, height);
            if (p.depth < double(layer.projection.nearDepth)) continue;
            node.x = p.x;
            node.y = p.y;
            node.w = float(perspective ? 1.0 / p.depth : p.depth);
            const auto rise = [&](float before, float after, double stepLength) {
                const bool one = !std::isnan(before), two = !std::isnan(after);
                if (!one && !two) return 0.0;
                return double((two ? after : z) - (one ? before : z)) * view.steps[2] /
                       ((int(one) + int(two)) * cell * stepLength);
            };
            const glm::dvec3 normal(-rise(tile.height(ni - 1, nj), tile.height(ni + 1, nj), view.steps[0]),
                                    -rise(tile.height(ni, nj - 1), tile.height(ni, nj + 1), view.steps[1]), 1.0);
            const double lit = std::max(0.0, glm::dot(glm::normalize(normal), light));
            const float shade = float(255.0 * std::min(1.0, 0.22 + 0.86 * lit));
            const glm::vec3 tint =
                look == SurfaceLook::Heights ? tintOf((height - view.low) / range) : glm::vec3(0.82f, 0.82f, 0.80f);
            node.r = shade * tint.x;
            node.g = shade * tint.y;
            node.b = shade * tint.z;
            node.level = m_contours.on() ? levelOf(layer, height) : 0.0f;
        }
    for (int j = 0; j + 1 < row; ++j)
        for (int i = 0; i + 1 < row; ++i) {
            const Node& a = nodes[std::size_t(j) * std::size_t(row) + std::size_t(i)];
            const Node& b = nodes[std::size_t(j) * std::size_t(row) + std::size_t(i) + 1];
            const Node& c = nodes[std::size_t(j + 1) * std::size_t(row) + std::size_t(i)];
            const Node& d = nodes[std::size_t(j + 1) * std::size_t(row) + std::size_t(i) + 1];
            const auto is = [](const Node& n) { return !std::isnan(n.w); };
            // two triangles; where one node lacks, that of the other three
            if (is(a) && is(d)) {
                if (is(b)) drawTriangle(a, b, d, perspective, within);
                if (is(c)) drawTriangle(a, d, c, perspective, within);
            } else if (is(b) && is(c)) {
                if (is(a)) drawTriangle(a, b, c, perspective, within);
                if (is(d)) drawTriangle(b, d, c, perspective, within);
            }
        }
}

void SurfaceRaster::drawTriangle(const Node& a, const Node& b, const Node& c, bool perspective,
                                 const Rectangle& within)
{
    const double lowY = std::min({a.y, b.y, c.y}), highY = std::max({a.y, b.y, c.y});
    const double lowX = std::min({a.x, b.x, c.x}), highX = std::max({a.x, b.x, c.x});
    if (!(highY >= within.firstRow) || !(lowY <= within.lastRow) || !(highX >= within.firstColumn) ||
        !(lowX <= within.lastColumn))
        return;
    // pixels whose middle is inside, on an edge, or so little beside it that it could fall between two triangles
    const int y0 = std::max(within.firstRow, int(std::ceil(std::max(lowY, -1.0) - 0.5 - kEdgePx)));
    const int y1 = std::min(within.lastRow - 1, int(std::floor(std::min(highY, 1e6) - 0.5 + kEdgePx)));
    const int x0 = std::max(within.firstColumn, int(std::ceil(std::max(lowX, -1.0) - 0.5 - kEdgePx)));
    const int x1 = std::min(within.lastColumn - 1, int(std::floor(std::min(highX, 1e6) - 0.5 + kEdgePx)));
    if (y0 > y1 || x0 > x1) return;
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0) return;
    const double inverse = 1.0 / area;
    // a share is the distance from the edge across, in heights above it
    const auto least = [&](const Node& from, const Node& to) {
        const double dx = to.x - from.x, dy = to.y - from.y;
        return -kEdgePx * std::sqrt(dx * dx + dy * dy) * std::abs(inverse);
    };
    const double leastA = least(b, c), leastB = least(c, a), leastC = least(a, b);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double px = x + 0.5, py = y + 0.5;
            double shareB = ((px - a.x) * (c.y - a.y) - (py - a.y) * (c.x - a.x)) * inverse;
            double shareC = ((b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x)) * inverse;
            double shareA = 1.0 - shareB - shareC;
            if (shareA < leastA || shareB < leastB || shareC < leastC) continue;
            if (shareA < 0 || shareB < 0 || shareC < 0) {  // beside it: as at the nearest place, about
                shareA = std::max(shareA, 0.0);
                shareB = std::max(shareB, 0.0);
                shareC = std::max(shareC, 0.0);
                const double sum = shareA + shareB + shareC;
                shareA /= sum;
                shareB /= sum;
                shareC /= sum;
            }
            const double w = shareA * a.w + shareB * b.w + shareC * c.w;
            const float depth = float(perspective ? 1.0 / w : w);
            const std::size_t at = std::size_t(y) * std::size_t(m_width) + std::size_t(x);
            if (!(depth < m_depths[at])) continue;
            m_depths[at] = depth;
            if (!m_levels.empty())
                m_levels[at] = float(
                    perspective ? (shareA * a.w * a.level + shareB * b.w * b.level + shareC * c.w * c.level) / w
                                : shareA * a.level + shareB * b.level + shareC * c.level);
            const auto mix = [&](float u, float v, float t) {
                return std::uint8_t(std::clamp(shareA * u + shareB * v + shareC * t, 0.0, 255.0));
            };
            m_colors[at] = {mix(a.r, b.r, c.r), mix(a.g, b.g, c.g), mix(a.b, b.b, c.b), 255};
        }
}

void SurfaceRaster::compose(Image& picture, const Points& points, const ResolveSettings& settings) const
{
    tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, 16), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y != rows.end(); ++y) {
            const Rgba8 background = backgroundOf(y, picture.height, settings);
            for (int x = 0; x < picture.width; ++x) {
                const std::size_t at = std::size_t(y) * std::size_t(m_width) + std::size_t(x);
                Rgba8& pixel = picture.pixels[at];
                const float surface = m_depths[at];
                const Rgba8 behind = surface < INFINITY ? seen(at) : background;
                const double slack = m_perspective ? m_nearestSlack * double(surface) : m_nearestSlack;
                const bool front = (points.onTop || double(points.depths[at]) <= double(surface) + slack) &&
                                   (points.replaced.empty() || points.replaced[at] == 0);
                if (surface < INFINITY && !front) {
                    pixel = behind;
                    continue;
                }
                if (pixel.a == 255) continue;
                if (pixel.a == 0 || behind.a == 0) {
                    if (pixel.a == 0) pixel = behind;
                    continue;
                }
                const auto over = [&](std::uint8_t top, std::uint8_t under) {
                    return std::uint8_t((top * pixel.a + under * (255 - pixel.a) + 127) / 255);
                };
                pixel = {over(pixel.r, behind.r), over(pixel.g, behind.g), over(pixel.b, behind.b),
                         std::uint8_t(pixel.a + behind.a * (255 - pixel.a) / 255)};
            }
        }
    });
}

}  // namespace punctum::render
