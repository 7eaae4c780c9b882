// SPDX-License-Identifier: MIT
#include "core/surface/Polygon.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

constexpr int kLinesOfRow = 8;
constexpr int kAreaRows = 64;

/// Whether a line to the right from a place meets an edge.
bool meetsRay(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& place) noexcept
{
    return (a.y > place.y) != (b.y > place.y) && place.x < (b.x - a.x) * (place.y - a.y) / (b.y - a.y) + a.x;
}

}  // namespace

bool isInside(const Ring& ring, const glm::dvec2& place) noexcept
{
    bool inside = false;
    for (std::size_t k = 0, before = ring.size() - 1; k < ring.size(); before = k++)
        if (meetsRay(ring[k], ring[before], place)) inside = !inside;
    return inside;
}

bool isInside(std::span<const Ring> rings, const glm::dvec2& place) noexcept
{
    bool inside = false;
    for (const Ring& ring : rings) inside = inside != isInside(ring, place);
    return inside;
}

double signedArea(const Ring& ring) noexcept
{
    double sum = 0;
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
        const glm::dvec2 a = ring[k] - ring[0], b = ring[k + 1] - ring[0];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum / 2;
}

CellCover::CellCover(std::span<const Ring> rings, double minY, double maxY)
{
    for (const Ring& ring : rings)
        for (std::size_t k = 0, before = ring.size() - 1; k < ring.size(); before = k++) {
            const glm::dvec2 &a = ring[before], &b = ring[k];
            if (std::max(a.y, b.y) >= minY && std::min(a.y, b.y) <= maxY) m_edges.push_back({a, b});
        }
}

/// From one place of a line to another, in cells from the row's begin; `part`: of the row for which it stands.
void CellCover::addSpan(double from, double to, double dx, double line, double part)
{
    from = std::max(from, 0.0);
    to = std::min(to, double(m_row.size()));
    if (!(from < to)) return;
    for (std::size_t cell = std::size_t(from); cell < m_row.size() && double(cell) < to; ++cell) {
        const double left = std::max(from, double(cell)), right = std::min(to, double(cell + 1));
        const double share = (right - left) * part;
        m_row[cell].share += share;
        m_row[cell].x += share * (left + right) / 2 * dx;
        m_row[cell].y += share * line;
    }
}

std::span<const CellCover::Part> CellCover::row(double x, double dx, int cells, double y, double dy)
{
    m_row.assign(std::size_t(cells), {});
    // between two heights no edge begins or ends, so that the line in the middle tells the area
    m_heights.clear();
    for (int k = 0; k <= kLinesOfRow; ++k) m_heights.push_back(y + double(k) / kLinesOfRow * dy);
    for (const auto& [a, b] : m_edges)
        if (a.y > y && a.y < y + dy) m_heights.push_back(a.y);
    std::sort(m_heights.begin(), m_heights.end());
    for (std::size_t k = 0; k + 1 < m_heights.size(); ++k) {
        const double part = (m_heights[k + 1] - m_heights[k]) / dy;
        if (!(part > 0)) continue;
        const double line = (m_heights[k] + m_heights[k + 1]) / 2;
        m_crossings.clear();
        for (const auto& [a, b] : m_edges)
            if ((a.y > line) != (b.y > line))
                m_crossings.push_back((((b.x - a.x) * (line - a.y) / (b.y - a.y) + a.x) - x) / dx);
        std::sort(m_crossings.begin(), m_crossings.end());
        for (std::size_t c = 0; c + 1 < m_crossings.size(); c += 2)
            addSpan(m_crossings[c], m_crossings[c + 1], dx, line, part);
    }
    for (Part& part : m_row) {
        if (part.share == 0) continue;
        part.x = x + part.x / part.share;
        part.y /= part.share;
    }
    return m_row;
}

double areaInside(std::span<const Ring> rings)
{
    glm::dvec2 low(INFINITY), high(-INFINITY);
    for (const Ring& ring : rings)
        for (const glm::dvec2& p : ring) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
    if (!(low.x < high.x && low.y < high.y)) return 0;
    CellCover cover(rings, low.y, high.y);
    const double width = high.x - low.x, row = (high.y - low.y) / kAreaRows;
    double area = 0;
    for (int j = 0; j < kAreaRows; ++j) area += cover.row(low.x, width, 1, low.y + j * row, row)[0].share;
    return area * width * row;
}

}  // namespace punctum
