// SPDX-License-Identifier: MIT
// punctum convert: reads a cloud and writes it again, as LAS or LAZ, losing nothing.
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

struct ConvertOptions {
    std::string in;
    std::string out;
    std::string version;
    int format = -1;
    bool upgrade = false;
    bool lossy = false;
    bool noVerify = false;
    bool replaceProtected = false;
    bool json = false;
};

void runConvert(const ConvertOptions& options, Progress& progress)
{
    const std::vector<std::filesystem::path> files = inputFiles({options.in}, progress);
    const Output out = outputOf(options.out, files.size() > 1);
    const auto session = loadForWriting(files, out, progress);
    las::WriteOptions write;
    if (!options.version.empty()) write.versionMinor = std::uint8_t(options.version.back() - '0');
    if (options.format >= 0) write.pointFormat = std::uint8_t(options.format);
    write.verify = !options.noVerify;
    write.replaceProtected = options.replaceProtected;
    write.upgrade = options.upgrade;
    write.lossy = options.lossy;
    reportWritten(saveSession(*session, out, write, progress), options.out, options.json);
}

}  // namespace

void addConvert(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "convert",
                                   "Write a cloud again as LAS or LAZ, as the ending of OUT says. "
                                   "Every field of every point, every record and the header are kept.");
    const auto options = std::make_shared<ConvertOptions>();
    command.add_option("IN", options->in, "LAS or LAZ file to read; a folder or a .vpc is taken as one survey")
        ->required();
    command
        .add_option("OUT", options->out,
                    "File to write (.las or .laz), or a folder, in which each file gets its own name")
        ->required();
    command
        .add_option("--las-version", options->version,
                    "LAS version to write, with the nearest point format that it has; default: as IN")
        ->type_name("VERSION")
        ->check(CLI::IsMember({"1.2", "1.3", "1.4", "1.5"}));
    command
        .add_option("--point-format", options->format, "Point data record format to write, 0 to 10; default: as IN")
        ->type_name("N")
        ->check(CLI::Range(0, 10));
    command.add_flag(
        "--lossy", options->lossy,
        "Round or leave out what the point format and version asked for cannot hold, and say what and of "
        "how many points");
    addUpgrade(command, options->upgrade);
    addNoVerify(command, options->noVerify);
    addReplaceProtected(command, options->replaceProtected);
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runConvert(*options, p); }; });
}

}  // namespace punctum::app
