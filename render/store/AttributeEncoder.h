// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/PointSet.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace punctum::render
{

/// How the 4 bytes of a slot are to be read when colors are made.
enum class WordKind : std::uint32_t {
    Scalar = 0,    ///< float bits of value - bias: color map over a range; NaN: no value
    Class = 1,     ///< class code: palette
    Category = 2,  ///< id: categoryColor()
    Color = 3,     ///< r, g, b, 255 from the lowest byte on
    Normal = 4,    ///< x, y, z from the lowest bit on, 10 bits each: 512 + 511 times the component; 0: no value
};

/// The bit of a word that says whether the point is selected, where the encoder marks selected points: the last
/// digit of a scalar, which no color shows; of a color the lowest bit of alpha, which is 0 for selected ones.
inline constexpr std::uint32_t selectedBit(WordKind kind) noexcept
{
    return kind == WordKind::Scalar ? 1u : kind == WordKind::Color ? 1u << 24 : 1u << 31;
}

/// How many bits colors have beyond 8, judged by the largest channel of each of some points: 0, 2 (10-bit colors),
/// 4 (12-bit colors) or 8. Black points do not count, and of the others 1 % may be brighter than the rest allow, so
/// that a few white ones do not make all others nearly black. Sorts the list.
int colorShiftOf(std::vector<std::uint32_t>& largestChannels) noexcept;

/// Turns an attribute's values into the 4 bytes a slot that drawing needs. Immutable once it is shared; any thread.
class AttributeEncoder
{
public:
    /// `bias`: taken off scalar values before they become float, so that GPS times keep their digits.
    /// `colorShift`: how many bits colors have beyond 8 (display only): see colorShiftOf().
    AttributeEncoder(Attribute attribute, double bias, int colorShift);

    const Attribute& attribute() const noexcept { return m_attribute; }
    WordKind kind() const noexcept { return m_kind; }
    double bias() const noexcept { return m_bias; }
    int colorShift() const noexcept { return m_colorShift; }
    /// Marks the points of this set from now on (an empty one: none); null: words have no mark.
    void setSelection(std::shared_ptr<const PointSet> selection) { m_selection = std::move(selection); }
    const std::shared_ptr<const PointSet>& selection() const noexcept { return m_selection; }

    /// Words of the points listed into `out` (indices.size() values). Returns how many have a color that does not
    /// fit into 8 bits after colorShift, and is cut to 255.
    std::size_t encode(std::span<const std::uint32_t> indices, std::uint32_t* out) const;
    /// The same for consecutive points, which is faster.
    std::size_t encode(PointRange range, std::uint32_t* out) const;

private:
    template <typename Points>
    void markWithoutColor(const Points& points, std::size_t count, std::uint32_t* words) const;
    template <typename Part>
    void markSelected(const Part& points, std::size_t count, std::uint32_t* words) const;
    template <typename Part>
    std::size_t encodeParts(std::size_t count, const Part& part, std::uint32_t* out) const;

    Attribute m_attribute;
    WordKind m_kind;
    double m_bias;
    int m_colorShift;
    bool m_lacking;  ///< colors, which some files of a survey lack
    std::shared_ptr<const PointSet> m_selection;
};

}  // namespace punctum::render
