// SPDX-License-Identifier: MIT
// punctum diff: what differs between two clouds on disk, exactly.
#include "core/las/Diff.h"
#include "app/Console.h"
#include "app/commands/Command.h"
#include "core/task/Progress.h"

#include <cmath>
#include <memory>

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

void runDiff(const Options& options, Progress& progress)
{
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
        "counts only with --bytes.");
    const auto options = std::make_shared<Options>();
    command.add_option("A", options->a, "LAS or LAZ file")->required();
    command.add_option("B", options->b, "LAS or LAZ file to compare it with")->required();
    command.add_flag("--bytes", options->bytes,
                     "The files must be the same byte for byte; tells the first byte that differs");
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([options, &action] { action = [options](Progress& p) { runDiff(*options, p); }; });
}

}  // namespace punctum::app
