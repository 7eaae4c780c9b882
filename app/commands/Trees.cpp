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

struct TreesOptions {
    std::vector<std::string> files;
    std::string out;
    TreeListRequest request;
    bool wgs84 = false;
    bool json = false;
};

void runTrees(const TreesOptions& options, Progress& progress)
{
    if (!isTableName(options.out)) throw UsageError("OUT must end in .csv, .geojson or .dxf");
    checkCondition(options.request.where);
    checkFolder(options.out);
    const auto session = loadForReading(inputFiles(options.files, progress), progress);
    const PointCloud& cloud = *session->cloud();
    const Clock clock;
    const TreeList list = listTrees(cloud, options.request, progress);
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
    command.add_option("FILE", options->files, "LAS or LAZ files, folders or .vpc, taken as one survey")
        ->required();
    command.add_option("-o,--output", options->out, "File to write: .csv, .geojson or .dxf")
        ->type_name("OUT")
        ->required();
    command
        .add_option("--id", options->request.id,
                    "The attribute that numbers the trees, above 0 (default: TreeId, in capitals or not)")
        ->type_name("ATTRIBUTE");
    command
        .add_option("--where", options->request.where,
                    "Only the points for which this condition over attributes holds; the user guide tells the "
                    "language")
        ->type_name("CONDITION");
    command.add_option("--ground", options->request.ground, "Classes of the ground, such as 2,9 (default: 2)")
        ->type_name("CLASSES");
    command.add_flag("--wgs84", options->wgs84,
                     "GeoJSON in longitude and latitude, as RFC 7946 has it, and not in the system of the points");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runTrees(*options, p); }; });
}

}  // namespace punctum::app
