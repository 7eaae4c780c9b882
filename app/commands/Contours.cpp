// SPDX-License-Identifier: MIT
// punctum contours: lines of equal height as GeoJSON or DXF.
#include "core/raster/Contours.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Bench.h"
#include "app/commands/Command.h"
#include "app/commands/MapOptions.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct ContoursOptions : MapOptions {
    GroundOptions ground;
    ContourOptions contours;
    std::string surface = "dtm";
    int smooth = 1;
    bool wgs84 = false;
};

void runContours(const ContoursOptions& options, Progress& progress)
{
    if (!isVectorName(options.out)) throw UsageError("OUT must end in .geojson or .dxf");
    MapRequest request = mapRequest(options, options.ground);
    request.kind = options.surface == "dsm" ? MapKind::Dsm : MapKind::Dtm;
    checkFolder(options.out);
    const auto session = loadForReading(inputFiles(options.files, progress), progress);
    const PointCloud& cloud = *session->cloud();
    const Clock clock;
    const Raster heights = smoothed(makeMap(cloud, request, progress).raster, options.smooth, progress);
    VectorMap map;
    map.lines = contoursOf(heights, options.contours, progress);
    const double seconds = clock.seconds();
    VectorOptions write;
    write.wgs84 = options.wgs84;
    writeVectors(options.out, map, mapCrs(cloud), write, progress);
    if (options.json)
        printJson({{"file", options.out},
                   {"contours", map.lines.size()},
                   {"points", cloud.size()},
                   {"seconds", seconds}});
    else
        print(options.out + ": " + grouped(map.lines.size()) + " contours\n");
}

}  // namespace

void addContours(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "contours", "Draw lines of equal height, as GeoJSON or DXF.");
    const auto options = std::make_shared<ContoursOptions>();
    addMapOptions(command, *options, "File to write: .geojson or .dxf");
    command.add_option("--step", options->contours.step, "Height between contours, in units of Z")
        ->type_name("SIZE")
        ->check(moreThanNothing())
        ->required();
    command.add_option("--base", options->contours.base, "A height that has a contour (default: 0)")
        ->type_name("Z");
    command
        .add_option("--index", options->contours.indexEvery,
                    "Each so manieth contour is an index contour (default: 5; 0: none)")
        ->check(CLI::Range(0, 1000));
    command.add_option("--surface", options->surface, "What they are of: dtm or dsm")
        ->check(CLI::IsMember({"dtm", "dsm"}));
    addGroundOptions(command, options->ground);
    command.add_option("--smooth", options->smooth, "How often heights are smoothed before (default: 1)")
        ->check(CLI::Range(0, 100));
    command
        .add_option("--simplify", options->contours.simplify,
                    "Cells that a contour may be off for having fewer points (default: 0.1)")
        ->check(CLI::Range(0.0, 100.0));
    command
        .add_option("--shortest", options->contours.shortest,
                    "Leave out closed contours that are shorter, in cells (default: 0)")
        ->check(CLI::Range(0.0, 1e6));
    addWgs84(command, options->wgs84);
    command.callback([options, &action] { action = [options](Progress& p) { runContours(*options, p); }; });
}

}  // namespace punctum::app
