// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <vector>

namespace punctum
{

/// One parameter of a processing step, as the panel shows it and the command line names it.
struct StepParameter {
    enum class Type {
        Integer,
        Real,
        AttributeName,
        ClassCode,   ///< one class: "7"
        ClassCodes,  ///< any number of them, also none: "2,8-9"
        Rule,
        Condition,
        Choice,
        Text
    };
    enum class Unit {
        None,
        Length,   ///< the cloud's unit of length (TrueLengths): that of X and Y, meters where these are angles
        Area,     ///< the square of it
        Degrees,  ///< of an angle
        PerCent
    };
    /// A preset that fits the data: so many times the spacing of the cloud's points (pointSpacing()), or so many
    /// meters, in the cloud's unit of length (units where that is not known); 0 each: `preset` is the same for all
    /// clouds. Of an Area the number is squared. Where both are given, the larger length counts.
    struct Fit {
        double spacings = 0;
        double meters = 0;
        bool used() const noexcept { return spacings > 0 || meters > 0; }
    };
    /// It has an effect only where another parameter, a Choice, has this value: "method" is "grid". No key: always.
    struct When {
        std::string key{};
        std::string value{};
    };
    std::string key{};    ///< "k"
    std::string label{};  ///< "Neighbors"
    std::string help{};   ///< one line
    Type type = Type::Real;
    std::string preset{};  ///< default value as text; empty: must be given, or means "not used" if optional
    Fit fit{};             ///< instead of a `preset`; of lengths and areas alone
    double min = 0.0;
    double max = 0.0;
    bool optional = false;
    bool ownOnly = false;    ///< attributes that are no field of the point format
    bool wholeOnly = false;  ///< not needed where the step is told which points it may change
    bool advanced = false;   ///< a panel shows it on demand: the preset does nearly always
    Unit unit = Unit::None;
    std::vector<std::string> choices{};  ///< of a Choice
    When when{};                         ///< a panel asks for it only then
};

using StepValues = std::map<std::string, std::string, std::less<>>;

}  // namespace punctum
