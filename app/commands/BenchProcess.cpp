// SPDX-License-Identifier: MIT
// punctum bench process: how long a processing step takes.
#include "app/commands/Bench.h"
#include "app/commands/BenchPcl.h"
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/neighbors/KdOrder.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"

namespace punctum::app
{

namespace
{

struct BenchProcessOptions : BenchOptions {
    std::string step;
    bool alone = false;
};

/// The same points for PCL: true lengths from the middle of the cloud, as floats.
PclPeer::Points pointsForPcl(const PointCloud& cloud)
{
    const TrueLengths lengths = trueLengths(cloud);
    const auto& grid = cloud.coordinates();
    PclPeer::Points points(cloud.size());
    std::array<double, 3> middle{};
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        middle[0] += double(cloud.rawX()[i]) / double(cloud.size());
        middle[1] += double(cloud.rawY()[i]) / double(cloud.size());
        middle[2] += double(cloud.rawZ()[i]) / double(cloud.size());
    }
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        const std::array<std::int32_t, 3> raw = {cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i]};
        for (std::size_t a = 0; a < 3; ++a)
            points[i][a] = float((double(raw[a]) - middle[a]) * grid.scale[int(a)] * lengths.stretch[int(a)]);
    }
    return points;
}

/// PCL's class for the step, where it has one, with the same values.
std::unique_ptr<PclPeer> peerOf(const ParsedStep& step, const PointCloud& cloud, Progress& progress)
{
    StepValues values = completeValues(*step.step, step.values);
    for (const StepParameter& p : step.step->parameters())
        if (p.fit.used() && !values.contains(p.key)) values.emplace(p.key, presetOf(p, dataScale(cloud, progress)));
    return PclPeer::make(step.step->name(), values, pointsForPcl(cloud));
}

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
    const auto peer = options.alone ? nullptr : peerOf(step, *cloud, progress);
    for (int round = 0; round < options.rounds; ++round) {
        KdOrder::drop(*cloud);  // each round makes its own, as PCL does
        const Clock clock;
        const auto command = step.step->run(*cloud, step.values, progress);
        const double seconds = clock.seconds();
        figures.add("seconds", seconds);
        figures.add("mpts_per_s", double(cloud->size()) / seconds * 1e-6);
        figures.add("points_changed", double(command ? command->changedPoints() : 0));
        if (peer == nullptr) continue;
        progress.check();
        const Clock theirs;
        peer->run();
        const double pcl = theirs.seconds();
        figures.add("pcl_mpts_per_s", double(cloud->size()) / pcl * 1e-6);
        figures.add("times_pcl", pcl / seconds);
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
    command.add_flag("--alone", options->alone, "Do not time PCL's class for the same beside it");
    command.callback([options, &action] { action = [options](Progress& p) { runBenchProcess(*options, p); }; });
}

}  // namespace punctum::app
