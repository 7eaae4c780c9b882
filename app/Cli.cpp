// SPDX-License-Identifier: MIT
#include "app/Cli.h"

#include "app/Console.h"
#include "app/HelpFormatter.h"
#include "app/Interrupt.h"
#include "app/MemoryOption.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/task/Progress.h"

#include <new>
#include <regex>

namespace punctum::app
{

namespace
{

constexpr const char* kVersion = "punctum " PUNCTUM_VERSION;

/// The whole command line; `action` gets what it asks for when it is parsed.
void describe(CLI::App& root, Action& action)
{
    root.name("punctum");
    root.description(
        "Punctum opens laser scans (LAS, LAZ): with files, or nothing, it opens the window.\n"
        "Several files, a folder or a virtual point cloud (.vpc) are one survey.\n"
        "The commands below need no display. A file with the name of a command is written ./info.");
    root.set_help_flag("-h,--help", "Show this help");
    root.set_version_flag("--version", kVersion, "Show the version");
    root.formatter(std::make_shared<HelpFormatter>());  // taken over by the commands
    addInfo(root, action);
    addConvert(root, action);
    addDiff(root, action);
    addRepair(root, action);
    addRender(root, action);
    addProcess(root, action);
    addExtract(root, action);
    addVolume(root, action);
    addReplay(root, action);
    addRaster(root, action);
    addContours(root, action);
    addOutline(root, action);
    addTrees(root, action);
    addSample(root, action);
    addBench(root, action);
    root.require_subcommand(1);
    root.footer(
        "Options of the window: --backend cpu, gl-compute or gl-points draws; --order stratified or prime; "
        "--budget MS\n"
        "for a frame in motion, or --budget-points N in each frame; --memory SIZE for what points keep in memory.\n"
        "Exit code: 0 done, 1 the work failed (one sentence says why), 2 wrong usage.\n"
        "punctum COMMAND --help tells the options of a command.");
}

/// The command that the words name, for "see ... --help".
std::string chosenCommand(const CLI::App& root)
{
    std::string name = "punctum";
    const CLI::App* app = &root;
    while (!app->get_subcommands().empty()) {
        app = app->get_subcommands().front();
        name += ' ' + app->get_name();
    }
    return name;
}

std::string withFullStop(std::string sentence)
{
    if (!sentence.empty() && std::string_view(".?!)").find(sentence.back()) == std::string_view::npos)
        sentence += '.';
    return sentence;
}

/// "0.100000" as "0.1".
std::string shortNumber(std::string text)
{
    if (text.find('.') == std::string::npos) return text;
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

/// What is wrong with the words, in words of ours where the parser has a shorthand of its own.
std::string sentenceOf(const CLI::ParseError& error)
{
    static const std::regex range("(-\\S+): Value (.*) not in range \\[?([-0-9.e+]+)(?: to | - )([-0-9.e+]+)\\]?"),
        choice("(-\\S+): (.*) not in \\{(.*)\\}"), twice("(-\\S+): At Most 1 required but received \\d+");
    const std::string said = error.what();
    std::smatch part;
    if (std::regex_match(said, part, range))
        return part.str(1) + " must be from " + shortNumber(part.str(3)) + " to " + shortNumber(part.str(4)) +
               ", not \"" + part.str(2) + "\".";
    if (std::regex_match(said, part, choice))
        return part.str(1) + " must be one of " + std::regex_replace(part.str(3), std::regex(","), ", ") +
               ", not \"" + part.str(2) + "\".";
    if (std::regex_match(said, part, twice)) return part.str(1) + " is given more than once.";
    return withFullStop(said);
}

int run(const Action& action, const std::string& command)
{
    Progress progress;
    try {
        const Interrupt interrupt(progress);
        const ProgressBar bar(progress);
        action(progress);
        return kDone;
    } catch (const UsageError& error) {
        complain(withFullStop(error.what()) + " See " + command + " --help.");
        return kUsage;
    } catch (const Reported&) {
        // the user has been told already
    } catch (const Cancelled&) {
        complain("Cancelled; nothing was written.");
    } catch (const Error& error) {
        complain(withFullStop(error.what()));
    } catch (const std::bad_alloc&) {
        complain("There is not enough memory for this.");
    } catch (const std::exception& error) {
        complain(withFullStop(error.what()));
    }
    return kFailed;
}

}  // namespace

CLI::App& addCommand(CLI::App& root, const std::string& name, const std::string& description)
{
    CLI::App& command = *root.add_subcommand(name, description);
    command.set_help_flag("-h,--help", "Show this help");
    command.set_version_flag("--version", kVersion, "Show the version");
    command
        .add_option_function<std::string>(
            "--memory",
            [](const std::string& text) {
                if (std::string wrong = takeMemoryBudget(text); !wrong.empty()) throw CLI::ValidationError(wrong);
            },
            "What points may keep in memory, such as 2G; the rest is on the disk")
        ->type_name("SIZE");
    return command;
}

bool isCommand(std::string_view word)
{
    CLI::App root;
    Action action;
    describe(root, action);
    for (const CLI::App* command : root.get_subcommands({}))
        if (command->get_name() == word) return true;
    return false;
}

int runCommandLine(int argc, char** argv)
{
    CLI::App root;
    Action action;
    describe(root, action);
    try {
        root.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return root.exit(success) == 0 && std::fflush(stdout) == 0 ? kDone : kFailed;  // help, version
    } catch (const CLI::ParseError& error) {
        complain(sentenceOf(error) + " See " + chosenCommand(root) + " --help.");
        return kUsage;
    }
    return run(action, chosenCommand(root));
}

}  // namespace punctum::app
