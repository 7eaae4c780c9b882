// SPDX-License-Identifier: MIT
// punctum bench surface: how long the ground surface takes at first, and after a stroke of the brush.
#include "app/commands/Bench.h"
#include "core/edit/ClassCommand.h"
#include "core/surface/Surface.h"
#include "core/task/Progress.h"

#include <cmath>
#include <memory>

namespace punctum::app
{

namespace
{

constexpr double kStrokeRadius = 5.0;  ///< units of length

/// Ground points about that ground point that is the `part`-th part of all from the first one.
PointSet strokeAbout(const PointCloud& cloud, double part)
{
    const auto x = cloud.rawX(), y = cloud.rawY();
    const Attribute& classes = *cloud.findAttribute("Classification");
    PointIndex middle = PointIndex(part * double(cloud.size()));
    while (middle + 1 < cloud.size() && classes.number(middle) != 2.0) ++middle;
    const TrueLengths lengths = trueLengths(cloud);
    const double dx = lengths.stretch.x * cloud.coordinates().scale.x,
                 dy = lengths.stretch.y * cloud.coordinates().scale.y;
    PointSet stroke(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i)
        if (std::hypot((double(x[i]) - x[middle]) * dx, (double(y[i]) - y[middle]) * dy) < kStrokeRadius &&
            classes.number(i) == 2.0)
            stroke.insert(i);
    return stroke;
}

void runBenchSurface(const BenchOptions& options, Progress& progress)
{
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    PointCloud& cloud = *drawable.cloud;
    Figures figures;
    figures.fact("points", cloud.size());
    for (int round = 0; round < options.rounds; ++round) {
        Clock clock;
        Surface surface(drawable.cloud, {}, progress);
        figures.add("build_ms", clock.milliseconds());
        if (round == 0) {
            figures.fact("ground_points", surface.groundPoints());
            figures.fact("tiles", surface.view()->tiles.size());
        }
        for (const double part : {0.2, 0.4, 0.6, 0.8}) {
            const auto stroke = std::make_shared<PointSet>(strokeAbout(cloud, part));
            const auto command = makeClassCommand("brush", classAttribute(cloud, 6), stroke, 6);
            if (!command) continue;
            for (int way = 0; way < 2; ++way) {  // there and back
                command->apply(cloud);
                clock.restart();
                const std::size_t tiles = surface.update(stroke.get(), progress);
                figures.add("update_ms", clock.milliseconds());
                figures.add("tiles_updated", double(tiles));
            }
            figures.add("points_changed", double(stroke->count()));
        }
    }
    figures.report(options);
}

}  // namespace

void addBenchSurface(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "surface",
                                   "The surface of the ground points: made, and brought up to date after a stroke");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSurface(*options, p); }; });
}

}  // namespace punctum::app
