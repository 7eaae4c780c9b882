// SPDX-License-Identifier: MIT
#include "render/scene/ScreenDensity.h"

#include "render/scene/LayerProjection.h"
#include "render/store/LocalFrame.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace punctum::render
{

std::optional<ScreenRect> screenRect(const LayerProjection& projection, const LocalBox& box)
{
    const glm::dvec3 low = glm::dvec3(box.low) - glm::dvec3(projection.reference);
    const glm::dvec3 size = glm::dvec3(box.high) - glm::dvec3(box.low), middle = low + size / 2.0;
    glm::dvec3 x(projection.rowX), y(projection.rowY);  // px along the axes
    double atX = glm::dot(x, middle) + double(projection.rowX.w);
    double atY = glm::dot(y, middle) + double(projection.rowY.w);
    if (projection.perspective) {
        const glm::dvec3 d(projection.rowD);
        const double depth = glm::dot(d, middle) + double(projection.rowD.w);
        if (depth - glm::dot(glm::abs(d), size) / 2.0 <= double(projection.nearDepth)) return {};
        atX /= depth;
        atY /= depth;
        x = (x - d * atX) / depth;
        y = (y - d * atY) / depth;
    }
    // A px at least: what is smaller still falls into one.
    const double halfX = std::max(0.5, glm::dot(glm::abs(x), size) / 2.0);
    const double halfY = std::max(0.5, glm::dot(glm::abs(y), size) / 2.0);
    return ScreenRect{atX - halfX, atY - halfY, atX + halfX, atY + halfY};
}

ScreenDensity::ScreenDensity(const TargetSize& size)
    : m_columns(std::size_t(std::max(1, (size.width + kCell - 1) / kCell))),
      m_rows(std::size_t(std::max(1, (size.height + kCell - 1) / kCell))),
      m_stride(m_columns + 1),
      m_sums(m_stride * (m_rows + 1))
{
}

auto ScreenDensity::cellsOf(const ScreenRect& rect) const noexcept -> Cells
{
    const auto cell = [](double px, std::size_t count) {
        return std::size_t(std::clamp(px / kCell, 0.0, double(count - 1)));
    };
    return {cell(rect.left, m_columns), cell(rect.top, m_rows), cell(rect.right, m_columns) + 1,
            cell(rect.bottom, m_rows) + 1};
}

void ScreenDensity::add(const ScreenRect& rect, double points)
{
    // Of small rectangles the density is that of their cells.
    const double width = std::max<double>(kCell, rect.right - rect.left);
    const double height = std::max<double>(kCell, rect.bottom - rect.top);
    const double density = points / width / height;
    const Cells c = cellsOf(rect);
    // One that is smaller than a cell, and lies across its edges, is in several: each has its part of it.
    const double inCells = double(c.right - c.left) * double(c.bottom - c.top) * kCell * kCell;
    const double part = density * std::min(1.0, width * height / inCells);
    at(c.left, c.top) += part;
    at(c.right, c.top) -= part;
    at(c.left, c.bottom) -= part;
    at(c.right, c.bottom) += part;
}

void ScreenDensity::finish(double pointsAPixel)
{
    for (std::size_t row = 0; row <= m_rows; ++row)
        for (std::size_t column = 1; column <= m_columns; ++column) at(column, row) += at(column - 1, row);
    for (std::size_t row = 1; row <= m_rows; ++row)
        for (std::size_t column = 0; column <= m_columns; ++column) at(column, row) += at(column, row - 1);
    // From the last cell on, so that each makes room for the sum of those before it.
    std::vector<double> sums(m_sums.size());
    for (std::size_t row = 0; row < m_rows; ++row)
        for (std::size_t column = 0; column < m_columns; ++column) {
            const double density = std::max(at(column, row), 1e-9);
            const std::size_t here = row * m_stride + column;
            sums[here + m_stride + 1] =
                std::min(1.0, pointsAPixel / density) + sums[here + 1] + sums[here + m_stride] - sums[here];
        }
    m_sums = std::move(sums);
}

double ScreenDensity::share(const ScreenRect& rect) const noexcept
{
    const Cells c = cellsOf(rect);
    const double sum = at(c.right, c.bottom) - at(c.left, c.bottom) - at(c.right, c.top) + at(c.left, c.top);
    return std::clamp(sum / (double(c.right - c.left) * double(c.bottom - c.top)), 1e-9, 1.0);
}

}  // namespace punctum::render
