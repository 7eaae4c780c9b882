// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace punctum::app
{

/// How the program ends (docs: `punctum --help`).
enum ExitCode : int {
    kDone = 0,
    kFailed = 1,  ///< the work failed; one sentence on stderr says why
    kUsage = 2,   ///< the command line is wrong
};

/// Whether this word is a subcommand rather than a file.
bool isCommand(std::string_view word);

/// Parses and runs a command line that begins with a subcommand, --help or --version; returns the exit code. Needs
/// no display and no Qt application.
int runCommandLine(int argc, char** argv);

}  // namespace punctum::app
