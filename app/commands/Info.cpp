// SPDX-License-Identifier: MIT
// punctum info: what is in a file, computed from its points, and what is wrong with it.
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "app/commands/InfoReport.h"
#include "core/Error.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct InfoOptions {
    std::vector<std::string> files;
    bool json = false;
};

void runInfo(const InfoOptions& options, Progress& progress)
{
    Json all = Json::array();
    bool failed = false;
    bool first = true;
    const std::vector<std::filesystem::path> files = inputFiles(options.files, progress);
    for (const std::filesystem::path& file : files) {
        try {
            const FileInfo info = inspect(file, progress);
            if (options.json)
                all.push_back(jsonOf(info));
            else
                print((first ? "" : "\n") + textOf(info));
            first = false;
        } catch (const Error& error) {
            // the files after it may well be readable
            complain(error.what());
            failed = true;
        }
    }
    if (options.json && !all.empty()) printJson(files.size() == 1 ? all[0] : all);
    if (failed) throw Reported{};
}

}  // namespace

void addInfo(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(
        root, "info",
        "Tell what is in LAS or LAZ files: header, CRS, records, each attribute's range and mean, counts by "
        "class, return and flag, density and GPS time computed from the points, and what is wrong with the "
        "file and would mend it.");
    const auto options = std::make_shared<InfoOptions>();
    command.add_option("FILE", options->files, "LAS or LAZ files, or folders and .vpc of them")->required();
    command.add_flag("--json", options->json, "Print JSON: an object for one file, an array for several");
    command.callback([options, &action] { action = [options](Progress& p) { runInfo(*options, p); }; });
}

}  // namespace punctum::app
