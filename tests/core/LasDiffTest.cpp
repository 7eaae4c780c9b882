// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/edit/Command.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/process/Step.h"
#include "core/task/Progress.h"
#include "tests/core/Differences.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <bit>
#include <map>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// What differs between two files: nothing is overlooked, nothing is made up.
class LasDiffTest : public QObject
{
    Q_OBJECT

private slots:
    void lasAndLazHoldTheSame_data();
    void lasAndLazHoldTheSame();
    void everyBitBelongsToItsAttribute_data();
    void everyBitBelongsToItsAttribute();
    void everyHeaderFieldHasItsName();
    void recordsAndOtherBytes_data();
    void recordsAndOtherBytes();
    void extraBytesAreComparedExactly();
    void extraBytesGoByName();
    void formatsOfTheOtherFamilyByMeaning();
    void coordinatesByValue();
    void pointsThatAreMissing();
    void unreadablePointsAreNotEqual();
    void theFirstDifferenceIsTold();
    void shortCompressionRecords();
    void cancels();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    las::Difference diff(const Bytes& a, const Bytes& b, bool lazA = false, bool lazB = false) const
    {
        return diffOf(make(lazA ? "a.laz" : "a.las", a), make(lazB ? "b.laz" : "b.las", b));
    }
    static las::Difference diffOf(const fs::path& a, const fs::path& b, bool bytes = false)
    {
        Progress progress;
        return las::diffFiles(a, b, {bytes}, progress);
    }

    QTemporaryDir m_dir;
};

namespace
{

Bytes descriptor(int type, const std::string& name, int options = 0)
{
    Bytes d(192);
    d[2] = std::byte(type);
    d[3] = std::byte(options);
    std::memcpy(d.data() + 4, name.data(), std::min<std::size_t>(name.size(), 32));
    return d;
}

/// One bit of each record, another in each one, is turned.
Bytes withOneBitTurnedInEach(Bytes records, std::uint16_t length)
{
    for (std::size_t i = 0; i * length < records.size(); ++i) {
        const std::size_t bit = i % (length * 8u);
        records[i * length + bit / 8] ^= std::byte(1u << bit % 8);
    }
    return records;
}

std::string fields(const std::vector<las::FieldDifference>& list)
{
    std::string all;
    for (const auto& f : list) all += f.name + " ";
    return all;
}

}  // namespace

void LasDiffTest::lasAndLazHoldTheSame_data()
{
    QTest::addColumn<int>("format");
    for (int format = 0; format <= 10; ++format) QTest::addRow("format %d", format) << format;
}

void LasDiffTest::lasAndLazHoldTheSame()
{
    QFETCH(int, format);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + 3);
    const Bytes records = lasfiles::randomRecords(f, length, 3000, 5, true);
    Bytes head = lasfiles::header(lasfiles::minorFor(f), f, length, 3000);
    const fs::path las = make("same.las", lasfiles::file(head, {}, records));
    const fs::path laz = make("same.laz", lasfiles::lazFile(f, length, records, 700));
    for (const auto& [a, b] : {std::pair(las, laz), std::pair(laz, las)}) {
        const las::Difference d = diffOf(a, b, true);
        QVERIFY2(d.contentEqual(), las::report(d, "a", "b").c_str());
        QCOMPARE(d.compared, PointIndex(3000));
        QVERIFY(!d.containerEqual());
        QCOMPARE(d.storedA == "LAS", a == las);
        QCOMPARE(d.storedB == "LAS", b == las);
        QVERIFY(d.firstByte.has_value());
        QVERIFY(las::summary(d).empty());
    }
    const las::Difference same = diffOf(laz, laz, true);
    QVERIFY(same.contentEqual() && same.containerEqual());
    // other chunks, the same points
    const las::Difference chunks = diffOf(laz, make("chunks.laz", lasfiles::lazFile(f, length, records, 300)));
    QVERIFY(chunks.contentEqual() && !chunks.containerEqual());
}

void LasDiffTest::everyBitBelongsToItsAttribute_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<bool>("compressed");
    for (int format = 0; format <= 10; ++format)
        for (const bool compressed : {false, true})
            QTest::addRow("format %d %s", format, compressed ? "LAZ" : "LAS") << format << compressed;
}

