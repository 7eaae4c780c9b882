// SPDX-License-Identifier: MIT
// punctum bench view: how soon the picture of a part of a cloud is full, of which most points are out of sight.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/cloud/Section.h"
#include "core/task/Progress.h"
#include "render/store/Arrangement.h"

#include <ctime>
#include <memory>
#include <optional>

namespace punctum::app
{

namespace
{

struct BenchViewOptions : BenchOptions {
    std::string backend = "auto";
    std::optional<double> share;
    std::optional<double> section;
    bool fileOrder = false;
};

/// A strip along the longer side, in the middle of the other one.
Section stripOf(const WorldBounds& box, double share, const glm::dvec3& stretch)
{
    const glm::dvec3 extent = box.max - box.min, middle = (box.min + box.max) / 2.0;
    const bool east = extent.x * stretch.x >= extent.y * stretch.y;
    Section strip;
    strip.stretch = stretch;
    strip.from = east ? glm::dvec2(box.min.x, middle.y) : glm::dvec2(middle.x, box.min.y);
    strip.to = east ? glm::dvec2(box.max.x, middle.y) : glm::dvec2(middle.x, box.max.y);
    strip.width = share * (east ? extent.x * stretch.x : extent.y * stretch.y);
    return strip;
}

/// Of all threads of the program: what other programs take beside it does not count.
double processorMilliseconds()
{
    return double(std::clock()) * 1e3 / double(CLOCKS_PER_SEC);
}

void runBenchView(const BenchViewOptions& options, Progress& progress)
{
    HeadlessRenderer headless(options.backend);
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud cloud = loadDrawable(options.file, progress);
    render::DisplaySettings display;
    const WorldBounds box = cloud.cloud->coordinates().toWorld(cloud.bounds);
    render::Camera camera;
    if (options.section) {
        const Section strip = stripOf(box, *options.section, trueLengths(*cloud.cloud, box).stretch);
        const auto sides = strip.sides();
        display.clip.planes.assign(sides.begin(), sides.end());
        camera = render::sectionCamera(strip, box.min.z, box.max.z, {kBenchWidth, kBenchHeight});
    } else {
        camera = benchCamera(cloud, kBenchWidth, kBenchHeight, options.share.value_or(0.1));
    }
    show(renderer, cloud, kBenchWidth, kBenchHeight, display);
    renderer.setCamera(camera);
    if (!options.fileOrder) {  // as the window does behind the scenes
        if (auto arrangement = cloud.store->arrangement(cloud.bounds, progress))
            renderer.arrange(*cloud.cloud, std::move(*arrangement));
    }
    drawAll(renderer, false, progress);  // streams the attribute, learns the cost of a point, touches all memory

    Figures figures;
    figures.fact("points", cloud.cloud->size());
    figures.fact("arranged", cloud.store->arranged());
    figures.fact("backend", render::nameOf(renderer.backend().kind()));
    figures.fact("device", renderer.backend().description());
    for (int round = 0; round < options.rounds; ++round) {
        Clock clock;
        const double before = processorMilliseconds();
        renderer.renderBruteForce();
        figures.add("brute_force_ms", clock.milliseconds());
        figures.add("brute_force_processor_ms", processorMilliseconds() - before);
        beginEmpty(renderer, kBenchWidth, kBenchHeight);
        clock.restart();
        const double processor = processorMilliseconds();
        int frames = 0;
        render::FrameReport::Passes passes;
        for (bool full = false; !full; ++frames) {
            const render::FrameReport report = renderer.renderFrame(render::kFrameSeconds);
            full = report.converged;
            passes.reproject += report.passes.reproject;
            passes.fill += report.passes.fill;
            passes.resolve += report.passes.resolve;
            progress.check();
        }
        figures.add("full_picture_ms", clock.milliseconds());
        figures.add("full_picture_processor_ms", processorMilliseconds() - processor);
        figures.add("frames", frames);
        figures.add("passes.begin_ms", passes.reproject * 1e3);
        figures.add("passes.fill_ms", passes.fill * 1e3);
        figures.add("passes.resolve_ms", passes.resolve * 1e3);
        figures.add("points_read", double(renderer.pointsInSight()));
    }
    figures.report(options);
}

}  // namespace

void addBenchView(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(
        bench, "view",
        "A part of the cloud: from nothing to its full picture, by the points of stretches of the file that "
        "are in sight; and by looking at all points");
    const auto options = std::make_shared<BenchViewOptions>();
    addBenchOptions(command, *options);
    addBackendOption(command, options->backend);
    command.add_flag(
        "--file-order", options->fileOrder,
        "Leave slots in the order of the file; else they are arranged as in the window, where that pays");
    CLI::Option* const share =
        command.add_option("--share", options->share, "Share of each side that is seen, 0.001 to 1; default 0.1")
            ->type_name("S")
            ->check(CLI::Range(0.001, 1.0));
    command
        .add_option("--section", options->section,
                    "A section along the longer side instead, so wide as a share of it, 0.0001 to 1")
        ->type_name("W")
        ->check(CLI::Range(0.0001, 1.0))
        ->excludes(share);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchView(*options, p); }; });
}

}  // namespace punctum::app
