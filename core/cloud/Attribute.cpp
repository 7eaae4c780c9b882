// SPDX-License-Identifier: MIT
#include "core/cloud/Attribute.h"

#include "core/cloud/DecimalScale.h"
#include "core/cloud/PointSet.h"
#include "core/cloud/ValueText.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace punctum
{

namespace
{

/// Points handled between two looks at the cancel flag.
constexpr PointIndex kGrain = 1 << 16;

/// Raw element of component `c`, bit field applied; T is the column's type.
template <typename T>
struct RawReader {
    const T* data;
    std::uint32_t stride;
    std::uint8_t shift;
    std::uint8_t width;

    RawReader(const Attribute& a, std::uint32_t component)
        : data(reinterpret_cast<const T*>(a.columns[component]->data())),
          stride(a.columns[component]->components()),
          shift(a.bitShift),
          width(a.bitWidth)
    {
    }
    T operator()(PointIndex i) const noexcept
    {
        const T raw = data[i * stride];
        if constexpr (std::is_integral_v<T>) {
            if (width != 0) return bits(raw);
        }
        return raw;
    }
    /// The field's bits of an element; width is not 0.
    T bits(T raw) const noexcept requires std::is_integral_v<T>
    {
        using U = std::make_unsigned_t<T>;
        return T(U(U(raw) >> shift) & U((std::uint64_t(1) << width) - 1));
    }
};

template <typename T>
bool isNoData(const Attribute& a, T raw)
{
    if (!a.noData) return false;
    return std::visit(
        [raw](auto v) {
            // A no-data value of NaN means all NaN; integers are compared as such, so that 64 bits stay exact.
            if constexpr (std::is_integral_v<T> && std::is_integral_v<decltype(v)>)
                return std::cmp_equal(raw, v);
            else
                return double(raw) == double(v) || (std::isnan(double(v)) && std::isnan(double(raw)));
        },
        *a.noData);
}

/// Calls none(i) for the points of the range that have no value, since their file lacks the attribute and no edit
/// has given them one.
template <typename T, typename F>
void forEachWithoutValue(const Column& column, const RawReader<T>& raw, PointRange range, const F& none)
{
    const std::vector<PointRange>& absent = column.absent();  // thousands, where there are as many files
    auto lacking = std::upper_bound(absent.begin(), absent.end(), range.first,
                                    [](PointIndex p, const PointRange& r) { return p < r.last; });
    for (; lacking != absent.end() && lacking->first < range.last; ++lacking) {
        const PointIndex last = std::min(lacking->last, range.last);
        for (PointIndex i = std::max(lacking->first, range.first); i < last; ++i)
            if (raw(i) == T(0)) none(i);
    }
}

/// The same of one point.
template <typename T>
bool hasNoValue(const Column& column, const RawReader<T>& raw, PointIndex i)
{
    return !column.absent().empty() && raw(i) == T(0) && column.isAbsent(i);
}

DecimalScale stepsOf(const Attribute& a)
{
    return a.scaled ? DecimalScale(a.scale, a.offset) : DecimalScale();
}

/// `steps`: stepsOf(a).
template <typename T>
double numberOf(const Attribute& a, const DecimalScale& steps, T raw)
{
    if (isNoData(a, raw)) return std::numeric_limits<double>::quiet_NaN();
    return a.scaled ? steps(raw) : double(raw);
}

template <typename T>
Value valueOf(const Attribute& a, T raw)
{
    if (a.scaled) return stepsOf(a)(raw);
    if constexpr (std::is_floating_point_v<T>)
        return double(raw);
    else if constexpr (std::is_signed_v<T>)
        return std::int64_t(raw);
    else
        return std::uint64_t(raw);
}

/// Extremes and sum of raw values of one type; kept raw so that 64-bit integers stay exact.
template <typename T>
struct Extremes {
    T min{};
    T max{};
    long double sum = 0;
    std::uint64_t count = 0;

    void include(T v) noexcept
    {
        if (count == 0 || v < min) min = v;
        if (count == 0 || v > max) max = v;
        ++count;
    }
    void include(const Extremes& o) noexcept
    {
        if (o.count == 0) return;
        min = count == 0 ? o.min : std::min(min, o.min);
        max = count == 0 ? o.max : std::max(max, o.max);
        sum += o.sum;
        count += o.count;
    }
};

}  // namespace

double toDouble(const Value& value) noexcept
{
    return std::visit([](auto v) { return double(v); }, value);
}

std::string toText(const Value& value)
{
    if (const auto* const number = std::get_if<double>(&value)) return shortestText(*number);
    return std::visit([](auto v) { return std::to_string(v); }, value);
}

Value Attribute::value(PointIndex index, std::uint32_t component) const
{
    return visitScalar(columns[component]->type(), [&](auto zero) {
        return valueOf(*this, RawReader<decltype(zero)>(*this, component)(index));
    });
}

double Attribute::number(PointIndex index, std::uint32_t component) const
{
    return visitScalar(columns[component]->type(), [&](auto zero) {
        const RawReader<decltype(zero)> raw(*this, component);
        return hasNoValue(*columns[component], raw, index) ? std::numeric_limits<double>::quiet_NaN()
                                                           : numberOf(*this, stepsOf(*this), raw(index));
    });
}

bool Attribute::lacks(PointIndex index, std::uint32_t component) const
{
    return visitScalar(columns[component]->type(), [&](auto zero) {
        return hasNoValue(*columns[component], RawReader<decltype(zero)>(*this, component), index);
    });
}

std::uint64_t Attribute::maxBits() const noexcept
{
    const unsigned width = bitWidth != 0 ? bitWidth : unsigned(sizeOf(type()) * 8);
    return width >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << width) - 1;
}