void LasDiffTest::everyBitBelongsToItsAttribute()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + 11);  // float64, uint8, and 2 undescribed bytes
    const std::size_t count = length * 8u * 2;
    const Bytes records = lasfiles::randomRecords(f, length, count, 3);
    const Bytes turned = withOneBitTurnedInEach(records, length);
    Bytes data = descriptor(10, "Deviation");
    lasfiles::append(data, descriptor(1, "Mark"));
    const auto file = [&](const Bytes& r) {
        return lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, count),
                              {lasfiles::record("LASF_Spec", 4, data)}, r);
    };
    fs::path a = make("bits-a.las", file(records));
    const fs::path b = make("bits-b.las", file(turned));
    if (compressed) {
        Progress progress;
        const auto cloud = las::load(a, progress);
        a.replace_extension(".laz");
        las::WriteOptions options;
        options.compressed = true;
        las::write(*cloud, a, options, progress);
    }
    const las::Difference d = diffOf(a, b);

    std::map<std::string, std::uint64_t> bits{{"X", 32},
                                              {"Y", 32},
                                              {"Z", 32},
                                              {"Intensity", 16},
                                              {"ScanDirectionFlag", 1},
                                              {"EdgeOfFlightLine", 1},
                                              {"Synthetic", 1},
                                              {"KeyPoint", 1},
                                              {"Withheld", 1},
                                              {"UserData", 8},
                                              {"PointSourceId", 16},
                                              {"Deviation", 64},
                                              {"Mark", 8},
                                              {"ExtraBytes", 16}};
    const bool extended = format >= 6;
    bits["ReturnNumber"] = bits["NumberOfReturns"] = extended ? 4 : 3;
    bits["Classification"] = extended ? 8 : 5;
    bits["ScanAngle"] = extended ? 16 : 8;
    if (extended) {
        bits["Overlap"] = 1;
        bits["ScannerChannel"] = 2;
    }
    if (format == 1 || format >= 3) bits["GpsTime"] = 64;
    if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10)
        bits["Red"] = bits["Green"] = bits["Blue"] = 16;
    if (format == 8 || format == 10) bits["NIR"] = 16;
    if (format == 4 || format == 5 || format >= 9) {
        bits["WaveformDescriptorIndex"] = 8;
        bits["WaveformOffset"] = 64;
        bits["WaveformSize"] = bits["WaveformReturnLocation"] = 32;
        bits["WaveformX"] = bits["WaveformY"] = bits["WaveformZ"] = 32;
    }
    std::map<std::string, std::uint64_t> found;
    for (const auto& x : d.attributes) found[x.name] = x.points;
    for (auto& [name, n] : bits) n *= 2;
    QVERIFY2(found == bits, names(d).c_str());
    QCOMPARE(d.differing, PointIndex(count));
    QVERIFY(d.header.empty() && d.records.empty() && d.bytes.empty());
    // the first bit of X is turned in the first point
    QCOMPARE(d.attributes.front().first, PointIndex(0));
}

