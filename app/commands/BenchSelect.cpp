// SPDX-License-Identifier: MIT
// punctum bench select: how long a polygon takes through all points, and a rule; until the picture shows it; and
// what a stroke of the brush costs the frames that are drawn meanwhile.
#include "app/commands/Bench.h"
#include "core/expression/Condition.h"
#include "core/select/Selecting.h"
#include "core/task/Progress.h"

#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

namespace punctum::app
{

namespace
{

constexpr double kStrokeSeconds = 2.0;
constexpr double kBrushRadius = 24.0;  // px
constexpr const char* kRule = "Classification == 2 and Intensity < 1000";

/// A star of twelve corners in the middle of the picture.
ScreenMask star()
{
    std::vector<glm::dvec2> corners;
    for (int k = 0; k < 12; ++k) {
        const double radius = kBenchHeight * (k % 2 == 0 ? 0.45 : 0.25), angle = k * std::numbers::pi / 6;
        corners.push_back(
            {kBenchWidth / 2.0 + radius * std::cos(angle), kBenchHeight / 2.0 + radius * std::sin(angle)});
    }
    ScreenMask mask(kBenchWidth, kBenchHeight);
    mask.addPolygon(corners);
    return mask;
}

/// The hand goes round. As in the window, a thread of its own finds the points of the stroke so far, again and
/// again, and what it found is shown in the next frame.
void measureBrush(render::ProgressiveRenderer& renderer, const PointCloud& cloud, Figures& figures,
                  Progress& progress)
{
    using namespace std::chrono_literals;
    ScreenMask stroke(kBenchWidth, kBenchHeight);
    glm::dvec2 last(kBenchWidth * 0.75, kBenchHeight / 2.0);
    std::future<std::shared_ptr<const PointSet>> job;
    double asked = 0;  // when the job began, on the clock
    std::vector<double> frames, behind;
    const Clock clock;
    for (double now = 0; now < kStrokeSeconds; now = clock.seconds()) {
        progress.check();
        const double angle = now / kStrokeSeconds * 2 * std::numbers::pi;
        const glm::dvec2 hand(kBenchWidth * (0.5 + 0.25 * std::cos(angle)),
                              kBenchHeight * (0.5 + 0.3 * std::sin(angle)));
        stroke.addStroke(std::exchange(last, hand), hand, kBrushRadius);

        const Clock frame;
        const bool found = job.valid() && job.wait_for(0s) == std::future_status::ready;
        if (found) renderer.setSelection(cloud, job.get());
        const bool drawn = !renderer.converged();
        renderer.renderFrame(render::kFrameSeconds);
        if (found) behind.push_back((clock.seconds() - asked) * 1e3);
        if (!job.valid() && renderer.converged()) {
            asked = clock.seconds();
            job = std::async(std::launch::async,
                             [&, region = Region{stroke, renderer.projectionOf(cloud)},
                              visible = renderer.visiblePoints(cloud)]() -> std::shared_ptr<const PointSet> {
                                 const auto points =
                                     std::make_shared<PointSet>(pointsIn(region, cloud, {}, progress));
                                 countWithout(*points, visible);
                                 return points;
                             });
        }
        if (drawn) frames.push_back(frame.milliseconds());
        std::this_thread::sleep_for(std::chrono::duration<double>(render::kFrameSeconds - frame.seconds()));
    }
    if (job.valid()) job.get();
    figures.add("brush.frame_ms", median(frames));
    figures.add("brush.frame_ms_p95", percentile(frames, 0.95));
    figures.add("brush.behind_ms", median(behind));
    renderer.setSelection(cloud, nullptr);
    drawAll(renderer, false, progress);
}

void runBenchSelect(const BenchOptions& options, Progress& progress)
{
    HeadlessRenderer headless("cpu");
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    const PointCloud& cloud = *drawable.cloud;
    render::DisplaySettings display;
    display.attribute = "Classification";
    show(renderer, drawable, kBenchWidth, kBenchHeight, display);
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
        renderer.renderFrame(render::kFrameSeconds);
        figures.add("shown_ms", clock.milliseconds());
        drawAll(renderer, false, progress);
        clock.restart();
        renderer.setSelection(cloud, nullptr);
        renderer.renderFrame(render::kFrameSeconds);
        figures.add("cleared_ms", clock.milliseconds());
        drawAll(renderer, false, progress);

        clock.restart();
        const expression::Condition rule(kRule, cloud);
        expression::select(cloud, rule, progress);
        figures.add("rule_mpts_per_s", double(cloud.size()) / clock.seconds() * 1e-6);
        measureBrush(renderer, cloud, figures, progress);
    }
    figures.report(options);
}

}  // namespace

void addBenchSelect(CLI::App& bench, Action& action)
{
    CLI::App& command =
        addCommand(bench, "select",
                   "Selecting by a polygon through all points, by a rule and by the brush; and until it is shown");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSelect(*options, p); }; });
}

}  // namespace punctum::app
