// SPDX-License-Identifier: MIT
#include "core/process/Step.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/PointCloud.h"
#include "core/cloud/ValueText.h"
#include "core/expression/Condition.h"
#include "core/expression/Rule.h"
#include "core/measure/Spacing.h"
#include "core/process/Values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace punctum
{

namespace
{

const StepParameter* findParameter(const std::vector<StepParameter>& parameters, std::string_view key)
{
    const auto it = std::find_if(parameters.begin(), parameters.end(), [&](auto& p) { return p.key == key; });
    return it == parameters.end() ? nullptr : &*it;
}

/// What a value of this parameter has to be: "a whole number from 3 to 1000".
std::string demand(const StepParameter& p)
{
    switch (p.type) {
        case StepParameter::Type::AttributeName:
            return "the name of an attribute";
        case StepParameter::Type::Rule:
            return "a rule such as Classification = 2 if Z < 12.5";
        case StepParameter::Type::Text:
            return "a text";
        case StepParameter::Type::Condition:
            return "a condition such as Classification == 7";
        case StepParameter::Type::Choice:
            return "one of " + enumerated(p.choices, [](const std::string& choice) { return choice; });
        case StepParameter::Type::ClassCodes:
            return "classes from 0 to 255, such as 2,8-9";
        case StepParameter::Type::ClassCode:
            return "a whole number from 0 to 255";
        case StepParameter::Type::Integer:
        case StepParameter::Type::Real:
            break;
    }
    std::string text = p.type == StepParameter::Type::Real ? "a number" : "a whole number";
    if (p.min < p.max) text += " from " + shortestText(p.min) + " to " + shortestText(p.max);
    return text;
}

bool numberFits(const StepParameter& p, const std::string& text)
{
    const auto number = parseNumber(text);
    if (!number) return false;
    const double v = toDouble(*number);
    const bool whole = !std::holds_alternative<double>(*number);
    const bool bounded = p.type == StepParameter::Type::ClassCode || p.min < p.max;
    const double lo = p.type == StepParameter::Type::ClassCode ? 0.0 : p.min;
    const double hi = p.type == StepParameter::Type::ClassCode ? 255.0 : p.max;
    return (whole || p.type == StepParameter::Type::Real) && (!bounded || (v >= lo && v <= hi));
}

void checkValue(const Step& step, const StepParameter& p, const std::string& text)
{
    bool fits = false;
    switch (p.type) {
        case StepParameter::Type::AttributeName:
        case StepParameter::Type::Text:
            fits = !text.empty();
            break;
        case StepParameter::Type::Rule:
            fits = !text.empty();
            if (fits) expression::Rule{text};  // refuses by itself, and says where
            break;
        case StepParameter::Type::Condition:
            fits = !text.empty();
            if (fits) expression::Condition::check(text);
            break;
        case StepParameter::Type::Choice:
            fits = std::find(p.choices.begin(), p.choices.end(), text) != p.choices.end();
            break;
        case StepParameter::Type::ClassCodes:
            fits = parseClasses(text).has_value();
            break;
        case StepParameter::Type::Integer:
        case StepParameter::Type::Real:
        case StepParameter::Type::ClassCode:
            fits = numberFits(p, text);
            break;
    }
    if (fits) return;
    throw Error(step.name() + ": " + p.key + " must be " + demand(p) + ", not \"" + text + "\".");
}

/// To two digits: what a field is preset to.
double roundToTwo(double value)
{
    const double power = std::pow(10.0, std::floor(std::log10(value)) - 1);
    return std::round(value / power) * power;
}

}  // namespace

std::string_view nameOf(StepGroup group) noexcept
{
    constexpr std::array<std::string_view, kStepGroups> kNames = {"Cleaning", "Thinning", "Ground", "Objects",
                                                                  "Shape",    "Classes",  "Points", "Attributes"};
    return kNames[std::size_t(group)];
}

std::unique_ptr<Command> Step::run(const PointCloud& cloud, const StepValues& values, Progress& progress,
                                   const PointSet* within) const
{
    if (within != nullptr) checkNarrows(*this);
    StepValues complete = completeValues(*this, values, within != nullptr);
    std::optional<DataScale> scale;
    for (const StepParameter& p : parameters()) {
        if (!p.fit.used() || complete.contains(p.key)) continue;
        if (!scale) scale = dataScale(cloud, progress);
        complete.emplace(p.key, presetOf(p, *scale));
    }
    return make(cloud, complete, within, progress);
}

void checkNarrows(const Step& step)
{
    if (!step.description().narrows)
        throw Error("The step " + step.name() + " changes all points, not some of them.");
}

DataScale dataScale(const PointCloud& cloud, Progress& progress)
{
    const TrueLengths lengths = trueLengths(cloud);
    return {cloud.size() == 0 ? 0.0 : pointSpacing(cloud, lengths.stretch, progress), lengths.meters};
}

std::string presetOf(const StepParameter& parameter, const DataScale& scale)
{
    if (!parameter.fit.used()) return parameter.preset;
    const double meters = parameter.fit.meters / (scale.meters > 0 ? scale.meters : 1.0);
    double length = std::max(meters, parameter.fit.spacings * scale.spacing);
    if (parameter.unit == StepParameter::Unit::Area) length *= length;
    if (!(length > 0) || !std::isfinite(length)) length = 1.0;
    length = roundToTwo(length);
    if (parameter.min < parameter.max) length = std::clamp(length, parameter.min, parameter.max);
    return shortestText(length);
}

std::string presetText(const StepParameter& parameter)
{
    if (!parameter.fit.used()) return parameter.preset.empty() ? "" : "Default: " + parameter.preset + ".";
    const bool area = parameter.unit == StepParameter::Unit::Area;
    const auto squared = [area](double length) { return shortestText(area ? length * length : length); };
    std::string text;
    if (parameter.fit.meters > 0) text = squared(parameter.fit.meters) + (area ? " square meters" : " m");
    if (parameter.fit.spacings > 0) {
        text += text.empty() ? "" : ", or more where points are sparse: ";
        text += shortestText(parameter.fit.spacings) + " times the spacing of the points";
        if (area) text += ", squared";
    }
    return "Default: " + text + ".";
}

std::string whenText(const StepParameter& parameter)
{
    const StepParameter::When& when = parameter.when;
    return when.key.empty() ? "" : " Only with " + when.key + "=" + when.value + ".";
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

std::optional<ClassSet> parseClasses(std::string_view text)
{
    ClassSet classes;
    if (text == "none") return classes;
    const auto takeCode = [&text]() -> std::optional<unsigned> {
        while (text.starts_with(' ')) text.remove_prefix(1);
        unsigned code = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), code);
        if (error != std::errc() || code > 255) return {};
        text.remove_prefix(std::size_t(end - text.data()));
        while (text.starts_with(' ')) text.remove_prefix(1);
        return code;
    };
    for (;;) {
        const auto first = takeCode();
        if (!first) return {};
        auto last = first;
        if (text.starts_with('-')) {
            text.remove_prefix(1);
            last = takeCode();
            if (!last || *last < *first) return {};
        }
        for (unsigned code = *first; code <= *last; ++code) classes.set(code);
        if (text.empty()) return classes;
        if (!text.starts_with(',')) return {};
        text.remove_prefix(1);
    }
}

ClassSet classesValue(const StepValues& values, std::string_view key)
{
    return parseClasses(textValue(values, key)).value_or(ClassSet());
}

StepValues completeValues(const Step& step, const StepValues& values, bool narrowed)
{
    const std::vector<StepParameter>& parameters = step.parameters();
    for (const auto& [key, text] : values) {
        if (findParameter(parameters, key) != nullptr) continue;
        if (parameters.empty()) throw Error(step.name() + " takes no values.");
        throw Error(step.name() + " has no key \"" + key + "\"; its keys are " +
                    enumerated(parameters, [](const StepParameter& p) { return p.key; }) + ".");
    }
    StepValues complete;
    for (const StepParameter& p : parameters) {
        const auto it = values.find(p.key);
        const std::string& text = it == values.end() ? p.preset : it->second;
        // an empty field of a form means the same as no key
        if (text.empty() && (p.optional || p.fit.used() || (narrowed && p.wholeOnly))) continue;
        if (it == values.end() && text.empty())
            throw Error(step.name() + " needs " + p.key + "=, " + demand(p) + ".");
        checkValue(step, p, text);
        complete.emplace(p.key, text);
    }
    return complete;
}

}  // namespace punctum
