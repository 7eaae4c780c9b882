// SPDX-License-Identifier: MIT
#include "core/survey/Grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace punctum
{

namespace
{

constexpr double kMostSteps = 0x1p31 * 0.99;  ///< from the offset to the farthest point
constexpr int kFiner = 3;                     ///< decimals that are added for exact coordinates

/// The whole number that a quotient of decimals means; nothing where it is none.
bool isWhole(double v)
{
    return std::abs(v - std::round(v)) < 1e-6 && std::abs(v) < 0x1p52;
}

/// Whether a quotient of steps is a whole number: it is multiplied by coordinates of up to 2^31 steps, so that what
/// a scale that once was a float differs by (0.01f, 2e-8) would be many steps.
bool isFactor(double v)
{
    constexpr double kOfDecimals = 1e-13;  // rounding of decimals and their quotient, relative
    const double whole = std::round(v);
    return whole != 0.0 && std::abs(whole) < 0x1p31 && std::abs(v - whole) <= kOfDecimals * std::abs(whole);
}

bool isExact(const CoordinateScale& from, const CoordinateScale& to, int axis)
{
    return isFactor(from.scale[axis] / to.scale[axis]) &&
           isWhole((from.offset[axis] - to.offset[axis]) / to.scale[axis]);
}

/// Whether an axis of the grid reaches from `low` to `high`.
bool holds(double scale, double offset, double low, double high)
{
    const double step = std::abs(scale);
    return std::abs(low - offset) / step < kMostSteps && std::abs(high - offset) / step < kMostSteps;
}

/// An axis of the grid that makes the coordinates of most points whole: of the steps that files have, the finest of
/// the best.
void chooseAxis(std::span<const GridOfPart> parts, const CoordinateScale& most, const WorldBounds& all, int axis,
                CoordinateScale& grid)
{
    const auto fits = [&](double scale, double offset) {
        return all.empty() || holds(scale, offset, all.min[axis], all.max[axis]);
    };
    /// With this step, from the offset of most points or, where it does not reach, from the middle.
    const auto place = [&](double scale) {
        CoordinateScale at = grid;
        at.scale[axis] = scale;
        at.offset[axis] = most.offset[axis];
        if (!fits(scale, at.offset[axis]))
            at.offset[axis] +=
                std::round((0.5 * (all.min[axis] + all.max[axis]) - at.offset[axis]) / scale) * scale;
        return at;
    };
    const auto inexact = [&](const CoordinateScale& at) {
        PointIndex points = 0;
        for (const GridOfPart& part : parts)
            if (!isExact(part.coordinates, at, axis)) points += part.points;
        return points;
    };
    std::set<double> steps;
    for (const GridOfPart& part : parts)
        if (part.points != 0) steps.insert(std::abs(part.coordinates.scale[axis]));
    steps.insert(std::abs(most.scale[axis]));
    CoordinateScale best = place(*steps.rbegin());
    while (!fits(best.scale[axis], best.offset[axis])) best = place(best.scale[axis] * 10.0);
    PointIndex fewest = inexact(best);
    const auto consider = [&](double scale) {
        const CoordinateScale at = place(scale);
        if (!fits(scale, at.offset[axis])) return false;
        if (const PointIndex n = inexact(at); n < fewest || (n == fewest && steps.contains(scale))) {
            fewest = n;
            best = at;
        }
        return true;
    };
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) consider(*step);
    double finer = best.scale[axis];
    for (int k = 0; k < kFiner && fewest != 0; ++k)
        if (!consider(finer /= 10.0)) break;
    // what is rounded, is rounded to no more than a step of its own, where there is room
    while (fewest != 0 && std::any_of(parts.begin(), parts.end(), [&](const GridOfPart& part) {
               return part.points != 0 && std::abs(part.coordinates.scale[axis]) < 0.99 * best.scale[axis];
           })) {
        const CoordinateScale at = place(best.scale[axis] / 10.0);
        if (!fits(at.scale[axis], at.offset[axis]) || inexact(at) > fewest) break;
        best = at;
    }
    grid.scale[axis] = best.scale[axis];
    grid.offset[axis] = best.offset[axis];
}

}  // namespace

CommonGrid commonGrid(std::span<const GridOfPart> parts)
{
    using Key = std::tuple<double, double, double, double, double, double>;
    std::map<Key, PointIndex> points;
    WorldBounds all;
    const CoordinateScale* most = &parts.front().coordinates;
    PointIndex count = 0;
    for (const GridOfPart& part : parts) {
        const CoordinateScale& c = part.coordinates;
        PointIndex& n = points[{c.scale.x, c.scale.y, c.scale.z, c.offset.x, c.offset.y, c.offset.z}];
        n += part.points;
        if (n > count) {
            count = n;
            most = &c;
        }
        all.include(part.bounds);
    }
    CommonGrid grid;
    const auto reaches = [&](int axis) {
        return all.empty() || holds(most->scale[axis], most->offset[axis], all.min[axis], all.max[axis]);
    };
    // The files' own coordinates fit, however strange their headers are; those from another system need not.
    const bool moved = std::any_of(parts.begin(), parts.end(),
                                   [](const GridOfPart& part) { return part.points == 0 && !part.bounds.empty(); });
    if (points.size() == 1 && (!moved || (reaches(0) && reaches(1) && reaches(2)))) {
        grid.coordinates = *most;
        return grid;
    }
    for (int axis = 0; axis < 3; ++axis) chooseAxis(parts, *most, all, axis, grid.coordinates);
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k].points != 0 && !GridChange(parts[k].coordinates, grid.coordinates).exact())
            grid.rounded.push_back(k);
    return grid;
}

GridChange::GridChange(const CoordinateScale& from, const CoordinateScale& to)
    : m_same(from.scale == to.scale && from.offset == to.offset)
{
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = std::size_t(axis);
        m_ratio[a] = from.scale[axis] / to.scale[axis];
        m_offset[a] = (from.offset[axis] - to.offset[axis]) / to.scale[axis];
        m_whole[a] = isExact(from, to, axis);
        m_factor[a] = std::llround(std::clamp(m_ratio[a], -0x1p31, 0x1p31));
        m_shift[a] = std::llround(std::clamp(m_offset[a], -0x1p52, 0x1p52));
    }
}

std::size_t GridChange::operator()(int axis, std::span<const std::int32_t> from, std::int32_t* to) const noexcept
{
    constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min(),
                           kMost = std::numeric_limits<std::int32_t>::max();
    const auto a = std::size_t(axis);
    std::size_t beyond = 0;
    if (m_whole[a]) {
        const std::int64_t factor = m_factor[a], shift = m_shift[a];
        for (std::size_t i = 0; i < from.size(); ++i) {
            const std::int64_t v = from[i] * factor + shift, c = std::clamp(v, kLeast, kMost);
            beyond += std::size_t(v != c);
            to[i] = std::int32_t(c);
        }
        return beyond;
    }
    const double ratio = m_ratio[a], offset = m_offset[a];
    for (std::size_t i = 0; i < from.size(); ++i) {
        const double v = std::floor(from[i] * ratio + offset + 0.5);
        const double c = std::clamp(v, double(kLeast), double(kMost));
        beyond += std::size_t(!(v == c));
        to[i] = c == c ? std::int32_t(c) : 0;
    }
    return beyond;
}

}  // namespace punctum
