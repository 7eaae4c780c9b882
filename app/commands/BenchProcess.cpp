// SPDX-License-Identifier: MIT
// punctum bench process: how long a processing step takes.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"

namespace punctum::app
{

namespace
{

struct BenchProcessOptions : BenchOptions {
    std::string step;
};

void runBenchProcess(const BenchProcessOptions& options, Progress& progress)
{
    ParsedStep step;
    try {
        step = parseStep(options.step);
        completeValues(*step.step, step.values);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
    const auto cloud = las::load(options.file, progress);
    Figures figures;
    figures.fact("points", cloud->size());
    figures.fact("step", options.step);
    for (int round = 0; round < options.rounds; ++round) {
        const Clock clock;
        const auto command = step.step->run(*cloud, step.values, progress);
        const double seconds = clock.seconds();
        figures.add("seconds", seconds);
        figures.add("mpts_per_s", double(cloud->size()) / seconds * 1e-6);
        figures.add("points_changed", double(command ? command->changedPoints() : 0));
    }
    figures.report(options);
}

}  // namespace

void addBenchProcess(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "process", "A processing step, without loading and saving");
    const auto options = std::make_shared<BenchProcessOptions>();
    addBenchOptions(command, *options);
    command.add_option("--step", options->step, "The step, as in punctum process: \"normals k=16\"")
        ->required()
        ->type_name("STEP");
    command.callback([options, &action] { action = [options](Progress& p) { runBenchProcess(*options, p); }; });
}

}  // namespace punctum::app
