// SPDX-License-Identifier: MIT
#include "core/las/RecordComparer.h"

#include "core/cloud/DecimalScale.h"
#include "core/cloud/ValueText.h"
#include "core/las/Compatible.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace punctum::las
{

namespace
{

using Place = RecordComparer::Place;

constexpr unsigned kClassicClassBits = 0x1F;
constexpr std::size_t kClassicClassByte = 15;

Place placeOf(const RecordLayout& layout, std::size_t attribute)
{
    const Attribute& a = layout.attributes[attribute];
    const RecordField& f = layout.field(layout.attributeFields[attribute][0]);
    Place p;
    p.there = true;
    p.offset = f.offset;
    p.bytes = f.bytes();
    p.type = f.type;
    p.shift = a.bitShift;
    p.width = a.bitWidth;
    p.scaled = a.scaled;
    p.scale = a.scale;
    p.scaleOffset = a.offset;
    p.opaque = a.kind == AttributeKind::Opaque || f.components != 1;
    return p;
}

std::string typeText(const Place& p)
{
    if (!p.there) return {};
    if (p.opaque) return std::to_string(p.bytes) + (p.bytes == 1 ? " byte" : " bytes");
    if (p.width != 0) return std::to_string(p.width) + (p.width == 1 ? " bit" : " bits");
    return std::string(nameOf(p.type));
}

/// Two layouts that put everything in the same place, and mean the same by it.
bool sameLayout(const RecordLayout& a, const RecordLayout& b)
{
    if (a.format != b.format || a.length != b.length || a.attributes.size() != b.attributes.size()) return false;
    for (std::size_t k = 0; k < a.attributes.size(); ++k) {
        const Place p = placeOf(a, k), q = placeOf(b, k);
        if (a.attributes[k].name != b.attributes[k].name || p.offset != q.offset || p.bytes != q.bytes ||
            p.type != q.type || p.shift != q.shift || p.width != q.width || p.scaled != q.scaled ||
            std::bit_cast<std::uint64_t>(p.scale) != std::bit_cast<std::uint64_t>(q.scale) ||
            std::bit_cast<std::uint64_t>(p.scaleOffset) != std::bit_cast<std::uint64_t>(q.scaleOffset))
            return false;
    }
    return true;
}

std::uint64_t load(const Place& p, const std::byte* record)
{
    std::uint64_t bits = 0;
    std::memcpy(&bits, record + p.offset, p.bytes);
    return bits;
}

/// The raw value as T; bit field applied.
template <typename T>
T rawOf(const Place& p, const std::byte* record)
{
    const std::uint64_t bits = load(p, record);
    if (p.width != 0) return T((bits >> p.shift) & ((std::uint64_t(1) << p.width) - 1));
    return visitScalar(p.type, [&](auto zero) {
        decltype(zero) v;
        std::memcpy(&v, &bits, sizeof v);
        return T(v);
    });
}

long double realOf(const Place& p, const std::byte* record)
{
    const auto raw = rawOf<long double>(p, record);
    return p.scaled ? raw * static_cast<long double>(p.scale) + static_cast<long double>(p.scaleOffset) : raw;
}

bool sameReal(long double a, long double b)
{
    return a == b || (std::isnan(a) && std::isnan(b));
}

__extension__ using Wide = __int128;
constexpr Wide kWideLimit = Wide(1) << 124;

/// digits * 10^exponent: the shortest decimal that means this double.
struct Decimal {
    Wide digits = 0;
    int exponent = 0;
};

Decimal decimalOf(double value)
{
    char text[40] = {};  // ends in zeros, where atoi stops
    const char* const end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific).ptr;
    Decimal d;
    const char* p = text;
    const bool negative = *p == '-';
    if (negative) ++p;
    bool fraction = false;
    for (; p != end && *p != 'e'; ++p) {
        if (*p == '.') {
            fraction = true;
            continue;
        }
        d.digits = d.digits * 10 + (*p - '0');
        if (fraction) --d.exponent;
    }
    if (p != end) d.exponent += std::atoi(p + 1);
    if (negative) d.digits = -d.digits;
    if (d.digits == 0) d.exponent = 0;
    return d;
}

/// The digits in units of 10^exponent; false when they do not fit.
bool inUnits(const Decimal& d, int exponent, Wide& result)
{
    result = d.digits;
    for (int k = d.exponent; k > exponent && result != 0; --k) {
        result *= 10;
        if (result > kWideLimit || result < -kWideLimit) return false;
    }
    return true;
}

}  // namespace

