// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

/// The px of a picture that a tool has marked: a byte each. What is drawn by hand is no finer than a px, and so a
/// point is meant when the px that it lies in is. A value; positions in px from the picture's top left corner.
class ScreenMask
{
public:
    ScreenMask() = default;
    ScreenMask(int width, int height);

    int width() const noexcept { return m_width; }
    int height() const noexcept { return m_height; }
    /// False outside of the picture.
    bool contains(int x, int y) const noexcept
    {
        return x >= 0 && y >= 0 && x < m_width && y < m_height &&
               m_px[std::size_t(y) * std::size_t(m_width) + std::size_t(x)] != 0;
    }
    /// Rows from the top, one behind the other.
    std::span<const std::uint8_t> px() const noexcept { return m_px; }

    /// Each marks the px whose middles lie inside, further to those that are marked.
    /// The outline closes itself; where it crosses itself, every other part is inside.
    void addPolygon(std::span<const glm::dvec2> corners);
    void addRectangle(glm::dvec2 corner, glm::dvec2 opposite);
    /// What a disc covers on its way from one place to the other.
    void addStroke(glm::dvec2 from, glm::dvec2 to, double radius);
    /// All px above (or below) the line through two places, between the two places sideways.
    void addSideOf(glm::dvec2 from, glm::dvec2 to, bool above);

    /// Marked px lie in [left, right) x [top, bottom); empty when nothing is marked.
    struct Box {
        int left = 0, top = 0, right = 0, bottom = 0;
        bool empty() const noexcept { return right <= left || bottom <= top; }
    };
    Box box() const noexcept;

private:
    void fillRow(int y, double from, double to) noexcept;

    int m_width = 0, m_height = 0;
    std::vector<std::uint8_t> m_px;
};

}  // namespace punctum
