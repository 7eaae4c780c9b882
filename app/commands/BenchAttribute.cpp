// SPDX-License-Identifier: MIT
// punctum bench attribute: how soon another attribute is on screen, and how soon everywhere.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/task/Progress.h"

#include <array>

namespace punctum::app
{

namespace
{

constexpr int kTurnFrames = 120, kFramesPerSwitch = 40;
constexpr double kHalfTurn = 3.14159265358979;

/// Frames of a half turn in which the attribute is switched three times: of a large cloud something streams in most
/// of them.
void measureTurn(render::ProgressiveRenderer& renderer, render::DisplaySettings display,
                 const std::array<std::string, 2>& names, Figures& figures, Progress& progress)
{
    const render::Camera before = renderer.camera();
    std::vector<double> times;
    for (int frame = 0; frame < kTurnFrames; ++frame) {
        progress.check();
        const Clock clock;
        display.attribute = names[std::size_t(frame / kFramesPerSwitch) % 2];
        renderer.setDisplay(display);
        render::Camera camera = before;
        camera.orbit(kHalfTurn * frame / kTurnFrames, 0.0);
        renderer.setCamera(camera);
        renderer.renderFrame(render::kFrameSeconds);
        times.push_back(clock.milliseconds());
    }
    figures.add("turning_frame_ms_p95", percentile(times, 0.95));
    renderer.setCamera(before);
    drawAll(renderer, false, progress);
}

void runBenchAttribute(const BenchOptions& options, Progress& progress)
{
    HeadlessRenderer headless("auto");
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud cloud = loadDrawable(options.file, progress);
    render::DisplaySettings display;
    show(renderer, cloud, kBenchWidth, kBenchHeight, display);
    drawAll(renderer, false, progress);

    const std::string first = renderer.shownAttribute();
    const std::array<std::string, 2> names{first, first == "Z" ? "Intensity" : "Z"};
    std::array<render::Image, 2> finished;
    for (const std::size_t which : {1, 0}) {
        display.attribute = names[which];
        renderer.setDisplay(display);
        drawAll(renderer, false, progress);
        finished[which] = renderer.image();
    }

    Figures figures;
    figures.fact("points", cloud.cloud->size());
    figures.fact("attributes", names);
    for (int round = 0; round < options.rounds; ++round) {
        const std::size_t which = std::size_t(round + 1) % 2;
        display.attribute = names[which];
        // the clock stands while pictures are compared: a still view is finished when it looks as it will in the
        // end
        double spent = 0;
        double visible = 0;
        for (bool all = false; !all;) {
            progress.check();
            const Clock clock;
            renderer.setDisplay(display);
            all = renderer.renderFrame(render::kFrameSeconds).converged;
            spent += clock.milliseconds();
            if (visible == 0 && renderer.image() == finished[which]) visible = spent;
        }
        if (visible == 0) throw Error("The picture did not come out as it was the last time.");
        figures.add("switch_visible_ms", visible);
        figures.add("switch_all_ms", spent);
        figures.add("mpts_per_s", double(cloud.cloud->size()) / spent * 1e-3);
        measureTurn(renderer, display, names, figures, progress);
        display.attribute = names[which];
        renderer.setDisplay(display);
        drawAll(renderer, false, progress);
    }
    figures.report(options);
}

}  // namespace

void addBenchAttribute(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "attribute",
                                   "Showing another attribute: to the first frame in which all "
                                   "visible points have it, and until all points do");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchAttribute(*options, p); }; });
}

}  // namespace punctum::app
