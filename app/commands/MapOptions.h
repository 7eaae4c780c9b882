// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/Maps.h"

#include <filesystem>
#include <string>
#include <vector>

namespace CLI
{
class App;
class Validator;
}  // namespace CLI

namespace punctum::app
{

/// What all commands are told that make something of points to be written to another kind of file.
struct PointsToFile {
    std::vector<std::string> files;
    std::string out;
    std::string where;
    bool json = false;
};
/// What all commands that make maps are told.
struct MapOptions : PointsToFile {
    double cell = 0;
};
/// What those are told that draw the ground.
struct GroundOptions {
    std::string classes = "2";
    double bridge = 0;
    int fill = -1;
    bool noise = false;
};

/// Checks that an option is a number above 0.
CLI::Validator moreThanNothing();
/// Adds FILE..., -o, --where and --json; `out` says what OUT may be.
void addPointsToFile(CLI::App& command, PointsToFile& options, const std::string& out);
/// The same, and --cell.
void addMapOptions(CLI::App& command, MapOptions& options, const std::string& out);
/// Adds --ground.
void addGroundClasses(CLI::App& command, std::string& classes);
/// Adds --wgs84.
void addWgs84(CLI::App& command, bool& wgs84);
/// Adds --ground, --bridge, --fill and --noise.
void addGroundOptions(CLI::App& command, GroundOptions& options);

/// A request with these options. Throws UsageError when the condition is none.
MapRequest mapRequest(const MapOptions& options, const GroundOptions& ground);
/// Throws UsageError when the condition is none.
void checkCondition(const std::string& where);

}  // namespace punctum::app
