// SPDX-License-Identifier: MIT
#include "core/cloud/ValueText.h"

#include "core/cloud/PointCloud.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace punctum
{

namespace
{

constexpr double kPlainFrom = 1e-6, kPlainTo = 1e15;  ///< magnitudes that are written without an exponent
constexpr int kMostDecimals = 30;

bool isPlain(double value)
{
    const double magnitude = std::abs(value);
    return magnitude == 0.0 || (magnitude >= kPlainFrom && magnitude < kPlainTo) || std::isinf(value);
}

template <typename T>
std::string shortest(T value)
{
    if (std::isnan(value)) return "nan";
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, value,
                                isPlain(double(value)) ? std::chars_format::fixed : std::chars_format::scientific)
                      .ptr};
}

double numberOf(const std::string& text)
{
    double number = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

/// With these decimals if they are enough for the value.
std::string withDecimals(double value, int decimals)
{
    if (decimals < 0 || !std::isfinite(value)) return shortestText(value);
    std::string text = decimalText(value, decimals);
    return numberOf(text) == value ? text : shortestText(value);
}

bool isFloat(const Attribute& attribute)
{
    return !attribute.scaled && attribute.columns[0] && attribute.type() == ScalarType::F32;
}

}  // namespace

std::string shortestText(double value)
{
    return shortest(value);
}

std::string shortestText(float value)
{
    return shortest(value);
}

std::string decimalText(double value, int decimals)
{
    if (!std::isfinite(value)) return shortestText(value);
    char text[400];  // 309 digits before the point, at most 30 behind it
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed,
                                   std::clamp(decimals, 0, kMostDecimals));
    return {text, end.ptr};
}

std::string roundedText(double value, int decimals)
{
    std::string text = decimalText(value, decimals);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    }
    const double number = numberOf(text);
    if (!isPlain(number)) return shortestText(number);
    return text == "-0" ? "0" : text;
}

std::string valueText(const Attribute& attribute, const Value& value)
{
    if (attribute.scaled) return withDecimals(toDouble(value), decimalsOf(attribute));
    if (isFloat(attribute)) return shortestText(float(toDouble(value)));
    return toText(value);
}

std::string coordinateText(const CoordinateScale& coordinates, int axis, double value)
{
    return withDecimals(value, decimalsOf(coordinates, axis));
}

std::string differenceText(const CoordinateScale& coordinates, int axis, double difference)
{
    constexpr int kOfNumbers = 9;  // where no number of decimals is enough for the values
    const int decimals = decimalsOf(coordinates, axis);
    return decimals < 0 ? roundedText(difference, kOfNumbers) : decimalText(difference, decimals);
}

int decimalsOf(const Attribute& attribute)
{
    if (attribute.integral()) return 0;
    if (!attribute.scaled || isFloating(attribute.type())) return -1;
    return DecimalScale(attribute.scale, attribute.offset).decimals();
}

int decimalsOf(const CoordinateScale& coordinates, int axis)
{
    return coordinates.steps(axis).decimals();
}

double typedValue(const Attribute& attribute, double typed)
{
    if (!isFloat(attribute) || !std::isfinite(typed)) return typed;
    const auto nearest = float(typed);
    return std::isfinite(nearest) && numberOf(shortestText(nearest)) == typed ? double(nearest) : typed;
}

double writtenValue(const Attribute& attribute, double value)
{
    return isFloat(attribute) && std::isfinite(value) ? numberOf(shortestText(float(value))) : value;
}

}  // namespace punctum
