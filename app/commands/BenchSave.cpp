// SPDX-License-Identifier: MIT
// punctum bench save: how long writing a cloud takes.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"

#include <unistd.h>

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

void runBenchSave(const BenchSaveOptions& options, Progress& progress)
{
    const auto cloud = las::load(options.file, progress);
    las::WriteOptions write;
    write.compressed = options.as.empty() ? cloud->source()->compressed : options.as == "laz";
    write.verify = !options.noVerify;
    write.copyChunks = false;  // writing is measured, not copying
    const fs::path folder = options.folder.empty() ? fs::temp_directory_path() : fs::path(options.folder);
    const ScratchFile scratch{folder /
                              ("punctum-bench-" + std::to_string(getpid()) + (write.compressed ? ".laz" : ".las"))};

    Figures figures;
    figures.fact("points", cloud->size());
    figures.fact("compressed", write.compressed);
    figures.fact("verified", write.verify);
    for (int round = 0; round < options.rounds; ++round) {
        const Clock clock;
        const las::WriteReport report = las::write(*cloud, scratch.path, write, progress);
        const double seconds = clock.seconds();
        figures.fact("bytes", report.bytes);
        figures.add("seconds", seconds);
        figures.add("mpts_per_s", double(cloud->size()) / seconds * 1e-6);
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
    command.add_flag("--no-verify", options->noVerify, "Do not read the written file back");
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSave(*options, p); }; });
}

}  // namespace punctum::app