void LasDiffTest::everyHeaderFieldHasItsName()
{
    const Bytes records = lasfiles::randomRecords(6, 30, 20, 1);
    Bytes head = lasfiles::header(4, 6, 30, 20);
    const Bytes a = lasfiles::file(head, {}, records);
    const std::pair<std::size_t, const char*> places[] = {{4, "file_source_id"},
                                                          {6, "global_encoding"},
                                                          {8, "project_id"},
                                                          {23, "project_id"},
                                                          {26, "system_identifier"},
                                                          {57, "system_identifier"},
                                                          {58, "generating_software"},
                                                          {90, "creation_day"},
                                                          {92, "creation_year"},
                                                          {111, "legacy_points_by_return[1]"},
                                                          {127, "legacy_points_by_return[5]"},
                                                          {179, "max_x"},
                                                          {187, "min_x"},
                                                          {195, "max_y"},
                                                          {203, "min_y"},
                                                          {211, "max_z"},
                                                          {219, "min_z"},
                                                          {227, "waveform_start"},
                                                          {255, "points_by_return[1]"},
                                                          {367, "points_by_return[15]"}};
    for (const auto& [at, name] : places) {
        Bytes b = a;
        b[at] ^= std::byte(1);
        const las::Difference d = diff(a, b);
        QCOMPARE_STRING(fields(d.header), std::string(name) + " ");
        QVERIFY2(las::toText(d.header[0].a) != las::toText(d.header[0].b), name);
        QVERIFY(!d.contentEqual() && d.attributes.empty() && d.records.empty());
    }
    // the sign of a zero, and what stands behind the end of a text
    Bytes b = a;
    lasfiles::set<double>(b, 155, -0.0);
    las::Difference d = diff(a, b);
    QCOMPARE_STRING(fields(d.header), "offset_x ");
    QCOMPARE_STRING(las::toText(d.header[0].b), "-0");
    QVERIFY(d.attributes.empty());
    b = a;
    b[80] = std::byte('x');  // generating_software ends at byte 62
    d = diff(a, b);
    QCOMPARE_STRING(fields(d.header), "generating_software ");
    QVERIFY(las::toText(d.header[0].a).starts_with("0x74657374"));
    // where there are no extended records, their beginning says nothing
    b = a;
    lasfiles::set<std::uint64_t>(b, 235, b.size());
    d = diff(a, b);
    QVERIFY(d.contentEqual());
    QCOMPARE_STRING(fields(d.container), "evlr_start ");
    // a header of another version
    d = diff(a, lasfiles::file(lasfiles::header(2, 6, 30, 20), {}, records));
    QVERIFY(fields(d.header).find("version_minor header_size ") != std::string::npos);
    QVERIFY(fields(d.header).find("point_count ") != std::string::npos);
    QCOMPARE_STRING(las::toText(d.header.back().b), "none");
}

void LasDiffTest::recordsAndOtherBytes_data()
{
    QTest::addColumn<QByteArray>("a");
    QTest::addColumn<QByteArray>("b");
    QTest::addColumn<QString>("expected");
    const auto text = [](const std::string& s) {
        Bytes b(s.size());
        std::memcpy(b.data(), s.data(), s.size());
        return b;
    };
    const auto file = [&](const std::vector<Bytes>& vlrs, const std::vector<Bytes>& evlrs = {},
                          const Bytes& gap = {}, const Bytes& user = {}, const Bytes& after = {},
                          const Bytes& tail = {}) {
        Bytes head = lasfiles::header(4, 6, 30, 2);
        lasfiles::append(head, user);
        lasfiles::set<std::uint16_t>(head, 94, std::uint16_t(head.size()));
        Bytes rest = after;
        for (const Bytes& e : evlrs) lasfiles::append(rest, e);
        lasfiles::append(rest, tail);
        std::size_t points = head.size() + gap.size();
        for (const Bytes& v : vlrs) points += v.size();
        lasfiles::set<std::uint32_t>(head, 243, std::uint32_t(evlrs.size()));
        if (!evlrs.empty()) lasfiles::set<std::uint64_t>(head, 235, points + 60 + after.size());
        Bytes records = gap;
        lasfiles::append(records, Bytes(60));
        Bytes all = lasfiles::file(head, vlrs, records, rest);
        lasfiles::set<std::uint32_t>(all, 96, std::uint32_t(points));
        return QByteArray(reinterpret_cast<const char*>(all.data()), qsizetype(all.size()));
    };
    const Bytes one = lasfiles::record("u", 1, text("first")), two = lasfiles::record("u", 2, text("second"));
    const Bytes other = lasfiles::record("u", 1, text("firSt")), longer = lasfiles::record("u", 1, text("first!"));
    const Bytes extended = lasfiles::record("u", 1, text("first"), true);
    const QByteArray plain = file({one, two});
    QTest::newRow("added") << file({one}) << plain << "+u/2:6 vlr_count";
    QTest::newRow("removed") << plain << file({two}) << "-u/1:5 vlr_count";
    QTest::newRow("changed") << plain << file({other, two}) << "*u/1:5>5@3";
    QTest::newRow("longer") << plain << file({longer, two}) << "*u/1:5>6@5";
    Bytes described = one;
    described[30] = std::byte('d');
    QTest::newRow("described") << plain << file({described, two}) << "*u/1:5>5d";
    QTest::newRow("reordered") << plain << file({two, one}) << "order";
    QTest::newRow("twice") << file({one, one, two}) << file({one, other, two}) << "*u/1:5>5@3";
    QTest::newRow("first of two goes") << file({other, one, two}) << plain << "-u/1:5 vlr_count";
    QTest::newRow("becomes extended") << file({one}) << file({}, {extended})
                                      << "*u/1:5>5x evlr_count evlr_start vlr_count";
    QTest::newRow("EVLR added") << plain << file({one, two}, {extended}) << "+u/1:5 evlr_count evlr_start";
    QTest::newRow("gap") << plain << file({one, two}, {}, text("gap")) << "[bytes before the points 0>3@0]";
    QTest::newRow("user bytes") << file({}, {}, {}, text("ab")) << file({}, {}, {}, text("aX"))
                                << "[user bytes of the header 2>2@1]";
    QTest::newRow("after points") << file({}, {extended}, {}, {}, text("zz"))
                                  << file({}, {extended}, {}, {}, text("zy")) << "[bytes after the points 2>2@1]";
    QTest::newRow("tail") << file({}, {extended}, {}, {}, {}, text("t")) << file({}, {extended})
                          << "[bytes at the end of the file 1>0@0]";
}

