// SPDX-License-Identifier: MIT
#include "app/commands/StepList.h"

#include "core/cloud/ValueText.h"
#include "core/steps/Steps.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace punctum::app
{

namespace
{

std::string_view nameOf(StepParameter::Type type)
{
    switch (type) {
        case StepParameter::Type::Integer:
            return "integer";
        case StepParameter::Type::Real:
            return "real";
        case StepParameter::Type::AttributeName:
            return "attribute";
        case StepParameter::Type::ClassCode:
            return "class";
        case StepParameter::Type::ClassCodes:
            return "classes";
        case StepParameter::Type::Rule:
            return "rule";
        case StepParameter::Type::Condition:
            return "condition";
        case StepParameter::Type::Text:
            return "text";
        case StepParameter::Type::Choice:
            return "choice";
    }
    return "";
}

std::string_view nameOf(StepParameter::Unit unit)
{
    switch (unit) {
        case StepParameter::Unit::None:
            break;
        case StepParameter::Unit::Length:
            return "length";
        case StepParameter::Unit::Area:
            return "area";
        case StepParameter::Unit::Degrees:
            return "degrees";
        case StepParameter::Unit::PerCent:
            return "%";
    }
    return "";
}

std::string joined(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

/// " In degrees."
std::string unitText(StepParameter::Unit unit)
{
    switch (unit) {
        case StepParameter::Unit::None:
            break;
        case StepParameter::Unit::Length:
            return " In the unit of X and Y; in meters where these are degrees.";
        case StepParameter::Unit::Area:
            return " In the square of the unit of X and Y; in square meters where these are degrees.";
        case StepParameter::Unit::Degrees:
            return " In degrees.";
        case StepParameter::Unit::PerCent:
            return " In percent.";
    }
    return "";
}

/// "Default: 8.", "Optional." or that it must be given.
std::string presetOrNeed(const StepParameter& p)
{
    std::string preset = presetText(p);
    if (!preset.empty()) return preset;
    if (p.wholeOnly) return "Must be given where all points may change.";
    return p.optional ? "Optional." : "Must be given.";
}

/// "Method: Rusu et al. 2008.", ended by one full stop.
std::string methodText(const std::string& source)
{
    return "Method: " + source + (source.ends_with('.') ? "" : ".");
}

std::string underlined(std::string_view title)
{
    return std::string(title) + "\n" + std::string(title.size(), '=') + "\n";
}

/// As it is to be read in a page of Markdown, in the cell of a table, too.
std::string escaped(std::string_view text)
{
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '|' || c == '*' || c == '`')
            out += std::string("\\") + c;
        else
            out += c;
    }
    return out;
}

/// "whole number, 3 to 1000"
std::string typeCell(const StepParameter& p)
{
    using Type = StepParameter::Type;
    std::string text;
    switch (p.type) {
        case Type::Integer:
            text = "whole number";
            break;
        case Type::Real:
            text = "number";
            break;
        case Type::AttributeName:
            return p.ownOnly ? "attribute that is no field of the point format" : "attribute";
        case Type::ClassCode:
            return "class, 0 to 255";
        case Type::ClassCodes:
            return "classes, such as 2,8-9, or none";
        case Type::Rule:
            return "[rule](user.md#rules)";
        case Type::Condition:
            return "[condition](user.md#rules)";
        case Type::Text:
            return "text";
        case Type::Choice:
            return "one of " + escaped(joined(p.choices));
    }
    constexpr double kAnyLength = 1e9;  // a bound that says no more than that it is a length
    if (p.min < p.max && p.max < kAnyLength) text += ", " + shortestText(p.min) + " to " + shortestText(p.max);
    return text;
}

/// "8", "3 times the spacing of the points", "must be given"
std::string presetCell(const StepParameter& p)
{
    constexpr std::string_view kLead = "Default: ";
    std::string text = presetOrNeed(p);
    if (text.starts_with(kLead))
        text.erase(0, kLead.size());
    else
        text[0] = char(std::tolower(static_cast<unsigned char>(text[0])));
    text.pop_back();  // the full stop
    return escaped(text);
}

std::string markdownOf(const Step& step)
{
    const StepDescription& about = step.description();
    std::string text = "\n### `" + about.name + "`: " + escaped(about.title) + "\n\n" + escaped(about.help) + "\n";
    if (!about.source.empty()) text += "\n" + escaped(methodText(about.source)) + "\n";
    if (!about.narrows) text += "\nIt cannot be told to change some points only.\n";
    if (!about.shows.empty()) text += "\nWorth looking at afterwards: `" + about.shows + "`.\n";
    if (about.parameters.empty()) return text;
    text += "\n| key | what | unit | default | |\n| --- | --- | --- | --- | --- |\n";
    for (const StepParameter& p : about.parameters)
        text += "| `" + p.key + "` | " + typeCell(p) + " | " + std::string(nameOf(p.unit)) + " | " + presetCell(p) +
                " | " + escaped(p.help + whenText(p)) + " |\n";
    return text;
}

}  // namespace

