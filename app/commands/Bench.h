// SPDX-License-Identifier: MIT
#pragma once

#include "app/Console.h"
#include "app/Files.h"
#include "app/Renderer.h"
#include "app/commands/Command.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace punctum::app
{

/// What every benchmark is told.
struct BenchOptions {
    std::string file;
    int rounds = 5;
    bool json = false;
};

/// Of the pictures that benchmarks draw, in px, where nothing else is asked for.
inline constexpr int kBenchWidth = 1280;
inline constexpr int kBenchHeight = 800;

/// Adds FILE, --rounds and --json.
void addBenchOptions(CLI::App& command, BenchOptions& options);

// Each adds one benchmark below `punctum bench`.
void addBenchLoad(CLI::App& bench, Action& action);
void addBenchOpen(CLI::App& bench, Action& action);
void addBenchSave(CLI::App& bench, Action& action);
void addBenchRender(CLI::App& bench, Action& action);
void addBenchView(CLI::App& bench, Action& action);
void addBenchOrder(CLI::App& bench, Action& action);
void addBenchAttribute(CLI::App& bench, Action& action);
void addBenchEdit(CLI::App& bench, Action& action);
void addBenchSelect(CLI::App& bench, Action& action);
void addBenchSurface(CLI::App& bench, Action& action);
void addBenchProcess(CLI::App& bench, Action& action);

/// Seconds since it was made or restarted.
class Clock
{
public:
    double seconds() const
    {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
    }
    double milliseconds() const { return seconds() * 1e3; }
    void restart() { m_start = std::chrono::steady_clock::now(); }

private:
    std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

/// What several rounds measured: each figure's median with the least and the most beside it.
class Figures
{
public:
    /// One round's value of a figure; "orbit.frame_ms" is frame_ms within orbit.
    void add(const std::string& name, double value);
    /// A fact that does not vary, such as the number of points.
    void fact(const std::string& name, Json value);
    Json json() const;
    /// As text or JSON to stdout.
    void report(const BenchOptions& options) const;

private:
    Json m_order = Json::object();  ///< facts, and null where a figure stands
    std::map<std::string, std::vector<double>> m_values;
};

double median(std::vector<double> values);
/// The value that a share (0.95) of all values do not exceed.
double percentile(std::vector<double> values, double share);

/// Reads the file once, so that what is measured is the program and not the disk.
void warmFileCache(const std::filesystem::path& path, Progress& progress);

/// Takes memory from the system once and gives it back, so that a virtual machine has it: what its host needs to
/// find pages that have lain idle (up to two seconds for 20 M points here) is not what the program costs.
void warmMemory(std::uint64_t bytes);

/// The picture every benchmark draws: an oblique view that shows the whole cloud, or so much of its sides, in the
/// middle.
render::Camera benchCamera(const DrawableCloud& cloud, int width, int height, double share = 1.0);

/// An oblique view of the whole survey as far as it is known before its points are read.
render::Camera firstCamera(const Survey& survey);

/// The next frame begins with an empty picture of this size.
void beginEmpty(render::ProgressiveRenderer& renderer, int width, int height);

/// A renderer that shows the cloud at the benchmark's camera, nothing drawn yet.
void show(render::ProgressiveRenderer& renderer, const DrawableCloud& cloud, int width, int height,
          const render::DisplaySettings& display);

}  // namespace punctum::app
