// SPDX-License-Identifier: MIT
#include "core/process/Step.h"

#include "core/Error.h"
#include "core/cloud/ValueText.h"
#include "core/expression/Condition.h"
#include "core/expression/Rule.h"
#include "core/process/AttributeList.h"
#include "core/process/Delete.h"
#include "core/process/Normals.h"
#include "core/process/Outliers.h"
#include "core/process/Reclassify.h"
#include "core/process/SetByRule.h"
#include "core/process/Values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace punctum
{

namespace
{

/// "a, b and c"
template <typename Items, typename NameOf>
std::string enumerate(const Items& items, NameOf nameOf)
{
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i != 0) text += i + 1 == items.size() ? " and " : ", ";
        text += nameOf(items[i]);
    }
    return text;
}

std::string stepNames()
{
    return enumerate(allSteps(), [](const Step* s) { return s->name(); });
}

bool isSpace(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// Takes the next word; "..." or '...' inside it keeps spaces, so that attribute="Echo width" is one word.
std::string takeWord(std::string_view& text)
{
    std::string word;
    char quote = 0;
    while (!text.empty() && (quote != 0 || !isSpace(text.front()))) {
        const char c = text.front();
        text.remove_prefix(1);
        if (quote == 0 && (c == '"' || c == '\''))
            quote = c;
        else if (c == quote)
            quote = 0;
        else
            word += c;
    }
    if (quote != 0) throw Error("The step's text has a quotation mark that is not closed.");
    return word;
}

void skipSpace(std::string_view& text)
{
    while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
}

const StepParameter* findParameter(const std::vector<StepParameter>& parameters, std::string_view key)
{
    const auto it = std::find_if(parameters.begin(), parameters.end(), [&](auto& p) { return p.key == key; });
    return it == parameters.end() ? nullptr : &*it;
}

[[noreturn]] void refuseKey(const Step& step, const std::vector<StepParameter>& parameters, std::string_view key)
{
    if (parameters.empty()) throw Error(step.name() + " takes no values.");
    throw Error(step.name() + " has no key \"" + std::string(key) + "\"; its keys are " +
                enumerate(parameters, [](const StepParameter& p) { return p.key; }) + ".");
}

/// What a value of this parameter has to be: "a whole number from 3 to 1000".
std::string demand(const StepParameter& p)
{
    if (p.type == StepParameter::Type::AttributeName) return "the name of an attribute";
    if (p.type == StepParameter::Type::Rule) return "a rule such as Classification = 2 if Z < 12.5";
    if (p.type == StepParameter::Type::Text) return "a text";
    if (p.type == StepParameter::Type::Condition) return "a condition such as Classification == 7";
    if (p.type == StepParameter::Type::Choice)
        return "one of " + enumerate(p.choices, [](const std::string& choice) { return choice; });
    std::string text = p.type == StepParameter::Type::Real ? "a number" : "a whole number";
    if (p.type == StepParameter::Type::ClassCode) return text + " from 0 to 255";
    if (p.min < p.max) text += " from " + shortestText(p.min) + " to " + shortestText(p.max);
    return text;
}

void checkValue(const Step& step, const StepParameter& p, const std::string& text)
{
    bool fits = false;
    if (p.type == StepParameter::Type::AttributeName || p.type == StepParameter::Type::Text) {
        fits = !text.empty();
    } else if (p.type == StepParameter::Type::Rule) {
        fits = !text.empty();
        if (fits) expression::Rule{text};  // refuses by itself, and says where
    } else if (p.type == StepParameter::Type::Condition) {
        fits = !text.empty();
        if (fits) expression::Condition::check(text);
    } else if (p.type == StepParameter::Type::Choice) {
        fits = std::find(p.choices.begin(), p.choices.end(), text) != p.choices.end();
    } else if (const auto number = parseNumber(text)) {
        const double v = toDouble(*number);
        const bool whole = !std::holds_alternative<double>(*number);
        const bool bounded = p.type == StepParameter::Type::ClassCode || p.min < p.max;
        const double lo = p.type == StepParameter::Type::ClassCode ? 0.0 : p.min;
        const double hi = p.type == StepParameter::Type::ClassCode ? 255.0 : p.max;
        fits = (whole || p.type == StepParameter::Type::Real) && (!bounded || (v >= lo && v <= hi));
    }
    if (fits) return;
    throw Error(step.name() + ": " + p.key + " must be " + demand(p) + ", not \"" + text + "\".");
}

}  // namespace

