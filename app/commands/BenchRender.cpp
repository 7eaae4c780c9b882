// SPDX-License-Identifier: MIT
// punctum bench render: one pass over all points, a turn at a fixed budget, convergence, idleness.
#include "app/Picture.h"
#include "app/Window.h"
#include "app/commands/Bench.h"
#include "app/commands/StepBeside.h"
#include "core/Error.h"
#include "core/task/Progress.h"

#include <ctime>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <thread>

namespace punctum::app
{

namespace
{

constexpr int kFrames = 120;
constexpr int kLeadIn = 10;  ///< frames whose coverage does not count: the picture begins empty
constexpr double kTurn = std::numbers::pi;

struct BenchRenderOptions : BenchOptions {
    std::string backend = "auto";
    std::optional<int> samples;  ///< none: 1, or the window's
    bool asWindow = false;
    std::string order = "stratified";
    double budget = render::kFrameMilliseconds;
    double budgetPoints = 0;
    double spacings = 0;  ///< 0: points of 1 px
    std::string beside;   ///< a step that runs meanwhile; empty: none
    PictureSize size;
};

/// The renderer and the cloud it shows, and how to begin with an empty picture.
struct Stage {
    render::ProgressiveRenderer& renderer;
    const BenchRenderOptions& options;
    render::Camera camera;

