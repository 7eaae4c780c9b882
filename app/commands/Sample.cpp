// SPDX-License-Identifier: MIT
// punctum sample: writes a synthetic survey.
#include "core/sample/Sample.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct SampleOptions {
    std::string out;
    std::uint64_t points = 0;
    std::uint64_t seed = 1;
    bool replaceProtected = false;
    bool json = false;
};

void runSample(const SampleOptions& options, Progress& progress)
{
    checkCloudName(options.out);
    checkFolder(options.out);
    const auto cloud = makeSample(options.points, options.seed, progress);
    las::WriteOptions write;
    write.compressed = las::isCompressedName(options.out);
    // there is no original to lose: whoever wants another copy makes one from the seed
    write.verify = false;
    write.replaceProtected = options.replaceProtected;
    reportWritten(withHints([&] { return las::write(*cloud, options.out, write, progress); }), options.out,
                  options.json);
}

}  // namespace

void addSample(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "sample",
                                   "Write a synthetic but lifelike survey: terrain, buildings, trees, "
                                   "several returns, colors, GPS time, extra bytes. The same points "
                                   "and seed give the same file on every machine.");
    const auto options = std::make_shared<SampleOptions>();
    // more than 2^32 - 2 points cannot be drawn, which is what samples are for
    constexpr std::uint64_t kMost = 4'000'000'000;
    command.add_option("OUT", options->out, "File to write: .las or .laz")->required();
    command.add_option("--points", options->points, "How many points")
        ->required()
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t(1), kMost));
    command.add_option("--seed", options->seed, "Number that decides the landscape; default 1")->type_name("S");
    addReplaceProtected(command, options->replaceProtected);
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runSample(*options, p); }; });
}

}  // namespace punctum::app
