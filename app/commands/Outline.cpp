// SPDX-License-Identifier: MIT
// punctum outline: the areas that points cover, as GeoJSON or DXF.
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

struct OutlineOptions : MapOptions {
    OutlineRequest request;
    bool wgs84 = false;
};

void runOutline(const OutlineOptions& options, Progress& progress)
{
    if (!isVectorName(options.out)) throw UsageError("OUT must end in .geojson or .dxf");
    checkCondition(options.where);
    checkFolder(options.out);
    const auto session = loadForReading(inputFiles(options.files, progress), progress);
    const PointCloud& cloud = *session->cloud();
    OutlineRequest request = options.request;
    request.cell = options.cell;
    request.where = options.where;
    const Clock clock;
    VectorMap map;
    map.areas = outlinesOf(cloud, request, progress);
    const double seconds = clock.seconds();
    double area = 0;
    for (const MapArea& a : map.areas) area += a.area;
    VectorOptions write;
    write.wgs84 = options.wgs84;
    writeVectors(options.out, map, mapCrs(cloud), write, progress);
    if (options.json)
        printJson({{"file", options.out},
                   {"areas", map.areas.size()},
                   {"area", area},
                   {"points", cloud.size()},
                   {"seconds", seconds}});
    else
        print(options.out + ": " + grouped(map.areas.size()) + (map.areas.size() == 1 ? " area\n" : " areas\n"));
}

}  // namespace

void addOutline(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "outline",
                                   "Draw around the areas that points cover, such as buildings by --where "
                                   "\"Classification == 6\", as GeoJSON or DXF.");
    const auto options = std::make_shared<OutlineOptions>();
    addMapOptions(command, *options, "File to write: .geojson or .dxf");
    command
        .add_option("--close", options->request.close,
                    "Gaps narrower than this are closed, in units of X and Y (default: 3 cells)")
        ->type_name("LENGTH")
        ->check(moreThanNothing());
    command
        .add_option("--simplify", options->request.simplify,
                    "How far an outline may be off for having fewer points, in units of X and Y (default: a cell)")
        ->type_name("LENGTH")
        ->check(moreThanNothing());
    command
        .add_option("--least-area", options->request.leastArea,
                    "Leave out smaller areas and holes, in square units of X and Y (default: 16 cells)")
        ->type_name("AREA")
        ->check(moreThanNothing());
    command.add_flag("--convex", options->request.convex, "One convex hull of all points");
    addWgs84(command, options->wgs84);
    command.callback([options, &action] { action = [options](Progress& p) { runOutline(*options, p); }; });
}

}  // namespace punctum::app
