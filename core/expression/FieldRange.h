// SPDX-License-Identifier: MIT
#pragma once

#include "core/expression/Program.h"

#include <cstdint>

namespace punctum::expression
{

/// Ranges of a field's values, compared as they are stored: several times as fast as when they become doubles
/// first.

/// From low to high, with the ends that are not left out; nothing where low is above high or one of them is NaN.
template <typename Bound>
struct Range {
    Bound low{};
    Bound high{};
    bool withoutLow = false;
    bool withoutHigh = false;
};

/// The range of the values for which the comparison with a constant holds; of Op::Unequal those for which it does
/// not.
Range<double> rangeOf(Node::Op comparison, double constant) noexcept;
Range<Int128> rangeOf(Node::Op comparison, Int128 constant) noexcept;

/// Sets the flags of the points whose stored value lies in the range; leaves the others as they are. Points without
/// a value are in no range. `a`: a scalar; its scale is not looked at. Hold the cloud's mutex shared.
void addInRange(const Attribute& a, PointRange points, const Range<double>& range, std::uint8_t* flags);
void addInRange(const Attribute& a, PointRange points, const Range<Int128>& range, std::uint8_t* flags);

}  // namespace punctum::expression
