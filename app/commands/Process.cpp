// SPDX-License-Identifier: MIT
// punctum process: runs processing steps over a cloud, in order, and writes the result.
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "app/commands/StepList.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/expression/Condition.h"
#include "core/las/Writer.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <chrono>
#include <memory>

namespace punctum::app
{
namespace
{

struct ProcessOptions {
    std::vector<std::string> in;
    std::string out;
    std::vector<std::string> steps;
    std::string within;
    bool upgrade = false;
    bool noVerify = false;
    bool replaceProtected = false;
    bool list = false;
    bool markdown = false;
    bool json = false;
};

/// Steps from the shell's words, where "--step normals k=16" may have come without quotation marks: a word that
/// begins with a key belongs to the step before it.
std::vector<std::string> joinedSteps(const std::vector<std::string>& words)
{
    std::vector<std::string> steps;
    for (const std::string& word : words) {
        const std::size_t equals = word.find('=');
        const std::size_t space = word.find(' ');
        if (equals == std::string::npos || equals > space || steps.empty())
            steps.push_back(word);
        else if (space == std::string::npos)
            steps.back() += ' ' + word;
        else {
            const char mark = word.find('"') == std::string::npos ? '"' : '\'';
            steps.back() += ' ' + word.substr(0, equals + 1) + mark + word.substr(equals + 1) + mark;
        }
    }
    return steps;
}

/// Whether one of the values that were given is a length.
bool hasLength(const ParsedStep& step)
{
    const auto parameters = step.step->parameters();
    return std::any_of(parameters.begin(), parameters.end(), [&](const StepParameter& p) {
        return p.unit == StepParameter::Unit::Length && step.values.contains(p.key);
    });
}

void runProcess(const ProcessOptions& options, Progress& progress)
{
    if (options.list) {
        if (options.json)
            printJson(jsonOfSteps());
        else
            print(options.markdown ? markdownOfSteps() : textOfSteps());
        return;
    }
    // all that can be wrong is found before the first point is read
    const std::vector<std::string> words = joinedSteps(options.steps);
    std::vector<ParsedStep> steps;
    const bool narrowed = !options.within.empty();
    if (narrowed) {
        try {
            expression::Condition::check(options.within);
        } catch (const Error& error) {
            throw UsageError(std::string("--within: ") + error.what());
        }
    }
    for (const std::string& text : words) {
        try {
            steps.push_back(parseStep(text, narrowed));
        } catch (const Error& error) {
            throw UsageError(error.what());
        }
    }
    const std::vector<std::filesystem::path> files = inputFiles(options.in, progress);
    const Output out = outputOf(options.out, files.size() > 1);
    const auto session = loadForWriting(files, out, progress);

    Json report = Json::array();
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const auto start = std::chrono::steady_clock::now();
        std::shared_ptr<const PointSet> within;
        if (narrowed)  // anew: the step before may have changed what it reads
            within = expression::select(*session->cloud(), expression::Condition(options.within, *session->cloud()),
                                        progress);
        const EditOutcome outcome = session->edit({steps[k].step->name(), steps[k].values, within}, progress);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        Json line = {{"step", words[k]}, {"points_changed", outcome.changed}, {"seconds", seconds.count()}};
        if (within) line["points_within"] = within->count();
        if (!outcome.finding.empty()) line["finding"] = outcome.finding;
        std::string lengths;
        if (hasLength(steps[k])) {
            const std::string unit = trueLengths(*session->cloud(), WorldBounds()).unit;
            line["length_unit"] = unit;
            lengths =
                unit.empty() ? " (the file does not say the unit of its lengths)" : " (lengths in " + unit + ")";
        }
        report.push_back(std::move(line));
        if (!options.json)
            note(words[k] + ": " + pointsText(outcome.changed) + " changed" + lengths + "." +
                 (outcome.finding.empty() ? "" : " " + outcome.finding));
    }
    las::WriteOptions write;
    write.verify = !options.noVerify;
    write.replaceProtected = options.replaceProtected;
    write.upgrade = options.upgrade;
    reportWritten(saveSession(*session, out, write, progress), options.out, options.json, {{"steps", report}});
}

}  // namespace

void addProcess(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "process",
                                   "Run processing steps over a cloud, one after the other, and write "
                                   "the result. --list-steps tells which steps there are.");
    const auto options = std::make_shared<ProcessOptions>();
    CLI::Option* in =
        command.add_option("IN", options->in, "LAS or LAZ files, folders or .vpc, taken as one survey");
    CLI::Option* out =
        command
            .add_option("-o,--output", options->out,
                        "File to write (.las or .laz), or a folder, in which each file gets its own name")
            ->type_name("OUT");
    CLI::Option* steps = command
                             .add_option("--step", options->steps,
                                         "A step: its name, then key=value for each parameter, such as "
                                         "--step \"normals k=16\"; may be given again for further steps")
                             ->type_name("STEP");
    command
        .add_option("--within", options->within,
                    "The steps change only points for which this condition holds, such as \"Classification == 2\"; "
                    "it is looked at anew before each step")
        ->type_name("CONDITION");
    addUpgrade(command, options->upgrade);
    addNoVerify(command, options->noVerify);
    addReplaceProtected(command, options->replaceProtected);
    command.add_flag("--list-steps", options->list, "List all steps with their parameters, and do nothing else");
    command.add_flag("--markdown", options->markdown, "The list of steps as a page in Markdown: docs/steps.md");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([=, &action] {
        if (!options->list) {
            if (in->empty()) throw CLI::RequiredError("IN");
            if (out->empty()) throw CLI::RequiredError("-o OUT");
            if (steps->empty()) throw CLI::RequiredError("--step");
        }
        action = [options](Progress& p) { runProcess(*options, p); };
    });
}

}  // namespace punctum::app
