// SPDX-License-Identifier: MIT
// punctum diff: what differs between two clouds on disk, exactly.
#include "core/las/Diff.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/FindFiles.h"
#include "core/Text.h"
#include "core/session/SurveyFiles.h"
#include "core/task/Progress.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

namespace punctum::app
{

namespace
{

struct Options {
    std::string a;
    std::string b;
    bool bytes = false;
    bool json = false;
};

/// Doubles that JSON has no numbers for become text.
Json jsonOf(const las::ToldValue& value)
{
    struct Visitor {
        Json operator()(std::monostate) const { return nullptr; }
        Json operator()(double v) const { return std::isfinite(v) ? Json(v) : Json(las::toText(v)); }
        Json operator()(std::int64_t v) const { return v; }
        Json operator()(std::uint64_t v) const { return v; }
        Json operator()(const std::string& v) const { return v; }
    };
    return std::visit(Visitor{}, value);
}

template <typename Change>
const char* nameOfChange(Change change)
{
    switch (change) {
        case Change::Removed:
            return "only_in_a";
        case Change::Added:
            return "only_in_b";
        case Change::Changed:
            break;
    }
    return "changed";
}

Json jsonOf(const std::vector<las::FieldDifference>& fields)
{
    Json all = Json::array();
    for (const auto& f : fields) all.push_back({{"field", f.name}, {"a", jsonOf(f.a)}, {"b", jsonOf(f.b)}});
    return all;
}

Json jsonOf(const las::RecordDifference& r)
{
    const auto side = [](bool there, std::uint64_t length, bool extended) {
        return there ? Json{{"length", length}, {"extended", extended}} : Json(nullptr);
    };
    using Change = las::RecordDifference::Change;
    return {{"user_id", r.user},
            {"record_id", r.id},
            {"change", nameOfChange(r.change)},
            {"a", side(r.change != Change::Added, r.lengthA, r.extendedA)},
            {"b", side(r.change != Change::Removed, r.lengthB, r.extendedB)},
            {"first_differing_byte", r.firstDataByte ? Json(*r.firstDataByte) : Json(nullptr)},
            {"description_differs", r.frameDiffers}};
}

Json jsonOf(const las::AttributeDifference& d)
{
    Json json{{"name", d.name}, {"change", nameOfChange(d.change)}, {"differing_points", d.points}};
    if (d.points != 0) {
        json["first_point"] = d.first;
        json["first_a"] = jsonOf(d.a);
        json["first_b"] = jsonOf(d.b);
    }
    json["type_a"] = d.typeA.empty() ? Json(nullptr) : Json(d.typeA);
    json["type_b"] = d.typeB.empty() ? Json(nullptr) : Json(d.typeB);
    return json;
}

Json jsonOf(const Options& options, const las::Difference& d, const std::vector<std::string>& warnings)
{
    Json records = Json::array(), bytes = Json::array(), attributes = Json::array();
    for (const auto& r : d.records) records.push_back(jsonOf(r));
    for (const auto& x : d.bytes)
        bytes.push_back({{"where", x.what},
                         {"length_a", x.lengthA},
                         {"length_b", x.lengthB},
                         {"first_differing_byte", x.firstByte}});
    for (const auto& x : d.attributes) attributes.push_back(jsonOf(x));
    Json container{
        {"equal", d.containerEqual()}, {"a", d.storedA}, {"b", d.storedB}, {"fields", jsonOf(d.container)}};
    if (options.bytes) container["first_differing_byte"] = d.firstByte ? Json(*d.firstByte) : Json(nullptr);
    return {{"a", options.a},
            {"b", options.b},
            {"equal", d.contentEqual()},
            {"points",
             {{"a", d.pointsA},
              {"b", d.pointsB},
              {"only_a", d.onlyA},
              {"only_b", d.onlyB},
              {"compared", d.compared},
              {"differing", d.differing},
              {"unreadable_a", d.unreadableA},
              {"unreadable_b", d.unreadableB}}},
            {"header", jsonOf(d.header)},
            {"attributes", attributes},
            {"vlrs", records},
            {"vlrs_reordered", d.recordsReordered},
            {"other_bytes", bytes},
            {"container", container},
            {"warnings", warnings}};
}

/// The files of two surveys by their names, as far as both have them.
struct Pairs {
    std::vector<std::pair<std::filesystem::path, std::filesystem::path>> both;
    std::vector<std::string> onlyA, onlyB;
};

Pairs pairsOf(const Options& options, Progress& progress)
{
    const auto byName = [&](const std::string& word) {
        std::map<std::string, std::filesystem::path> files;
        for (const auto& file : inputFiles({word}, progress))
            if (!files.emplace(file.filename().string(), file).second)
                throw Error(word, "Two files have the name " + file.filename().string() +
                                      ", so that they cannot be told apart by it.");
        return files;
    };
    const auto a = byName(options.a), b = byName(options.b);
    Pairs pairs;
    for (const auto& [name, file] : a) {
        const auto other = b.find(name);
        if (other == b.end())
            pairs.onlyA.push_back(name);
        else
            pairs.both.emplace_back(file, other->second);
    }
    for (const auto& [name, file] : b)
        if (!a.contains(name)) pairs.onlyB.push_back(name);
    return pairs;
}

/// File by file, and what differs in all of them together.
void diffSurveys(const Options& options, Progress& progress)
{
    const Pairs pairs = pairsOf(options, progress);
    las::Difference all;
    std::vector<std::string> warnings;
    Json files = Json::array();
    std::string text;
    std::size_t differing = 0;
    bool bytesDiffer = false;
    for (const auto& [a, b] : pairs.both) {
        std::vector<std::string> said;
        const las::Difference d = las::diffFiles(a, b, {options.bytes}, progress, &said);
        addDifference(d, all);
        warnings.insert(warnings.end(), said.begin(), said.end());
        bytesDiffer = bytesDiffer || d.firstByte;
        if (d.contentEqual() && !d.firstByte) continue;
        ++differing;
        const std::string name = a.filename().string();
        std::string what = las::summary(d);
        if (what.empty()) what = "the bytes, from byte " + grouped(*d.firstByte) + " on";
        files.push_back({{"file", name}, {"summary", what}, {"differing_points", d.differing}});
        text += name + ": " + what + "\n";
    }
    if (options.json) {
        Json report = jsonOf(options, all, warnings);
        report["equal"] = all.contentEqual() && pairs.onlyA.empty() && pairs.onlyB.empty();
        report["files"] = pairs.both.size();
        report["differing_files"] = std::move(files);
        report["only_in_a"] = pairs.onlyA;
        report["only_in_b"] = pairs.onlyB;
        printJson(report);
    } else {
        for (const std::string& warning : warnings) note(warning);
        for (const std::string& name : pairs.onlyA) text += name + ": only in " + options.a + "\n";
        for (const std::string& name : pairs.onlyB) text += name + ": only in " + options.b + "\n";
        text += grouped(differing) + " of " + grouped(pairs.both.size()) + " files differ";
        if (const std::string what = las::summary(all); !what.empty()) text += ": " + what;
        print(text + ".\n");
    }
    if (!all.contentEqual() || bytesDiffer || !pairs.onlyA.empty() || !pairs.onlyB.empty()) throw Reported{};
}

void runDiff(const Options& options, Progress& progress)
{
    if (standsForFiles(options.a) && standsForFiles(options.b)) return diffSurveys(options, progress);
    std::vector<std::string> warnings;
    const las::Difference d = las::diffFiles(options.a, options.b, {options.bytes}, progress, &warnings);
    if (options.json) {
        printJson(jsonOf(options, d, warnings));
    } else {
        for (const std::string& warning : warnings) note(warning);
        print(las::report(d, options.a, options.b));
    }
    if (!d.contentEqual() || (options.bytes && d.firstByte)) throw Reported{};
}

}  // namespace

void addDiff(CLI::App& root, Action& action)
{
    CLI::App& command = addCommand(
        root, "diff",
        "Tell what differs between two LAS or LAZ files: header fields, records (VLRs), and for each attribute how "
        "many points. Exit code 1 when anything differs. How the points are stored, LAS or LAZ, is told apart and "
        "counts only with --bytes. Of two folders or .vpc, the files of the same name are compared.");
    const auto options = std::make_shared<Options>();
    command.add_option("A", options->a, "LAS or LAZ file, or a folder or a .vpc of them")->required();
    command
        .add_option("B", options->b, "What to compare it with: a file with a file, a folder or a .vpc with another")
        ->required();
    command.add_flag("--bytes", options->bytes,
                     "The files must be the same byte for byte; tells the first byte that differs");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runDiff(*options, p); }; });
}

}  // namespace punctum::app
