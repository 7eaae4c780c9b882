// SPDX-License-Identifier: MIT
#include "core/process/Reclassify.h"

#include "core/Error.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/ValueText.h"
#include "core/edit/ClassCommand.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace punctum
{

namespace
{

/// Raw values from `min` to `max`, both included, less one: how a column's values are matched.
template <typename T>
struct RawRange {
    T min{};
    T max{};
    bool empty = false;
    bool hasNoData = false;
    T noData{};
};

/// Smallest whole number >= v as T, or nothing above T's range; and the largest <= v.
template <typename T>
bool ceilTo(const Value& v, T& out)
{
    using Limits = std::numeric_limits<T>;
    return std::visit(
        [&](auto bound) {
            if constexpr (std::is_floating_point_v<decltype(bound)>) {
                const double up = std::ceil(bound);
                // 2^digits is exact in a double, where T's own maximum may not be
                if (!(up < std::ldexp(1.0, Limits::digits))) return false;
                out = up <= double(Limits::min()) ? Limits::min() : T(up);
            } else {
                if (std::cmp_greater(bound, Limits::max())) return false;
                out = std::cmp_less(bound, Limits::min()) ? Limits::min() : T(bound);
            }
            return true;
        },
        v);
}

template <typename T>
bool floorTo(const Value& v, T& out)
{
    using Limits = std::numeric_limits<T>;
    return std::visit(
        [&](auto bound) {
            if constexpr (std::is_floating_point_v<decltype(bound)>) {
                const double down = std::floor(bound);
                if (!(down >= double(Limits::min()))) return false;
                out = down >= std::ldexp(1.0, Limits::digits) ? Limits::max() : T(down);
            } else {
                if (std::cmp_less(bound, Limits::min())) return false;
                out = std::cmp_greater(bound, Limits::max()) ? Limits::max() : T(bound);
            }
            return true;
        },
        v);
}

/// The raw values whose scaled value lies from min to max, as real bounds.
void unscale(const Attribute& a, Value& min, Value& max, bool& empty)
{
    const double lo = toDouble(min), hi = toDouble(max);
    if (a.scale == 0.0 || !std::isfinite(a.scale) || !std::isfinite(a.offset)) {
        // every point has one and the same value, or none has any
        empty = !(a.scale == 0.0 && a.offset >= lo && a.offset <= hi);
        min = -std::numeric_limits<double>::infinity();
        max = std::numeric_limits<double>::infinity();
        return;
    }
    double rawLo = (lo - a.offset) / a.scale, rawHi = (hi - a.offset) / a.scale;
    if (a.scale < 0.0) std::swap(rawLo, rawHi);
    constexpr double kSlack = 1e-6;  // of a step: bounds are typed in decimals, scale factors are binary fractions
    min = rawLo - kSlack;
    max = rawHi + kSlack;
}

template <typename T>
RawRange<T> rawRange(const Attribute& a, Value min, Value max)
{
    RawRange<T> range;
    if constexpr (std::is_integral_v<T>) {
        if (a.scaled) unscale(a, min, max, range.empty);
        range.empty = range.empty || !ceilTo(min, range.min) || !floorTo(max, range.max) || range.min > range.max;
    }
    if (a.noData)
        std::visit(
            [&](auto v) {
                const double d = double(v);
                if constexpr (std::is_integral_v<T>) {
                    if constexpr (std::is_integral_v<decltype(v)>) {
                        if (!std::in_range<T>(v)) return;
                    } else if (!(d >= double(std::numeric_limits<T>::min()) &&
                                 d < std::ldexp(1.0, std::numeric_limits<T>::digits)) ||
                               d != std::floor(d)) {
                        return;
                    }
                } else if (std::isnan(d)) {
                    return;  // NaN never matches anyway
                }
                range.hasNoData = true;
                range.noData = T(v);
            },
            *a.noData);
    return range;
}

/// Sets the bits of words [firstWord, lastWord) for which match(i) is 1; match must not branch, to be vectorized.
template <typename Match>
void setWords(PointSet& points, std::size_t firstWord, std::size_t lastWord, Match match)
{
    for (std::size_t w = firstWord; w < lastWord; ++w) {
        alignas(64) std::uint8_t flags[64] = {};
        const PointIndex base = PointIndex(w) * 64;
        const PointIndex n = std::min<PointIndex>(64, points.size() - base);
        if (n == 64)
            for (unsigned j = 0; j < 64; ++j) flags[j] = match(base + j);
        else
            for (unsigned j = 0; j < n; ++j) flags[j] = match(base + j);
        points.words()[w] = packFlags(flags);
    }
}

/// The points of words [firstWord, lastWord) that match and do not have the class yet.
template <typename T>
void matchWords(const Attribute& a, const RawRange<T>& range, double min, double max, const Attribute& classes,
                std::uint8_t code, PointSet& points, std::size_t firstWord, std::size_t lastWord)
{
    const T* const raw = a.columns[0]->values<T>().data();
    const std::uint8_t* const byte = classes.columns[0]->values<std::uint8_t>().data();
    const std::uint8_t classMask = std::uint8_t(classes.maxBits() << classes.bitShift);
    const std::uint8_t classBits = std::uint8_t(code << classes.bitShift);
    // A code that the field cannot hold is not there yet.
    const std::uint8_t beyond = std::uint8_t(code > classes.maxBits());
    const auto other = [=](PointIndex i) {
        return std::uint8_t(std::uint8_t((byte[i] & classMask) != classBits) | beyond);
    };
    if constexpr (std::is_floating_point_v<T>) {
        const bool scaled = a.scaled;
        const double scale = a.scale, offset = a.offset;
        if (scaled)
            setWords(points, firstWord, lastWord, [=](PointIndex i) {
                const double v = double(raw[i]) * scale + offset;
                const bool none = range.hasNoData & (raw[i] == range.noData);
                return std::uint8_t(std::uint8_t(v >= min) & std::uint8_t(v <= max) & std::uint8_t(!none) &
                                    other(i));
            });
        else
            setWords(points, firstWord, lastWord, [=](PointIndex i) {
                const double v = double(raw[i]);
                const bool none = range.hasNoData & (raw[i] == range.noData);
                return std::uint8_t(std::uint8_t(v >= min) & std::uint8_t(v <= max) & std::uint8_t(!none) &
                                    other(i));
            });
    } else if (a.bitWidth != 0) {
        const T mask = T(a.maxBits());
        const unsigned shift = a.bitShift;
        setWords(points, firstWord, lastWord, [=](PointIndex i) {
            const T v = T((std::make_unsigned_t<T>(raw[i]) >> shift) & std::make_unsigned_t<T>(mask));
            const bool none = range.hasNoData & (v == range.noData);
            return std::uint8_t(std::uint8_t(v >= range.min) & std::uint8_t(v <= range.max) & std::uint8_t(!none) &
                                other(i));
        });
    } else {
        setWords(points, firstWord, lastWord, [=](PointIndex i) {
            const T v = raw[i];
            const bool none = range.hasNoData & (v == range.noData);
            return std::uint8_t(std::uint8_t(v >= range.min) & std::uint8_t(v <= range.max) & std::uint8_t(!none) &
                                other(i));
        });
    }
}

Attribute scalarAttribute(const PointCloud& cloud, const std::string& name)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute(name);
    if (found == nullptr) throw Error("reclassify: this cloud has no attribute \"" + name + "\".");
    if (found->components != 1)
        throw Error("reclassify: " + name + " has three components; choose one of them, such as " +
                    found->columns[0]->name() + ".");
    if (found->kind == AttributeKind::Opaque || found->columns[0]->components() != 1)
        throw Error("reclassify: " + name +
                    " holds bytes that the file does not describe; choose another attribute.");
    return *found;
}

}  // namespace

