// SPDX-License-Identifier: MIT
// punctum trees: the list of trees, as CSV, GeoJSON or DXF.
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Bench.h"
#include "app/commands/Command.h"
#include "app/commands/MapOptions.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/raster/TreeList.h"
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"

#include <cmath>
#include <memory>

namespace punctum::app
{

namespace
{

struct TreesOptions : PointsToFile {
    TreeListRequest request;
    bool wgs84 = false;
};

void runTrees(const TreesOptions& options, Progress& progress)
{
    if (!isTableName(options.out)) throw UsageError("OUT must end in .csv, .geojson or .dxf");
    checkCondition(options.where);
    checkFolder(options.out);
    const auto session = loadForReading(inputFiles(options.files, progress), progress);
    const PointCloud& cloud = *session->cloud();
    TreeListRequest request = options.request;
    request.where = options.where;
    const Clock clock;
    const TreeList list = listTrees(cloud, request, progress);
    const double seconds = clock.seconds();
    VectorOptions write;
    write.wgs84 = options.wgs84;
    writeVectors(options.out, {{}, {}, treeTable(list)}, mapCrs(cloud), write, progress);
    if (!list.finding.empty()) note(list.finding);
    if (options.json)
        printJson({{"file", options.out},
                   {"trees", list.trees.size()},
                   {"points", cloud.size()},
                   {"unit", list.unit},
                   {"seconds", seconds}});
    else
        print(options.out + ": " + grouped(list.trees.size()) + (list.trees.size() == 1 ? " tree\n" : " trees\n"));
}

}  // namespace

void addTrees(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "trees",
                                   "List the trees that the step trees has numbered: top, height above the ground, "
                                   "crown area and points, as CSV, GeoJSON or DXF.");
    const auto options = std::make_shared<TreesOptions>();
    addPointsToFile(command, *options, "File to write: .csv, .geojson or .dxf");
    command
        .add_option("--id", options->request.id,
                    "The attribute that numbers the trees, above 0 (default: TreeId, in capitals or not)")
        ->type_name("ATTRIBUTE");
    addGroundClasses(command, options->request.ground);
    addWgs84(command, options->wgs84);
    command.callback([options, &action] { action = [options](Progress& p) { runTrees(*options, p); }; });
}

}  // namespace punctum::app
