// SPDX-License-Identifier: MIT
// punctum bench open: a survey from its headers to the full picture, and to that of a street after a jump.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/las/RecordBlocks.h"
#include "core/task/Progress.h"
#include "render/camera/Sight.h"
#include "render/store/CloudLoad.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

namespace punctum::app
{

namespace
{

/// Asks the system to forget what it has of the file in memory, so that it comes from the disk once more.
void coolFileCache(const std::filesystem::path& path)
{
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return;
    (void)::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
    ::close(file);
}

/// From now on the peak of resident memory counts anew, where the system can do that.
void restartPeak()
{
    std::ofstream("/proc/self/clear_refs") << 5;
}

double peakMegabytes()
{
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        double kibibytes = 0;
        if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024e-6;
    }
    return 0;
}

/// Of figures of an opening whose files and overview nobody had before.
constexpr const char* kCold = "cold.";
/// ms between two looks at whether every part is seen, which take some themselves.
constexpr double kLookEvery = 100;

/// A tenth of the sides of a part, from aslant: what a street takes.
render::Camera streetCamera(const render::CloudLoad& load, std::size_t part)
{
    const Survey& survey = load.session()->survey();
    const WorldBounds& box = survey.parts()[part].source->firstBounds;
    const CoordinateScale& grid = survey.cloud()->coordinates();
    RawBounds bounds;
    for (const glm::dvec3& corner : {grid.toRaw(box.min), grid.toRaw(box.max)})
        bounds.include(std::llround(corner.x), std::llround(corner.y), std::llround(corner.z));
    return benchCamera({survey.cloud(), load.store(), bounds, {}}, kBenchWidth, kBenchHeight, 0.1);
}

/// Looks from there, and tells those who read.
void lookFrom(const render::Camera& camera, render::ProgressiveRenderer& renderer, const render::CloudLoad& load)
{
    renderer.setCamera(camera);
    load.session()->readingOrder()->look(render::sightOf(camera, {kBenchWidth, kBenchHeight}, {}));
}

/// A jump to a street while files are read: until all in sight is read, and in a picture that is full.
struct StreetJump {
    bool begun = false;
    Clock clock{};
    double from = 0;  ///< share of the points that was read before
    double took = 0;  ///< ms; 0: not there yet
};

/// Whether every part of the survey has a point in the picture.
bool showsEveryPart(render::ProgressiveRenderer& renderer, const Survey& survey)
{
    std::vector<bool> shown(survey.parts().size());
    for (std::size_t k = 0; k < shown.size(); ++k) shown[k] = survey.parts()[k].points.empty();
    renderer.visiblePoints(*survey.cloud()).forEach([&](PointIndex i) { shown[survey.partOf(i)] = true; });
    return std::find(shown.begin(), shown.end(), false) == shown.end();
}

/// Draws until the picture is full.
void drawFull(render::ProgressiveRenderer& renderer, Progress& progress)
{
    while (!renderer.renderFrame(render::kFrameSeconds).converged) progress.check();
}

/// Once from the files to the pictures. `prefix`: of the figures' names.
void openOnce(const BenchOptions& options, const std::string& prefix, Figures& figures, Progress& progress)
{
    HeadlessRenderer headless("auto");  // the window and its backend are there before a survey is opened
    render::ProgressiveRenderer& renderer = headless.renderer();
    renderer.setSize(kBenchWidth, kBenchHeight);
    renderer.setDisplay(render::DisplaySettings());
    restartPeak();

    const Clock clock;
    const render::CloudLoad load(Session::open(inputFiles({options.file}, progress), {}, progress));
    const Survey& survey = load.session()->survey();
    figures.add(prefix + "headers_ms", clock.milliseconds());
    if (prefix == kCold) survey.forgetOverview();
    renderer.addCloud(load.store());
    renderer.setCamera(firstCamera(survey));

    std::atomic<bool> ended{false};
    std::string failure;
    std::thread reading([&] {
        try {
            (void)load.read(progress);
        } catch (const Cancelled&) {
            // check() tells it below
        } catch (const std::exception& error) {
            failure = error.what();
        }
        ended = true;
    });
    double first = 0, overview = 0;
    StreetJump street;
    Clock looked;
    try {
        for (bool last = false; !last;) {
            last = ended;
            const bool sightRead = load.session()->readingOrder()->sightRead();
            const render::FrameReport report = renderer.renderFrame(render::kFrameSeconds);
            if (overview != 0 && !street.begun && !last) {
                street = {true, Clock(), double(load.store()->filled()) / double(survey.cloud()->size()), 0};
                // as far from what was read first as can be told
                lookFrom(streetCamera(load, las::spreadOrder(std::uint32_t(survey.parts().size())).back()),
                         renderer, load);
            } else if (street.begun && street.took == 0 && sightRead && report.converged && report.current) {
                street.took = street.clock.milliseconds();
                renderer.setCamera(firstCamera(survey));
                load.session()->readingOrder()->look({});
            }
            if (first == 0 && renderer.coveredShare() > 0) first = clock.milliseconds();
            if (first != 0 && overview == 0 && looked.milliseconds() > kLookEvery) {
                if (showsEveryPart(renderer, survey)) overview = clock.milliseconds();
                looked = Clock();
            }
            if (renderer.converged()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    } catch (...) {
        progress.cancel();
        reading.join();
        throw;
    }
    reading.join();
    progress.check();
    if (!failure.empty()) throw Error(failure);
    renderer.setCamera(firstCamera(survey));
    drawFull(renderer, progress);
    const double complete = clock.milliseconds();
    figures.add(prefix + "first_picture_ms", first != 0 ? first : complete);
    figures.add(prefix + "overview_ms", overview != 0 ? overview : complete);
    figures.add(prefix + "complete_ms", complete);
    figures.add(prefix + "points_drawn", double(renderer.pointsInSight()));

    const Clock jump;
    renderer.setCamera(streetCamera(load, 0));
    drawFull(renderer, progress);
    const double afterwards = jump.milliseconds();
    figures.add(prefix + "street_ms", street.took != 0 ? street.took : afterwards);
    figures.add(prefix + "street_from", street.took != 0 ? street.from : 1.0);
    figures.add(prefix + "street_read_ms", afterwards);
    figures.add(prefix + "peak_rss_mb", peakMegabytes());
}

void runBenchOpen(const BenchOptions& options, Progress& progress)
{
    const auto files = inputFiles({options.file}, progress);
    Figures figures;
    figures.fact("parts", files.size());
    figures.fact("points", Session::open(files, {}, progress)->cloud()->size());
    for (int round = 0; round < options.rounds; ++round) {
        for (const auto& file : files) coolFileCache(file);
        openOnce(options, kCold, figures, progress);
        openOnce(options, "again.", figures, progress);
    }
    figures.report(options);
}

}  // namespace

void addBenchOpen(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(
        bench, "open",
        "Opening a survey, from the disk and once more: headers, the first picture, one with a point of every "
        "file, the full one, and the full one after a jump to a street while files are read (from which share of "
        "the points on) and when all are; with the most memory that it took");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchOpen(*options, p); }; });
}

}  // namespace punctum::app