void LasDiffTest::recordsAndOtherBytes()
{
    QFETCH(QByteArray, a);
    QFETCH(QByteArray, b);
    QFETCH(QString, expected);
    const auto bytes = [](const QByteArray& q) {
        Bytes v(std::size_t(q.size()));
        std::memcpy(v.data(), q.data(), v.size());
        return v;
    };
    const las::Difference d = diff(bytes(a), bytes(b));
    std::string found;
    for (const auto& r : d.records) {
        using Change = las::RecordDifference::Change;
        const std::string what = r.user + "/" + std::to_string(r.id) + ":";
        if (r.change == Change::Added) found += "+" + what + std::to_string(r.lengthB);
        if (r.change == Change::Removed) found += "-" + what + std::to_string(r.lengthA);
        if (r.change == Change::Changed) {
            found += "*" + what + std::to_string(r.lengthA) + ">" + std::to_string(r.lengthB);
            if (r.firstDataByte) found += "@" + std::to_string(*r.firstDataByte);
            if (r.frameDiffers) found += "d";
            if (r.extendedA != r.extendedB) found += "x";
        }
        found += " ";
    }
    if (d.recordsReordered) found += "order ";
    for (const auto& x : d.bytes)
        found += "[" + x.what + " " + std::to_string(x.lengthA) + ">" + std::to_string(x.lengthB) + "@" +
                 std::to_string(x.firstByte) + "] ";
    for (const auto& f : d.header)
        if (f.name != "header_size") found += f.name + " ";
    QCOMPARE(QString::fromStdString(found).trimmed(), expected);
    QVERIFY(!d.contentEqual() && d.attributes.empty());
}

void LasDiffTest::extraBytesAreComparedExactly()
{
    // uint64 beyond what a double holds, the payload of a NaN, the sign of a zero
    Bytes data = descriptor(7, "Big");
    lasfiles::append(data, descriptor(10, "Real"));
    lasfiles::append(data, descriptor(9, "Single"));
    const Bytes head = lasfiles::header(2, 0, 40, 3);
    Bytes a(120), b(120);
    for (Bytes* r : {&a, &b})
        for (std::size_t i = 0; i < 3; ++i) {
            lasfiles::set<std::uint64_t>(*r, i * 40 + 20, (1ull << 60) + 1);
            lasfiles::set<std::uint64_t>(*r, i * 40 + 28, 0x7FF8000000000001ull);
            lasfiles::set<float>(*r, i * 40 + 36, 0.0f);
        }
    lasfiles::set<std::uint64_t>(b, 40 + 20, (1ull << 60) + 2);
    lasfiles::set<std::uint64_t>(b, 80 + 28, 0x7FF8000000000002ull);
    lasfiles::set<float>(b, 80 + 36, -0.0f);
    const std::vector<Bytes> vlrs{lasfiles::record("LASF_Spec", 4, data)};
    const las::Difference d = diff(lasfiles::file(head, vlrs, a), lasfiles::file(head, vlrs, b));
    QCOMPARE_STRING(names(d), "Big:1 Real:1 Single:1 ");
    QCOMPARE(d.differing, PointIndex(2));
    QCOMPARE(d.attributes[0].first, PointIndex(1));
    QCOMPARE_STRING(las::toText(d.attributes[0].a), "1152921504606846977");
    QCOMPARE_STRING(las::toText(d.attributes[0].b), "1152921504606846978");
    QCOMPARE_STRING(las::toText(d.attributes[1].b), "NaN (0x7ff8000000000002)");
    QCOMPARE_STRING(las::toText(d.attributes[2].b), "-0");
}

