// SPDX-License-Identifier: MIT
// punctum info: what is in a file, computed from its points.
#include "app/Console.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/PointCloud.h"
#include "core/cloud/ValueText.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <memory>
#include <sstream>

namespace punctum::app
{

namespace
{

struct InfoOptions {
    std::vector<std::string> files;
    bool json = false;
};

/// A file and the figures of its points.
struct FileInfo {
    std::string file;
    std::shared_ptr<PointCloud> cloud;
    las::ReadResult result;
    WorldBounds bounds;
    std::vector<std::vector<AttributeStatistics>> statistics;  ///< by attribute, then component; opaque: none
};

FileInfo inspect(const std::string& file, Progress& progress)
{
    FileInfo info;
    info.file = file;
    info.cloud = las::load(file, progress, &info.result);
    if (info.cloud->size() != 0) info.bounds = info.cloud->coordinates().toWorld(info.cloud->computeBounds());
    progress.begin("Computing ranges", info.cloud->attributes().size());
    for (const Attribute& attribute : info.cloud->attributes()) {
        auto& figures = info.statistics.emplace_back();
        if (attribute.kind != AttributeKind::Opaque)
            for (std::uint32_t c = 0; c < attribute.components; ++c)
                figures.push_back(computeStatistics(attribute, c, progress));
        progress.add(1);
    }
    return info;
}

PointIndex missingPoints(const las::ReadResult& result)
{
    PointIndex missing = 0;
    for (const PointRange& range : result.missing) missing += range.size();
    return missing;
}

/// What is missing or damaged, one sentence each; the warnings have them, too.
std::vector<std::string> lossesOf(const FileInfo& info)
{
    const las::SourceFile& source = *info.cloud->source();
    std::vector<std::string> losses = source.losses;
    for (const std::string& warning : info.result.warnings)  // of the points, those that opening did not know yet
        if (std::find(source.warnings.begin(), source.warnings.end(), warning) == source.warnings.end())
            losses.push_back(warning);
    return losses;
}

std::uint32_t listedComponents(const Attribute& attribute)
{
    return attribute.kind == AttributeKind::Opaque ? attribute.columns[0]->components() : attribute.components;
}

Json jsonOf(const glm::dvec3& v)
{
    return Json::array({v.x, v.y, v.z});
}

Json jsonOf(const Attribute& attribute, const Value& value)
{
    if (const auto* const number = std::get_if<double>(&value)) return writtenValue(attribute, *number);
    return std::visit([](auto v) { return Json(v); }, value);
}

/// One figure of an attribute: a number, an array of as many as it has components, or null where no point has one.
template <typename F>
Json figureOf(const std::vector<AttributeStatistics>& statistics, F&& figure)
{
    if (statistics.empty()) return nullptr;
    Json all = Json::array();
    for (const AttributeStatistics& s : statistics) all.push_back(s.count == 0 ? Json(nullptr) : Json(figure(s)));
    return all.size() == 1 ? all[0] : all;
}

Json jsonOf(const FileInfo& info)
{
    const las::SourceFile& source = *info.cloud->source();
    Json vlrs = Json::array();
    for (const auto* records : {&source.vlrs, &source.evlrs})
        for (const las::Vlr& vlr : *records)
            vlrs.push_back({{"user_id", vlr.user()},
                            {"record_id", vlr.recordId},
                            {"length", vlr.data.size()},
                            {"extended", vlr.extended}});
    Json attributes = Json::array();
    for (std::size_t k = 0; k < info.statistics.size(); ++k) {
        const Attribute& attribute = info.cloud->attributes()[k];
        const auto& figures = info.statistics[k];
        attributes.push_back({{"name", attribute.name},
                              {"type", nameOf(attribute.type())},
                              {"components", listedComponents(attribute)},
                              {"standard", attribute.standard},
                              {"min", figureOf(figures, [&](const auto& s) { return jsonOf(attribute, s.min); })},
                              {"max", figureOf(figures, [&](const auto& s) { return jsonOf(attribute, s.max); })},
                              {"mean", figureOf(figures, [](const auto& s) { return Json(s.mean); })}});
    }
    const bool empty = info.bounds.empty();
    return {{"file", info.file},
            {"points", info.cloud->size()},
            {"las_version", source.header.version()},
            {"point_format", source.layout.shownFormat()},
            {"record_length", source.header.recordLength()},
            {"compressed", source.compressed},
            {"scale", jsonOf(info.cloud->coordinates().scale)},
            {"offset", jsonOf(info.cloud->coordinates().offset)},
            {"min", empty ? Json(nullptr) : jsonOf(info.bounds.min)},
            {"max", empty ? Json(nullptr) : jsonOf(info.bounds.max)},
            {"crs", source.crs},
            {"vlrs", vlrs},
            {"attributes", attributes},
            {"recovered", source.recovered || !info.result.missing.empty()},
            {"losses", lossesOf(info)},
            {"missing_points", missingPoints(info.result)},
            {"warnings", info.result.warnings}};
}

// -- text

/// A mean has some digits more than the values.
std::string meanText(const Attribute& attribute, double mean)
{
    constexpr int kMore = 3;
    constexpr int kOfNumbers = 9;
    const int decimals = decimalsOf(attribute);
    return roundedText(mean, decimals < 0 ? kOfNumbers : decimals + kMore);
}

template <typename F>
std::string joined(const std::vector<AttributeStatistics>& statistics, F&& figure)
{
    std::string text;
    for (const AttributeStatistics& s : statistics) {
        if (!text.empty()) text += ' ';
        text += s.count == 0 ? "-" : figure(s);
    }
    return text.empty() ? "-" : text;
}

/// Rows with columns as wide as they need; numbers stand right.
std::string table(const std::vector<std::vector<std::string>>& rows, const std::vector<bool>& right)
{
    std::vector<std::size_t> widths(right.size());
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    std::string text;
    for (const auto& row : rows) {
        std::string line = " ";
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::string padding(widths[c] - row[c].size(), ' ');
            line += ' ' + (right[c] ? padding + row[c] : row[c] + padding) + ' ';
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

/// The first line of a long text, cut to what fits a terminal.
std::string firstLine(const std::string& text)
{
    constexpr std::size_t kMost = 90;
    std::string line = text.substr(0, text.find('\n'));
    if (line.size() > kMost) line = line.substr(0, kMost - 3) + "...";
    return line;
}

std::string textOf(const FileInfo& info)
{
    const las::SourceFile& source = *info.cloud->source();
    const CoordinateScale& coordinates = info.cloud->coordinates();
    std::ostringstream out;
    out << info.file << '\n';
    std::vector<std::vector<std::string>> head;
    head.push_back({"Points", grouped(info.cloud->size())});
    head.push_back(
        {"Format",
         "LAS " + source.header.version() + ", point format " + std::to_string(source.layout.shownFormat()) +
             (source.layout.compatible ? " (stored as " + std::to_string(source.layout.format) + ")" : "") + ", " +
             std::to_string(source.header.recordLength()) + " bytes a point" +
             (source.compressed ? ", compressed (LAZ)" : "")});
    head.push_back({"File size", grouped(source.fileSize) + " bytes"});
    head.push_back({"CRS", source.crs.empty() ? "none given" : firstLine(source.crs)});
    out << table(head, {false, false});

    out << "\n  Coordinates\n";
    std::vector<std::vector<std::string>> axes{{"", "min", "max", "extent", "scale", "offset"}};
    for (int axis = 0; axis < 3; ++axis) {
        const double low = info.bounds.min[axis];
        const double high = info.bounds.max[axis];
        const bool empty = info.bounds.empty();
        axes.push_back({std::string(1, "XYZ"[axis]), empty ? "-" : coordinateText(coordinates, axis, low),
                        empty ? "-" : coordinateText(coordinates, axis, high),
                        empty ? "-" : differenceText(coordinates, axis, high - low),
                        toText(coordinates.scale[axis]), toText(coordinates.offset[axis] + 0.0)});
    }
    out << table(axes, {false, true, true, true, true, true});

    out << "\n  Attributes\n";
    std::vector<std::vector<std::string>> rows{{"name", "type", "min", "max", "mean", ""}};
    for (std::size_t k = 0; k < info.statistics.size(); ++k) {
        const Attribute& attribute = info.cloud->attributes()[k];
        const auto& figures = info.statistics[k];
        const std::uint32_t components = listedComponents(attribute);
        rows.push_back(
            {attribute.name,
             std::string(nameOf(attribute.type())) + (components > 1 ? " x " + std::to_string(components) : ""),
             joined(figures, [&](const auto& s) { return valueText(attribute, s.min); }),
             joined(figures, [&](const auto& s) { return valueText(attribute, s.max); }),
             joined(figures, [&](const auto& s) { return meanText(attribute, s.mean); }),
             attribute.standard ? "" : "extra"});
    }
    out << table(rows, {false, false, true, true, true, false});

    if (!source.vlrs.empty() || !source.evlrs.empty()) {
        out << "\n  Records (VLRs)\n";
        std::vector<std::vector<std::string>> records{{"user", "id", "bytes", ""}};
        for (const auto* list : {&source.vlrs, &source.evlrs})
            for (const las::Vlr& vlr : *list)
                records.push_back({vlr.user(), std::to_string(vlr.recordId), grouped(vlr.data.size()),
                                   vlr.extended ? "extended" : ""});
        out << table(records, {false, true, true, false});
    }
    const std::vector<std::string> losses = lossesOf(info);
    const auto list = [&](const char* heading, const std::vector<std::string>& sentences) {
        if (sentences.empty()) return;
        out << "\n  " << heading << '\n';
        for (const std::string& sentence : sentences) out << "  - " << sentence << '\n';
    };
    std::vector<std::string> warnings = info.result.warnings;
    std::erase_if(warnings,
                  [&](const std::string& w) { return std::find(losses.begin(), losses.end(), w) != losses.end(); });
    list("Missing or damaged (to be saved under another name only)", losses);
    list("Warnings", warnings);
    if (const PointIndex missing = missingPoints(info.result))
        out << "\n  " << grouped(missing) << " points could not be read.\n";
    return std::move(out).str();
}

void runInfo(const InfoOptions& options, Progress& progress)
{
    Json all = Json::array();
    bool failed = false;
    bool first = true;
    for (const std::string& file : options.files) {
        try {
            const FileInfo info = inspect(file, progress);
            if (options.json)
                all.push_back(jsonOf(info));
            else
                print((first ? "" : "\n") + textOf(info));
            first = false;
        } catch (const Error& error) {
            // the files after it may well be readable
            complain(error.what());
            failed = true;
        }
    }
    if (options.json && !all.empty()) printJson(options.files.size() == 1 ? all[0] : all);
    if (failed) throw Reported{};
}

}  // namespace

void addInfo(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(root, "info",
                                   "Tell what is in LAS or LAZ files: header, CRS, records, and each "
                                   "attribute's range and mean computed from the points.");
    const auto options = std::make_shared<InfoOptions>();
    command.add_option("FILE", options->files, "LAS or LAZ files")->required();
    command.add_flag("--json", options->json, "Print JSON: an object for one file, an array for several");
    command.callback([options, &action] { action = [options](Progress& p) { runInfo(*options, p); }; });
}

}  // namespace punctum::app
