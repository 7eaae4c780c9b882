// SPDX-License-Identifier: MIT
// punctum bench load: from the file to columns and store, beside what a bare loop over the same file takes.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/FindFiles.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"
#include "render/store/CloudLoad.h"

#include <laszip/laszip_api.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstring>
#include <fstream>
#include <mutex>
#include <thread>

namespace punctum::app
{

namespace
{

double residentBytes()
{
    std::ifstream statm("/proc/self/statm");
    double total = 0;
    double resident = 0;
    statm >> total >> resident;
    return resident * double(sysconf(_SC_PAGESIZE));
}

/// The file, mapped for reading; unmapped when it goes.
class MappedFile
{
public:
    explicit MappedFile(const las::SourceFile& source) : m_size(std::size_t(source.fileSize))
    {
        const int file = open(source.path.c_str(), O_RDONLY | O_CLOEXEC);
        void* data = file < 0 ? MAP_FAILED : mmap(nullptr, m_size, PROT_READ, MAP_PRIVATE, file, 0);
        if (file >= 0) close(file);
        if (data == MAP_FAILED) throw Error(source.path, "The file could not be mapped.");
        m_data = static_cast<const std::byte*>(data);
    }
    ~MappedFile() { munmap(const_cast<std::byte*>(m_data), m_size); }
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    const std::byte* data() const noexcept { return m_data; }

private:
    std::size_t m_size;
    const std::byte* m_data = nullptr;
};

template <std::size_t kBytes>
void copyField(const std::byte* from, std::size_t stride, std::byte* to, PointIndex count)
{
    for (PointIndex k = 0; k < count; ++k, from += stride, to += kBytes) std::memcpy(to, from, kBytes);
}

void copyField(std::size_t bytes, const std::byte* from, std::size_t stride, std::byte* to, PointIndex count)
{
    switch (bytes) {
        case 1:
            return copyField<1>(from, stride, to, count);
        case 2:
            return copyField<2>(from, stride, to, count);
        case 4:
            return copyField<4>(from, stride, to, count);
        case 8:
            return copyField<8>(from, stride, to, count);
        default:
            for (PointIndex k = 0; k < count; ++k, from += stride, to += bytes) std::memcpy(to, from, bytes);
    }
}

/// The least that loading a LAS file can be: the mapped records taken apart into columns by two threads. Seconds.
double bareDeinterleave(const las::Reader& reader)
{
    const las::SourceFile& source = *reader.source();
    const Clock clock;
    const MappedFile file(source);
    const auto cloud = reader.createCloud();
    const std::byte* records = file.data() + source.header.pointOffset();
    const std::size_t stride = source.layout.length;
    constexpr PointIndex kBlock = 4096;  // records that stay in the processor's second level cache
    const auto work = [&](PointRange range) {
        for (PointIndex first = range.first; first < range.last; first += kBlock) {
            const PointIndex count = std::min(kBlock, range.last - first);
            for (std::size_t k = 0; k < source.layout.fields.size(); ++k) {
                const las::RecordField& field = source.layout.fields[k];
                copyField(field.bytes(), records + first * stride + field.offset, stride,
                          cloud->columns()[k]->data() + first * field.bytes(), count);
            }
        }
    };
    const PointIndex half = source.pointCount / 2 / kBlock * kBlock;
    std::thread other(work, PointRange{half, source.pointCount});
    work({0, half});
    other.join();
    return clock.seconds();
}

/// Reads every point by LASzip's own API, one after the other in one thread. Seconds.
double laszipLoop(const las::SourceFile& source)
{
    const Clock clock;
    laszip_POINTER reader = nullptr;
    laszip_BOOL compressed = 0;
    laszip_point_struct* point = nullptr;
    if (laszip_create(&reader) != 0) throw Error("LASzip could not be started.");
    bool good = laszip_open_reader(reader, source.path.c_str(), &compressed) == 0 &&
                laszip_get_point_pointer(reader, &point) == 0;
    for (PointIndex k = 0; good && k < source.pointCount; ++k) good = laszip_read_point(reader) == 0;
    laszip_close_reader(reader);
    laszip_destroy(reader);
    if (!good)
        throw Error(source.path, "LASzip's own loop could not read this file, so there is nothing to compare.");
    return clock.seconds();
}

/// Of a point in the store: position, word, class.
constexpr std::uint64_t kStoreBytes = 17;

/// One load as the program does it, with nothing else going on.
void measureLoad(const std::string& file, Figures& figures, Progress& progress, double& seconds)
{
    const double before = residentBytes();
    const Clock clock;
    const DrawableCloud loaded = loadDrawable(file, progress);
    seconds = clock.seconds();
    const auto points = double(loaded.cloud->size());
    figures.add("seconds", seconds);
    figures.add("mpts_per_s", points / seconds * 1e-6);
    figures.add("rss_bytes_per_point", (residentBytes() - before) / points);
}

/// A load with a view that draws meanwhile, as in the window: when its first picture with points was done.
void measureFirstImage(const std::string& file, Figures& figures, Progress& progress)
{
    HeadlessRenderer headless("auto");  // the window and its backend are there before a file is opened
    render::ProgressiveRenderer& renderer = headless.renderer();
    renderer.setSize(kBenchWidth, kBenchHeight);
    renderer.setDisplay(render::DisplaySettings());

    const Clock clock;
    const render::CloudLoad load(Session::open(inputFiles({file}, progress), {}, progress));
    renderer.addCloud(load.store());
    renderer.setCamera(firstCamera(load.session()->survey()));

    std::atomic<bool> ended{false};
    double firstImage = 0;
    std::string failure;
    std::thread view([&] {
        try {
            while (firstImage == 0 || !ended) {
                const bool last = ended;
                renderer.renderFrame(render::kFrameSeconds);
                if (firstImage == 0 && renderer.coveredShare() > 0) firstImage = clock.milliseconds();
                if (last) break;
                if (renderer.converged()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        } catch (const std::exception& error) {
            failure = error.what();
        }
    });
    try {
        load.read(progress);
    } catch (...) {
        ended = true;
        view.join();
        throw;
    }
    const double seconds = clock.seconds();
    ended = true;
    view.join();
    if (!failure.empty()) throw Error(failure);
    if (firstImage == 0) throw Error(file, "No picture with points came about.");
    figures.add("first_image_ms", firstImage);
    figures.add("seconds_while_drawing", seconds);
}

/// Of a survey of many files nothing bare is there to compare with.
void runBenchSurvey(const std::vector<std::filesystem::path>& files, const BenchOptions& options,
                    Progress& progress)
{
    Figures figures;
    for (const auto& file : files) warmFileCache(file, progress);
    figures.fact("files", files.size());
    figures.fact("points", Session::open(files, {}, progress)->cloud()->size());
    figures.fact("threads", std::thread::hardware_concurrency());
    for (int round = 0; round < options.rounds; ++round) {
        progress.check();
        double seconds = 0;
        measureLoad(options.file, figures, progress, seconds);
        measureFirstImage(options.file, figures, progress);
    }
    figures.report(options);
}

void runBenchLoad(const BenchOptions& options, Progress& progress)
{
    if (standsForFiles(options.file))
        return runBenchSurvey(inputFiles({options.file}, progress), options, progress);
    const auto reader = las::Reader::open(options.file);
    warmFileCache(options.file, progress);
    const las::SourceFile& source = *reader->source();
    if (source.pointCount == 0) throw Error(options.file, "There is no point in this file to measure with.");
    const auto points = double(source.pointCount);

    Figures figures;
    figures.fact("points", source.pointCount);
    figures.fact("file_bytes", source.fileSize);
    figures.fact("threads", std::thread::hardware_concurrency());
    for (int round = 0; round < options.rounds; ++round) {
        progress.check();
        // one after the other in each round, so that what else the machine does falls on all of them
        double seconds = 0;
        warmMemory(source.pointCount * (source.layout.length + kStoreBytes));
        measureLoad(options.file, figures, progress, seconds);
        measureFirstImage(options.file, figures, progress);
        if (source.compressed) {
            const double loop = laszipLoop(source);
            figures.add("laszip_loop_mpts_per_s", points / loop * 1e-6);
            figures.add("ratio_to_laszip_loop", loop / seconds);
        } else {
            const double bare = bareDeinterleave(*reader);
            figures.add("bare_deinterleave_mpts_per_s", points / bare * 1e-6);
            figures.add("ratio_to_bare_deinterleave", bare / seconds);
        }
    }
    figures.report(options);
}

}  // namespace

void addBenchLoad(CLI::App& bench, Action& action)
{
    CLI::App& command =
        addCommand(bench, "load",
                   "Loading into columns and store, the first picture, and memory; beside it a bare "
                   "loop over the same file (LAS: two threads take the records apart; LAZ: LASzip's "
                   "own API in one thread)");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchLoad(*options, p); }; });
}

}  // namespace punctum::app
