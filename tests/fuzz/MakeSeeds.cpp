// SPDX-License-Identifier: MIT
// Makes the inputs that fuzzing begins with: MakeSeeds FOLDER [FOLDER OF REAL FILES]; FOLDER is tests/fuzz/corpus.
#include "core/SummedText.h"
#include "core/edit/Journal.h"
#include "core/edit/Literal.h"
#include "core/las/File.h"
#include "core/las/SourceParser.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"
#include "tests/core/BadInputs.h"
#include "tests/core/CopcFiles.h"
#include "tests/fuzz/FixedCloud.h"
#include "tests/fuzz/Fuzz.h"

using lasfiles::Bytes;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 30;
constexpr std::size_t kMostRecordBytes = 400;  ///< of VLRs and EVLRs in a trimmed file; longer ones are left out

fs::path folder;

void seed(const std::string& target, std::string name, const Bytes& bytes)
{
    for (char& c : name)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.')) c = '-';
    fs::create_directories(folder / target);
    lasfiles::writeFile(folder / target / name, bytes);
}

void wholeFile(const std::string& name, const Bytes& bytes)
{
    seed("files", name, bytes);  // of the targets header and open_save_open
}

/// Input of the target extra_bytes.
void extraBytes(const std::string& name, std::uint8_t format, std::uint16_t extra,
                const std::vector<Bytes>& records)
{
    Bytes b(3);
    b[0] = std::byte(format);
    lasfiles::set(b, 1, extra);
    for (const Bytes& r : records) {
        b.resize(b.size() + 2);
        lasfiles::set(b, b.size() - 2, std::uint16_t(r.size()));
        lasfiles::append(b, r);
    }
    seed("extra_bytes", name, b);
}

/// Inputs of the target chunk_table: the table alone, and the whole point part with its pointer made relative.
void chunkTable(const std::string& name, const Bytes& laz, bool variable)
{
    const std::size_t at = lasfiles::bad::pointOffset(laz);
    const auto format = lasfiles::get<std::uint8_t>(laz, 104) & 0x3F;
    const auto table = std::size_t(lasfiles::get<std::int64_t>(laz, at));
    Bytes head(5);
    lasfiles::set<std::uint32_t>(head, 1, kPoints);
    head[0] = std::byte((variable ? 1 : 0) | format << 2);
    Bytes all = head;
    all.insert(all.end(), laz.begin() + std::ptrdiff_t(at), laz.end());
    if (table > at && table <= laz.size()) {
        lasfiles::set<std::int64_t>(all, 5, std::int64_t(table - at));
        head[0] |= std::byte(2);
        head.insert(head.end(), laz.begin() + std::ptrdiff_t(table), laz.end());
        seed("chunk_table", name + " table", head);
    }
    seed("chunk_table", name + " points", all);
}

/// Input of the target chunk: the first chunk of a file.
void chunk(const std::string& name, const Bytes& laz, std::uint16_t count, unsigned versionBits, bool stream)
{
    const auto format = std::uint8_t(lasfiles::get<std::uint8_t>(laz, 104) & 0x3F);
    const auto extra = lasfiles::get<std::uint16_t>(laz, 105) - lasfiles::recordLength(format);
    if (extra > 7) return;
    Bytes b(4);
    b[0] = std::byte(format);
    b[1] = std::byte(unsigned(extra) | versionBits << 3 | (stream ? 32 : 0));
    lasfiles::set<std::uint16_t>(b, 2, std::uint16_t(count - 1));
    const auto [first, last] = lasfiles::bad::chunkAt(laz, 0);
    b.insert(b.end(), laz.begin() + std::ptrdiff_t(first), laz.begin() + std::ptrdiff_t(last));
    seed("chunk", name, b);
}

/// A real file's header, its shorter records, and its first points.
void trimmed(const fs::path& path)
{
    const punctum::las::File file(path);
    const auto parsed = punctum::las::parseFile(file);
    const punctum::las::SourceFile& s = *parsed.source;
    const std::size_t length = s.layout.length;
    const auto count = std::size_t(std::min<std::uint64_t>(kPoints, s.pointCount));
    if (length > 200) return;
    Bytes points, table;
    const Bytes records = lasfiles::recordsByLaszip(path, s.layout.format, std::uint16_t(length), count);
    std::vector<Bytes> vlrs;
    for (const punctum::las::Vlr& v : s.vlrs)
        if (v.data.size() <= kMostRecordBytes && v.user() != punctum::las::kLaszipUser && vlrs.size() < 5)
            vlrs.push_back(lasfiles::record(v.user(), v.recordId, v.data));
    Bytes head = s.header.bytes;
    lasfiles::set<std::uint32_t>(head, 107, s.layout.format < 6 ? std::uint32_t(count) : 0);
    if (s.header.extendedCounts()) {
        lasfiles::set<std::uint64_t>(head, 247, count);
        lasfiles::set<std::uint64_t>(head, 235, 0);
        lasfiles::set<std::uint32_t>(head, 243, 0);
    }
    if (s.compressed) {
        Bytes vlr;
        points = lasfiles::compressedByLaszip(s.layout.format, std::uint16_t(length), records, 10, &vlr);
        vlrs.insert(vlrs.begin(), vlr);
    } else {
        points = records;
    }
    Bytes all = lasfiles::file(head, vlrs, points);
    if (s.compressed) {
        const std::size_t at = all.size() - points.size();
        lasfiles::set<std::int64_t>(all, at, lasfiles::get<std::int64_t>(all, at) + std::int64_t(at));
    }
    wholeFile("real " + path.filename().string(), all);
    std::vector<Bytes> descriptors;
    for (const punctum::las::Vlr* v : s.extraBytesRecords()) descriptors.emplace_back(v->data);
    if (!descriptors.empty())
        extraBytes("real " + path.filename().string(), s.layout.format,
                   std::uint16_t(length - punctum::las::standardRecordLength(s.layout.format)), descriptors);
}