void Attribute::read(PointRange range, double* out, std::uint32_t component) const
{
    readStored(range, out, component);
    if (columns[component]->absent().empty()) return;
    visitScalar(columns[component]->type(), [&](auto zero) {
        forEachWithoutValue(*columns[component], RawReader<decltype(zero)>(*this, component), range,
                            [&](PointIndex i) { out[i - range.first] = std::numeric_limits<double>::quiet_NaN(); });
    });
}

void Attribute::readStored(PointRange range, double* out, std::uint32_t component) const
{
    visitScalar(columns[component]->type(), [&](auto zero) {
        using T = decltype(zero);
        const RawReader<T> raw(*this, component);
        const DecimalScale steps = stepsOf(*this);
        if (noData || raw.stride != 1) {
            for (PointIndex i = range.first; i < range.last; ++i) *out++ = numberOf(*this, steps, raw(i));
            return;
        }
        // said apart, so that they become loops over vectors
        const T* const values = raw.data + range.first;
        const auto n = std::size_t(range.size());
        if constexpr (std::is_integral_v<T>) {
            if (raw.width != 0 && !scaled) {
                for (std::size_t k = 0; k < n; ++k) out[k] = double(raw.bits(values[k]));
                return;
            }
        }
        if (scaled && raw.width != 0)
            for (std::size_t k = 0; k < n; ++k) out[k] = steps(raw(range.first + k));
        else if (scaled)
            for (std::size_t k = 0; k < n; ++k) out[k] = steps(values[k]);
        else
            for (std::size_t k = 0; k < n; ++k) out[k] = double(values[k]);
    });
}

namespace
{

/// Indices of consecutive points, as a list would give them.
struct Consecutive {
    PointRange range;
    std::size_t size() const noexcept { return std::size_t(range.size()); }
    PointIndex operator[](std::size_t k) const noexcept { return range.first + k; }
};

template <typename Indices>
void gatherNumbers(const Attribute& a, const Indices& indices, double bias, float* out, std::uint32_t component)
{
    visitScalar(a.columns[component]->type(), [&](auto zero) {
        const RawReader<decltype(zero)> raw(a, component);
        const DecimalScale steps = stepsOf(a);
        for (std::size_t k = 0; k < indices.size(); ++k) out[k] = float(numberOf(a, steps, raw(indices[k])) - bias);
        if (a.columns[component]->absent().empty()) return;
        for (std::size_t k = 0; k < indices.size(); ++k)
            if (hasNoValue(*a.columns[component], raw, indices[k]))
                out[k] = std::numeric_limits<float>::quiet_NaN();
    });
}

template <typename Indices, typename Out>
void gatherRawBits(const Attribute& a, const Indices& indices, Out* out, std::uint32_t component)
{
    visitScalar(a.columns[component]->type(), [&](auto zero) {
        using T = decltype(zero);
        const RawReader<T> raw(a, component);
        if constexpr (std::is_integral_v<T>) {
            if (raw.stride != 1) {
                for (std::size_t k = 0; k < indices.size(); ++k) out[k] = Out(raw(indices[k]));
                return;
            }
            // said apart, so that they become loops over vectors
            if (raw.width == 0)
                for (std::size_t k = 0; k < indices.size(); ++k) out[k] = Out(raw.data[indices[k]]);
            else
                for (std::size_t k = 0; k < indices.size(); ++k) out[k] = Out(raw.bits(raw.data[indices[k]]));
        } else {
            std::fill_n(out, indices.size(), Out(0));
        }
    });
}

}  // namespace

