// SPDX-License-Identifier: MIT
// punctum volume: what lies between the ground surface and a base.
#include "core/surface/Volume.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/process/Values.h"
#include "core/raster/AreaFiles.h"
#include "core/raster/MapCrs.h"
#include "core/surface/SurfaceTiles.h"
#include "core/task/Progress.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace punctum::app
{

namespace
{

struct VolumeOptions {
    std::string file;
    std::string base;
    std::string within;
    std::string polygons;
    std::string corners;
    std::string classes = "2";
    bool json = false;
};

/// The base that a word names, and of a height the height; anything else is a file.
struct BaseWish {
    VolumeBase kind = VolumeBase::Surface;
    double height = 0;
};

BaseWish baseOf(const VolumeOptions& options)
{
    const bool edge = !options.within.empty() || !options.polygons.empty() || !options.corners.empty();
    if (options.base.empty()) {
        if (!edge) throw UsageError("--base is needed, or an area: --polygons, --corners or --within");
        return {VolumeBase::Outline};
    }
    if (std::filesystem::exists(options.base)) return {VolumeBase::Surface};
    if (const auto named = volumeBaseOf(options.base); named && *named < VolumeBase::Height) {
        if (!edge) throw UsageError("--base " + options.base + " needs an area: --polygons, --corners or --within");
        return {*named};
    }
    double height = 0;
    if (CLI::detail::lexical_cast(options.base, height) && std::isfinite(height))
        return {VolumeBase::Height, height};
    return {VolumeBase::Surface};
}

std::string shortText(double value)
{
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

/// "X,Y:X,Y:X,Y"
Ring cornersOf(const std::string& text)
{
    Ring ring;
    std::istringstream corners(text);
    for (std::string word; std::getline(corners, word, ':');) {
        const std::size_t comma = word.find(',');
        glm::dvec2 corner(0);
        if (comma == std::string::npos || !CLI::detail::lexical_cast(word.substr(0, comma), corner.x) ||
            !CLI::detail::lexical_cast(word.substr(comma + 1), corner.y) || !std::isfinite(corner.x) ||
            !std::isfinite(corner.y))
            throw UsageError("\"" + word + "\" is no corner; write X,Y:X,Y:X,Y");
        ring.push_back(corner);
    }
    if (ring.size() < 3) throw UsageError("an area has at least three corners: X,Y:X,Y:X,Y");
    return ring;
}

/// One without rings where everything is asked for.
std::vector<NamedArea> areasOf(const VolumeOptions& options, const PointCloud& cloud, Progress& progress)
{
    if (!options.corners.empty()) return {{"", {cornersOf(options.corners)}}};
    if (!options.polygons.empty()) return readAreas(options.polygons, mapCrs(cloud));
    if (options.within.empty()) return {{}};
    const auto points = expression::select(cloud, expression::Condition(options.within, cloud), progress);
    Ring outline = outlineOf(cloud, *points);
    if (outline.size() < 3) throw Error("The points for which the condition holds enclose no area.");
    return {{"", {std::move(outline)}}};
}

SurfaceTiles tilesOf(const PointCloud& cloud, const std::vector<NamedArea>& areas, const VolumeOptions& options,
                     Progress& progress)
{
    std::vector<Ring> about;
    for (const NamedArea& area : areas) about.insert(about.end(), area.rings.begin(), area.rings.end());
    const auto classes = parseClasses(options.classes);
    const PointSet points = pointsForVolume(cloud, about, classes ? &*classes : nullptr, nullptr, progress);
    return {cloud, points, 0, progress};
}

void printVolume(const std::string& name, const Volume& volume, const std::string& unit)
{
    const auto amount = [&](double value, const char* power) {
        return shortText(value) + (unit.empty() ? std::string() : " " + unit + power);
    };
    print((name.empty() ? name : name + ": ") + "cut " + amount(volume.cut, "3") + ", fill " +
          amount(volume.fill, "3") + ", net " + amount(volume.net(), "3") + " (standard deviation " +
          amount(volume.deviation, "3") + "), area " + amount(volume.area, "2") + "\n");
}

Json jsonOf(const Volume& volume)
{
    return {{"cut", volume.cut},
            {"fill", volume.fill},
            {"net", volume.net()},
            {"deviation", volume.deviation},
            {"area", volume.area},
            {"area_without_surface", volume.lacking},
            {"base_height", volume.height},
            {"edge", volume.edge},
            {"edge_without_surface", volume.edgeLacking},
            {"ground_points", volume.points},
            {"residual", volume.residual}};
}

void runVolume(const VolumeOptions& options, Progress& progress)
{
    const bool all = options.classes == "all";
    if (const auto classes = parseClasses(options.classes); !all && !(classes && classes->any()))
        throw UsageError("\"" + options.classes +
                         "\" names no classes; write their codes with commas, such as 2,8, or all");
    const BaseWish wish = baseOf(options);
    if (!options.corners.empty()) cornersOf(options.corners);
    try {
        if (!options.within.empty()) expression::Condition::check(options.within);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    const PointCloud& cloud = *drawable.cloud;
    const std::vector<NamedArea> areas = areasOf(options, cloud, progress);
    const SurfaceTiles tiles = tilesOf(cloud, areas, options, progress);
    VolumeQuestion question;
    question.base = wish.kind;
    question.height = wish.height;
    DrawableCloud other;
    std::optional<SurfaceTiles> otherTiles;
    if (wish.kind == VolumeBase::Surface) {
        other = loadDrawable(options.base, progress);
        otherTiles.emplace(tilesOf(*other.cloud, areas, options, progress));
        question.otherCloud = other.cloud.get();
        question.otherTiles = &*otherTiles;
    }
    const std::string unit = trueLengths(cloud).unit;
    Json report{{"file", options.file},
                {"base", wish.kind == VolumeBase::Height    ? Json(wish.height)
                         : wish.kind == VolumeBase::Surface ? Json(options.base)
                                                            : Json(std::string(nameOf(wish.kind)))},
                {"unit", unit}};
    for (const NamedArea& area : areas) {
        question.within = area.rings;
        Volume volume;
        try {
            volume = volumeOf(cloud, tiles, question, progress);
        } catch (const Error& error) {
            if (area.name.empty()) throw;
            throw Error(area.name + ": " + error.what());
        }
        if (!options.json)
            printVolume(area.name, volume, unit);
        else if (options.polygons.empty())
            report.update(jsonOf(volume));
        else
            report["polygons"].push_back([&] {
                Json one{{"name", area.name}};
                one.update(jsonOf(volume));
                return one;
            }());
    }
    if (options.json) printJson(report);
}

}  // namespace

void addVolume(CLI::App& root, Action& action)
{
    CLI::App& command =
        addCommand(root, "volume",
                   "Measure the volume between the ground surface of a file and a base, everywhere or "
                   "within an area: cut (the ground is higher), fill (it is lower) and net, with the "
                   "standard deviation that comes of the number of ground points and of how much they "
                   "scatter about the surface.");
    const auto options = std::make_shared<VolumeOptions>();
    command.add_option("FILE", options->file, "LAS or LAZ file; a folder or a .vpc is taken as one survey")
        ->required();
    command
        .add_option(
            "--base", options->base,
            "What the ground is compared with: a height; a file, whose ground it is; or, of an area, "
            "outline (the surface through the ground along its edge), lowest (the lowest place of the edge) "
            "or plane (the plane that fits the edge). Preset, of an area: outline")
        ->type_name("HEIGHT|FILE|outline|lowest|plane");
    CLI::Option* const within =
        command
            .add_option("--within", options->within,
                        "Measure within the convex outline of the points for which this condition holds")
            ->type_name("CONDITION");
    CLI::Option* const polygons =
        command
            .add_option("--polygons", options->polygons,
                        "Measure within each polygon of a GeoJSON file, which may be in another coordinate system")
            ->type_name("FILE")
            ->excludes(within);
    command
        .add_option("--corners", options->corners,
                    "Measure within the polygon of these corners, in the file's coordinates, three at least")
        ->type_name("X,Y:X,Y:X,Y[:...]")
        ->excludes(within)
        ->excludes(polygons);
    command.add_option("--classes", options->classes, "Classes that are ground, with commas, or all; preset: 2")
        ->type_name("LIST");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runVolume(*options, p); }; });
}

}  // namespace punctum::app