void seedText(const std::string& target, const std::string& name, char flags, const std::string& text)
{
    const std::string all = flags + text;
    const auto bytes = std::as_bytes(std::span(all));
    seed(target, name, Bytes(bytes.begin(), bytes.end()));
}

/// Inputs of the target journal: each edit as a step, and as a literal, done, undone and done again.
void journals(bool odd)
{
    using namespace punctum;
    PointSet some(fuzz::kPoints);
    for (PointIndex i = 20; i < 90; i += i % 7 == 0 ? 5 : 1) some.insert(i);
    const auto within = std::make_shared<PointSet>(some);
    const std::string own = odd ? "Height" : "Reflectance";
    const std::vector<Recipe> recipes = {
        {"normals", {{"k", "8"}}, nullptr},
        {"normals", {{"radius", "4"}}, nullptr},
        {"outliers", {{"k", "4"}, {"deviations", "0.5"}, {"class", "18"}}, nullptr},
        {"reclassify", {{"attribute", "Z"}, {"min", "-1e9"}, {"max", "1e9"}, {"class", "200"}}, nullptr},
        {"reclassify", {{"attribute", "GpsTime"}, {"min", "0"}, {"max", "1e15"}, {"class", "6"}}, nullptr},
        {"set", {{"rule", "Classification = 2 if Z > 0 else 5 if exists(GpsTime)"}}, nullptr},
        {"set", {{"rule", "Withheld = 1"}}, within},
        {"set", {{"rule", own + " = " + own + " / 2"}}, within},
        {"set", {{"rule", "\"New one\" = Z * 2"}, {"new", "float64"}}, nullptr},
        {"delete", {{"where", "Classification == 2 or Z < 1"}}, nullptr},
        {"delete", {}, within},
        {"rename", {{"attribute", own}, {"to", "Other name"}}, nullptr},
        {"remove", {{"attribute", own}}, nullptr}};
    std::string together;
    for (std::size_t k = 0; k < recipes.size(); ++k) {
        const auto cloud = fuzz::copyOf(*fuzz::fixedCloud(odd).cloud);
        Progress progress;
        const auto command = makeCommand(recipes[k], *cloud, progress);
        if (!command) continue;
        command->prepare();
        JournalEntry entry;
        entry.recipe = recipes[k];
        entry.name = command->name();
        entry.changed = command->changedPoints();
        const std::string name = recipes[k].step + " " + std::to_string(k) + (odd ? " odd" : " sample");
        const std::string lines = journalLine(entry) + "\nundo\nredo\nundo\n";
        seedText("journal", name, char(odd ? 2 : 0), lines);
        together += lines;
        entry.recipe = literalOf(*command, *cloud, true, nullptr);
        entry.name = literalName(entry.recipe);
        const std::string literal = journalLine(entry) + "\nundo\nredo\n";
        seedText("journal", name + " literal", char(odd ? 6 : 4), literal);
    }
    seedText("journal", odd ? "together odd" : "together sample", char(odd ? 14 : 12), together);
    std::uint32_t sum = 0;
    std::string whole = summed(std::string(kJournalFirstLine), sum);
    whole += summed(journalCloudLine(fuzz::fixedCloud(odd).key, "a file.las"), sum);
    whole += summed("do 1 Restore%20deleted restore", sum);
    seedText("journal", odd ? "whole odd" : "whole sample", char(odd ? 3 : 1), whole);
}

void expressions()
{
    const char* const texts[] = {"Classification = 2 if Z > 12.5 and Intensity < 1000 else 5",
                                 "Classification in (2, 5..7, 9) or not Withheld",
                                 "\"Big id\" // 3 % 1000003 + 7 between -5 and 18446744073709551615",
                                 "Height = clamp(Z - 100, -300, 300) if exists(Height)",
                                 "Red = min(65535, Green * 2 if Blue > 5 else sqrt(Blue ** 2))",
                                 "A = abs(B) - floor(C / 2.5) * pi if 0 < A <= 500",
                                 "Classification == ground or Classification == 'low vegetation'",
                                 "Deviation = atan2(X, Y) if Reflectance != Reflectance else 3",
                                 "Fresh = log10(Z) if GpsTime >= 1e3",
                                 "NumberOfReturns > 1 and ReturnNumber == NumberOfReturns"};
    int number = 0;
    for (const char* text : texts) {
        ++number;
        for (const int flags : {0, 3, 5, 0x94})
            seedText("expression", std::to_string(number) + " " + std::to_string(flags), char(flags), text);
    }
}

