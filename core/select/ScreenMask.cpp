// SPDX-License-Identifier: MIT
#include "core/select/ScreenMask.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace punctum
{

namespace
{

/// The first whole px whose middle is not left of v, kept inside [0, end].
int firstFrom(double v, int end)
{
    return int(std::clamp(std::ceil(v - 0.5), 0.0, double(end)));
}

}  // namespace

ScreenMask::ScreenMask(int width, int height)
    : m_width(std::max(width, 0)), m_height(std::max(height, 0)), m_px(std::size_t(m_width) * std::size_t(m_height))
{
}

void ScreenMask::fillRow(int y, double from, double to) noexcept
{
    const int first = firstFrom(from, m_width), last = firstFrom(to, m_width);
    const auto row = m_px.begin() + std::ptrdiff_t(y) * m_width;
    if (first < last) std::fill(row + first, row + last, std::uint8_t(1));
}

void ScreenMask::addPolygon(std::span<const glm::dvec2> corners)
{
    if (corners.size() < 3) return;
    double top = corners[0].y, bottom = corners[0].y;
    for (const glm::dvec2& c : corners) {
        top = std::min(top, c.y);
        bottom = std::max(bottom, c.y);
    }
    const int last = firstFrom(bottom, m_height);
    std::vector<double> crossings;
    for (int y = firstFrom(top, m_height); y < last; ++y) {
        const double middle = y + 0.5;
        crossings.clear();
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const glm::dvec2 &a = corners[k], &b = corners[(k + 1) % corners.size()];
            // the lower end belongs to an edge, the upper one does not: no corner counts twice
            if ((a.y <= middle) != (b.y <= middle))
                crossings.push_back(a.x + (middle - a.y) / (b.y - a.y) * (b.x - a.x));
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) fillRow(y, crossings[k], crossings[k + 1]);
    }
}

void ScreenMask::addRectangle(glm::dvec2 corner, glm::dvec2 opposite)
{
    const int last = firstFrom(std::max(corner.y, opposite.y), m_height);
    for (int y = firstFrom(std::min(corner.y, opposite.y), m_height); y < last; ++y)
        fillRow(y, std::min(corner.x, opposite.x), std::max(corner.x, opposite.x));
}

void ScreenMask::addStroke(glm::dvec2 from, glm::dvec2 to, double radius)
{
    const int last = firstFrom(std::max(from.y, to.y) + radius, m_height);
    const int left = firstFrom(std::min(from.x, to.x) - radius, m_width);
    const int right = firstFrom(std::max(from.x, to.x) + radius, m_width);
    const glm::dvec2 way = to - from;
    const double length = way.x * way.x + way.y * way.y;
    for (int y = firstFrom(std::min(from.y, to.y) - radius, m_height); y < last; ++y)
        for (int x = left; x < right; ++x) {
            const glm::dvec2 p(x + 0.5 - from.x, y + 0.5 - from.y);
            const double t = length > 0 ? std::clamp((p.x * way.x + p.y * way.y) / length, 0.0, 1.0) : 0.0;
            const glm::dvec2 off(p.x - t * way.x, p.y - t * way.y);
            if (off.x * off.x + off.y * off.y <= radius * radius)
                m_px[std::size_t(y) * std::size_t(m_width) + std::size_t(x)] = 1;
        }
}

void ScreenMask::addSideOf(glm::dvec2 from, glm::dvec2 to, bool above)
{
    if (from.x > to.x) std::swap(from, to);
    const int last = firstFrom(to.x, m_width);
    for (int x = firstFrom(from.x, m_width); x < last; ++x) {
        const double line = from.y + (x + 0.5 - from.x) / (to.x - from.x) * (to.y - from.y);
        const int edge = firstFrom(line, m_height);  // the first px whose middle is below the line
        const int begin = above ? 0 : edge, end = above ? edge : m_height;
        for (int y = begin; y < end; ++y) m_px[std::size_t(y) * std::size_t(m_width) + std::size_t(x)] = 1;
    }
}

ScreenMask::Box ScreenMask::box() const noexcept
{
    Box box{m_width, m_height, 0, 0};
    for (int y = 0; y < m_height; ++y) {
        const auto row = m_px.begin() + std::ptrdiff_t(y) * m_width;
        const auto first = std::find(row, row + m_width, std::uint8_t(1));
        if (first == row + m_width) continue;
        int right = m_width;
        while (row[right - 1] == 0) --right;
        box.left = std::min(box.left, int(first - row));
        box.right = std::max(box.right, right);
        box.top = std::min(box.top, y);
        box.bottom = y + 1;
    }
    return box;
}

}  // namespace punctum