void LasDiffTest::extraBytesGoByName()
{
    // the same values in another order and as other types: a difference of types and of the record, not of values
    Bytes one = descriptor(1, "Small"), two = descriptor(3, "Wide");
    Bytes first = one, second = descriptor(5, "Wide"), gone = one;
    lasfiles::append(first, two);
    lasfiles::append(second, one);
    Bytes a(3 * 23), b(3 * 25);
    for (std::size_t i = 0; i < 3; ++i) {
        lasfiles::set<std::uint8_t>(a, i * 23 + 20, std::uint8_t(i + 1));
        lasfiles::set<std::uint16_t>(a, i * 23 + 21, std::uint16_t(1000 * i));
        lasfiles::set<std::uint32_t>(b, i * 25 + 20, std::uint32_t(1000 * i));
        lasfiles::set<std::uint8_t>(b, i * 25 + 24, std::uint8_t(i + 1));
    }
    const Bytes fileA = lasfiles::file(lasfiles::header(2, 0, 23, 3), {lasfiles::record("LASF_Spec", 4, first)}, a);
    Bytes fileB = lasfiles::file(lasfiles::header(2, 0, 25, 3), {lasfiles::record("LASF_Spec", 4, second)}, b);
    las::Difference d = diff(fileA, fileB);
    QCOMPARE_STRING(names(d), "Wide:0 ");
    QCOMPARE_STRING(d.attributes[0].typeA + d.attributes[0].typeB, "uint16uint32");
    QCOMPARE(d.differing, PointIndex(0));
    QCOMPARE_STRING(fields(d.header), "record_length ");
    QCOMPARE(d.records.size(), std::size_t(1));
    // one that only one file has
    Bytes c(3 * 21);
    for (std::size_t i = 0; i < 3; ++i) lasfiles::set<std::uint8_t>(c, i * 21 + 20, std::uint8_t(i + 1));
    d = diff(fileA, lasfiles::file(lasfiles::header(2, 0, 21, 3), {lasfiles::record("LASF_Spec", 4, gone)}, c));
    QCOMPARE_STRING(names(d), "Wide:2 ");
    QVERIFY(d.attributes[0].change == las::AttributeDifference::Change::Removed);
    QVERIFY(las::dropsOrUpgrades(d));
    // numbers of the other kind, or in steps that have no unit in common, are compared as real ones
    const auto made = [&](const Bytes& description, auto value) {
        const auto length = std::uint16_t(20 + sizeof value);
        Bytes records(length);
        lasfiles::set(records, 20, value);
        return lasfiles::file(lasfiles::header(2, 0, length, 1), {lasfiles::record("LASF_Spec", 4, description)},
                              records);
    };
    const auto scaled = [](double scale) {
        Bytes description = descriptor(5, "V", 8);
        lasfiles::set(description, 112, scale);
        return description;
    };
    QCOMPARE(diff(made(descriptor(9, "V"), 0.5f), made(descriptor(10, "V"), 0.5)).differing, PointIndex(0));
    QCOMPARE(diff(made(descriptor(9, "V"), 0.5f), made(descriptor(10, "V"), 0.6)).differing, PointIndex(1));
    QCOMPARE(diff(made(scaled(1e-30), 0u), made(scaled(1e30), 0u)).differing, PointIndex(0));
    QCOMPARE(diff(made(scaled(1e-30), 0u), made(scaled(1e30), 1u)).differing, PointIndex(1));
}

