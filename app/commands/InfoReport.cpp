// SPDX-License-Identifier: MIT
#include "app/commands/InfoReport.h"

#include "core/Text.h"
#include "core/cloud/ClassNames.h"
#include "core/cloud/Units.h"
#include "core/cloud/ValueText.h"
#include "core/las/HeaderWords.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace punctum::app
{

namespace
{

using Rows = std::vector<std::vector<std::string>>;

PointIndex missingPoints(const las::ReadResult& result)
{
    PointIndex missing = 0;
    for (const PointRange& range : result.missing) missing += range.size();
    return missing;
}

/// What is missing or damaged, one sentence each; the warnings have them, too.
std::vector<std::string> lossesOf(const FileInfo& info)
{
    const las::SourceFile& source = info.source();
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

/// Density and spacing in the unit of length of the coordinate system.
struct Density {
    std::string unit;  ///< "m"; empty: unknown
    double density = 0.0, pulseDensity = 0.0, spacing = 0.0;
};

Density densityOf(const FileInfo& info)
{
    const PointFigures& f = info.figures();
    Density d;
    const TrueLengths lengths = trueLengths(*info.cloud, info.bounds);
    d.unit = lengths.unit;
    const double area = lengths.stretch.x * lengths.stretch.y;
    if (!(f.density > 0) || !(area > 0)) return d;
    d.density = f.density / area;
    d.pulseDensity = f.pulseDensity / area;
    d.spacing = 1.0 / std::sqrt(d.density);
    return d;
}

/// Three or four digits: density and spacing are estimates.
double rounded(double value)
{
    if (!(value > 0)) return 0.0;
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3.0);
    return std::round(value / unit) * unit;
}

std::string estimateText(double value)
{
    const int decimals = value > 0 ? std::max(0, 3 - int(std::floor(std::log10(value)))) : 0;
    return roundedText(value, decimals);
}

struct Flag {
    const char* name;
    std::uint64_t points;
};

std::vector<Flag> flagsOf(const PointFigures& f)
{
    return {{"Synthetic", f.synthetic},
            {"KeyPoint", f.keyPoint},
            {"Withheld", f.withheld},
            {"Overlap", f.overlap},
            {"ScanDirectionFlag", f.scanDirection},
            {"EdgeOfFlightLine", f.edgeOfFlightLine}};
}

// -- JSON

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

Json recordsJson(const las::SourceFile& source)
{
    Json vlrs = Json::array();
    for (const auto* records : {&source.vlrs, &source.evlrs})
        for (const las::Vlr& vlr : *records)
            vlrs.push_back({{"user_id", vlr.user()},
                            {"record_id", vlr.recordId},
                            {"length", vlr.data.size()},
                            {"extended", vlr.extended},
                            {"description", las::recordWords(vlr)}});
    return vlrs;
}

Json attributesJson(const FileInfo& info)
{
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
    return attributes;
}

/// Counts by code, those that occur.
template <std::size_t N>
Json countsJson(const std::array<std::uint64_t, N>& counts)
{
    Json json = Json::object();
    for (std::size_t code = 0; code < N; ++code)
        if (counts[code] != 0) json[std::to_string(code)] = counts[code];
    return json;
}

std::string orEmpty(const std::string& text, const char* otherwise)
{
    return text.empty() ? otherwise : text;
}

Json textOrNull(const std::string& text)
{
    return text.empty() ? Json(nullptr) : Json(text);
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

/// The first line of a long text, cut to what fits a terminal.
std::string firstLine(const std::string& text)
{
    constexpr std::size_t kMost = 90;
    return cutToWidth(printable(text.substr(0, text.find_first_of("\r\n"))), kMost);
}

std::string percent(std::uint64_t part, std::uint64_t all)
{
    return all == 0 ? "" : decimalText(100.0 * double(part) / double(all), 2) + " %";
}

std::string gpsTimeText(const FileInfo& info)
{
    const auto& time = info.figures().gpsTime;
    if (!time) return "none";
    std::string text = shortestText(time->first) + " to " + shortestText(time->second);
    const las::Header& header = info.source().header;
    const std::string first = las::gpsDay(header, time->first), last = las::gpsDay(header, time->second);
    if (!first.empty() && !last.empty()) text += " (" + first + (first == last ? "" : " to " + last) + ")";
    return text;
}

std::string densityText(const FileInfo& info)
{
    const Density d = densityOf(info);
    if (!(d.density > 0)) return "cannot be told";
    const std::string area = d.unit.empty() ? "square unit" : d.unit + "\u00b2";
    std::string text = estimateText(d.density) + " points/" + area;
    if (d.pulseDensity > 0 && d.pulseDensity != d.density)
        text += ", " + estimateText(d.pulseDensity) + " last returns/" + area;
    return text + ", spacing " + estimateText(d.spacing) + (d.unit.empty() ? " units" : " " + d.unit);
}

/// "9 nodes on 2 levels, spacing 0.03867 m on the first"
std::string copcText(const FileInfo& info)
{
    const las::CopcIndex& octree = *info.source().copc;
    const std::uint64_t nodes = octree.chunks;
    const std::int32_t levels = octree.levels();
    const std::string& unit = info.source().units.horizontal;
    return grouped(nodes) + (nodes == 1 ? " node on " : " nodes on ") + std::to_string(levels) +
           (levels == 1 ? " level" : " levels") + ", spacing " + estimateText(octree.spacing) +
           (unit.empty() ? "" : " " + unit) + " on the first";
}

void addHead(std::ostringstream& out, const FileInfo& info)
{
    const las::SourceFile& source = info.source();
    const las::Header& header = source.header;
    Rows head;
    head.push_back({"Points", grouped(info.cloud->size())});
    head.push_back(
        {"Format",
         "LAS " + header.version() + ", point format " + std::to_string(source.layout.shownFormat()) +
             (source.layout.compatible ? " (stored as " + std::to_string(source.layout.format) + ")" : "") + ", " +
             std::to_string(header.recordLength()) + " bytes a point" +
             (source.compressed ? ", compressed (LAZ)" : "")});
    if (source.copc) head.push_back({"COPC", copcText(info)});
    head.push_back({"File size", grouped(source.fileSize) + " bytes"});
    head.push_back({"CRS", source.crs.empty() ? "none given" : firstLine(source.crs)});
    head.push_back({"Units", las::unitsText(source.units)});
    head.push_back({"Density", densityText(info)});
    if (las::hasGpsTime(source.layout.shownFormat())) head.push_back({"GPS time", gpsTimeText(info)});
    if (header.versionMinor() >= 5)
        head.push_back({"GPS time in header", shortestText(header.get(las::at::kMinGpsTime)) + " to " +
                                                  shortestText(header.get(las::at::kMaxGpsTime))});
    head.push_back({"Created", orEmpty(las::creationText(header), "not said")});
    head.push_back({"Software", orEmpty(las::headerText(header, las::at::kSoftware), "not said")});
    head.push_back({"System", orEmpty(las::headerText(header, las::at::kSystemId), "not said")});
    head.push_back({"Project id", orEmpty(las::guidText(header), "none")});
    head.push_back({"File source", std::to_string(header.get(las::at::kFileSourceId))});
    std::string words;
    for (const std::string& word : las::encodingWords(header)) words += (words.empty() ? "" : "; ") + word;
    head.push_back({"Encoding", std::to_string(header.globalEncoding()) + ": " + words});
    out << textTable(head);
}

void addCoordinates(std::ostringstream& out, const FileInfo& info)
{
    const CoordinateScale& coordinates = info.cloud->coordinates();
    out << "\n  Coordinates\n";
    Rows axes{{"", "min", "max", "extent", "scale", "offset"}};
    for (int axis = 0; axis < 3; ++axis) {
        const double low = info.bounds.min[axis], high = info.bounds.max[axis];
        const bool empty = info.bounds.empty();
        axes.push_back({std::string(1, "XYZ"[axis]), empty ? "-" : coordinateText(coordinates, axis, low),
                        empty ? "-" : coordinateText(coordinates, axis, high),
                        empty ? "-" : differenceText(coordinates, axis, high - low),
                        shortestText(coordinates.scale[axis]), shortestText(coordinates.offset[axis] + 0.0)});
    }
    out << textTable(axes, {{false, true, true, true, true, true}});
}

void addAttributes(std::ostringstream& out, const FileInfo& info)
{
    out << "\n  Attributes\n";
    Rows rows{{"name", "type", "min", "max", "mean", ""}};
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
    out << textTable(rows, {{false, false, true, true, true, false}});
}

void addCounts(std::ostringstream& out, const FileInfo& info)
{
    const PointFigures& f = info.figures();
    const auto list = [&](const char* heading, const Rows& rows) {
        if (!rows.empty()) out << "\n  " << heading << '\n' << textTable(rows, {{false, true, true}});
    };
    Rows classes, returns, flags;
    for (std::uint32_t code = 0; code < f.classes.size(); ++code)
        if (f.classes[code] != 0)
            classes.push_back({classLabel(code), grouped(f.classes[code]), percent(f.classes[code], f.points)});
    for (std::size_t k = 0; k < f.returns.size(); ++k)
        if (f.returns[k] != 0)
            returns.push_back(
                {"return " + std::to_string(k), grouped(f.returns[k]), percent(f.returns[k], f.points)});
    for (std::size_t k = 0; k < f.pulses.size(); ++k)
        if (f.pulses[k] != 0)
            returns.push_back({"of " + std::to_string(k), grouped(f.pulses[k]), percent(f.pulses[k], f.points)});
    for (const Flag& flag : flagsOf(f))
        if (flag.points != 0) flags.push_back({flag.name, grouped(flag.points), percent(flag.points, f.points)});
    list("Classes", classes);
    list("Returns, and returns of their pulses", returns);
    list("Flags", flags);
}

void addRecords(std::ostringstream& out, const las::SourceFile& source)
{
    if (source.vlrs.empty() && source.evlrs.empty()) return;
    out << "\n  Records (VLRs)\n";
    Rows records{{"user", "id", "bytes", "", ""}};
    for (const auto* list : {&source.vlrs, &source.evlrs})
        for (const las::Vlr& vlr : *list)
            records.push_back({vlr.user(), std::to_string(vlr.recordId), grouped(vlr.data.size()),
                               vlr.extended ? "extended" : "", las::recordWords(vlr)});
    out << textTable(records, {{false, true, true, false, false}});
}

}  // namespace

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
    info.examination = las::examine(*info.cloud, progress);
    return info;
}

Json findingsJson(const std::vector<las::Finding>& findings)
{
    Json all = Json::array();
    for (const las::Finding& f : findings)
        all.push_back({{"fault", f.fault}, {"mend", f.mend}, {"repairable", f.repairable}});
    return all;
}

std::string findingsText(const std::vector<las::Finding>& findings)
{
    std::string text;
    for (const las::Finding& f : findings)
        text += "  - " + f.fault + "\n    " + (f.repairable ? "repair: " : "") + f.mend + '\n';
    return text;
}

/// The octree of a COPC file.
Json copcJson(const las::SourceFile& source)
{
    if (!source.copc) return nullptr;
    const las::CopcIndex& octree = *source.copc;
    return {
        {"nodes", octree.chunks},    {"levels", octree.levels()},       {"points_by_level", octree.pointsByLevel()},
        {"spacing", octree.spacing}, {"center", jsonOf(octree.center)}, {"half_size", octree.halfSize}};
}

Json unitsJson(const CoordinateUnits& units)
{
    constexpr const char* kKinds[] = {"unknown", "lengths", "degrees", "geocentric"};
    return {{"kind", kKinds[std::size_t(units.kind)]},
            {"horizontal", textOrNull(units.horizontal)},
            {"vertical", textOrNull(units.vertical)},
            {"guessed", units.guessed}};
}

Json jsonOf(const FileInfo& info)
{
    const las::SourceFile& source = info.source();
    const las::Header& header = source.header;
    const PointFigures& f = info.figures();
    const Density density = densityOf(info);
    const bool empty = info.bounds.empty();
    Json flags = Json::object();
    for (const Flag& flag : flagsOf(f)) flags[flag.name] = flag.points;
    const bool newest = header.versionMinor() >= 5;
    const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
    const auto positive = [](double v) { return v > 0 ? Json(rounded(v)) : Json(nullptr); };
    return {{"file", info.file},
            {"points", info.cloud->size()},
            {"las_version", header.version()},
            {"point_format", source.layout.shownFormat()},
            {"record_length", header.recordLength()},
            {"compressed", source.compressed},
            {"copc", copcJson(source)},
            {"scale", jsonOf(info.cloud->coordinates().scale)},
            {"offset", jsonOf(info.cloud->coordinates().offset)},
            {"min", empty ? Json(nullptr) : jsonOf(info.bounds.min)},
            {"max", empty ? Json(nullptr) : jsonOf(info.bounds.max)},
            {"crs", source.crs},
            {"units", unitsJson(source.units)},
            {"vlrs", recordsJson(source)},
            {"attributes", attributesJson(info)},
            {"classes", countsJson(f.classes)},
            {"returns", countsJson(f.returns)},
            {"number_of_returns", countsJson(f.pulses)},
            {"flags", flags},
            {"density", positive(density.density)},
            {"pulse_density", positive(density.pulseDensity)},
            {"spacing", positive(density.spacing)},
            {"length_unit", textOrNull(density.unit)},
            {"gps_time", f.gpsTime ? Json::array({f.gpsTime->first, f.gpsTime->second}) : Json(nullptr)},
            {"header_gps_time", newest ? Json::array({number(header.get(las::at::kMinGpsTime)),
                                                      number(header.get(las::at::kMaxGpsTime))})
                                       : Json(nullptr)},
            {"time_offset", newest ? Json(header.get(las::at::kTimeOffset)) : Json(nullptr)},
            {"guid", textOrNull(las::guidText(header))},
            {"software", las::headerText(header, las::at::kSoftware)},
            {"system", las::headerText(header, las::at::kSystemId)},
            {"created", textOrNull(las::creationText(header))},
            {"encoding", las::encodingWords(header)},
            {"recovered", source.recovered || !info.result.missing.empty()},
            {"losses", lossesOf(info)},
            {"missing_points", missingPoints(info.result)},
            {"warnings", info.result.warnings},
            {"doctor", findingsJson(info.examination.diagnosis.findings)}};
}

std::string textOf(const FileInfo& info)
{
    std::ostringstream out;
    out << printable(info.file) << '\n';
    addHead(out, info);
    addCoordinates(out, info);
    addAttributes(out, info);
    addCounts(out, info);
    addRecords(out, info.source());
    const std::vector<std::string> losses = lossesOf(info);
    const std::vector<las::Finding>& findings = info.examination.diagnosis.findings;
    const auto list = [&](const char* heading, const std::vector<std::string>& sentences) {
        if (sentences.empty()) return;
        out << "\n  " << heading << '\n';
        for (const std::string& sentence : sentences) out << "  - " << printable(sentence) << '\n';
    };
    // Each is told once.
    std::vector<std::string> warnings = info.result.warnings;
    std::erase_if(warnings, [&](const std::string& w) {
        return std::find(losses.begin(), losses.end(), w) != losses.end() ||
               std::any_of(findings.begin(), findings.end(), [&](const las::Finding& f) { return f.fault == w; });
    });
    list("Missing or damaged (to be saved under another name only)", losses);
    list("Warnings", warnings);
    if (!findings.empty()) {
        out << "\n  Doctor"
            << (info.examination.diagnosis.repairable() ? " (\"punctum repair\" mends some of it)" : "") << '\n'
            << printable(findingsText(findings), true);
    }
    if (const PointIndex missing = missingPoints(info.result))
        out << "\n  " << pointsText(missing) << " could not be read.\n";
    return std::move(out).str();
}

}  // namespace punctum::app
