// SPDX-License-Identifier: MIT
// punctum bench select: how long a polygon takes through all points, and a rule; and until the picture shows it.
#include "app/commands/Bench.h"
#include "core/expression/Condition.h"
#include "core/select/Selecting.h"
#include "core/task/Progress.h"

#include <cmath>
#include <numbers>

namespace punctum::app
{

namespace
{

constexpr int kWidth = 1280;
constexpr int kHeight = 800;
constexpr double kFrameSeconds = 0.0166;
constexpr const char* kRule = "Classification == 2 and Intensity < 1000";

/// A star of twelve corners in the middle of the picture.
ScreenMask star()
{
    std::vector<glm::dvec2> corners;
    for (int k = 0; k < 12; ++k) {
        const double radius = kHeight * (k % 2 == 0 ? 0.45 : 0.25), angle = k * std::numbers::pi / 6;
        corners.push_back({kWidth / 2.0 + radius * std::cos(angle), kHeight / 2.0 + radius * std::sin(angle)});
    }
    ScreenMask mask(kWidth, kHeight);
    mask.addPolygon(corners);
    return mask;
}

void runBenchSelect(const BenchOptions& options, Progress& progress)
{
    HeadlessRenderer headless("cpu");
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    const PointCloud& cloud = *drawable.cloud;
    render::DisplaySettings display;
    display.attribute = "Classification";
    show(renderer, drawable, kWidth, kHeight, display);
    drawAll(renderer, false, progress);

    Figures figures;
    figures.fact("points", cloud.size());
    figures.fact("rule", kRule);
    for (int round = 0; round < options.rounds; ++round) {
        Clock clock;
        const Region region{star(), renderer.projectionOf(cloud)};
        auto points = std::make_shared<PointSet>(pointsIn(region, cloud, {}, progress));
        figures.add("polygon_ms", clock.milliseconds());
        figures.add("points_selected", double(points->count()));

        clock.restart();
        renderer.setSelection(cloud, points);
        renderer.renderFrame(kFrameSeconds);
        figures.add("shown_ms", clock.milliseconds());
        drawAll(renderer, false, progress);
        clock.restart();
        renderer.setSelection(cloud, nullptr);
        renderer.renderFrame(kFrameSeconds);
        figures.add("cleared_ms", clock.milliseconds());
        drawAll(renderer, false, progress);

        clock.restart();
        const expression::Condition rule(kRule, cloud);
        expression::select(cloud, rule, progress);
        figures.add("rule_mpts_per_s", double(cloud.size()) / clock.seconds() * 1e-6);
    }
    figures.report(options);
}

}  // namespace

void addBenchSelect(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(
        bench, "select", "Selecting by a polygon through all points, and by a rule; and until it is shown");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSelect(*options, p); }; });
}

}  // namespace punctum::app