void LasDiffTest::formatsOfTheOtherFamilyByMeaning()
{
    constexpr std::size_t kCount = 2000;
    const fs::path three = make("three.las", lasfiles::file(lasfiles::header(2, 3, 34, kCount), {},
                                                            lasfiles::randomRecords(3, 34, kCount, 9)));
    Progress progress;
    const auto cloud = las::load(three, progress);
    const fs::path seven = three.parent_path() / "seven.laz";
    las::WriteOptions options;
    options.compressed = true;
    options.pointFormat = 7;
    las::write(*cloud, seven, options, progress);
    las::Difference d = diffOf(three, seven);
    QCOMPARE(d.compared, PointIndex(kCount));
    QVERIFY2(d.differing == 0, las::report(d, "a", "b").c_str());
    QCOMPARE_STRING(names(d), "ReturnNumber:0 NumberOfReturns:0 Classification:0 ScanAngle:0 ");
    QVERIFY(!d.contentEqual() && las::dropsOrUpgrades(d));  // the format is another one

    // one value of each kind
    const auto back = las::load(seven, progress);
    const auto column = [&](const char* name) {
        for (const auto& c : back->columns())
            if (c->name() == name) return c;
        return std::shared_ptr<Column>();
    };
    column("Classification")->values<std::uint8_t>()[3] ^= 1;
    column("Flags")->values<std::uint8_t>()[4] ^= 8;      // overlap
    column("Flags")->values<std::uint8_t>()[5] ^= 16;     // channel
    column("Flags")->values<std::uint8_t>()[6] ^= 4;      // withheld
    column("ScanAngle")->values<std::int16_t>()[7] += 1;  // no whole degree any more
    column("Returns")->values<std::uint8_t>()[8] ^= 16;
    options.pointFormat.reset();
    las::write(*back, seven, options, progress);
    d = diffOf(seven, three);
    std::map<std::string, std::pair<std::uint64_t, PointIndex>> found;
    for (const auto& a : d.attributes)
        if (a.points != 0) found[a.name] = {a.points, a.first};
    // overlap also is what class 12 says, which the first edit may have made or unmade
    QCOMPARE(found.count("Overlap"), std::size_t(1));
    found.erase("Overlap");
    const decltype(found) expected{{"Classification", {1, 3}},
                                   {"ScannerChannel", {1, 5}},
                                   {"Withheld", {1, 6}},
                                   {"ScanAngle", {1, 7}},
                                   {"NumberOfReturns", {1, 8}}};
    QVERIFY2(found == expected, las::report(d, "a", "b").c_str());
}

void LasDiffTest::coordinatesByValue()
{
    Bytes a(60), b(60);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            lasfiles::set<std::int32_t>(a, i * 20 + k * 4, std::int32_t(63701224 + i));
            lasfiles::set<std::int32_t>(b, i * 20 + k * 4, std::int32_t(63701224 + i) * 10 - 600000000);
        }
    Bytes head = lasfiles::header(2, 0, 20, 3), fine = head;
    for (std::size_t k = 0; k < 3; ++k) {
        lasfiles::set<double>(fine, 131 + 8 * k, 0.001);
        lasfiles::set<double>(fine, 155 + 8 * k, 600000.0);
    }
    las::Difference d = diff(lasfiles::file(head, {}, a), lasfiles::file(fine, {}, b));
    QVERIFY2(d.attributes.empty() && d.differing == 0, las::report(d, "a", "b").c_str());
    QCOMPARE_STRING(fields(d.header), "scale_x scale_y scale_z offset_x offset_y offset_z ");
    lasfiles::set<std::int32_t>(b, 20, lasfiles::get<std::int32_t>(b, 20) + 1);
    d = diff(lasfiles::file(head, {}, a), lasfiles::file(fine, {}, b));
    QCOMPARE_STRING(names(d), "X:1 ");
    QCOMPARE(d.attributes[0].first, PointIndex(1));
    QCOMPARE_STRING(las::toText(d.attributes[0].a), "637012.25");
    QCOMPARE_STRING(las::toText(d.attributes[0].b), "637012.251");
    // scales for which no common decimal unit exists
    for (std::size_t k = 0; k < 3; ++k) lasfiles::set<double>(fine, 131 + 8 * k, 1.1e-300);
    d = diff(lasfiles::file(head, {}, a), lasfiles::file(fine, {}, b));
    QCOMPARE_STRING(names(d), "X:3 Y:3 Z:3 ");
}

