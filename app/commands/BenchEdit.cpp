// SPDX-License-Identifier: MIT
// punctum bench edit: how soon a reclassification is on screen, and how soon it is undone.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/edit/History.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"

namespace punctum::app
{

namespace
{

void runBenchEdit(const BenchOptions& options, Progress& progress)
{
    HeadlessRenderer headless("auto");
    render::ProgressiveRenderer& renderer = headless.renderer();
    const DrawableCloud cloud = loadDrawable(options.file, progress);
    render::DisplaySettings display;
    display.attribute = "Classification";
    show(renderer, cloud, kBenchWidth, kBenchHeight, display);
    drawAll(renderer, false, progress);

    // the middle half of the heights becomes water
    const WorldBounds box = cloud.cloud->coordinates().toWorld(cloud.bounds);
    const double height = box.max.z - box.min.z;
    const ParsedStep step = parseStep("reclassify attribute=Z min=" + toText(box.min.z + height / 4) +
                                      " max=" + toText(box.max.z - height / 4) + " class=9");
    History history(cloud.cloud);
    const Subscription subscription =
        cloud.cloud->subscribe([&](const ChangeNotice& notice) { renderer.valuesChanged(*cloud.cloud, notice); });
    const render::Image before = renderer.image();

    Figures figures;
    figures.fact("points", cloud.cloud->size());
    for (int round = 0; round < options.rounds; ++round) {
        Clock clock;
        auto command = step.step->run(*cloud.cloud, step.values, progress);
        if (!command) throw Error("No point of this file changes when its middle heights become class 9.");
        const PointIndex changed = command->changedPoints();
        history.push(std::move(command));
        renderer.renderFrame(render::kFrameSeconds);
        const double visible = clock.milliseconds();
        const render::Image first = renderer.image();
        drawAll(renderer, false, progress);
        if (first != renderer.image()) throw Error("The first frame after the edit did not show all of it.");

        clock.restart();
        history.undo();
        renderer.renderFrame(render::kFrameSeconds);
        const double undone = clock.milliseconds();
        if (renderer.image() != before) throw Error("The first frame after undoing did not show the old classes.");
        drawAll(renderer, false, progress);
        figures.add("points_changed", double(changed));
        figures.add("visible_ms", visible);
        figures.add("undo_ms", undone);
    }
    figures.report(options);
}

}  // namespace

void addBenchEdit(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "edit",
                                   "Reclassifying the middle half of the heights: to the first frame "
                                   "that shows it, and back");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchEdit(*options, p); }; });
}

}  // namespace punctum::app
