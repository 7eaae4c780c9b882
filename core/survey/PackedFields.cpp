// SPDX-License-Identifier: MIT
#include "core/survey/PackedFields.h"

#include "core/Text.h"
#include "core/las/FormatNeeds.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

void toExtended(const ClassicFields& from, const ExtendedFields& to, std::size_t count) noexcept
{
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t r = from.returns[i], c = from.classes[i];
        to.returns[i] = std::uint8_t((r & 7u) | ((r >> 3u) & 7u) << 4u);
        to.flags[i] = std::uint8_t((c >> 5u) | (r & 0xC0u));
        to.classification[i] = std::uint8_t(c & 31u);
        to.angle[i] = std::int16_t(std::lround(double(from.angle[i]) / las::kScanAngleStep));
    }
}

ClassicMisfits toClassic(const ExtendedFields& from, const ClassicFields& to, std::size_t count) noexcept
{
    ClassicMisfits misfits;
    for (std::size_t i = 0; i < count; ++i) {
        const unsigned number = from.returns[i] & 15u, of = from.returns[i] >> 4u, flags = from.flags[i];
        const std::uint8_t cls = from.classification[i];
        const long angle = std::lround(double(from.angle[i]) * las::kScanAngleStep);
        misfits.returns += PointIndex(number > las::kMostOldReturns || of > las::kMostOldReturns);
        misfits.flags += PointIndex((flags & 0x38u) != 0);
        misfits.classes += PointIndex(cls > las::kHighestOldClass);
        misfits.angles += PointIndex(angle < -128 || angle > 127 ||
                                     std::lround(double(angle) / las::kScanAngleStep) != from.angle[i]);
        to.returns[i] = std::uint8_t((number & 7u) | (of & 7u) << 3u | (flags & 0xC0u));
        to.classes[i] = std::uint8_t((cls > las::kHighestOldClass ? las::kUnclassified : cls) | (flags & 7u) << 5u);
        to.angle[i] = std::int8_t(std::clamp(angle, -128L, 127L));
    }
    return misfits;
}

void ClassicMisfits::include(const ClassicMisfits& other) noexcept
{
    flags += other.flags;
    returns += other.returns;
    angles += other.angles;
    classes += other.classes;
}

std::string ClassicMisfits::text() const
{
    std::string all;
    const auto add = [&](PointIndex points, const char* what) {
        if (points == 0) return;
        all += (all.empty() ? "" : ", ") + pointsText(points) + (points == 1 ? " has " : " have ") + what;
    };
    add(flags, "an overlap flag or a scanner channel");
    add(returns, "a return number above 7");
    add(angles, "a scan angle that is no whole number of degrees");
    return all;
}

}  // namespace punctum