void RecordComparer::Tally::add(const Tally& other)
{
    if (counts.empty()) {
        *this = other;
        return;
    }
    differing += other.differing;
    for (std::size_t k = 0; k < other.counts.size(); ++k) {
        counts[k].points += other.counts[k].points;
        if (other.counts[k].first >= counts[k].first) continue;
        counts[k].first = other.counts[k].first;
        a[k] = other.a[k];
        b[k] = other.b[k];
    }
}

RecordComparer::RecordComparer(const RecordLayout& a, const RecordLayout& b)
    : m_a(a), m_b(b), m_same(sameLayout(a, b))
{
    const auto find = [](const RecordLayout& layout, const std::string& name) {
        for (std::size_t k = 0; k < layout.attributes.size(); ++k)
            if (layout.attributes[k].name == name) return int(k);
        return -1;
    };
    const auto onlyOne = [&](Pair& pair, const RecordLayout& other) {
        pair.rule = Rule::Present;
        if (isExtendedFormat(other.shownFormat())) return;
        // The older formats say these in another way, or mean zero.
        pair.implied = pair.name == "Overlap" || pair.name == "ScannerChannel";
        if (pair.name == "Overlap") pair.rule = Rule::Overlap;
    };
    for (std::size_t k = 0; k < a.attributes.size(); ++k) {
        Pair pair;
        pair.name = a.attributes[k].name;
        pair.a = placeOf(a, k);
        if (const int other = find(b, pair.name); other >= 0) {
            pair.b = placeOf(b, std::size_t(other));
            chooseRule(pair);
            if (pair.name == "ScanAngle" && isExtendedFormat(a.shownFormat()) != isExtendedFormat(b.shownFormat()))
                pair.rule = Rule::Angle;
        } else {
            onlyOne(pair, b);
        }
        m_pairs.push_back(std::move(pair));
    }
    for (std::size_t k = 0; k < b.attributes.size(); ++k) {
        if (find(a, b.attributes[k].name) >= 0) continue;
        Pair pair;
        pair.name = b.attributes[k].name;
        pair.b = placeOf(b, k);
        onlyOne(pair, a);
        m_pairs.push_back(std::move(pair));
    }
}

void RecordComparer::chooseRule(Pair& pair)
{
    const Place &a = pair.a, &b = pair.b;
    if (a.opaque || b.opaque) {
        pair.rule = Rule::Bytes;
        return;
    }
    const bool sameScale =
        a.scaled == b.scaled &&
        (!a.scaled ||
         (std::bit_cast<std::uint64_t>(a.scale + 0.0) == std::bit_cast<std::uint64_t>(b.scale + 0.0) &&
          std::bit_cast<std::uint64_t>(a.scaleOffset + 0.0) == std::bit_cast<std::uint64_t>(b.scaleOffset + 0.0)));
    if (sameScale && a.type == b.type && a.shift == b.shift && a.width == b.width) {
        pair.rule = Rule::Bits;
        if (a.width != 0) pair.mask = ((std::uint64_t(1) << a.width) - 1) << a.shift;
        return;
    }
    if (isFloating(a.type) || isFloating(b.type))
        pair.rule = Rule::Real;
    else if (sameScale)
        pair.rule = Rule::Integer;
    else
        pair.rule = alignDecimals(pair) ? Rule::Decimal : Rule::Real;
}

