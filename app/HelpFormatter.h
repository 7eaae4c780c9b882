// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace punctum::app
{

/// Lays out --help: what an option does stands in a second column, broken into lines that fit a terminal.
class HelpFormatter final : public CLI::Formatter
{
public:
    std::string make_option(const CLI::Option* option, bool positional) const override;
    std::string make_usage(const CLI::App* app, std::string name) const override;
    std::string make_subcommand(const CLI::App* command) const override;
    std::string make_description(const CLI::App* app) const override;
};

}  // namespace punctum::app
