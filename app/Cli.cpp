// SPDX-License-Identifier: MIT
#include "app/Cli.h"

#include "app/Console.h"
#include "app/HelpFormatter.h"
#include "app/Interrupt.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/task/Progress.h"

#include <new>

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
    addReplay(root, action);
    addSample(root, action);
    addBench(root, action);
    root.require_subcommand(1);
    root.footer(
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
        complain(withFullStop(error.what()) + " See " + chosenCommand(root) + " --help.");
        return kUsage;
    }
    return run(action, chosenCommand(root));
}

}  // namespace punctum::app
