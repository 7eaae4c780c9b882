// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"
#include "core/process/StepParameter.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

class Progress;

/// What a step is for: how panel, menu and --list-steps group them, in this order.
enum class StepGroup {
    Cleaning,    ///< what is no measurement of the scene: noise, strays, duplicates
    Thinning,    ///< fewer points
    Ground,      ///< ground and heights above it
    Objects,     ///< what stands on the ground
    Shape,       ///< normals, features: attributes computed from neighbors
    Classes,     ///< classes and values by rule
    Points,      ///< deleting and restoring
    Attributes,  ///< the list of attributes
};
/// "Cleaning"
std::string_view nameOf(StepGroup group) noexcept;
inline constexpr int kStepGroups = int(StepGroup::Attributes) + 1;

/// All that is said of a step: panel, menu, command line, --list-steps, the page in docs and tests are made of it.
struct StepDescription {
    std::string name;   ///< "normals": command line, journals
    std::string title;  ///< "Normals": window
    StepGroup group = StepGroup::Classes;
    std::string help;      ///< one or two sentences: what it does, and by which method
    std::string source{};  ///< the paper or program that the method is of: "Rusu et al. 2008"; empty: none
    std::vector<StepParameter> parameters{};
    /// The attribute worth looking at afterwards: "Classification", "Normal". Empty: none.
    std::string shows{};
    /// Whether it can be told to change some points alone (`within`). All points are looked at all the same, as
    /// neighbors, where the help does not say otherwise.
    bool narrows = true;
};

/// A processing step: reads a cloud, makes the command that changes it. One file pair a step.
///
/// Stateless. Every call may come from any thread. Lengths are true ones, in the unit of trueLengths().
class Step
{
public:
    virtual ~Step() = default;
    /// Always the same one.
    virtual const StepDescription& description() const = 0;

    const std::string& name() const { return description().name; }
    const std::string& title() const { return description().title; }
    const std::string& help() const { return description().help; }
    const std::vector<StepParameter>& parameters() const { return description().parameters; }

    /// The command that has the effect; null when nothing would change. Values that are not given are presets.
    /// `within`: the points that it may change; null: all. Holds cloud.mutex() shared while reading (for some 20 ms
    /// at a time: forEachSlab()), changes nothing, reports progress. Throws Cancelled within 100 ms of a cancel,
    /// and Error on values or attributes that do not fit, or where the step cannot be told which points.
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values, Progress& progress,
                                 const PointSet* within = nullptr) const;

private:
    /// run() with every value there (but for optional ones) and checked.
    virtual std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const = 0;
};

/// Presets filled in, but for those that fit the data, and every value checked; throws Error. `narrowed`: the step
/// is told which points, so that it needs no condition.
StepValues completeValues(const Step& step, const StepValues& values, bool narrowed = false);
/// Throws Error where the step cannot be told to change some points alone.
void checkNarrows(const Step& step);
/// What presets that fit the data are made of.
struct DataScale {
    double spacing = 0;  ///< pointSpacing(), in units of length; 0 when unknown
    double meters = 0;   ///< of one unit of length; 0 when unknown
};
DataScale dataScale(const PointCloud& cloud, Progress& progress);
/// The preset, of two digits at most where it fits the data. Empty where there is none.
std::string presetOf(const StepParameter& parameter, const DataScale& scale);
/// "Default: 3 times the spacing of the points."; empty where it has none.
std::string presetText(const StepParameter& parameter);
/// " Only with method=grid."; empty where it always has an effect.
std::string whenText(const StepParameter& parameter);

}  // namespace punctum
