// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace punctum
{

class PointSet;
class Progress;

/// How an attribute's values are meant, which decides how they are drawn and listed.
enum class AttributeKind {
    Scalar,    ///< a quantity: drawn through a color map over a range
    Class,     ///< an ASPRS class code: drawn with the class palette
    Category,  ///< ids, flags and small counts: each value has a color of its own
    Color,     ///< red, green, blue
    Vector,    ///< a direction of three components, such as Normal
    Opaque,    ///< bytes nobody described: kept and written back, not drawn
};

/// An exact value: 64-bit integers never pass through a double.
using Value = std::variant<std::int64_t, std::uint64_t, double>;

double toDouble(const Value& value) noexcept;
/// As text, exact: integers in full, doubles with the digits that tell them apart. ValueText.h has the rest.
std::string toText(const Value& value);

/// A named view on one column (or three): whole values, a bit field of a byte, or scaled integers.
///
/// Value of component c at point i: raw = columns[c][i] (or its bits [bitShift, bitShift+bitWidth)),
/// value = raw * scale + offset (as DecimalScale has it) where `scaled`, else raw. Copies share the columns, and
/// keep them alive. Reading is as thread-safe as the column: hold PointCloud::mutex() shared when edits may run.
struct Attribute {
    std::string name;  ///< the standard's own ("ReturnNumber") or the extra bytes' name; unique in its cloud
    AttributeKind kind = AttributeKind::Scalar;
    std::uint32_t components = 1;                      ///< 1, or 3 for Color and Vector
    std::array<std::shared_ptr<Column>, 3> columns{};  ///< `components` of them are set
    std::uint8_t bitShift = 0;
    std::uint8_t bitWidth = 0;  ///< 0: the whole value
    bool scaled = false;
    double scale = 1.0;
    double offset = 0.0;
    std::optional<Value> noData;  ///< raw value that means "none" (extra bytes)
    bool standard = false;        ///< a field of the LAS point format, not extra bytes or computed
    std::string unit;             ///< for display: "m", "deg", "s"; empty when there is none
    std::string description;

    ScalarType type() const noexcept { return columns[0]->type(); }
    PointIndex size() const noexcept { return columns[0]->size(); }
    bool integral() const noexcept { return !scaled && !isFloating(type()); }

    /// Exact value of one point; meant for single points (lists, picking).
    Value value(PointIndex index, std::uint32_t component = 0) const;
    /// value() as a double. NaN for no-data, and for points whose file lacks the attribute.
    double number(PointIndex index, std::uint32_t component = 0) const;
    /// Whether the point has no value, since its file lacks the attribute (Column::absent()).
    bool lacks(PointIndex index, std::uint32_t component = 0) const;
    /// Largest raw value the field can hold (31 for Classification of point formats 0-5).
    std::uint64_t maxBits() const noexcept;

    /// Values of consecutive points as doubles (no-data: NaN) into `out`, which holds range.size() values.
    void read(PointRange range, double* out, std::uint32_t component = 0) const;
    /// float(value - bias) of the points listed, into `out` (indices.size() values). The bias keeps the digits
    /// of large values such as GPS time.
    void gather(std::span<const std::uint32_t> indices, double bias, float* out, std::uint32_t component = 0) const;
    void gather(PointRange range, double bias, float* out, std::uint32_t component = 0) const;
    /// Raw bits of integral or bit-field attributes of the points listed, cut to the 32 or 8 bits of `out`.
    void gatherBits(std::span<const std::uint32_t> indices, std::uint32_t* out, std::uint32_t component = 0) const;
    void gatherBits(PointRange range, std::uint32_t* out, std::uint32_t component = 0) const;
    void gatherBits(PointRange range, std::uint8_t* out, std::uint32_t component = 0) const;

private:
    void readStored(PointRange range, double* out, std::uint32_t component) const;
};

/// What can be computed of one component over all points.
struct AttributeStatistics {
    Value min = 0.0;
    Value max = 0.0;
    double mean = 0.0;
    std::uint64_t count = 0;  ///< points that have a value (NaN and no-data left out); 0: min, max, mean are 0
};

/// Exact minimum, maximum and mean of one component, in parallel; without the points of `leftOut` (null: none).
/// Throws Cancelled.
AttributeStatistics computeStatistics(const Attribute& attribute, std::uint32_t component, Progress& progress,
                                      const PointSet* leftOut = nullptr);

/// How many points have each of the 256 class codes (or any attribute's raw value, cut at 255); those of `leftOut`
/// (null: none) are not counted.
std::array<std::uint64_t, 256> countValues(const Attribute& attribute, Progress& progress,
                                           const PointSet* leftOut = nullptr);

}  // namespace punctum
