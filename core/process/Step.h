// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

class Progress;

/// One parameter of a processing step, as the panel shows it and the command line names it.
struct StepParameter {
    enum class Type { Integer, Real, AttributeName, ClassCode, Rule, Condition, Choice, Text };
    enum class Unit {
        None,
        Length,  ///< the cloud's unit of length (TrueLengths): that of X and Y, meters where these are angles
    };
    std::string key{};    ///< "k"
    std::string label{};  ///< "Neighbors"
    std::string help{};   ///< one line
    Type type = Type::Real;
    std::string preset{};  ///< default value as text; empty: must be given, or means "not used" if optional
    double min = 0.0;
    double max = 0.0;
    bool optional = false;
    bool ownOnly = false;  ///< attributes that are no field of the point format
    Unit unit = Unit::None;
    std::vector<std::string> choices{};  ///< of a Choice
};

using StepValues = std::map<std::string, std::string, std::less<>>;

/// A processing step: reads a cloud, makes the command that changes it. One file pair a step.
///
/// Stateless. run() may be called from any thread; it holds cloud.mutex() shared while reading, does not change
/// the cloud, reports progress, and stops within 100 ms when cancelled (throws Cancelled). Throws Error on values
/// or attributes that do not fit.
class Step
{
public:
    virtual ~Step() = default;
    virtual std::string name() const = 0;   ///< "normals": command line and files
    virtual std::string title() const = 0;  ///< "Normals": window
    virtual std::string help() const = 0;   ///< one or two sentences; names the method and its source
    virtual std::vector<StepParameter> parameters() const = 0;
    /// The command that has the effect; null when nothing would change.
    virtual std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                         Progress& progress) const = 0;
    /// The same for these points alone. Throws Error where the step cannot do that.
    virtual std::unique_ptr<Command> runWithin(const PointCloud& cloud, const StepValues& values,
                                               const PointSet& within, Progress& progress) const;
};

/// All steps there are, in the order they are listed to users.
std::span<const Step* const> allSteps();
/// Null when there is none of that name.
const Step* findStep(std::string_view name);

/// "normals k=16" -> the step and its values. Throws Error on an unknown name or key, or a value out of bounds.
struct ParsedStep {
    const Step* step = nullptr;
    StepValues values;
};
ParsedStep parseStep(std::string_view text);
/// Presets filled in and every value checked; throws Error.
StepValues completeValues(const Step& step, const StepValues& values);

}  // namespace punctum
