// SPDX-License-Identifier: MIT
#include "core/thin/Thin.h"

#include "core/process/Marking.h"
#include "core/process/Values.h"
#include "core/thin/Choices.h"
#include "core/thin/Thinned.h"
#include "core/thin/WantedNumber.h"

namespace punctum
{

namespace
{

CellChoice cellChoice(const std::string& keep)
{
    if (keep == "lowest") return CellChoice::Lowest;
    if (keep == "highest") return CellChoice::Highest;
    if (keep == "random") return CellChoice::Random;
    if (keep == "first") return CellChoice::First;
    return CellChoice::Middle;
}

StepDescription describeThin()
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    StepDescription about{
        .name = "thin",
        .title = "Thin",
        .group = StepGroup::Thinning,
        .help =
            "Keeps one point of each cell of a grid, or as many as can be kept with none nearer to another than a "
            "radius (Poisson disk), or an exact number, at random but evenly.",
        .source = "Cook 1986, Wei 2008",
        .parameters = {
            {.key = "method",
             .label = "Method",
             .help = "Grid: one point a cell. Distance: none nearer to another than the radius. Number: so many.",
             .type = Type::Choice,
             .preset = "grid",
             .choices = {"grid", "distance", "number"}},
            {.key = "cell",
             .label = "Cell",
             .help = "The side of the grid's cells.",
             .fit = {.spacings = 3},
             .min = 1e-9,
             .max = 1e9,
             .unit = Unit::Length,
             .when = {"method", "grid"}},
            {.key = "keep",
             .label = "Keep",
             .help =
                 "Which point of a cell: the nearest to its middle, the lowest or highest (noise only where there "
                 "is nothing else), a random one, or the first in the file.",
             .type = Type::Choice,
             .preset = "middle",
             .choices = {"middle", "lowest", "highest", "random", "first"},
             .when = {"method", "grid"}},
            {.key = "radius",
             .label = "Distance",
             .help = "Kept points are no nearer to each other than this.",
             .fit = {.spacings = 2},
             .min = 1e-9,
             .max = 1e9,
             .unit = Unit::Length,
             .when = {"method", "distance"}}}};
    const std::size_t others = about.parameters.size();
    addWantedNumber(about.parameters);
    for (std::size_t k = others; k < about.parameters.size(); ++k) about.parameters[k].when = {"method", "number"};
    for (StepParameter& parameter : thinnedParameters()) about.parameters.push_back(std::move(parameter));
    return about;
}

}  // namespace

const StepDescription& ThinStep::description() const
{
    static const StepDescription about = describeThin();
    return about;
}

std::unique_ptr<Command> ThinStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                        Progress& progress) const
{
    const auto leftOut = pointsOutside(cloud, within);
    const std::string method = textValue(values, "method");
    std::shared_ptr<PointSet> kept;
    if (method == "distance")
        kept = chooseByDistance(cloud, *realValue(values, "radius"), leftOut.get(), progress);
    else if (method == "number")
        kept = chooseByNumber(cloud, wantedNumber(values, cloud, leftOut.get()), leftOut.get(), progress);
    else
        kept = chooseByGrid(cloud, *realValue(values, "cell"), cellChoice(textValue(values, "keep")), leftOut.get(),
                            progress);
    return thinTo("Thin", cloud, *kept, leftOut.get(), values, progress);
}

}  // namespace punctum
