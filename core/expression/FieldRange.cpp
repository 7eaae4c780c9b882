// SPDX-License-Identifier: MIT
#include "core/expression/FieldRange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace punctum::expression
{

namespace
{

using Op = Node::Op;

constexpr std::size_t kPiece = 64;  ///< points that are compared together
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whole numbers of T in the range; nothing where there are none.
template <typename T>
std::optional<Range<T>> within(const Range<Int128>& range)
{
    const Int128 least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
    const Int128 low = range.low < least ? least : range.low, high = range.high > most ? most : range.high;
    if (low > high) return {};
    return Range<T>{T(low), T(high)};
}

template <typename T>
std::optional<Range<T>> within(const Range<double>& range)
{
    if (std::isnan(range.low) || std::isnan(range.high)) return {};
    // Beyond these no T lies, and whole numbers between them are 128-bit integers.
    constexpr double kMost = 0x1p100;
    const double low = std::clamp(range.low, -kMost, kMost), high = std::clamp(range.high, -kMost, kMost);
    return within<T>(Range<Int128>{range.withoutLow ? Int128(std::floor(low)) + 1 : Int128(std::ceil(low)),
                                   range.withoutHigh ? Int128(std::ceil(high)) - 1 : Int128(std::floor(high))});
}

/// The stored value that stands for none, if T can be it.
template <typename T>
std::optional<T> noneOf(const Attribute& a)
{
    if (!a.noData) return {};
    return std::visit(
        [](auto v) -> std::optional<T> {
            if constexpr (std::is_integral_v<decltype(v)>) {
                if (std::in_range<T>(v)) return T(v);
                return {};
            } else {
                const auto one = within<T>(Range<double>{v, v});
                return one ? std::optional<T>(one->low) : std::nullopt;
            }
        },
        *a.noData);
}

/// Flags that are 1 join those that are there.
void join(const std::array<std::uint8_t, kPiece>& found, std::uint8_t* flags)
{
    std::array<std::uint64_t, kPiece / 8> ours, others;
    std::memcpy(ours.data(), flags, kPiece);
    std::memcpy(others.data(), found.data(), kPiece);
    for (std::size_t k = 0; k < ours.size(); ++k) ours[k] |= others[k];
    std::memcpy(flags, ours.data(), kPiece);
}

/// flags[k] |= test(values[k]). In loops of one length into memory of their own, of which the compiler makes
/// vectors; test must not branch.
template <typename T, typename Test>
void addFlags(const T* values, std::size_t count, std::uint8_t* flags, Test test)
{
    std::size_t at = 0;
    for (; at + kPiece <= count; at += kPiece) {
        alignas(64) std::array<std::uint8_t, kPiece> found;
        for (std::size_t k = 0; k < kPiece; ++k) found[k] = std::uint8_t(test(values[at + k]));
        join(found, flags + at);
    }
    for (; at < count; ++at) flags[at] |= std::uint8_t(test(values[at]));
}

#if defined(__SSE2__)
/// The same for doubles from low to high, of which the compiler makes no vectors.
void addDoubles(const double* values, std::size_t count, double low, double high, std::uint8_t* flags)
{
    const __m128d lo = _mm_set1_pd(low), hi = _mm_set1_pd(high);
    const __m128i one = _mm_set1_epi8(1), lowByte = _mm_set1_epi16(0xFF);
    // eight bits a value, twice each
    const auto eight = [&](const double* v) {
        const auto two = [&](std::size_t k) {
            const __m128d x = _mm_loadu_pd(v + k);
            return _mm_castpd_si128(_mm_and_pd(_mm_cmpge_pd(x, lo), _mm_cmple_pd(x, hi)));
        };
        return _mm_packs_epi16(_mm_packs_epi32(two(0), two(2)), _mm_packs_epi32(two(4), two(6)));
    };
    std::size_t at = 0;
    for (; at + kPiece <= count; at += kPiece) {
        alignas(64) std::array<std::uint8_t, kPiece> found;
        for (std::size_t k = 0; k < kPiece; k += 16) {
            const __m128i first = _mm_and_si128(eight(values + at + k), lowByte);
            const __m128i second = _mm_and_si128(eight(values + at + k + 8), lowByte);
            _mm_store_si128(reinterpret_cast<__m128i*>(found.data() + k),
                            _mm_and_si128(_mm_packus_epi16(first, second), one));
        }
        join(found, flags + at);
    }
    for (; at < count; ++at) flags[at] |= std::uint8_t(values[at] >= low && values[at] <= high);
}
#endif

template <typename T, typename Test>
void addExisting(const T* values, std::size_t count, std::uint8_t* flags, std::optional<T> none, Test test)
{
    if (!none) return addFlags(values, count, flags, test);
    addFlags(values, count, flags,
             [test, none = *none](T v) { return std::uint8_t(test(v)) & std::uint8_t(v != none); });
}

template <typename T, typename Bound>
void addOfType(const Attribute& a, PointRange points, const Range<Bound>& range, std::uint8_t* flags)
{
    const T* const values = a.columns[0]->values<T>().data() + points.first;
    const auto count = std::size_t(points.size());
    if constexpr (std::is_floating_point_v<T>) {
        double low = double(range.low), high = double(range.high);
        if ((range.withoutLow && low == kInfinity) || (range.withoutHigh && high == -kInfinity)) return;
        if (range.withoutLow) low = std::nextafter(low, kInfinity);
        if (range.withoutHigh) high = std::nextafter(high, -kInfinity);
        const auto inside = [=](T v) { return std::uint8_t(double(v) >= low) & std::uint8_t(double(v) <= high); };
#if defined(__SSE2__)
        if constexpr (std::is_same_v<T, double>)
            if (!a.noData) return addDoubles(values, count, low, high, flags);
#endif
        if (!a.noData) return addFlags(values, count, flags, inside);
        addFlags(values, count, flags, [=, none = toDouble(*a.noData)](T v) {
            return std::uint8_t(inside(v)) & std::uint8_t(!(double(v) == none));
        });
    } else {
        const auto bounds = within<T>(range);
        if (!bounds) return;
        const T low = bounds->low, high = bounds->high;
        // one comparison for two: what is below `low` wraps around to the top
        using Bits = std::make_unsigned_t<T>;
        const Bits span = Bits(Bits(high) - Bits(low));
        const auto inside = [=](T v) { return std::uint8_t(Bits(Bits(v) - Bits(low)) <= span); };
        const std::optional<T> none = noneOf<T>(a);
        if (a.bitWidth == 0) return addExisting(values, count, flags, none, inside);
        const auto mask = Bits(a.maxBits());
        const unsigned shift = a.bitShift;
        addFlags(values, count, flags, [=, has = none.has_value(), none = none.value_or(T{})](T stored) {
            const T v = T((Bits(stored) >> shift) & mask);
            return std::uint8_t(inside(v)) & std::uint8_t(!(has & (v == none)));
        });
    }
}

template <typename Bound>
void addAny(const Attribute& a, PointRange points, const Range<Bound>& range, std::uint8_t* flags)
{
    visitScalar(a.type(), [&](auto zero) { addOfType<decltype(zero)>(a, points, range, flags); });
}

}  // namespace

Range<double> rangeOf(Op comparison, double constant) noexcept
{
    switch (comparison) {
        case Op::Less:
            return {.low = -kInfinity, .high = constant, .withoutHigh = true};
        case Op::LessEqual:
            return {-kInfinity, constant};
        case Op::Greater:
            return {.low = constant, .high = kInfinity, .withoutLow = true};
        case Op::GreaterEqual:
            return {constant, kInfinity};
        default:
            return {constant, constant};
    }
}

Range<Int128> rangeOf(Op comparison, Int128 constant) noexcept
{
    constexpr Int128 kMost = Int128(1) << 120;  // beyond it are no values
    if (constant == kNone) return {1, 0};
    switch (comparison) {
        case Op::Less:
            return {-kMost, constant - 1};
        case Op::LessEqual:
            return {-kMost, constant};
        case Op::Greater:
            return {constant + 1, kMost};
        case Op::GreaterEqual:
            return {constant, kMost};
        default:
            return {constant, constant};
    }
}

void addInRange(const Attribute& a, PointRange points, const Range<double>& range, std::uint8_t* flags)
{
    addAny(a, points, range, flags);
}

void addInRange(const Attribute& a, PointRange points, const Range<Int128>& range, std::uint8_t* flags)
{
    addAny(a, points, range, flags);
}

}  // namespace punctum::expression