bool RecordComparer::alignDecimals(Pair& pair)
{
    const Decimal scaleA = decimalOf(pair.a.scaled ? pair.a.scale : 1.0);
    const Decimal scaleB = decimalOf(pair.b.scaled ? pair.b.scale : 1.0);
    const Decimal offsetA = decimalOf(pair.a.scaled ? pair.a.scaleOffset : 0.0);
    const Decimal offsetB = decimalOf(pair.b.scaled ? pair.b.scaleOffset : 0.0);
    const int unit = std::min({scaleA.exponent, scaleB.exponent, offsetA.exponent, offsetB.exponent});
    if (!inUnits(scaleA, unit, pair.scaleA) || !inUnits(scaleB, unit, pair.scaleB) ||
        !inUnits(offsetA, unit, pair.offsetA) || !inUnits(offsetB, unit, pair.offsetB))
        return false;
    const auto fits = [](Wide scale, const Place& place) {
        const unsigned bits = place.width != 0 ? place.width : place.bytes * 8;
        return (scale < 0 ? -scale : scale) < (kWideLimit >> bits);
    };
    return fits(pair.scaleA, pair.a) && fits(pair.scaleB, pair.b);
}

bool RecordComparer::differs(const Pair& pair, const std::byte* a, const std::byte* b) const
{
    switch (pair.rule) {
        case Rule::Bits:
            return ((load(pair.a, a) ^ load(pair.b, b)) & pair.mask) != 0;
        case Rule::Bytes:
            return pair.a.bytes != pair.b.bytes ||
                   std::memcmp(a + pair.a.offset, b + pair.b.offset, pair.a.bytes) != 0;
        case Rule::Integer:
            return rawOf<Wide>(pair.a, a) != rawOf<Wide>(pair.b, b);
        case Rule::Decimal:
            return rawOf<Wide>(pair.a, a) * pair.scaleA + pair.offsetA !=
                   rawOf<Wide>(pair.b, b) * pair.scaleB + pair.offsetB;
        case Rule::Real:
            return !sameReal(realOf(pair.a, a), realOf(pair.b, b));
        case Rule::Angle: {
            const bool aClassic = pair.a.type == ScalarType::I8;
            const long degrees = aClassic ? rawOf<long>(pair.a, a) : rawOf<long>(pair.b, b);
            const long steps = aClassic ? rawOf<long>(pair.b, b) : rawOf<long>(pair.a, a);
            return std::lround(double(degrees) / kScanAngleStep) != steps;
        }
        case Rule::Present: {
            const Place& p = pair.a.there ? pair.a : pair.b;
            const std::byte* const record = pair.a.there ? a : b;
            if (!p.opaque && p.width != 0) return rawOf<std::uint64_t>(p, record) != 0;
            return std::any_of(record + p.offset, record + p.offset + p.bytes,
                               [](std::byte x) { return x != std::byte(0); });
        }
        case Rule::Overlap: {
            const bool flag = pair.a.there ? rawOf<unsigned>(pair.a, a) != 0 : rawOf<unsigned>(pair.b, b) != 0;
            const std::byte* const classic = pair.a.there ? b : a;
            const unsigned code = std::to_integer<unsigned>(classic[kClassicClassByte]) & kClassicClassBits;
            return flag != (code == kOverlapClass);
        }
    }
    return false;
}

const std::byte* RecordComparer::expanded(const RecordLayout& layout, const std::byte* record,
                                          std::vector<std::byte>& scratch)
{
    if (!layout.compatible) return record;
    scratch.resize(layout.derived.back().offset + layout.derived.back().bytes());
    expandCompatible(layout, record, scratch.data());
    return scratch.data();
}

