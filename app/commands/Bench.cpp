// SPDX-License-Identifier: MIT
// punctum bench: measures the program on a file; each benchmark has a file of its own.
#include "app/commands/Bench.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/Buffer.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace punctum::app
{

namespace
{

std::string rounded(double value)
{
    if (value >= 1e4) return grouped(std::uint64_t(value + 0.5));
    char text[40];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

void addLines(std::string& text, const std::string& prefix, const Json& figures)
{
    for (const auto& [key, value] : figures.items()) {
        std::string line = "  " + prefix + key;
        line.resize(std::max<std::size_t>(line.size() + 2, 36), ' ');
        if (value.is_object() && value.contains("median"))
            text += line + rounded(value["median"]) + "  (" + rounded(value["min"]) + " to " +
                    rounded(value["max"]) + ")\n";
        else if (value.is_object())
            addLines(text, prefix + key + ".", value);
        else
            text += line + (value.is_string() ? value.get<std::string>() : value.dump()) + "\n";
    }
}

render::Camera cameraOver(const PointCloud& cloud, const WorldBounds& box, int width, int height, double share)
{
    render::Camera camera;
    camera.setView("iso");
    camera.stretch = trueLengths(cloud, box).stretch;
    const glm::dvec3 margin = (box.max - box.min) * glm::dvec3(1.0, 1.0, 0.0) * (1.0 - share) / 2.0;
    camera.fit({box.min + margin, box.max - margin}, {width, height});
    return camera;
}

}  // namespace

double median(std::vector<double> values)
{
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double percentile(std::vector<double> values, double share)
{
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const auto rank = std::size_t(std::ceil(share * double(values.size())));
    return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

void Figures::add(const std::string& name, double value)
{
    fact(name, nullptr);
    m_values[name].push_back(value);
}

void Figures::fact(const std::string& name, Json value)
{
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos)
        m_order[name] = std::move(value);
    else
        m_order[name.substr(0, dot)][name.substr(dot + 1)] = std::move(value);
}

Json Figures::json() const
{
    Json all = m_order;
    for (const auto& [name, values] : m_values) {
        const Json figure = {{"median", median(values)},
                             {"min", *std::min_element(values.begin(), values.end())},
                             {"max", *std::max_element(values.begin(), values.end())}};
        const std::size_t dot = name.find('.');
        (dot == std::string::npos ? all[name] : all[name.substr(0, dot)][name.substr(dot + 1)]) = figure;
    }
    return all;
}

void Figures::report(const BenchOptions& options) const
{
    if (options.json) return printJson(json());
    std::string text = options.file + ", median of " + std::to_string(options.rounds) + " rounds (least to most)\n";
    addLines(text, "", json());
    print(text);
}

void addBenchOptions(CLI::App& command, BenchOptions& options)
{
    command.add_option("FILE", options.file, "LAS or LAZ file; most take a folder or a .vpc as a survey")
        ->required();
    command.add_option("--rounds", options.rounds, "How often to measure; default 5")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    command.add_flag("--json", options.json, "Print JSON: each figure as {\"median\", \"min\", \"max\"}");
}

void warmMemory(std::uint64_t bytes)
{
    constexpr std::size_t kPage = 4096;
    Buffer memory(bytes);
    for (std::size_t at = 0; at < memory.size(); at += kPage) memory.data()[at] = std::byte(1);
}

void warmFileCache(const std::filesystem::path& path, Progress& progress)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<char> block(4 << 20);
    while (file.read(block.data(), std::streamsize(block.size()))) progress.check();
}

render::Camera benchCamera(const DrawableCloud& cloud, int width, int height, double share)
{
    return cameraOver(*cloud.cloud, cloud.cloud->coordinates().toWorld(cloud.bounds), width, height, share);
}

render::Camera firstCamera(const Survey& survey)
{
    return cameraOver(*survey.cloud(), survey.firstBounds(), kBenchWidth, kBenchHeight, 1.0);
}

void beginEmpty(render::ProgressiveRenderer& renderer, int width, int height)
{
    // a target of another size and back is a new one, with nothing in it
    renderer.setSize(width + 8, height);
    renderer.setSize(width, height);
}

void show(render::ProgressiveRenderer& renderer, const DrawableCloud& cloud, int width, int height,
          const render::DisplaySettings& display)
{
    if (cloud.cloud->size() == 0) throw Error("There is no point in this file to measure with.");
    renderer.setSize(width, height);
    renderer.setDisplay(display);
    renderer.addCloud(cloud.store);
    renderer.loadingEnded(*cloud.cloud, cloud.bounds);
    renderer.setCamera(benchCamera(cloud, width, height));
}

void addBench(CLI::App& root, Action& action)
{
    CLI::App& bench = addCommand(root, "bench",
                                 "Measure loading, drawing, attribute switch, edits, saving or "
                                 "processing on a file of yours.");
    addBenchLoad(bench, action);
    addBenchOpen(bench, action);
    addBenchSave(bench, action);
    addBenchRender(bench, action);
    addBenchView(bench, action);
    addBenchOrder(bench, action);
    addBenchAttribute(bench, action);
    addBenchEdit(bench, action);
    addBenchSelect(bench, action);
    addBenchSurface(bench, action);
    addBenchProcess(bench, action);
    bench.require_subcommand(1);
}

}  // namespace punctum::app
