// SPDX-License-Identifier: MIT
#include "app/commands/MapOptions.h"

#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/expression/Condition.h"

#include <cmath>

namespace punctum::app
{

CLI::Validator moreThanNothing()
{
    return CLI::Validator(
        [](std::string& text) {
            double number = 0;
            const bool good = CLI::detail::lexical_cast(text, number) && std::isfinite(number) && number > 0;
            return good ? std::string() : "it must be a number above 0, not \"" + text + "\"";
        },
        "");
}

void addPointsToFile(CLI::App& command, PointsToFile& options, const std::string& out)
{
    command.add_option("FILE", options.files, "LAS or LAZ files, folders or .vpc, taken as one survey")->required();
    command.add_option("-o,--output", options.out, out)->type_name("OUT")->required();
    command
        .add_option("--where", options.where,
                    "Only the points for which this condition over attributes holds; the user guide tells the "
                    "language")
        ->type_name("CONDITION");
    command.add_flag("--json", options.json, "Report in JSON");
}

void addMapOptions(CLI::App& command, MapOptions& options, const std::string& out)
{
    addPointsToFile(command, options, out);
    command
        .add_option("--cell", options.cell,
                    "Side of a cell in units of X and Y (default: fits the spacing of the points); cells lie on "
                    "multiples of it")
        ->type_name("SIZE")
        ->check(moreThanNothing());
}

void addGroundClasses(CLI::App& command, std::string& classes)
{
    command.add_option("--ground", classes, "Classes of the ground, such as 2,9 (default: 2)")
        ->type_name("CLASSES");
}

void addWgs84(CLI::App& command, bool& wgs84)
{
    command.add_flag("--wgs84", wgs84,
                     "GeoJSON in longitude and latitude, as RFC 7946 has it, and not in the system of the points");
}

void addGroundOptions(CLI::App& command, GroundOptions& options)
{
    addGroundClasses(command, options.classes);
    command
        .add_option(
            "--bridge", options.bridge,
            "Width up to which the ground is drawn across voids, in the unit of X and Y, or in meters where "
            "these are degrees (default: 100 cells)")
        ->type_name("LENGTH")
        ->check(moreThanNothing());
    command
        .add_option(
            "--fill", options.fill,
            "Cells across which holes are filled from the cells around (default: 3 for dsm and chm, else 0)")
        ->type_name("CELLS")
        ->check(CLI::Range(0, 1000));
    command.add_flag("--noise", options.noise, "Take heights of the noise classes 7 and 18 as well");
}

void checkCondition(const std::string& where)
{
    if (where.empty()) return;
    try {
        expression::Condition::check(where);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
}

MapRequest mapRequest(const MapOptions& options, const GroundOptions& ground)
{
    checkCondition(options.where);
    MapRequest request;
    request.cell = options.cell;
    request.where = options.where;
    request.ground = ground.classes;
    request.bridge = ground.bridge;
    if (ground.fill >= 0) request.fill = ground.fill;
    request.noise = ground.noise;
    return request;
}

}  // namespace punctum::app
