// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <string>

namespace punctum
{

struct CoordinateScale;

/// How values are written, everywhere: in reports, tables, JSON and CSV, and, with the signs of the user's
/// language, in the window. What is written is exact: reading it again gives the same value, and a condition with
/// it finds the point that has it. Numbers have a point and no separators, and an exponent only beyond 10^15 and
/// below 10^-6; no number is "nan", and the infinite ones are "inf" and "-inf". Any thread.

/// The fewest digits that tell a double (or float) from its neighbors: "849148.2", "1e-09".
std::string shortestText(double value);
std::string shortestText(float value);
/// Exactly so many decimals, rounded: for what was computed and is no stored value (means, distances).
std::string decimalText(double value, int decimals);
/// At most so many decimals, rounded, without zeros at the end.
std::string roundedText(double value, int decimals);

/// A value of an attribute. Scaled integers have the decimals of scale and offset ("849148.20" at a scale of 0.01),
/// floating numbers their shortest text, integers all their digits.
std::string valueText(const Attribute& attribute, const Value& value);
/// A value along an axis (0 to 2): as a stored coordinate where it is one, else as many digits as it needs.
std::string coordinateText(const CoordinateScale& coordinates, int axis, double value);

/// A difference of two of them, with their decimals.
std::string differenceText(const CoordinateScale& coordinates, int axis, double difference);

/// Decimals of the values of an attribute or axis; -1 where they are written with as many as each needs.
int decimalsOf(const Attribute& attribute);
int decimalsOf(const CoordinateScale& coordinates, int axis);

/// The number that a typed one means among the attribute's values: what a float is written as is that float.
double typedValue(const Attribute& attribute, double typed);
/// The number as which the value's text is read: for JSON, where a float would get the digits of the double around.
double writtenValue(const Attribute& attribute, double value);

}  // namespace punctum