std::string ReclassifyStep::help() const
{
    return "Gives a class to all points whose value of an attribute lies in a range, ends included.";
}

std::vector<StepParameter> ReclassifyStep::parameters() const
{
    using Type = StepParameter::Type;
    std::vector<StepParameter> p(4);
    p[0].key = "attribute";
    p[0].label = "Attribute";
    p[0].help = "The attribute whose values decide.";
    p[0].type = Type::AttributeName;
    p[1].key = "min";
    p[1].label = "From";
    p[1].help = "Lowest value of the range.";
    p[2].key = "max";
    p[2].label = "To";
    p[2].help = "Highest value of the range.";
    p[3].key = "class";
    p[3].label = "Class";
    p[3].help = "The class these points get.";
    p[3].type = Type::ClassCode;
    return p;
}

std::unique_ptr<Command> ReclassifyStep::run(const PointCloud& cloud, const StepValues& values,
                                             Progress& progress) const
{
    const StepValues complete = completeValues(*this, values);
    const Value min = *parseNumber(complete.at("min")), max = *parseNumber(complete.at("max"));
    double realMin = toDouble(min), realMax = toDouble(max);
    if (realMin > realMax)
        throw Error("reclassify: min is " + complete.at("min") + ", which is above max, " + complete.at("max") +
                    ".");
    const auto code = std::uint32_t(*integerValue(complete, "class"));
    const Attribute attribute = scalarAttribute(cloud, complete.at("attribute"));
    realMin = typedValue(attribute, realMin);
    realMax = typedValue(attribute, realMax);
    const Attribute classes = classAttribute(cloud, code);

    progress.begin("Reclassifying", cloud.size());
    auto points = std::make_shared<PointSet>(cloud.size());
    visitScalar(attribute.type(), [&](auto zero) {
        using T = decltype(zero);
        const auto range = rawRange<T>(attribute, min, max);
        if (range.empty) return;
        forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
            matchWords<T>(attribute, range, realMin, realMax, classes, std::uint8_t(code), *points, first, last);
        });
    });
    if (const auto deleted = deletedPoints(cloud)) points->remove(*deleted);
    return makeClassCommand("Reclassify to " + classLabel(code), classes, std::move(points), code);
}

}  // namespace punctum
