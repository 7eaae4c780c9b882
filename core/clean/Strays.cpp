// SPDX-License-Identifier: MIT
#include "core/clean/Strays.h"

#include "core/Text.h"
#include "core/cloud/ShownExtent.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Visibility.h"
#include "core/process/Marking.h"
#include "core/task/Progress.h"

namespace punctum
{

const StepDescription& StraysStep::description() const
{
    static const StepDescription about{
        .name = "strays",
        .title = "Strays far away",
        .group = StepGroup::Cleaning,
        .help =
            "Finds the few points that lie so far away from all others that they would make a dot of them in a "
            "picture: those that fitting the view leaves out.",
        .parameters = {doParameter({"delete", "withheld", "class"}, "delete",
                                   "Strays are deleted, or get a class or the flag Withheld."),
                       doClassParameter("7", "The class strays get.")}};
    return about;
}

std::unique_ptr<Command> StraysStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    const auto deleted = deletedPoints(cloud);
    const ShownExtent extent =
        shownExtent(cloud, cloud.computeBounds(), deleted.get(), trueLengths(cloud).stretch, progress);
    if (extent.strays == 0) return nullptr;
    // The box of what is no stray is exact, so that it can be told in raw coordinates again.
    const RawBounds near = rawInside(extent.typical, cloud.coordinates());
    auto points = std::make_shared<PointSet>(cloud.size());
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();

    progress.begin("Telling strays", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const std::size_t last = std::min<std::size_t>(cloud.size(), lastWord * 64);
        for (std::size_t i = firstWord * 64; i < last; ++i) {
            const bool inside = (x[i] >= near.min.x) & (x[i] <= near.max.x) & (y[i] >= near.min.y) &
                                (y[i] <= near.max.y) & (z[i] >= near.min.z) & (z[i] <= near.max.z);
            if (!inside) points->insert(i);
        }
    });
    if (deleted) points->remove(*deleted);
    if (within != nullptr) points->intersect(*within);
    const PointIndex found = points->count();
    auto command = markPoints("Strays", cloud, std::move(points), values, progress);
    if (command)
        command->setFinding(pointsText(found) + (found == 1 ? " was" : " were") + " far away from all others.");
    return command;
}

}  // namespace punctum