std::unique_ptr<Command> Step::runWithin(const PointCloud&, const StepValues&, const PointSet&, Progress&) const
{
    throw Error("The step " + name() + " changes all points, not some of them.");
}

std::optional<Value> parseNumber(std::string_view text)
{
    if (text.starts_with('+')) {
        text.remove_prefix(1);
        if (text.starts_with('-')) return {};
    }
    const auto parse = [text](auto number) -> std::optional<Value> {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc() || end != text.data() + text.size()) return {};
        return Value(number);
    };
    if (const auto v = parse(std::int64_t{})) return v;
    if (const auto v = parse(std::uint64_t{})) return v;
    const auto v = parse(double{});
    return v && std::isnan(std::get<double>(*v)) ? std::nullopt : v;
}

std::optional<double> realValue(const StepValues& values, std::string_view key)
{
    const auto it = values.find(key);
    const auto number = it == values.end() ? std::nullopt : parseNumber(it->second);
    return number ? std::optional(toDouble(*number)) : std::nullopt;
}

std::optional<std::int64_t> integerValue(const StepValues& values, std::string_view key)
{
    const auto it = values.find(key);
    const auto number = it == values.end() ? std::nullopt : parseNumber(it->second);
    if (!number || !std::holds_alternative<std::int64_t>(*number)) return {};
    return std::get<std::int64_t>(*number);
}

std::string textValue(const StepValues& values, std::string_view key)
{
    const auto it = values.find(key);
    return it == values.end() ? std::string() : it->second;
}

std::span<const Step* const> allSteps()
{
    static const NormalsStep normals;
    static const OutliersStep outliers;
    static const ReclassifyStep reclassify;
    static const SetByRuleStep setByRule;
    static const DeleteStep deleteStep;
    static const RestoreStep restore;
    static const RenameStep rename;
    static const RemoveStep remove;
    static const std::array<const Step*, 8> steps{&normals,    &outliers, &reclassify, &setByRule,
                                                  &deleteStep, &restore,  &rename,     &remove};
    return steps;
}

const Step* findStep(std::string_view name)
{
    for (const Step* step : allSteps())
        if (step->name() == name) return step;
    return nullptr;
}

ParsedStep parseStep(std::string_view text)
{
    skipSpace(text);
    const std::string name = takeWord(text);
    if (name.empty()) throw Error("Name a step; the steps are " + stepNames() + ".");
    ParsedStep parsed;
    parsed.step = findStep(name);
    if (parsed.step == nullptr)
        throw Error("There is no step \"" + name + "\"; the steps are " + stepNames() + ".");
    const auto parameters = parsed.step->parameters();
    for (skipSpace(text); !text.empty(); skipSpace(text)) {
        const std::string word = takeWord(text);
        const auto equals = word.find('=');
        if (equals == std::string::npos)
            throw Error(name + ": write \"" + word + "\" as key=value; its keys are " +
                        enumerate(parameters, [](const StepParameter& p) { return p.key; }) + ".");
        const std::string key = word.substr(0, equals);
        if (findParameter(parameters, key) == nullptr) refuseKey(*parsed.step, parameters, key);
        if (!parsed.values.emplace(key, word.substr(equals + 1)).second)
            throw Error(name + ": " + key + " is given twice.");
    }
    parsed.values = completeValues(*parsed.step, parsed.values);
    return parsed;
}

StepValues completeValues(const Step& step, const StepValues& values)
{
    const auto parameters = step.parameters();
    for (const auto& [key, text] : values)
        if (findParameter(parameters, key) == nullptr) refuseKey(step, parameters, key);
    StepValues complete;
    for (const StepParameter& p : parameters) {
        const auto it = values.find(p.key);
        const std::string& text = it == values.end() ? p.preset : it->second;
        if (text.empty() && p.optional) continue;  // an empty field of a form means the same as no key
        if (it == values.end() && text.empty())
            throw Error(step.name() + " needs " + p.key + "=, " + demand(p) + ".");
        checkValue(step, p, text);
        complete.emplace(p.key, text);
    }
    return complete;
}

}  // namespace punctum