void Attribute::gather(std::span<const std::uint32_t> indices, double bias, float* out,
                       std::uint32_t component) const
{
    gatherNumbers(*this, indices, bias, out, component);
}

void Attribute::gather(PointRange range, double bias, float* out, std::uint32_t component) const
{
    gatherNumbers(*this, Consecutive{range}, bias, out, component);
}

void Attribute::gatherBits(std::span<const std::uint32_t> indices, std::uint32_t* out,
                           std::uint32_t component) const
{
    gatherRawBits(*this, indices, out, component);
}

void Attribute::gatherBits(PointRange range, std::uint32_t* out, std::uint32_t component) const
{
    gatherRawBits(*this, Consecutive{range}, out, component);
}

void Attribute::gatherBits(PointRange range, std::uint8_t* out, std::uint32_t component) const
{
    gatherRawBits(*this, Consecutive{range}, out, component);
}

AttributeStatistics computeStatistics(const Attribute& attribute, std::uint32_t component, Progress& progress,
                                      const PointSet* leftOut)
{
    return visitScalar(attribute.columns[component]->type(), [&](auto zero) {
        using T = decltype(zero);
        const RawReader<T> raw(attribute, component);
        const auto all = tbb::parallel_reduce(
            tbb::blocked_range<PointIndex>(0, attribute.size(), kGrain), Extremes<T>{},
            [&](const tbb::blocked_range<PointIndex>& r, Extremes<T> e) {
                if (progress.cancelled()) return e;
                double sum = 0;
                const bool plain = !attribute.noData, every = leftOut == nullptr;
                const Column& column = *attribute.columns[component];
                for (PointIndex i = r.begin(); i != r.end(); ++i) {
                    if (!every && leftOut->contains(i)) continue;
                    const T v = raw(i);
                    if constexpr (std::is_floating_point_v<T>)
                        if (std::isnan(v)) continue;
                    if (!plain && isNoData(attribute, v)) continue;
                    if (hasNoValue(column, raw, i)) continue;
                    e.include(v);
                    sum += double(v);
                }
                e.sum += sum;
                return e;
            },
            [](Extremes<T> a, const Extremes<T>& b) {
                a.include(b);
                return a;
            });
        progress.check();
        AttributeStatistics s;
        if (all.count == 0) return s;
        s.count = all.count;
        s.min = valueOf(attribute, all.min);
        s.max = valueOf(attribute, all.max);
        s.mean = double(all.sum / static_cast<long double>(all.count));
        if (attribute.scaled) s.mean = s.mean * attribute.scale + attribute.offset;
        if (attribute.scaled && attribute.scale < 0) std::swap(s.min, s.max);
        return s;
    });
}

std::array<std::uint64_t, 256> countValues(const Attribute& attribute, Progress& progress, const PointSet* leftOut)
{
    using Counts = std::array<std::uint64_t, 256>;
    return visitScalar(attribute.columns[0]->type(), [&](auto zero) {
        using T = decltype(zero);
        const RawReader<T> raw(attribute, 0);
        const Counts counts = tbb::parallel_reduce(
            tbb::blocked_range<PointIndex>(0, attribute.size(), kGrain), Counts{},
            [&](const tbb::blocked_range<PointIndex>& r, Counts c) {
                if constexpr (std::is_integral_v<T>)
                    if (!progress.cancelled())
                        for (PointIndex i = r.begin(); i != r.end(); ++i)
                            if ((leftOut == nullptr || !leftOut->contains(i)) &&
                                !hasNoValue(*attribute.columns[0], raw, i))
                                ++c[std::min<std::uint64_t>(255, std::uint64_t(raw(i)))];
                return c;
            },
            [](Counts a, const Counts& b) {
                for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
                return a;
            });
        progress.check();
        return counts;
    });
}

}  // namespace punctum
