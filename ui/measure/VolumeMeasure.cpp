// SPDX-License-Identifier: MIT
#include "ui/measure/VolumeMeasure.h"

#include "core/cloud/PointCloud.h"
#include "core/task/Progress.h"

#include <cmath>
#include <optional>
#include <shared_mutex>

namespace punctum::ui
{

namespace
{

constexpr double kWorthTelling = 0.005;  ///< of the outline, without surface

/// Nothing where there are none in the area, or the cloud has no classes.
std::optional<PointSet> groundIn(const PointCloud& cloud, std::span<const Ring> within, const VolumeScope& scope,
                                 Progress& progress)
{
    {
        const std::shared_lock lock(cloud.mutex());
        if (cloud.findAttribute("Classification") == nullptr) return std::nullopt;
    }
    PointSet ground = pointsForVolume(cloud, within, &scope.ground, nullptr, progress);
    if (!anySurfaceIn(cloud, within, ground)) return std::nullopt;
    return ground;
}

std::string codesText(const std::bitset<256>& classes)
{
    std::string text;
    for (std::size_t code = 0; code < classes.size(); ++code)
        if (classes[code]) text += (text.empty() ? "" : ", ") + std::to_string(code);
    return text;
}

}  // namespace

MeasuredVolume measureVolume(const PointCloud& cloud, const std::vector<MeasuredPoint>& corners,
                             const VolumeWish& wish, const VolumeScope& scope, Progress& progress)
{
    VolumeQuestion question;
    question.base = wish.base;
    question.height = wish.height;
    question.within.emplace_back();
    for (const MeasuredPoint& corner : corners) question.within.front().emplace_back(corner.world);
    MeasuredVolume found;
    std::optional<PointSet> points;
    if (wish.points == VolumeWish::Points::Automatic)
        points = groundIn(cloud, question.within, scope, progress);
    else if (wish.points == VolumeWish::Points::Ground)
        points = pointsForVolume(cloud, question.within, &scope.ground, nullptr, progress);
    found.ground = points.has_value();
    found.classes = scope.ground;
    if (!points) {
        const auto hidden = hiddenPoints(cloud, scope.visibility, progress);
        points = pointsForVolume(cloud, question.within, nullptr, hidden.get(), progress);
    }
    const SurfaceTiles tiles(cloud, *points, 0.0, progress);
    found.volume = volumeOf(cloud, tiles, question, progress);
    return found;
}

std::vector<Quantity> quantitiesOf(const MeasuredVolume& found)
{
    using Unit = Quantity::Unit;
    const Volume& v = found.volume;
    std::vector<Quantity> all{{"Net volume", v.net(), Unit::Volume},
                              {"Standard deviation", v.deviation, Unit::Volume},
                              {"Cut", v.cut, Unit::Volume},
                              {"Fill", v.fill, Unit::Volume},
                              {"Area", v.area, Unit::Area},
                              {"Mean height of base", v.height, Unit::Length},
                              {"Surface points", double(v.points), Unit::None}};
    if (v.lacking > 0) all.push_back({"Area without surface", v.lacking, Unit::Area});
    return all;
}

std::vector<std::pair<std::string, std::string>> factsOf(const MeasuredVolume& found, const VolumeWish& wish)
{
    std::vector<std::pair<std::string, std::string>> facts;
    switch (wish.base) {
        case VolumeBase::Outline:
            facts.emplace_back("Base", "outline");
            break;
        case VolumeBase::Lowest:
            facts.emplace_back("Base", "lowest of the outline");
            break;
        case VolumeBase::Plane:
            facts.emplace_back("Base", "plane of the outline");
            break;
        case VolumeBase::Height:
        case VolumeBase::Surface:
            facts.emplace_back("Base", "height");
            break;
    }
    facts.emplace_back("Surface of", found.ground ? "class " + codesText(found.classes) : "points shown");
    const double edge = found.volume.edge + found.volume.edgeLacking;
    if (found.volume.edgeLacking > kWorthTelling * edge)
        facts.emplace_back("Outline without surface",
                           std::to_string(std::lround(100 * found.volume.edgeLacking / edge)) + " %");
    return facts;
}

}  // namespace punctum::ui
