// SPDX-License-Identifier: MIT
// punctum repair: a new file with all put right that can be without guessing.
#include "core/las/Repair.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "app/commands/InfoReport.h"
#include "core/Text.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct RepairOptions {
    std::string in;
    std::string out;
    bool json = false;
};

std::string textOf(const las::RepairReport& report, const RepairOptions& options)
{
    std::string text;
    if (report.written)
        text += options.out + ": " + pointsText(report.points) + " as they were, " + grouped(report.bytes) +
                " bytes; read back and compared.\n\n  Mended\n" + findingsText(report.mended);
    else
        text += options.in + ": There is nothing to mend without guessing; nothing was written.\n";
    if (!report.left.empty()) text += "\n  Left as it is\n" + findingsText(report.left);
    return text;
}

void runRepair(const RepairOptions& options, Progress& progress)
{
    checkCloudName(options.out);
    checkFolder(options.out);
    const las::RepairReport report = las::repair(options.in, options.out, progress);
    if (options.json) {
        printJson({{"in", options.in},
                   {"file", report.written ? Json(options.out) : Json(nullptr)},
                   {"points", report.written ? Json(report.points) : Json(nullptr)},
                   {"bytes", report.written ? Json(report.bytes) : Json(nullptr)},
                   {"mended", findingsJson(report.mended)},
                   {"left", findingsJson(report.left)},
                   {"notes", report.notes}});
        return;
    }
    for (const std::string& sentence : report.notes) note(sentence);
    print(textOf(report, options));
}

}  // namespace

void addRepair(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "repair",
                                   "Write a new file with all put right that can be without guessing: counts, "
                                   "points by return, bounds, number "
                                   "and position of records, encoding bits. Points and records stay byte for byte "
                                   "as they are, which is proven "
                                   "by reading the new file. Where nothing can be mended, nothing is written.");
    const auto options = std::make_shared<RepairOptions>();
    command.add_option("IN", options->in, "LAS or LAZ file to mend")->required();
    command.add_option("-o,--output", options->out, "File to write, of the same kind as IN: .las or .laz")
        ->type_name("OUT")
        ->required();
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runRepair(*options, p); }; });
}

}  // namespace punctum::app
