// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <stdexcept>
#include <string>

namespace punctum
{
class Progress;
}

namespace punctum::app
{

/// What a command line asks for, found while it is parsed and run afterwards, so that wrong usage (exit 2) and work
/// that failed (exit 1) cannot be confused. Throws Error, Cancelled, UsageError or Reported.
using Action = std::function<void(Progress&)>;

/// A command line that is well formed but makes no sense with the files it names: exit 2.
class UsageError : public std::runtime_error
{
    using std::runtime_error::runtime_error;
};

/// The work failed and stderr says why already, or the answer was no and is told: exit 1.
struct Reported {
};

// Each adds one subcommand with its options to `root`, and sets `action` when it is the one chosen.
void addInfo(CLI::App& root, Action& action);
void addConvert(CLI::App& root, Action& action);
void addDiff(CLI::App& root, Action& action);
void addRepair(CLI::App& root, Action& action);
void addRender(CLI::App& root, Action& action);
void addProcess(CLI::App& root, Action& action);
void addExtract(CLI::App& root, Action& action);
void addVolume(CLI::App& root, Action& action);
void addReplay(CLI::App& root, Action& action);
void addRaster(CLI::App& root, Action& action);
void addContours(CLI::App& root, Action& action);
void addOutline(CLI::App& root, Action& action);
void addTrees(CLI::App& root, Action& action);
void addSample(CLI::App& root, Action& action);
void addBench(CLI::App& root, Action& action);

/// A subcommand in the style of all of them: help, version, description.
CLI::App& addCommand(CLI::App& root, const std::string& name, const std::string& description);

}  // namespace punctum::app
