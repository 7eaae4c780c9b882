// SPDX-License-Identifier: MIT
#include "app/HelpFormatter.h"

#include <sstream>

namespace punctum::app
{

namespace
{

constexpr std::size_t kWidth = 100;
constexpr std::size_t kColumn = 28;

/// Text in lines that end before kWidth, each but the first indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t at)
{
    std::string out;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (at > indent && at + 1 + word.size() > kWidth) {
            out += '\n' + std::string(indent, ' ');
            at = indent;
        } else if (at > indent) {
            out += ' ';
            ++at;
        }
        out += word;
        at += word.size();
    }
    return out;
}

std::string row(const std::string& name, const std::string& description)
{
    std::string line = "  " + name;
    if (line.size() + 2 > kColumn)
        line += '\n' + std::string(kColumn, ' ');
    else
        line.resize(kColumn, ' ');
    return line + wrapped(description, kColumn, kColumn) + '\n';
}

/// What stands for the value of an option: "N". CLI11 puts what its checks say behind it, which we leave out.
std::string valueName(const CLI::Option* option)
{
    std::string type = option->get_type_name();
    for (std::size_t colon = type.find(':'); colon != std::string::npos; colon = type.find(':', colon + 1)) {
        const std::string check = type.substr(colon + 1);
        if (check.starts_with('{') || check.find(" in [") != std::string::npos) return type.substr(0, colon);
    }
    return type;
}

}  // namespace

std::string HelpFormatter::make_option(const CLI::Option* option, bool positional) const
{
    std::string name = option->get_name(positional, true);
    if (const std::size_t comma = name.find(','); comma != std::string::npos) name.insert(comma + 1, 1, ' ');
    if (!positional && option->get_items_expected_max() > 0) name += ' ' + valueName(option);
    return row(name, option->get_description());
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const
{
    if (app->get_parent() == nullptr) return "Usage: punctum [FILE|FOLDER...]\n       punctum COMMAND [OPTIONS]\n";
    std::string usage = "Usage: " + name;
    if (!app->get_subcommands({}).empty()) usage += " WHAT";
    for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return o->get_positional(); })) {
        const bool several = option->get_items_expected_max() > 1;
        usage += ' ' + option->get_name(true) + (several ? "..." : "");
    }
    for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return o->nonpositional(); }))
        if (option->get_required())
            usage += ' ' + option->get_name().substr(0, option->get_name().find(',')) + ' ' + valueName(option);
    return usage + " [OPTIONS]\n";
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const
{
    return row(command->get_name(), command->get_description());
}

std::string HelpFormatter::make_description(const CLI::App* app) const
{
    std::string text;
    std::istringstream lines(app->get_description());
    for (std::string line; std::getline(lines, line);) text += wrapped(line, 0, 0) + '\n';
    return text;
}

}  // namespace punctum::app