void RecordComparer::compare(const std::byte* recordsA, const std::byte* recordsB, std::size_t count,
                             PointIndex first, Tally& tally) const
{
    if (m_same && std::memcmp(recordsA, recordsB, count * m_a.length) == 0) return;
    if (tally.counts.empty()) {
        tally.counts.resize(m_pairs.size());
        tally.a.resize(m_pairs.size());
        tally.b.resize(m_pairs.size());
    }
    std::vector<std::byte> scratchA, scratchB;
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte *a = recordsA + i * m_a.length, *b = recordsB + i * m_b.length;
        if (m_same && std::memcmp(a, b, m_a.length) == 0) continue;
        a = expanded(m_a, a, scratchA);
        b = expanded(m_b, b, scratchB);
        bool any = false;
        for (std::size_t k = 0; k < m_pairs.size(); ++k) {
            const Pair& pair = m_pairs[k];
            if (!differs(pair, a, b)) continue;
            any = any || pair.rule != Rule::Present;
            Tally::Count& c = tally.counts[k];
            ++c.points;
            if (first + i >= c.first) continue;
            c.first = first + i;
            tally.a[k] = told(pair.a, a);
            tally.b[k] = told(pair.b, b);
        }
        tally.differing += any ? 1 : 0;
    }
}

ToldValue RecordComparer::told(const Place& place, const std::byte* record) const
{
    if (!place.there) return std::monostate{};
    char text[64];
    if (place.opaque) {
        constexpr std::uint32_t kMost = 16;
        std::string hex;
        for (std::uint32_t k = 0; k < std::min(place.bytes, kMost); ++k) {
            std::snprintf(text, sizeof text, "%02x", std::to_integer<unsigned>(record[place.offset + k]));
            hex += text;
        }
        return place.bytes > kMost ? hex + "..." : hex;
    }
    if (place.scaled) {
        const DecimalScale steps(place.scale, place.scaleOffset);
        return visitScalar(place.type,
                           [&](auto zero) -> ToldValue { return steps(rawOf<decltype(zero)>(place, record)); });
    }
    if (place.width != 0) return rawOf<std::uint64_t>(place, record);
    return visitScalar(place.type, [&](auto zero) -> ToldValue {
        using T = decltype(zero);
        const T v = rawOf<T>(place, record);
        if constexpr (std::is_floating_point_v<T>) {
            if (!std::isnan(v)) {
                if constexpr (sizeof(T) == 8) return double(v);
                // the digits that tell floats apart, not those of the double around one
                return std::strtod(shortestText(v).c_str(), nullptr);
            }
            std::snprintf(text, sizeof text, "NaN (0x%llx)", static_cast<unsigned long long>(load(place, record)));
            return std::string(text);
        } else if constexpr (std::is_signed_v<T>) {
            return std::int64_t(v);
        } else {
            return std::uint64_t(v);
        }
    });
}

std::vector<AttributeDifference> RecordComparer::differences(const Tally& tally) const
{
    std::vector<AttributeDifference> list;
    for (std::size_t k = 0; k < m_pairs.size(); ++k) {
        const Pair& pair = m_pairs[k];
        AttributeDifference d;
        d.name = pair.name;
        d.typeA = typeText(pair.a);
        d.typeB = typeText(pair.b);
        if (!pair.implied) {
            if (!pair.b.there) d.change = AttributeDifference::Change::Removed;
            if (!pair.a.there) d.change = AttributeDifference::Change::Added;
        } else {
            d.typeA = d.typeB = pair.a.there ? d.typeA : d.typeB;
        }
        if (!tally.counts.empty() && tally.counts[k].points != 0) {
            d.points = tally.counts[k].points;
            d.first = tally.counts[k].first;
            d.a = tally.a[k];
            d.b = tally.b[k];
        }
        if (d.points != 0 || d.change != AttributeDifference::Change::Changed || d.typeDiffers())
            list.push_back(std::move(d));
    }
    return list;
}

}  // namespace punctum::las
