// SPDX-License-Identifier: MIT
// punctum: with files the window, with a subcommand the work that needs none.
#include "app/Cli.h"
#include "app/Window.h"

#include <algorithm>
#include <csignal>
#include <string_view>

int main(int argc, char** argv)
{
    using namespace punctum::app;
    // a file size limit is an error of write() like a full disk, not a reason to die with half a file
    std::signal(SIGXFSZ, SIG_IGN);

    // words after "--" are files, whatever they look like
    char** const end = std::find(argv, argv + argc, std::string_view("--"));
    const bool asks = std::any_of(
        argv, end, [](std::string_view word) { return word == "--help" || word == "-h" || word == "--version"; });
    if (argc > 1 && (asks || isCommand(argv[1]))) return runCommandLine(argc, argv);
    return runWindowed(argc, argv);
}
