// SPDX-License-Identifier: MIT
// punctum raster: maps of a survey as GeoTIFF.
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Bench.h"
#include "app/commands/Command.h"
#include "app/commands/MapOptions.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/raster/GeoTiff.h"
#include "core/task/Progress.h"

#include <cctype>
#include <memory>

namespace punctum::app
{

namespace
{

struct RasterOptions : MapOptions {
    GroundOptions ground;
    std::string of;
    std::string statistic;
    std::string surface = "dtm";
    double pits = 0;
    Sun sun;
};

bool isTiffName(const std::filesystem::path& path)
{
    std::string ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending == ".tif" || ending == ".tiff";
}

MapRequest requestOf(const RasterOptions& options)
{
    MapRequest request = mapRequest(options, options.ground);
    const auto kind = parseMapKind(options.of);
    request.kind = kind.value_or(MapKind::Attribute);
    if (!kind) {
        request.attribute = options.of;
        const auto statistic = parseStatistic(options.statistic.empty() ? "max" : options.statistic);
        if (!statistic)
            throw UsageError(
                "--statistic must be min, max, mean, median, stddev, range, sum, count, majority or "
                "p0 to p100, not \"" +
                options.statistic + "\"");
        request.statistic = *statistic;
    } else if (!options.statistic.empty()) {
        throw UsageError("--statistic is for attributes; " + options.of + " has one of its own");
    }
    request.reliefOfDsm = options.surface == "dsm";
    request.pits = options.pits;
    request.sun = options.sun;
    return request;
}

void runRaster(const RasterOptions& options, Progress& progress)
{
    if (!isTiffName(options.out)) throw UsageError("OUT must end in .tif");
    const MapRequest request = requestOf(options);
    checkFolder(options.out);
    const auto session = loadForReading(inputFiles(options.files, progress), progress);
    const PointCloud& cloud = *session->cloud();
    const Clock clock;
    const MapOutcome map = makeMap(cloud, request, progress);
    const double seconds = clock.seconds();
    const MapCrs crs = mapCrs(cloud);
    const std::uint64_t bytes = writeGeoTiff(options.out, map.raster, crs, map.options, progress);
    const RasterFrame& frame = map.raster.frame();
    if (options.json) {
        printJson({{"file", options.out},
                   {"of", options.of},
                   {"points", cloud.size()},
                   {"columns", frame.columns},
                   {"rows", frame.rows},
                   {"cell", frame.cell},
                   {"west", frame.west(0)},
                   {"north", frame.north(0)},
                   {"filled", map.raster.count()},
                   {"crs", crs.name},
                   {"epsg", crs.horizontal},
                   {"epsg_vertical", crs.vertical},
                   {"bytes", bytes},
                   {"seconds", seconds},
                   {"seconds_with_writing", clock.seconds()},
                   {"finding", map.finding}});
        return;
    }
    if (!map.finding.empty()) note(map.finding);
    if (!crs.known()) note("The points have no coordinate system that is known, so the map names none.");
    print(options.out + ": " + grouped(frame.columns) + " x " + grouped(frame.rows) + " cells, " + grouped(bytes) +
          " bytes\n");
}

}  // namespace

void addRaster(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "raster",
                                   "Make a map of points: terrain, surface, canopy, density, relief, or any "
                                   "attribute by a statistic, as cloud-optimized GeoTIFF.");
    const auto options = std::make_shared<RasterOptions>();
    addMapOptions(command, *options, "File to write: .tif");
    command
        .add_option("--of", options->of,
                    "dtm (ground, triangulated), dsm (highest first returns), chm (heights above ground), density "
                    "(points a square unit of length), hillshade, slope, aspect (degrees), or an attribute such "
                    "as Z or Intensity")
        ->type_name("WHAT")
        ->required();
    command
        .add_option("--statistic", options->statistic,
                    "Of an attribute: min, max (default), mean, median, stddev, range, sum, count, majority, or a "
                    "percentile such as p95")
        ->type_name("WORD");
    addGroundOptions(command, options->ground);
    command.add_option("--surface", options->surface, "What hillshade, slope and aspect are of: dtm or dsm")
        ->check(CLI::IsMember({"dtm", "dsm"}));
    command
        .add_option("--pits", options->pits,
                    "Of chm: fill cells lower than those around by more than this, in units of Z")
        ->type_name("DEPTH")
        ->check(moreThanNothing());
    command.add_option("--azimuth", options->sun.azimuth, "Where the light of hillshade is, degrees from north")
        ->check(CLI::Range(-360.0, 360.0));
    command.add_option("--altitude", options->sun.altitude, "How high it is, degrees")
        ->check(CLI::Range(0.0, 90.0));
    command.add_option("--exaggeration", options->sun.exaggeration, "Of heights in hillshade")
        ->check(CLI::Range(0.01, 100.0));
    command.callback([options, &action] { action = [options](Progress& p) { runRaster(*options, p); }; });
}

}  // namespace punctum::app