    double seconds() const noexcept { return options.budget * 1e-3; }
    void empty() const
    {
        beginEmpty(renderer, options.size.width, options.size.height);
        renderer.setCamera(camera);
    }
    render::Camera turned(int frame) const
    {
        render::Camera c = camera;
        c.orbit(kTurn * frame / kFrames, 0.0);
        return c;
    }
};

void measureBruteForce(const Stage& stage, double points, Figures& figures)
{
    stage.renderer.setCamera(stage.camera);
    const Clock clock;
    stage.renderer.renderBruteForce();
    const double seconds = clock.seconds();
    figures.add("brute_force_ms", seconds * 1e3);
    figures.add("mpts_per_s", points / seconds * 1e-6);
}

/// Covered share of each frame's picture, and the figures of its time.
std::vector<double> measureOrbit(const Stage& stage, Figures& figures, Progress& progress)
{
    std::vector<double> times;
    std::vector<double> covered;
    std::vector<double> reproject, fill, resolve, stream, up, down;
    stage.empty();
    for (int frame = 0; frame < kFrames; ++frame) {
        progress.check();
        const Clock clock;
        stage.renderer.setCamera(stage.turned(frame));
        const render::FrameReport report = stage.renderer.renderFrame(stage.seconds());
        times.push_back(clock.milliseconds());
        if (frame > 0) {
            reproject.push_back(report.passes.reproject * 1e3);
            fill.push_back(report.passes.fill * 1e3);
            resolve.push_back(report.passes.resolve * 1e3);
            stream.push_back(report.passes.stream * 1e3);
            up.push_back(double(report.bytesUp));
            down.push_back(double(report.bytesDown));
        }
        covered.push_back(stage.renderer.coveredShare());
    }
    figures.add("orbit.frame_ms", median(times));
    figures.add("orbit.frame_ms_p95", percentile(times, 0.95));
    figures.add("orbit.frame_ms_max", percentile(times, 1.0));
    figures.add("passes.reproject", median(reproject));
    figures.add("passes.fill", median(fill));
    figures.add("passes.resolve", median(resolve));
    figures.add("passes.stream", median(stream));
    figures.add("bytes_up", median(up));
    figures.add("bytes_down", median(down));
    return covered;
}

void measureConvergence(const Stage& stage, Figures& figures, Progress& progress)
{
    stage.empty();
    const Clock clock;
    while (!stage.renderer.renderFrame(stage.seconds()).converged) progress.check();
    figures.add("converge_ms", clock.milliseconds());

    // What a view does that asks for a frame whenever one is due: none of them may draw.
    const std::clock_t cpu = std::clock();
    int drawn = 0;
    for (const Clock second; second.seconds() < 1.0;) {
        progress.check();
        const render::FrameReport report = stage.renderer.renderFrame(stage.seconds());
        if (!report.converged || report.filled != 0) ++drawn;
        std::this_thread::sleep_for(std::chrono::duration<double>(stage.seconds()));
    }
    figures.add("idle_frames", drawn);
    figures.add("idle_cpu_ms", double(std::clock() - cpu) * 1e3 / CLOCKS_PER_SEC);
}

void runBenchRender(const BenchRenderOptions& options, Progress& progress)
{
    ParsedStep step;
    try {
        if (!options.beside.empty()) step = parseStep(options.beside);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
    const WindowLook look = options.asWindow ? windowLook() : WindowLook();
    const bool windowChooses = options.asWindow && options.backend == "auto";
    HeadlessRenderer headless(windowChooses ? std::string(render::nameOf(look.backend)) : options.backend);
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud cloud = loadDrawable(
        options.file, progress, render::orderFromName(options.order).value_or(render::OrderKind::Stratified));
    const auto points = double(cloud.cloud->size());
    render::DisplaySettings display = look.display;
    if (options.samples) display.samples = *options.samples;
    renderer.keepOnDevice(options.asWindow);
    if (options.spacings > 0) {
        display.sizing = render::PointSizing::Density;
        display.spacings = options.spacings;
    }
    show(renderer, cloud, options.size.width, options.size.height, display);
    const Stage stage{renderer, options, benchCamera(cloud, options.size.width, options.size.height)};
    renderer.setPointsAFrame(PointIndex(options.budgetPoints));
    drawAll(renderer, false, progress);  // streams the attribute, learns the cost of a point, touches all memory

    Figures figures;
    figures.fact("points", cloud.cloud->size());
    figures.fact("backend", render::nameOf(renderer.backend().kind()));
    figures.fact("device", renderer.backend().description());
    figures.fact("size", sizeText(options.size));
    figures.fact("samples", display.samples);
    figures.fact("as_window", options.asWindow);
    figures.fact("eye_dome", display.eyeDome > 0);
    figures.fact("holes_closed", display.fillHoles);
    if (!options.beside.empty()) figures.fact("step", options.beside);
    figures.fact("adaptive_size", display.sizing == render::PointSizing::Density ? display.spacings : 0.0);
    std::vector<std::vector<double>> covered;
    for (int round = 0; round < options.rounds; ++round) {
        measureBruteForce(stage, points, figures);
        {
            std::optional<StepBeside> beside;
            if (!options.beside.empty()) beside.emplace(*cloud.cloud, step);
            covered.push_back(measureOrbit(stage, figures, progress));
            if (beside) figures.add("while.runs", beside->runs());
        }
        measureConvergence(stage, figures, progress);
    }

    std::vector<double> reference;
    for (int frame = kLeadIn; frame < kFrames; ++frame) {
        progress.check();
        renderer.setCamera(stage.turned(frame));
        renderer.renderBruteForce();
        reference.push_back(renderer.coveredShare());
    }
    for (const std::vector<double>& round : covered) {
        double sum = 0;
        double worst = 1;
        for (std::size_t k = 0; k < reference.size(); ++k) {
            const double share = reference[k] > 0 ? round[k + kLeadIn] / reference[k] : 1.0;
            sum += share;
            worst = std::min(worst, share);
        }
        figures.add("orbit.coverage", sum / double(reference.size()));
        figures.add("orbit.coverage_least", worst);
    }
    figures.report(options);
}

}  // namespace

void addBenchRender(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "render",
                                   "Drawing: all points in one pass; a half turn of 120 frames, begun with "
                                   "an empty picture; from nothing to the full picture; frames drawn afterwards");
    const auto options = std::make_shared<BenchRenderOptions>();
    addBenchOptions(command, *options);
    addBackendOption(command, options->backend);
    addSize(command, options->size);
    command.add_option("--samples", options->samples, "Samples a pixel: 1, 4, 8 or 16; default 1, or the window's")
        ->type_name("N")
        ->check(CLI::IsMember({1, 4, 8, 16}));
    command.add_flag("--as-window", options->asWindow,
                     "Draw with what the window does: its settings, holes closed, pictures kept on the device");
    command
        .add_option("--adaptive-size", options->spacings,
                    "Width of points in spacings of the cloud's points, as the window draws them; default: 1 px")
        ->type_name("N")
        ->check(CLI::Range(0.1, 20.0));
    command
        .add_option("--while", options->beside,
                    "A processing step that runs again and again during the turn, as a job of the window does: "
                    "\"normals k=16\"")
        ->type_name("STEP");
    command.add_option("--order", options->order, "Order of drawing: stratified (the default) or prime")
        ->type_name("NAME")
        ->check(CLI::IsMember({"stratified", "prime"}));
    command.add_option("--budget", options->budget, "Milliseconds of a frame, 1 to 1000; default 16.6")
        ->type_name("MS")
        ->check(CLI::Range(1.0, 1000.0));
    command.add_option("--budget-points", options->budgetPoints, "Points drawn in each frame, whatever the time")
        ->type_name("N")
        ->check(CLI::Range(1.0, 4e9));
    command.callback([options, &action] { action = [options](Progress& p) { runBenchRender(*options, p); }; });
}

}  // namespace punctum::app