void cameras()
{
    const char* const texts[] = {"{}",
                                 R"({"yaw": 30, "pitch": -35, "fov": 45})",
                                 R"({"eye": [1000.5, 2000, 90], "pitch": -90, "orthographic": true})",
                                 R"({"eye": [0, 0, 1e6], "pivot": [1, 2, 3.5], "orthographic": false})",
                                 R"({"pivot": [1, 2, 3]})",
                                 R"({"eye": [1, 2], "yaw": "north", "zoom": 3})"};
    int number = 0;
    for (const char* text : texts) seedText("camera", std::to_string(++number), text[0], text + 1);
}

const char* const kManifests[] = {
    "punctum-save 1\nfolder /b\nfolder /c%20d\nfile .a.las.tmp-12-01234567 a.las 10 -5 11 6 0a0b0c0d\n"
    "new .b.laz.tmp-12-01234567 b.laz 11 6 00000000\nend 3\n",
    "punctum-save 1\ndecider /a\nnew .b.laz.tmp-12-01234567 b.laz 11 6 00000000\nend 3\n",
    "punctum-save 1\nfile .a.las.tmp-12-01234567 ../a.las 10 5 11 6 0a0b0c0d\nend 1\n", "punctum-save 2\nmore\n"};

void manifests()
{
    int number = 0;
    for (const char* text : kManifests) seedText("manifest", std::to_string(++number), text[0], text + 1);
}

void make(const fs::path& realFiles)
{
    manifests();
    journals(false);
    journals(true);
    expressions();
    cameras();
    for (std::uint8_t format = 0; format <= 10; ++format)
        for (const std::uint16_t extra : {0, 5}) {
            const std::string name = "format " + std::to_string(format) + " " + std::to_string(extra);
            const auto length = std::uint16_t(lasfiles::recordLength(format) + extra);
            const Bytes records = lasfiles::randomRecords(format, length, kPoints, format, true);
            const Bytes laz = lasfiles::lazFile(format, length, records, 10);
            if (extra == 0) {
                wholeFile("las " + name,
                          lasfiles::file(lasfiles::header(lasfiles::minorFor(format), format, length, kPoints), {},
                                         records));
                chunkTable(name, laz, false);
            }
            wholeFile("laz " + name, laz);
            for (unsigned version = 0; version < 3; ++version)
                chunk(name + " v" + std::to_string(version), laz, 10, version, false);
            if (format < 6) chunk(name + " stream", laz, 10, 1, true);
        }
    for (const std::uint8_t format : {std::uint8_t(6), std::uint8_t(10)}) {  // of LAS 1.5, with an offset of times
        const std::uint16_t length = lasfiles::recordLength(format);
        Bytes head = lasfiles::header(5, format, length, kPoints);
        lasfiles::set<std::uint16_t>(head, 6, 1 | 16 | 64);
        lasfiles::set<double>(head, 375, 1e6);
        lasfiles::set<double>(head, 383, -1e6);
        lasfiles::set<std::uint16_t>(head, 391, 1355);
        const Bytes records = lasfiles::randomRecords(format, length, kPoints, format, true);
        wholeFile("las 1.5 format " + std::to_string(format), lasfiles::file(head, {}, records));
    }
    {
        const Bytes octree = copcfiles::made({}, 100);
        wholeFile("copc", octree);
        Bytes circle = octree;  // an entry leads back to the page that it is on
        const std::uint64_t root = lasfiles::get<std::uint64_t>(octree, copcfiles::kInfo + 40);
        lasfiles::set<std::uint64_t>(circle, std::size_t(root) + 32 * 8 + 16, root);
        wholeFile("copc circle", circle);
    }
    for (const lasfiles::BadInput& row : lasfiles::badInputs(kPoints)) {
        if (row.bytes.size() > 8000) continue;
        wholeFile("bad " + row.name, row.bytes);
        const auto number = std::atoi(row.name.c_str());
        if (number >= 37 && number <= 48 && row.bytes.size() > 500)
            chunkTable("bad " + row.name, row.bytes, number == 40 || number == 41);
        if (number == 43 || (number == 44 && lasfiles::bad::tableAt(row.bytes) != 0))
            chunk("bad " + row.name, row.bytes, 6, 1, false);
    }
    using lasfiles::bad::descriptor;
    for (int type = 0; type <= 31; ++type)
        extraBytes("type " + std::to_string(type), std::uint8_t(type % 11), 24,
                   {descriptor(type, type == 0 ? 7 : 31, "Value"), descriptor(2, 0, "Value")});
    if (!realFiles.empty())
        for (const fs::path& path : lasfiles::sharedFiles(realFiles)) trimmed(path);
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "Usage: MakeSeeds FOLDER [FOLDER OF REAL FILES]\n");
        return 2;
    }
    folder = argv[1];
    try {
        make(argc > 2 ? fs::path(argv[2]) : fs::path());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
