// SPDX-License-Identifier: MIT
#include "ui/process/StepIcons.h"

#include "core/process/Step.h"
#include "ui/basic/Text.h"
#include "ui/style/Icons.h"

#include <array>
#include <string_view>
#include <utility>

namespace punctum::ui
{

namespace
{

/// Steps, by what their names have in them, whose picture is not that of their group.
constexpr std::array<std::pair<std::string_view, std::string_view>, 26> kPictures = {{
    {"above", "step-height"},
    {"height", "step-height"},
    {"vegetation", "step-vegetation"},
    {"building", "step-buildings"},
    {"roof", "step-buildings"},
    {"tree", "step-trees"},
    {"normal", "step-normals"},
    {"curvature", "step-features"},
    {"feature", "step-features"},
    {"splat", "step-splats"},
    {"cluster", "step-clusters"},
    {"plane", "step-planes"},
    {"low", "step-low"},
    {"stray", "step-stray"},
    {"isolated", "step-isolated"},
    {"duplicate", "step-duplicates"},
    {"radius-outlier", "step-radius"},
    {"outlier", "step-outliers"},
    {"ground", "step-ground"},
    {"thin-to", "step-thin-to"},
    {"thin", "step-thin"},
    {"set", "step-rule"},
    {"restore", "undo"},
    {"delete", "close"},
    {"remove", "close"},
    {"class", "class"},
}};

constexpr std::array<std::string_view, kStepGroups> kGroupPictures = {
    "step-outliers", "step-thin", "step-ground", "step-trees", "step-features", "class", "cloud", "attributes"};

QString pictureNameOf(const Step& step)
{
    for (const auto& [part, picture] : kPictures)
        if (step.name().find(part) != std::string::npos) return toQString(picture);
    return toQString(kGroupPictures[std::size_t(step.description().group)]);
}

}  // namespace

QIcon stepIcon(const Step& step)
{
    return lineIcon(pictureNameOf(step));
}

}  // namespace punctum::ui
