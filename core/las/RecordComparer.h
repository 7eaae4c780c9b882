// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Difference.h"
#include "core/las/PointFormat.h"

#include <cstddef>
#include <string>
#include <vector>

namespace punctum::las
{

/// Compares point records of two layouts, attribute by attribute.
///
/// Attributes of the same name are the same. Values that both store alike are compared bit by bit, so that NaN
/// payloads and negative zeros count. Otherwise by meaning: whole numbers exactly (never through a double), scaled
/// ones in exact decimal arithmetic, in which the scale 0.01 is a hundredth; the scan angle of the formats 0 to 5,
/// whole degrees, is the nearest step of 0.006 degrees; class 12 of these formats means the overlap flag, and they
/// have scanner channel 0 (LAS 1.4 R15, 2.6).
/// Immutable once made; compare() may be called from several threads, each with a Tally of its own.
class RecordComparer
{
public:
    /// What was found: for each attribute pair, the points that differ.
    struct Tally {
        struct Count {
            std::uint64_t points = 0;
            PointIndex first = ~PointIndex(0);
        };
        std::vector<Count> counts;
        std::vector<ToldValue> a, b;  ///< values at each first point
        PointIndex differing = 0;     ///< points of which any attribute differs that both have

        void add(const Tally& other);
    };

    RecordComparer(const RecordLayout& a, const RecordLayout& b);

    /// Compares `count` records; `first` is the index of the first of them. Adds to `tally`.
    void compare(const std::byte* a, const std::byte* b, std::size_t count, PointIndex first, Tally& tally) const;
    /// The attributes that differ in kind or of which points do, in the order of A, then what only B has.
    std::vector<AttributeDifference> differences(const Tally& tally) const;

    /// Where the value of an attribute is in a record, and what it means.
    struct Place {
        bool there = false;
        std::uint32_t offset = 0;
        std::uint32_t bytes = 0;  ///< more than 8 only for opaque ones
        ScalarType type = ScalarType::U8;
        std::uint8_t shift = 0, width = 0;  ///< width 0: the whole value
        bool scaled = false;
        double scale = 1.0, scaleOffset = 0.0;
        bool opaque = false;
    };

private:
    enum class Rule {
        Bits,     ///< the same bits in both
        Bytes,    ///< opaque
        Integer,  ///< exact whole numbers
        Decimal,  ///< scaled integers
        Real,     ///< anything else, in long double, which holds all 64-bit integers and doubles
        Angle,    ///< degrees of formats 0-5 and steps of formats 6-10
        Present,  ///< only one has it: whether it is not zero
        Overlap,  ///< only one has it: class 12 in the other
    };
    __extension__ using Wide = __int128;
    struct Pair {
        std::string name;
        Rule rule = Rule::Bits;
        Place a, b;
        std::uint64_t mask = ~std::uint64_t(0);
        Wide scaleA = 1, offsetA = 0, scaleB = 1, offsetB = 0;  ///< Decimal: in the same power of ten
        bool implied = false;  ///< one layout has no field of that name because its format implies the value
    };

    void addPair(Pair pair);
    static void chooseRule(Pair& pair);
    static bool alignDecimals(Pair& pair);
    bool differs(const Pair& pair, const std::byte* a, const std::byte* b) const;
    ToldValue told(const Place& place, const std::byte* record) const;

    /// The record with what it means behind it, where the layout has such columns.
    static const std::byte* expanded(const RecordLayout& layout, const std::byte* record,
                                     std::vector<std::byte>& scratch);

    RecordLayout m_a, m_b;
    std::vector<Pair> m_pairs;
    bool m_same = false;  ///< the layouts are equal: equal records need no further look
};

}  // namespace punctum::las
