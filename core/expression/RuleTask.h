// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"
#include "core/expression/Program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace punctum::expression
{

/// What a Rule is evaluated by: its cases over blocks of points, and values that become elements of a column.

/// A case of the rule, bound to a cloud.
struct BoundCase {
    Node value;
    std::optional<Node> condition;
};

/// A value that does not fit, and where.
struct Misfit {
    PointIndex point = std::numeric_limits<PointIndex>::max();
    std::string value;
};

/// As a person reads it, in the sentence on a value that does not fit.
std::string textOf(double v);
std::string textOf(Int128 v);

/// Classes that makeClassCommand() gives: a byte each.
bool isClassByte(const Attribute& a);
/// What the target's values are held against: a narrow field of classes (point formats 0-5) is widened if need be,
/// by makeClassCommand().
Attribute widest(Attribute target);
/// Throws Error when there is a value that does not fit.
void refuse(const Misfit& misfit, const Attribute& target);

/// Turns values into raw elements of the target.
template <typename T>
class Target
{
public:
    explicit Target(const Attribute& a) : m_scaled(a.scaled), m_scale(a.scale), m_offset(a.offset)
    {
        if constexpr (std::is_integral_v<T>) {
            m_low = a.bitWidth != 0 ? 0 : Int128(std::numeric_limits<T>::min());
            m_high = a.bitWidth != 0 ? Int128(a.maxBits()) : Int128(std::numeric_limits<T>::max());
        }
        if (!a.noData) return;
        std::visit(
            [&](auto v) {
                bool fits = true;
                if constexpr (!std::is_floating_point_v<T> && !std::is_integral_v<decltype(v)>)
                    fits = v >= double(m_low) && v <= double(m_high) && v == std::floor(v);
                if (fits) m_none = T(v);
            },
            *a.noData);
    }

    enum class Fit { Yes, No, None };

    Fit convert(double v, T& raw) const
    {
        if (std::isnan(v)) return none(raw);
        if (m_scaled) v = (v - m_offset) / m_scale;
        if constexpr (std::is_floating_point_v<T>) {
            raw = T(v);
            return std::isfinite(v) && !std::isfinite(raw) ? Fit::No : Fit::Yes;
        } else {
            v = std::round(v);
            if (!(std::abs(v) < 0x1p100)) return Fit::No;
            return whole(Int128(v), raw);
        }
    }
    Fit convert(Int128 v, T& raw) const
    {
        if (v == kNone) return none(raw);
        if constexpr (std::is_integral_v<T>)
            if (!m_scaled) return whole(v, raw);
        return convert(double(v), raw);
    }

private:
    Fit none(T& raw) const
    {
        if (m_none) {
            raw = *m_none;
            return Fit::Yes;
        }
        if constexpr (std::is_floating_point_v<T>) {
            raw = std::numeric_limits<T>::quiet_NaN();
            return Fit::Yes;
        } else {
            return Fit::None;
        }
    }
    Fit whole(Int128 v, T& raw) const
    {
        if (v < m_low || v > m_high) return Fit::No;
        raw = T(v);
        return Fit::Yes;
    }

    bool m_scaled;
    double m_scale, m_offset;
    Int128 m_low = 0, m_high = 0;
    std::optional<T> m_none;
};

/// Evaluates the cases over one task's words; T is the target column's type.
template <typename T>
class Task
{
public:
    using Value = T;

    Task(const std::vector<BoundCase>& cases, const std::vector<Attribute>& attributes, const Attribute& target,
         const PointSet* within)
        : m_cases(cases), m_target(target), m_convert(widest(target)), m_within(within), m_evaluator(attributes)
    {
    }

    /// Calls change(points, flags, raws) for each block: of the points whose flag is 1 the target gets the raw
    /// element. `current`: the column's values, which leaves out the points that have the value already; or null.
    template <typename Change>
    void run(std::size_t firstWord, std::size_t lastWord, PointIndex size, const T* current, Change change)
    {
        constexpr std::size_t kBlockWords = kBlockPoints / 64;
        for (std::size_t w = firstWord; w < lastWord; w += kBlockWords) {
            const PointRange points{PointIndex(w) * 64,
                                    std::min(size, PointIndex(std::min(lastWord, w + kBlockWords)) * 64)};
            if (block(points, current)) change(points, m_chosen.data(), m_raw.data());
        }
    }

    /// Those of an element that belong to the target: all of them, but for bit fields.
    T bits() const
    {
        if constexpr (std::is_integral_v<T>)
            return m_target.bitWidth == 0 ? T(~T(0)) : T(m_target.maxBits() << m_target.bitShift);
        else
            return T(0);
    }

    /// The element with these bits set to those of `raw`, which run() gave.
    T replaced(T element, T raw) const
    {
        if constexpr (std::is_integral_v<T>)
            return T((element & T(~bits())) | raw);
        else
            return raw;
    }
    /// Without the bits of other fields.
    T ownBits(T element) const
    {
        if constexpr (std::is_integral_v<T>)
            return T(element & bits());
        else
            return element;
    }

    Misfit misfit;

private:
    /// Fills m_chosen and m_raw; false when no point changes.
    bool block(PointRange points, const T* current)
    {
        if (!begin(points)) return false;
        for (const BoundCase& one : m_cases) {
            if (one.condition)
                m_evaluator.condition(*one.condition, points, m_flags.data());
            else
                m_flags.fill(1);
            if (!any(m_flags)) continue;
            m_touched = true;
            for (std::size_t k = 0; k < kBlockPoints; ++k) {
                m_flags[k] &= m_left[k];
                m_left[k] ^= m_flags[k];
            }
            assign(one.value, points);
        }
        if (!m_touched || !any(m_chosen)) return false;
        if (current == nullptr) return true;
        const T mask = bits();
        for (std::size_t k = 0; k < points.size(); ++k)
            m_chosen[k] &= std::uint8_t(differs(current[points.first + k], m_raw[k], mask));
        return any(m_chosen);
    }

    using Flags = std::array<std::uint8_t, kBlockPoints>;

    /// Eight flags at a time.
    static bool any(const Flags& flags)
    {
        std::uint64_t all = 0;
        for (std::size_t k = 0; k < kBlockPoints; k += sizeof all) {
            std::uint64_t eight;
            std::memcpy(&eight, flags.data() + k, sizeof eight);
            all |= eight;
        }
        return all != 0;
    }

    /// No point has been decided; only those within may be. False when there are none.
    bool begin(PointRange points)
    {
        const bool whole = points.size() == kBlockPoints;
        if (m_within == nullptr && whole && !m_touched) return true;  // as the last block has left them
        m_touched = !whole;
        m_chosen.fill(0);
        if (m_within == nullptr) {
            m_left.fill(1);
        } else {
            m_touched = true;
            m_left.fill(0);
            const std::size_t word = std::size_t(points.first / 64);
            m_within->forEachInWords(word, word + std::size_t((points.size() + 63) / 64),
                                     [&](PointIndex i) { m_left[std::size_t(i - points.first)] = 1; });
        }
        std::fill(m_left.begin() + std::ptrdiff_t(points.size()), m_left.end(), std::uint8_t(0));
        return any(m_left);
    }

    void assign(const Node& value, PointRange points)
    {
        if (value.op == Node::Op::Constant && takeConstant(value)) return;
        if (value.type == Node::Type::Wide) {
            m_evaluator.value(value, points, m_wides.data());
            take(points, m_wides.data());
        } else {
            m_evaluator.value(value, points, m_numbers.data());
            take(points, m_numbers.data());
        }
    }

    /// Takes one value for all points whose flag is set; false when it does not fit.
    bool takeConstant(const Node& value)
    {
        T raw{};
        const auto fit = value.type == Node::Type::Wide ? convert(value.wide, raw) : convert(value.number, raw);
        if (fit != Target<T>::Fit::Yes) return false;
        for (std::size_t k = 0; k < kBlockPoints; ++k) {
            m_raw[k] = m_flags[k] ? raw : m_raw[k];
            m_chosen[k] |= m_flags[k];
        }
        return true;
    }

    /// Takes the values of the points whose flag is set.
    template <typename V>
    void take(PointRange points, const V* values)
    {
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (!m_flags[k]) continue;
            switch (convert(values[k], m_raw[k])) {
                case Target<T>::Fit::Yes:
                    m_chosen[k] = 1;
                    break;
                case Target<T>::Fit::No:
                    if (points.first + k < misfit.point) misfit = {points.first + k, textOf(values[k])};
                    break;
                case Target<T>::Fit::None:
                    break;
            }
        }
    }

    template <typename V>
    typename Target<T>::Fit convert(V value, T& raw) const
    {
        const auto fit = m_convert.convert(value, raw);
        if constexpr (std::is_integral_v<T>) raw = T(raw << m_target.bitShift);
        return fit;
    }

    static bool differs(T a, T b, T mask)
    {
        if constexpr (std::is_integral_v<T>)
            return T(a & mask) != b;
        else
            return std::memcmp(&a, &b, sizeof a) != 0;  // one NaN is as good as the same one
    }

    const std::vector<BoundCase>& m_cases;
    const Attribute& m_target;
    Target<T> m_convert;
    const PointSet* m_within;
    Evaluator m_evaluator;
    Flags m_left{}, m_flags{}, m_chosen{};
    bool m_touched = true;  ///< m_left and m_chosen are not as begin() makes them of a whole block
    std::array<double, kBlockPoints> m_numbers{};
    std::array<Int128, kBlockPoints> m_wides{};
    std::array<T, kBlockPoints> m_raw{};
};

}  // namespace punctum::expression
