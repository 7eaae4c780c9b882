// SPDX-License-Identifier: MIT
// punctum volume: what lies between the ground surface and a height, or another file's ground surface.
#include "core/surface/Volume.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/process/Values.h"
#include "core/surface/Surface.h"
#include "core/task/Progress.h"

#include <cmath>
#include <cstdio>
#include <memory>

namespace punctum::app
{

namespace
{

struct VolumeOptions {
    std::string file;
    std::string base;
    std::string within;
    std::string classes = "2";
    bool json = false;
};

/// A height, unless it is the name of a file.
std::optional<double> heightOf(const std::string& base)
{
    double height = 0;
    if (std::filesystem::exists(base) || !CLI::detail::lexical_cast(base, height) || !std::isfinite(height))
        return std::nullopt;
    return height;
}

std::string shortText(double value)
{
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

void runVolume(const VolumeOptions& options, Progress& progress)
{
    SurfaceSettings settings;
    if (const auto classes = parseClasses(options.classes); classes && classes->any())
        settings.classes = *classes;
    else
        throw UsageError("\"" + options.classes +
                         "\" names no classes; write their codes with commas, such as 2,8");
    const std::optional<double> height = heightOf(options.base);
    try {
        if (!options.within.empty()) expression::Condition::check(options.within);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    const PointCloud& cloud = *drawable.cloud;
    VolumeQuestion question;
    if (!options.within.empty()) {
        const auto points = expression::select(cloud, expression::Condition(options.within, cloud), progress);
        question.within = outlineOf(cloud, *points);
        if (question.within.size() < 3) throw Error("The points for which the condition holds enclose no area.");
    }
    const Surface surface(drawable.cloud, settings, progress);
    DrawableCloud other;
    std::unique_ptr<Surface> otherSurface;
    if (!height) {
        other = loadDrawable(options.base, progress);
        otherSurface = std::make_unique<Surface>(other.cloud, settings, progress);
        question.otherCloud = other.cloud.get();
    }
    question.base = height.value_or(0);
    const Volume volume = surface.withTiles([&](const SurfaceTiles& tiles) {
        if (!otherSurface) return volumeOf(cloud, tiles, question, progress);
        return otherSurface->withTiles([&](const SurfaceTiles& otherTiles) {
            question.otherTiles = &otherTiles;
            return volumeOf(cloud, tiles, question, progress);
        });
    });
    const std::string unit = trueLengths(cloud).unit;
    if (options.json) {
        printJson({{"file", options.file},
                   {"base", height ? Json(*height) : Json(options.base)},
                   {"unit", unit},
                   {"cut", volume.cut},
                   {"fill", volume.fill},
                   {"net", volume.net()},
                   {"deviation", volume.deviation},
                   {"area", volume.area},
                   {"area_without_surface", volume.lacking},
                   {"ground_points", volume.points},
                   {"residual", volume.residual}});
        return;
    }
    const auto amount = [&](double value, const char* power) {
        return shortText(value) + (unit.empty() ? std::string() : " " + unit + power);
    };
    print("cut " + amount(volume.cut, "3") + ", fill " + amount(volume.fill, "3") + ", net " +
          amount(volume.net(), "3") + " (standard deviation " + amount(volume.deviation, "3") + "), area " +
          amount(volume.area, "2") + "\n");
}

}  // namespace

void addVolume(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "volume",
                                   "Measure the volume between the ground surface of a file and a height, or the "
                                   "ground surface of another file: "
                                   "cut (the file's ground is higher), fill (it is lower) and net, with the "
                                   "standard deviation that comes of the "
                                   "number of ground points and of how much they scatter about the surface.");
    const auto options = std::make_shared<VolumeOptions>();
    command.add_option("FILE", options->file, "LAS or LAZ file; a folder or a .vpc is taken as one survey")
        ->required();
    command.add_option("--base", options->base, "A height, or a file whose ground is compared with")
        ->type_name("HEIGHT|FILE")
        ->required();
    command
        .add_option("--within", options->within,
                    "Measure within the convex outline of the points for which this condition holds")
        ->type_name("CONDITION");
    command.add_option("--classes", options->classes, "Classes that are ground, with commas; preset: 2")
        ->type_name("LIST");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runVolume(*options, p); }; });
}

}  // namespace punctum::app