std::string textOfSteps()
{
    std::string text;
    const StepDescription* before = nullptr;
    for (const Step* step : allSteps()) {
        const StepDescription& about = step->description();
        if (before == nullptr || before->group != about.group)
            text += (before == nullptr ? "" : "\n") + underlined(nameOf(about.group));
        before = &about;
        text += "\n" + about.name + "\n    " + about.help + "\n";
        if (!about.source.empty()) text += "    " + methodText(about.source) + "\n";
        for (const StepParameter& p : about.parameters) {
            std::string key = "    " + p.key + "=" + std::string(nameOf(p.type));
            key.resize(std::max<std::size_t>(key.size() + 2, 28), ' ');
            text += key + p.help;
            if (!p.choices.empty()) text += " One of " + joined(p.choices) + ".";
            text += unitText(p.unit) + whenText(p) + " " + presetOrNeed(p) + "\n";
        }
    }
    return text;
}

Json jsonOfSteps()
{
    Json all = Json::array();
    for (const Step* step : allSteps()) {
        Json parameters = Json::array();
        for (const StepParameter& p : step->parameters())
            parameters.push_back(
                {{"key", p.key},
                 {"label", p.label},
                 {"help", p.help},
                 {"type", nameOf(p.type)},
                 {"default", p.preset.empty() ? Json(nullptr) : Json(p.preset)},
                 {"default_text", presetText(p)},
                 {"min", p.min},
                 {"max", p.max},
                 {"optional", p.optional},
                 {"choices", p.choices},
                 {"unit", nameOf(p.unit)},
                 {"advanced", p.advanced},
                 {"when", p.when.key.empty() ? Json(nullptr) : Json({{p.when.key, p.when.value}})}});
        const StepDescription& about = step->description();
        all.push_back({{"name", about.name},
                       {"title", about.title},
                       {"group", nameOf(about.group)},
                       {"help", about.help},
                       {"source", about.source},
                       {"shows", about.shows},
                       {"narrows", about.narrows},
                       {"parameters", parameters}});
    }
    return all;
}

std::string markdownOfSteps()
{
    std::string text =
        "# Processing steps\n\n"
        "This page is made by the program from what the steps say of themselves: "
        "`punctum process --list-steps --markdown > docs/steps.md`.\n\n"
        "In the window they are in the Process panel, on the command line "
        "`punctum process IN -o OUT --step \"NAME key=value ...\"` runs them. Keys that are not given have their "
        "defaults. Lengths are true ones, in the unit of X and Y, in meters where these are degrees; areas are in "
        "their squares. Defaults that are so many times the spacing of the points fit themselves to the data.\n";
    const StepDescription* before = nullptr;
    for (const Step* step : allSteps()) {
        const StepDescription& about = step->description();
        if (before == nullptr || before->group != about.group)
            text += "\n## " + std::string(nameOf(about.group)) + "\n";
        before = &about;
        text += markdownOf(*step);
    }
    return text;
}

}  // namespace punctum::app
