// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/PointSet.h"

#include <cstdint>
#include <memory>
#include <span>

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

/// Turns an attribute's values into the 4 bytes a slot that drawing needs. Immutable once it is shared; any thread.
class AttributeEncoder
{
public:
    /// `bias`: taken off scalar values before they become float, so that GPS times keep their digits.
    /// `colorShift`: 8 when colors have 16 bits, 0 when they have 8 (display only).
    AttributeEncoder(Attribute attribute, double bias, int colorShift);

    const Attribute& attribute() const noexcept { return m_attribute; }
    WordKind kind() const noexcept { return m_kind; }
    double bias() const noexcept { return m_bias; }
    int colorShift() const noexcept { return m_colorShift; }
    /// Marks the points of this set from now on (an empty one: none); null: words have no mark.
    void setSelection(std::shared_ptr<const PointSet> selection) { m_selection = std::move(selection); }
    const std::shared_ptr<const PointSet>& selection() const noexcept { return m_selection; }

    /// Words of the points listed into `out` (indices.size() values). False when a color does not fit into
    /// 8 bits after colorShift (it is cut to 255 then): the file has 16-bit colors.
    bool encode(std::span<const std::uint32_t> indices, std::uint32_t* out) const;
    /// The same for consecutive points, which is faster.
    bool encode(PointRange range, std::uint32_t* out) const;

private:
    template <typename Part>
    void markSelected(const Part& points, std::size_t count, std::uint32_t* words) const;
    template <typename Part>
    bool encodeParts(std::size_t count, const Part& part, std::uint32_t* out) const;

    Attribute m_attribute;
    WordKind m_kind;
    double m_bias;
    int m_colorShift;
    std::shared_ptr<const PointSet> m_selection;
};

}  // namespace punctum::render