void LasDiffTest::pointsThatAreMissing()
{
    const Bytes records = lasfiles::randomRecords(1, 28, 100, 2);
    const Bytes fewer(records.begin(), records.begin() + 28 * 97);
    const Bytes a = lasfiles::file(lasfiles::header(2, 1, 28, 100), {}, records);
    const Bytes b = lasfiles::file(lasfiles::header(2, 1, 28, 97), {}, fewer);
    const las::Difference d = diff(a, b);
    QCOMPARE(d.pointsA, PointIndex(100));
    QCOMPARE(d.pointsB, PointIndex(97));
    QCOMPARE(d.compared, PointIndex(97));
    QVERIFY(d.attributes.empty() && !d.contentEqual() && las::dropsOrUpgrades(d));
    QCOMPARE_STRING(fields(d.header), "legacy_point_count ");
    QVERIFY(las::report(d, "one", "two").find("lacks 3 points") != std::string::npos);
    // nothing to compare
    const Bytes none = lasfiles::file(lasfiles::header(2, 1, 28, 0), {}, {});
    QVERIFY(diff(none, none).contentEqual());
    QCOMPARE(diff(none, a).compared, PointIndex(0));
}

void LasDiffTest::unreadablePointsAreNotEqual()
{
    const Bytes records = lasfiles::randomRecords(3, 34, 1000, 2, true);
    const Bytes good = lasfiles::lazFile(3, 34, records, 200);
    Bytes bad = good;
    const std::size_t at = lasfiles::get<std::uint32_t>(bad, 96) + 8;
    for (std::size_t k = 6000; k < 6100; ++k) bad[at + k] ^= std::byte(0x5A);
    const Bytes las = lasfiles::file(lasfiles::header(2, 3, 34, 1000), {}, records);
    for (const auto& [other, laz] : {std::pair(good, true), std::pair(las, false)}) {
        const las::Difference d = diff(bad, other, true, laz);
        QVERIFY(d.unreadableA >= 1 && d.unreadableA <= 400);
        QCOMPARE(d.unreadableB, PointIndex(0));
        QCOMPARE(d.compared, 1000 - d.unreadableA);
        QVERIFY2(d.attributes.empty(), names(d).c_str());
        QVERIFY(!d.contentEqual());
        const las::Difference back = diff(other, bad, laz, true);
        QCOMPARE(back.unreadableB, d.unreadableA);
        QVERIFY(back.attributes.empty());
    }
    // in both files, at places that overlap
    Bytes worse = bad;
    for (std::size_t k = 5000; k < 7000; ++k) worse[at + k] ^= std::byte(0x5A);
    const las::Difference d = diff(bad, worse, true, true);
    QVERIFY(d.unreadableB >= d.unreadableA && d.unreadableA > 0);
    QCOMPARE(d.compared, 1000 - d.unreadableB);
    QVERIFY(d.attributes.empty());
}

void LasDiffTest::theFirstDifferenceIsTold()
{
    // chunks are compared in another order than that of the file
    Bytes records = lasfiles::randomRecords(3, 34, 1000, 2, true);
    const Bytes one = lasfiles::lazFile(3, 34, records, 200);
    for (const std::size_t point : {900u, 500u, 300u}) records[point * 34 + 12] ^= std::byte(1);
    const las::Difference d = diff(one, lasfiles::lazFile(3, 34, records, 200), true, true);
    QCOMPARE_STRING(names(d), "Intensity:3 ");
    QCOMPARE(d.attributes[0].first, PointIndex(300));
}

void LasDiffTest::shortCompressionRecords()
{
    const auto made = [](std::size_t bytes) {
        return lasfiles::file(lasfiles::header(2, 0, 20, 1),
                              {lasfiles::record("laszip encoded", 22204, Bytes(bytes, std::byte(0xAB)))},
                              Bytes(20));
    };
    const las::Difference d = diff(made(2), made(3));
    QVERIFY(d.contentEqual());
    const auto found = std::find_if(d.container.begin(), d.container.end(),
                                    [](const las::FieldDifference& f) { return f.name == "compression"; });
    QVERIFY(found != d.container.end());
    QCOMPARE_STRING(las::toText(found->a) + " " + las::toText(found->b), "0xabab 0xababab");
}

void LasDiffTest::cancels()
{
    const Bytes records = lasfiles::randomRecords(1, 28, 100, 2);
    const fs::path a = make("c.laz", lasfiles::lazFile(1, 28, records, 20));
    Progress progress;
    progress.cancel();
    QVERIFY_THROWS_EXCEPTION(Cancelled, las::diffFiles(a, a, {}, progress));
    QVERIFY_THROWS_EXCEPTION(Error, las::diffFiles(a, a.parent_path() / "none.las", {}, progress));
}

QTEST_GUILESS_MAIN(LasDiffTest)
#include "LasDiffTest.moc"
