// SPDX-License-Identifier: MIT
// punctum extract: writes the points for which a condition holds.
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct ExtractOptions {
    std::string in;
    std::string out;
    std::string where;
    bool noVerify = false;
    bool replaceProtected = false;
    bool json = false;
};

void runExtract(const ExtractOptions& options, Progress& progress)
{
    try {
        expression::Condition::check(options.where);  // before the first point is read
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
    checkCloudName(options.out);
    std::error_code ignored;
    if (std::filesystem::equivalent(options.in, options.out, ignored))
        throw UsageError("OUT is IN: points that are left out would be lost. Name another file");
    const auto session = loadForWriting(inputFiles({options.in}, progress), {options.out, false}, progress);
    const PointCloud& cloud = *session->cloud();
    const auto points = expression::select(cloud, expression::Condition(options.where, cloud), progress);
    las::WriteOptions write;
    write.verify = !options.noVerify;
    write.replaceProtected = options.replaceProtected;
    reportWritten(withHints([&] { return session->extract(*points, options.out, write, progress); }), options.out,
                  options.json, {{"points_read", cloud.size()}});
}

}  // namespace

void addExtract(CLI::App& root, Action& action)
{
    CLI::App& command =
        addCommand(root, "extract",
                   "Write the points for which a condition holds, such as --where \"not Withheld\" or "
                   "--where \"Classification in (2, 6)\". Header, records and every value are kept.");
    const auto options = std::make_shared<ExtractOptions>();
    command.add_option("IN", options->in, "LAS or LAZ file to read; a folder or a .vpc is taken as one survey")
        ->required();
    command.add_option("-o,--output", options->out, "File to write: .las or .laz")->type_name("OUT")->required();
    command.add_option("--where", options->where, "Condition over attributes; the user guide tells the language")
        ->type_name("CONDITION")
        ->required();
    addNoVerify(command, options->noVerify);
    addReplaceProtected(command, options->replaceProtected);
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runExtract(*options, p); }; });
}

}  // namespace punctum::app
