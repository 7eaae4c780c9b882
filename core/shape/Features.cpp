// SPDX-License-Identifier: MIT
#include "core/shape/Features.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Values.h"
#include "core/shape/KOrRadius.h"
#include "core/shape/Spread.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace punctum
{

namespace
{

struct Surroundings {
    const Neighborhood& neighbors;
    Spread spread;
    double radius;  ///< that holds them
};

struct Feature {
    const char* name;
    const char* description;
    double (*value)(const Surroundings& s);
};

double shareOfFirst(const Spread& s, double part)
{
    return s.l1() > 0 ? part / s.l1() : 0.0;
}

constexpr double kPi = 3.14159265358979323846;

constexpr std::array<Feature, 9> kFeatures = {{
    {"Linearity", "1: neighbors on a line",
     [](const Surroundings& s) { return shareOfFirst(s.spread, s.spread.l1() - s.spread.l2()); }},
    {"Planarity", "1: neighbors on a plane",
     [](const Surroundings& s) { return shareOfFirst(s.spread, s.spread.l2() - s.spread.l3()); }},
    {"Sphericity", "1: neighbors all around",
     [](const Surroundings& s) { return shareOfFirst(s.spread, s.spread.l3()); }},
    {"Anisotropy", "0: neighbors all around",
     [](const Surroundings& s) { return shareOfFirst(s.spread, s.spread.l1() - s.spread.l3()); }},
    {"Omnivariance", "0: neighbors on a plane",
     [](const Surroundings& s) {
         const double sum = s.spread.sum();
         return sum > 0 ? std::cbrt(s.spread.l1() / sum * s.spread.l2() / sum * s.spread.l3() / sum) : 0.0;
     }},
    {"Curvature", "surface variation, 0 to 1/3",
     [](const Surroundings& s) { return s.spread.sum() > 0 ? s.spread.l3() / s.spread.sum() : 0.0; }},
    {"Verticality", "0: level plane, 1: wall",
     [](const Surroundings& s) {
         const auto& n = s.spread.least;
         const bool none = n[0] == 0 && n[1] == 0 && n[2] == 0;
         return none ? 0.0 : 1 - std::fabs(n[2]);
     }},
    {"Roughness", "distance from the plane",
     [](const Surroundings& s) {  // the point is where offsets are 0
         const auto& n = s.spread.least;
         const auto& m = s.spread.mean;
         return std::fabs(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
     }},
    {"Density", "neighbors by area",
     [](const Surroundings& s) {
         return s.radius > 0 ? double(s.neighbors.points.size()) / (kPi * s.radius * s.radius) : 0.0;
     }},
}};

/// "Linearity,Planarity" -> those; "all": all.
std::vector<Feature> featuresOf(std::string_view text)
{
    if (text == "all") return {kFeatures.begin(), kFeatures.end()};
    std::vector<Feature> chosen;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(','), text.size());
        std::string_view name = text.substr(0, end);
        while (name.starts_with(' ')) name.remove_prefix(1);
        while (name.ends_with(' ')) name.remove_suffix(1);
        const auto same = [](char a, char b) { return (a | 32) == (b | 32); };
        const auto found = std::find_if(kFeatures.begin(), kFeatures.end(), [&](const Feature& f) {
            const std::string_view theirs(f.name);
            return std::equal(theirs.begin(), theirs.end(), name.begin(), name.end(), same);
        });
        if (found == kFeatures.end())
            throw Error("features: there is no \"" + std::string(name) + "\"; there are " +
                        enumerated(kFeatures, [](const Feature& f) { return std::string(f.name); }) + ".");
        if (std::none_of(chosen.begin(), chosen.end(), [&](const Feature& f) { return f.name == found->name; }))
            chosen.push_back(*found);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return chosen;
}

}  // namespace

const StepDescription& FeaturesStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "features",
        .title = "Features of shape",
        .group = StepGroup::Shape,
        .help =
            "Tells what the neighborhood of each point looks like, by the eigenvalues of its covariance: "
            "Linearity, "
            "Planarity, Sphericity, Anisotropy, Omnivariance, Curvature, Verticality, Roughness, Density.",
        .source = "Weinmann et al. 2015",
        .parameters = kOrRadiusParameters(
            "How many nearest points are looked at, the point itself among them.",
            "Look at all points within this distance instead of k nearest ones.",
            {{.key = "which",
              .label = "Which",
              .help = "Either all, or names with commas between, such as Planarity,Verticality.",
              .type = Type::Text,
              .preset = "all"}}),
        .shows = "Planarity"};
    return about;
}

std::unique_ptr<Command> FeaturesStep::make(const PointCloud& cloud, const StepValues& values,
                                            const PointSet* within, Progress& progress) const
{
    const std::vector<Feature> features = featuresOf(textValue(values, "which"));
    if (cloud.size() == 0 || features.empty()) return nullptr;
    std::vector<FilledAttribute> filled;
    filled.reserve(features.size());
    for (const Feature& f : features)
        filled.emplace_back(cloud, FilledAttribute::Description{f.name, f.description});
    const auto radius = realValue(values, "radius");
    const auto visit = [&](const Neighborhood& n) {
        const Surroundings s{n, spreadOf(n.offsets),
                             radius ? *radius : std::sqrt(double(n.squared.empty() ? 0.0f : n.squared.back()))};
        for (std::size_t f = 0; f < features.size(); ++f) filled[f].set(n.point, features[f].value(s));
    };
    const auto places = KdOrder::of(cloud, progress);
    forEachByKOrRadius(*places, values, "Looking at neighborhoods", progress, visit, within);
    std::vector<Attribute> attributes;
    attributes.reserve(filled.size());
    for (const FilledAttribute& f : filled) attributes.push_back(f.attribute());
    return std::make_unique<AttributesCommand>("Features of shape", std::move(attributes));
}

const StepDescription& SplatRadiusStep::description() const
{
    static const StepDescription about{
        .name = "splat-radius",
        .title = "Splat radius",
        .group = StepGroup::Shape,
        .help =
            "Tells how large a disk at each point must be that a surface of disks has no holes, as SplatRadius: "
            "twice the root of r squared by k, r being the distance of the k-th neighbor.",
        .source = "Preiner et al. 2012",
        .parameters = {{.key = "k",
                        .label = "Neighbors",
                        .help = "How many nearest points, not counting the point itself.",
                        .type = StepParameter::Type::Integer,
                        .preset = "16",
                        .min = 1,
                        .max = 1000}},
        .shows = "SplatRadius"};
    return about;
}

std::unique_ptr<Command> SplatRadiusStep::make(const PointCloud& cloud, const StepValues& values,
                                               const PointSet* within, Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    const auto k = std::size_t(*integerValue(values, "k"));
    const auto places = KdOrder::of(cloud, progress);
    FilledAttribute radius(cloud, {"SplatRadius", "radius of a disk at the point", places->lengths().unit});
    forEachNearest(
        *places, k + 1, "Measuring distances", progress,
        [&](const Neighborhood& n) {
            const std::size_t others = n.squared.size() - 1;
            radius.set(n.point, others > 0 ? 2 * std::sqrt(double(n.squared.back()) / double(others)) : 0.0);
        },
        within);
    return std::make_unique<AttributesCommand>("Splat radius", std::vector<Attribute>{radius.attribute()});
}

}  // namespace punctum
