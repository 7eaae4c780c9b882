// SPDX-License-Identifier: MIT
// punctum bench save: how long writing a cloud takes.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/las/WritePlan.h"
#include "core/task/Progress.h"

#include <unistd.h>

#include <fstream>

namespace punctum::app
{

namespace
{

namespace fs = std::filesystem;

struct BenchSaveOptions : BenchOptions {
    std::string as;
    std::string folder;
    bool noVerify = false;
};

/// A file that is gone when the benchmark ends, however it ends.
struct ScratchFile {
    fs::path path;
    ~ScratchFile()
    {
        std::error_code error;
        fs::remove(path, error);
    }
};

/// Compresses all records by LASzip's own writer, one after the other in one thread, into a file. Seconds; making
/// the records from the columns is not counted.
double laszipLoop(const PointCloud& cloud, const fs::path& path, const las::WriteOptions& write, Progress& progress)
{
    const las::WritePlan plan = las::planWrite(cloud, path, write, progress);
    const ScratchFile scratch{path};
    std::ofstream out(path, std::ios::binary);
    las::LaszipEncoder encoder(plan.laz, out);
    std::vector<std::byte> records;
    double seconds = 0;
    for (PointIndex first = 0; first < plan.maker->points(); first += las::kDefaultChunkSize) {
        progress.check();
        const PointRange range{first, std::min(first + las::kDefaultChunkSize, plan.maker->points())};
        records.resize(std::size_t(range.size() * plan.maker->layout().length));
        plan.maker->make(range, records.data());
        const Clock clock;
        encoder.add(records);
        seconds += clock.seconds();
    }
    const Clock clock;
    encoder.finish();
    out.close();
    if (!out) throw Error(path, "LASzip's own loop could not write, so there is nothing to compare.");
    return seconds + clock.seconds();
}

void runBenchSave(const BenchSaveOptions& options, Progress& progress)
{
    const auto cloud = las::load(options.file, progress);
    las::WriteOptions write;
    write.compressed = options.as.empty() ? cloud->source()->compressed : options.as == "laz";
    write.verify = !options.noVerify;
    write.copyChunks = false;  // writing is measured, not copying
    const fs::path folder = options.folder.empty() ? fs::temp_directory_path() : fs::path(options.folder);
    const std::string name = "punctum-bench-" + std::to_string(getpid());
    const ScratchFile scratch{folder / (name + (write.compressed ? ".laz" : ".las"))};

    Figures figures;
    figures.fact("points", cloud->size());
    figures.fact("compressed", write.compressed);
    figures.fact("verified", write.verify);
    const auto millions = double(cloud->size()) * 1e-6;
    for (int round = 0; round < options.rounds; ++round) {
        warmMemory(cloud->source()->fileSize);  // for the file cache
        const Clock clock;
        const las::WriteReport report = las::write(*cloud, scratch.path, write, progress);
        const double seconds = clock.seconds();
        figures.fact("bytes", report.bytes);
        figures.add("seconds", seconds);
        figures.add("mpts_per_s", millions / seconds);
        figures.add("write_seconds", report.writeSeconds);
        figures.add("write_mpts_per_s", millions / report.writeSeconds);
        if (write.compressed && cloud->size() != 0) {
            const double serial = laszipLoop(*cloud, folder / (name + "-serial.laz"), write, progress);
            figures.add("laszip_loop_mpts_per_s", millions / serial);
            figures.add("ratio_to_laszip_loop", serial / report.writeSeconds);
        }
    }
    figures.report(options);
}

}  // namespace

void addBenchSave(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(bench, "save", "Writing the cloud to a file that is removed again");
    const auto options = std::make_shared<BenchSaveOptions>();
    addBenchOptions(command, *options);
    command.add_option("--as", options->as, "las or laz; default: as FILE")
        ->type_name("FORMAT")
        ->check(CLI::IsMember({"las", "laz"}));
    command
        .add_option("--folder", options->folder, "Folder to write to; default: the system's for temporary files")
        ->type_name("DIR");
    addNoVerify(command, options->noVerify);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSave(*options, p); }; });
}

}  // namespace punctum::app
