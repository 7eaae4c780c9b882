// SPDX-License-Identifier: MIT
#include "core/steps/Steps.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/above/Buildings.h"
#include "core/above/Height.h"
#include "core/above/Trees.h"
#include "core/above/Vegetation.h"
#include "core/clean/Duplicates.h"
#include "core/clean/Isolated.h"
#include "core/clean/LowPoints.h"
#include "core/clean/Outliers.h"
#include "core/clean/RadiusOutliers.h"
#include "core/clean/Strays.h"
#include "core/ground/Ground.h"
#include "core/process/AttributeList.h"
#include "core/process/Delete.h"
#include "core/process/Reclassify.h"
#include "core/process/SetByRule.h"
#include "core/shape/Clusters.h"
#include "core/shape/Features.h"
#include "core/shape/Normals.h"
#include "core/shape/Planes.h"
#include "core/thin/Thin.h"
#include "core/thin/ThinTo.h"

#include <algorithm>
#include <vector>

namespace punctum
{

namespace
{

/// One of each, in groups; inside a group in the order in which people take them.
std::vector<const Step*> makeSteps()
{
    static const OutliersStep outliers;
    static const IsolatedStep isolated;
    static const LowPointsStep low;
    static const StraysStep strays;
    static const DuplicatesStep duplicates;
    static const ThinStep thin;
    static const ThinToStep thinTo;
    static const GroundStep ground;
    static const HeightStep height;
    static const BuildingsStep buildings;
    static const VegetationStep vegetation;
    static const TreesStep trees;
    static const RadiusOutliersStep radiusOutliers;
    static const ClustersStep clusters;
    static const PlanesStep planes;
    static const NormalsStep normals;
    static const FeaturesStep features;
    static const SplatRadiusStep splatRadius;
    static const ReclassifyStep reclassify;
    static const SetByRuleStep setByRule;
    static const DeleteStep deleteStep;
    static const RestoreStep restore;
    static const RenameStep rename;
    static const RemoveStep remove;
    std::vector<const Step*> steps{
        &outliers,   &radiusOutliers, &isolated,    &low,      &strays, &duplicates,  // cleaning
        &thin,       &thinTo,                                                         // thinning
        &ground,     &height,                                                         // ground
        &buildings,  &vegetation,     &trees,       &clusters, &planes,               // objects
        &normals,    &features,       &splatRadius,                                   // shape
        &reclassify, &setByRule,                                                      // classes
        &deleteStep, &restore,                                                        // points
        &rename,     &remove,                                                         // attributes
    };
    const auto before = [](const Step* a, const Step* b) {
        return a->description().group < b->description().group;
    };
    std::stable_sort(steps.begin(), steps.end(), before);
    return steps;
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

}  // namespace

std::span<const Step* const> allSteps()
{
    static const std::vector<const Step*> steps = makeSteps();
    return steps;
}

const Step* findStep(std::string_view name)
{
    for (const Step* step : allSteps())
        if (step->name() == name) return step;
    return nullptr;
}

ParsedStep parseStep(std::string_view text, bool narrowed)
{
    skipSpace(text);
    const std::string name = takeWord(text);
    if (name.empty()) throw Error("Name a step, such as \"normals k=16\"; --list-steps tells which there are.");
    ParsedStep parsed;
    parsed.step = findStep(name);
    if (parsed.step == nullptr)
        throw Error("There is no step \"" + name + "\"; --list-steps tells which there are.");
    for (skipSpace(text); !text.empty(); skipSpace(text)) {
        const std::string word = takeWord(text);
        const auto equals = word.find('=');
        if (equals == std::string::npos)
            throw Error(name + ": write \"" + word + "\" as key=value; its keys are " +
                        enumerated(parsed.step->parameters(), [](const StepParameter& p) { return p.key; }) + ".");
        const std::string key = word.substr(0, equals);
        const auto& parameters = parsed.step->parameters();
        const bool known =
            std::any_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.key == key; });
        if (!known) completeValues(*parsed.step, {{key, word.substr(equals + 1)}});  // says which there are
        if (!parsed.values.emplace(key, word.substr(equals + 1)).second)
            throw Error(name + ": " + key + " is given twice.");
    }
    if (narrowed) checkNarrows(*parsed.step);
    parsed.values = completeValues(*parsed.step, parsed.values, narrowed);
    return parsed;
}

}  // namespace punctum
