// SPDX-License-Identifier: MIT
// The figures of all points, what the doctor finds in files with one fault each, and what repair makes of them:
// held against LASzip's own API, and byte by byte.
#include "core/Error.h"
#include "core/cloud/PointFigures.h"
#include "core/expression/Condition.h"
#include "core/las/HeaderWords.h"
#include "core/las/Reader.h"
#include "core/las/Repair.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

#include <cmath>
#include <functional>
#include <limits>

using namespace punctum;
using lasfiles::Bytes;

namespace
{

namespace fs = std::filesystem;

constexpr std::size_t kPoints = 300;
const char* const kWkt =
    "PROJCS[\"WGS 84 / UTM zone 32N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
    "84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
    "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],"
    "PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],"
    "UNIT[\"metre\",1]]";

/// GeoTIFF keys that name a system, EPSG:32632.
Bytes keysRecord(std::uint16_t model = 1, std::uint16_t key = 3072, std::uint16_t code = 32632)
{
    const std::uint16_t words[] = {1, 1, 0, 2, 1024, 0, 1, model, key, 0, 1, code};
    Bytes data(sizeof words);
    std::memcpy(data.data(), words, sizeof words);
    return lasfiles::record("LASF_Projection", 34735, data);
}

/// Points on a plane a meter apart, first returns of one or two, of class 2, with times of 2012.
Bytes soundRecords(std::uint8_t format, std::size_t count = kPoints)
{
    const std::uint16_t length = lasfiles::recordLength(format);
    Bytes b(count * length);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t r = i * length;
        lasfiles::set(b, r, std::int32_t(i % 20 * 100));
        lasfiles::set(b, r + 4, std::int32_t(i / 20 * 100));
        lasfiles::set(b, r + 8, std::int32_t(i % 7));
        const unsigned number = i % 3 == 2 ? 2 : 1, of = i % 3 == 0 ? 1 : 2;
        if (format < 6) {
            b[r + 14] = std::byte(number | of << 3);
            b[r + 15] = std::byte(2);
            if (format == 1 || format >= 3) lasfiles::set(b, r + 20, 25873047.0 + double(i));
        } else {
            b[r + 14] = std::byte(number | of << 4);
            b[r + 16] = std::byte(2);
            lasfiles::set(b, r + 22, 25873047.0 + double(i));
        }
    }
    return b;
}

/// Counts, points by return and bounds as they have to be for soundRecords().
void makeSound(Bytes& head, std::uint8_t format, std::size_t count = kPoints)
{
    std::uint64_t returns[2] = {0, 0};
    for (std::size_t i = 0; i < count; ++i) ++returns[i % 3 == 2];
    if (format < 6)
        for (std::size_t k = 0; k < 2; ++k) lasfiles::set(head, 111 + 4 * k, std::uint32_t(returns[k]));
    if (head.size() >= 375)
        for (std::size_t k = 0; k < 2; ++k) lasfiles::set(head, 255 + 8 * k, returns[k]);
    const double most[] = {19.0, double((count - 1) / 20), 0.06};
    for (std::size_t k = 0; k < 3; ++k) lasfiles::set(head, 179 + 16 * k, most[k]);
    std::uint16_t encoding = 1;
    if (format >= 6) encoding |= 16;
    lasfiles::set(head, 6, encoding);
}

/// The records, each as long as the header says.
Bytes withExtra(const Bytes& records, std::uint8_t format, const Bytes& head)
{
    const std::size_t from = lasfiles::recordLength(format), to = lasfiles::get<std::uint16_t>(head, 105);
    Bytes longer(records.size() / from * to);
    for (std::size_t i = 0; i * from < records.size(); ++i)
        std::copy_n(records.begin() + std::ptrdiff_t(i * from), from, longer.begin() + std::ptrdiff_t(i * to));
    return longer;
}

/// A sound file: GeoTIFF keys (formats 0 to 5) or WKT; of LAS 1.4 with an extended record.
Bytes sound(std::uint8_t format, const Bytes& after = {})
{
    Bytes head = lasfiles::header(lasfiles::minorFor(format), format, lasfiles::recordLength(format), kPoints);
    makeSound(head, format);
    Bytes all = lasfiles::file(head, {format < 6 ? keysRecord() : lasfiles::wktRecord(kWkt)}, soundRecords(format));
    if (format >= 6) {
        lasfiles::set(all, 235, std::uint64_t(all.size()));
        lasfiles::set(all, 243, std::uint32_t(1));
        lasfiles::append(all, lasfiles::record("somebody", 7, lasfiles::textBytes("hello"), true));
    }
    lasfiles::append(all, after);
    return all;
}

Bytes soundLaz(std::uint8_t format)
{
    Bytes b = lasfiles::lazFile(format, lasfiles::recordLength(format), soundRecords(format), 100);
    makeSound(b, format);
    return b;
}

/// All faults in one text.
std::string told(const std::vector<las::Finding>& findings, std::optional<bool> repairable = {})
{
    std::string text;
    for (const las::Finding& f : findings)
        if (!repairable || *repairable == f.repairable) text += f.fault + "\n";
    return text;
}

las::Examination examined(const fs::path& path)
{
    Progress progress;
    const auto cloud = las::load(path, progress);
    return las::examine(*cloud, progress);
}

}  // namespace

class DoctorTest : public QObject
{
    Q_OBJECT

private slots:
    void init();
    void figures();
    void figuresOfNothing();
    void densityOfAGrid();
    void strays();
    void whatDeletesStraysLeavesTheOthers();
    void linesOfPointsHaveNoDensity();
    void words();
    void soundFilesHaveNoFaults_data();
    void soundFilesHaveNoFaults();
    void faults_data();
    void faults();
    void whatWasSavedIsLookedAt();
    void damagedChunksAreTold();
    void repairIsCancelledWhole();
    void repairKeepsTheOriginal();
    void realFiles_data();
    void realFiles();

private:
    fs::path path(const std::string& name) const { return fs::path(m_folder->path().toStdString()) / name; }
    std::unique_ptr<QTemporaryDir> m_folder;
};

void DoctorTest::init()
{
    m_folder = std::make_unique<QTemporaryDir>();
}

void DoctorTest::figures()
{
    Bytes records = soundRecords(6);
    const std::uint16_t length = lasfiles::recordLength(6);
    for (std::size_t i = 0; i < 10; ++i) {
        records[i * length + 15] = std::byte(0b1111 | 1 << 4 | 1 << 6 | 1 << 7);  // all flags, channel 1
        records[i * length + 16] = std::byte(200);
        records[i * length + 14] = std::byte(5 | 3 << 4);
    }
    lasfiles::writeFile(path("a.las"), lasfiles::file(lasfiles::header(4, 6, length, kPoints), {}, records));
    const PointFigures f = examined(path("a.las")).figures;
    QCOMPARE(f.points, std::uint64_t(kPoints));
    QCOMPARE(f.classes[200], std::uint64_t(10));
    QCOMPARE(f.classes[2], std::uint64_t(kPoints - 10));
    QCOMPARE(f.returns[5], std::uint64_t(10));
    QCOMPARE(f.pulses[3], std::uint64_t(10));
    QCOMPARE(f.returnsAbove, std::uint64_t(10));
    for (const std::uint64_t flag :
         {f.synthetic, f.keyPoint, f.withheld, f.overlap, f.scanDirection, f.edgeOfFlightLine})
        QCOMPARE(flag, std::uint64_t(10));
    QCOMPARE(f.channels[1], std::uint64_t(10));
    QCOMPARE(f.gpsTime->first, 25873047.0);
    QCOMPARE(f.gpsTime->second, 25873047.0 + kPoints - 1);
    QVERIFY((f.bounds.min == glm::i64vec3(0, 0, 0)) && (f.bounds.max == glm::i64vec3(1900, 1400, 6)));
    // against LASzip, serially
    std::uint64_t last = 0;
    lasfiles::forEachByLaszip(path("a.las"), kPoints, [&](const laszip_point& p) {
        last += p.extended_return_number == p.extended_number_of_returns;
    });
    QCOMPARE(f.lastReturns, last);
    Progress cancelled;
    cancelled.cancel();
    QVERIFY_EXCEPTION_THROWN(computePointFigures(*makeFrame(1'000'000), nullptr, cancelled), Cancelled);
}

void DoctorTest::figuresOfNothing()
{
    Progress progress;
    const PointFigures none = computePointFigures(*makeFrame(0), nullptr, progress);
    QCOMPARE(none.points, std::uint64_t(0));
    QVERIFY(none.bounds.empty() && none.density == 0.0 && !none.gpsTime);
    const PointFigures one = computePointFigures(*makeFrame(1), nullptr, progress);  // no extent
    QVERIFY(one.points == 1 && one.density == 0.0 && one.strays == 0);
    PointSet all(100);
    all.insert(PointRange{0, 100});
    QCOMPARE(computePointFigures(*makeFrame(100), &all, progress).points, std::uint64_t(0));
}

void DoctorTest::densityOfAGrid()
{
    // 4 points on a square meter, on half of the box: the empty half does not count
    const auto cloud = makeFrame(200'000, {glm::dvec3(0.01), glm::dvec3(500000, 0, 0)});
    auto x = cloud->columns()[0]->values<std::int32_t>(), y = cloud->columns()[1]->values<std::int32_t>();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto column = std::int32_t(i % 1000), row = std::int32_t(i / 1000);
        x[i] = column * 50 + (column >= 500 ? 50'000 : 0);
        y[i] = row * 50;
    }
    Progress progress;
    const PointFigures f = computePointFigures(*cloud, nullptr, progress);
    QVERIFY2(std::abs(f.density - 4.0) < 0.3, qPrintable(QString::number(f.density)));
    QVERIFY(std::abs(f.spacing - 0.5) < 0.03);
    QVERIFY(std::abs(f.area - 50'000.0) < 3'000.0);
    QCOMPARE(f.strays, std::uint64_t(0));
}

void DoctorTest::strays()
{
    const auto cloud = makeFrame(10'000, {glm::dvec3(0.01), glm::dvec3(0)});
    auto x = cloud->columns()[0]->values<std::int32_t>(), y = cloud->columns()[1]->values<std::int32_t>();
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = std::int32_t(i % 100 * 100);
        y[i] = std::int32_t(i / 100 * 100);
    }
    x[17] = 2'000'000'000;
    y[4711] = -2'000'000'000;
    Progress progress;
    const PointFigures f = computePointFigures(*cloud, nullptr, progress);
    QCOMPARE(f.strays, std::uint64_t(2));
    QVERIFY(f.common.max.x < 300 && f.common.min.y > -300);
    QVERIFY2(std::abs(f.density - 1.0) < 0.12, qPrintable(QString::number(f.density)));
}

void DoctorTest::whatDeletesStraysLeavesTheOthers()
{
    // also where the scale is no decimal number, as one that passed through a float
    for (const double scale : {0.01, double(1e-7f), 1.0 / 3.0}) {
        Bytes records = soundRecords(0);
        lasfiles::set(records, 0, std::int32_t(2'000'000'000));
        Bytes head = lasfiles::header(2, 0, 20, kPoints);
        for (std::size_t k = 0; k < 3; ++k) lasfiles::set(head, 131 + 8 * k, scale);
        lasfiles::writeFile(path("strays.las"), lasfiles::file(head, {}, records));
        const auto cloud = lasfiles::load(path("strays.las"));
        Progress progress;
        std::string mend;
        for (const las::Finding& f : las::examine(*cloud, progress).diagnosis.findings)
            if (f.fault.find("lies farther") != std::string::npos) mend = f.mend;
        const std::size_t begin = mend.find("where=\"") + 7, end = mend.find('"', begin);
        QVERIFY2(end != std::string::npos, mend.c_str());
        const expression::Condition outside(mend.substr(begin, end - begin), *cloud);
        QCOMPARE(select(*cloud, outside, progress)->count(), PointIndex(1));
    }
}

void DoctorTest::linesOfPointsHaveNoDensity()
{
    const auto cloud = makeFrame(1000, {glm::dvec3(1e-300, 1.0, 1.0), glm::dvec3(0)});
    auto x = cloud->columns()[0]->values<std::int32_t>(), y = cloud->columns()[1]->values<std::int32_t>();
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[i] = std::int32_t(i);
    Progress progress;
    QCOMPARE(computePointFigures(*cloud, nullptr, progress).density, 0.0);
}

void DoctorTest::words()
{
    las::Header header{lasfiles::header(4, 7, 36, 0)};
    QVERIFY(las::guidText(header).empty());
    for (std::size_t k = 0; k < 16; ++k) header.bytes[8 + k] = std::byte(0x10 + k);
    QVERIFY(las::guidText(header) == "13121110-1514-1716-1819-1A1B1C1D1E1F");
    QVERIFY(las::creationText(header) == "2020-04-09");  // day 100 of a leap year
    header.set(las::at::kCreationDay, 0);
    QVERIFY(las::creationText(header).empty());
    QVERIFY(las::gpsDay(0.0) == "2011-09-14");
    QVERIFY(las::gpsDay(-1e9) == "1980-01-06");
    QVERIFY(las::gpsDay(std::nan("")).empty() && las::gpsDay(1e300).empty());
    header.set(las::at::kGlobalEncoding, 0x801F);
    std::string all;
    for (const std::string& word : las::encodingWords(header)) all += word + ";";
    QVERIFY2(all.find("GPS seconds - 1,000,000,000") != std::string::npos && all.find("WKT") != std::string::npos &&
                 all.find("return numbers are synthetic") != std::string::npos &&
                 all.find("0x8000") != std::string::npos,
             all.c_str());
    QVERIFY(las::recordWords(las::makeVlr("LASF_Projection", 34735, "", {})) == "GeoTIFF keys");
    QVERIFY(las::recordWords(las::makeVlr("me", 1, "tab\there", {})) == "tab?here");
    QVERIFY(las::recordWords(las::makeVlr("LASF_Spec", 101, "", {})) == "Description of wave packets");
    CoordinateUnits units;
    units.kind = CoordinateUnits::Kind::Geocentric;
    units.horizontal = "m";
    QVERIFY(las::unitsText(units) == "m, from the middle of the earth");
    header.setText(las::at::kSystemId, "scanner  ");
    QVERIFY(las::headerText(header, las::at::kSystemId) == "scanner");
    QVERIFY(las::gpsDay(header, 0.0) == "2011-09-14");
    header.set(las::at::kGlobalEncoding, 0);
    QVERIFY(las::encodingWords(header)[0] == "GPS times are seconds of the week");
    QVERIFY(las::gpsDay(header, 0.0).empty());
    header.bytes.resize(las::standardHeaderSize(5));
    header.set(las::at::kVersionMinor, 5);
    header.set(las::at::kGlobalEncoding, las::encoding::kAdjustedGpsTime | las::encoding::kTimeOffset);
    header.set(las::at::kTimeOffset, 1400);
    QVERIFY(las::gpsDay(header, 0.0) == "2024-05-17");
}

void DoctorTest::soundFilesHaveNoFaults_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<bool>("compressed");
    for (int format = 0; format <= 8; ++format) {
        if (format == 4 || format == 5) continue;  // wave packets without waveforms are a fault
        QTest::addRow("format %d", format) << format << false;
        QTest::addRow("format %d, LAZ", format) << format << true;
    }
}

void DoctorTest::soundFilesHaveNoFaults()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const auto f = std::uint8_t(format);
    const fs::path file = path(compressed ? "a.laz" : "a.las"), out = path(compressed ? "b.laz" : "b.las");
    lasfiles::writeFile(file, compressed ? soundLaz(f) : sound(f));
    std::string faults = told(examined(file).diagnosis.findings);
    if (compressed) {  // these have no record on the coordinate system
        const std::string expected = "The file does not say its coordinate system.\n";
        QVERIFY2(faults == expected, faults.c_str());
        faults.clear();
    }
    QVERIFY2(faults.empty(), faults.c_str());
    Progress progress;
    const las::RepairReport report = las::repair(file, out, progress);
    QVERIFY(!report.written && report.mended.empty());
    QVERIFY(!fs::exists(out));
}

void DoctorTest::faults_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<std::function<void(Bytes&)>>("damage");
    QTest::addColumn<QString>("fault");
    QTest::addColumn<bool>("repairable");
    using Damage = std::function<void(Bytes&)>;
    const auto row = [](const char* name, int format, const Damage& damage, const char* fault, bool repairable) {
        QTest::newRow(name) << format << damage << QString(fault) << repairable;
    };
    const auto put = [](std::size_t at, auto value) {
        return Damage([=](Bytes& b) { lasfiles::set(b, at, value); });
    };
    const auto point = [](std::size_t field, auto value) {
        return Damage([=](Bytes& b) { lasfiles::set(b, lasfiles::get<std::uint32_t>(b, 96) + field, value); });
    };
    row("count 0", 1, put(107, 0u), "The header says 0 points, the file holds 300.", true);
    row("count of half", 1, put(107, 150u), "The header says 150 points, the file holds 300.", true);
    row("count of 1.4", 7, put(247, std::uint64_t(150)), "The header says 150 points, the file holds 300.", true);
    row("legacy count", 7, put(107, 300u), "legacy count is 300, where it has to be 0", true);
    row(
        "returns all 0", 1,
        [](Bytes& b) {
            for (std::size_t k = 0; k < 5; ++k) lasfiles::set(b, 111 + 4 * k, 0u);
        },
        "points by return are all 0", true);
    row("returns of another edition", 7, put(255, std::uint64_t(17)), "points by return are not those", true);
    row("box", 3, put(179, 5.0), "box is not that of the points (X, off by up to 14)", true);
    row("box NaN", 3, put(187, std::nan("")), "box is not that of the points (X)", true);
    row("box of raw integers", 6, put(195, 140000.0), "box is not that of the points (Y", true);
    row("number of records", 3, put(100, 100000u), "The header announces 100,000 records (VLRs), and there is 1.",
        true);
    row("EVLRs lost", 6, put(235, std::uint64_t(0)), "extended records (EVLRs) begin at byte 0", true);
    row("EVLRs elsewhere", 6, put(235, std::uint64_t(400)), "extended records (EVLRs) begin at byte 400", true);
    row("more EVLRs than there are", 6, put(243, 3u), "announces 3 extended records (EVLRs), and 1 is found", true);
    row("WKT that is cut off", 6, put(375 + 54 + 200, std::uint8_t(0)), "states is not understood", false);
    row("WKT without its bit", 6, put(6, std::uint16_t(1)), "asks for a coordinate system in WKT", true);
    row("WKT bit of keys", 1, put(6, std::uint16_t(17)), "and the file has GeoTIFF keys.", true);
    row("times of a week that are not", 1, put(6, std::uint16_t(0)),
        "which are adjusted standard GPS times (2012-07-09", true);
    row("times that are not adjusted", 1, point(20, 1.4e9), "before there was GPS or in the future", false);
    row(
        "no creation day", 1,
        [](Bytes& b) {
            lasfiles::set(b, 90, std::uint16_t(0));
            lasfiles::set(b, 92, std::uint16_t(0));
        },
        "does not say when the file was made", false);
    row("creation year", 1, put(92, std::uint16_t(12345)), "day 100 of the year 12345", false);
    row("creation day", 1, put(90, std::uint16_t(400)), "day 400 of the year 2020", false);
    row("scale 0", 1, put(131, 0.0), "The scale or offset of X cannot be used", false);
    row("offset that is no number", 1, put(155, std::nan("")),
        "The scale or offset of X cannot be used (0.01, nan)", false);
    row("negative scale", 1, put(131, -0.01), "The scale of X is negative", false);
    row("return number 0", 1, point(14, std::uint8_t(0)), "1 point has return number 0", false);
    row("return above", 1, point(14, std::uint8_t(3 | 1 << 3)), "1 point has a return number above", false);
    row("class 12 of format 6", 6, point(16, std::uint8_t(12)), "1 point has class 12", false);
    row("class 50 of format 6", 6, point(16, std::uint8_t(50)), "classes that are reserved: 50", false);
    row("stray", 1, point(0, std::int32_t(2'000'000'000)), "1 point lies farther than 20 times", false);
    row("scan angle", 1, point(16, std::int8_t(-120)), "Scan angles go up to 120 degrees", false);
    row("8-bit colors", 7, point(30, std::uint16_t(200)), "they are of 8 bits", false);
    row("format 3 in 1.1", 3, put(25, std::uint8_t(1)), "Point format 3 does not exist in LAS 1.1", false);
    row(
        "no coordinate system", 1,
        [](Bytes& b) {
            b = lasfiles::file(
                [&] {
                    Bytes head(b.begin(), b.begin() + 227);
                    return head;
                }(),
                {}, soundRecords(1));
        },
        "does not say its coordinate system", false);
    // sound files of other kinds, with one fault each
    const auto instead = [](Bytes head, const std::vector<Bytes>& vlrs, const Bytes& evlr = {}) {
        return Damage([=](Bytes& b) mutable {
            const auto format = std::to_integer<std::uint8_t>(head[104]);
            const std::uint16_t encoding = lasfiles::get<std::uint16_t>(head, 6);
            makeSound(head, format);
            lasfiles::set(head, 6, encoding);
            b = lasfiles::file(head, vlrs, withExtra(soundRecords(format), format, head));
            if (evlr.empty()) return;
            if (head.size() >= 375) {
                lasfiles::set(b, 235, std::uint64_t(b.size()));
                lasfiles::set(b, 243, std::uint32_t(1));
            }
            lasfiles::append(b, evlr);
        });
    };
    const auto headOf = [](std::uint8_t minor, std::uint8_t format, std::uint16_t encoding,
                           std::uint16_t extra = 0) {
        Bytes head =
            lasfiles::header(minor, format, std::uint16_t(lasfiles::recordLength(format) + extra), kPoints);
        lasfiles::set(head, 6, encoding);
        return head;
    };
    const Bytes waveforms = lasfiles::record("LASF_Spec", 65535, Bytes(50), true);
    row(
        "EVLRs cut off", 6, [](Bytes& b) { b.resize(b.size() - 66); },
        "announces 1 extended records (EVLRs), and 0 are found.", false);
    row("two of a kind", 1, instead(headOf(2, 1, 1), {keysRecord(), keysRecord()}),
        "more than one record LASF_Projection/34735", false);
    row("keys for format 6", 6, instead(headOf(4, 6, 1), {keysRecord()}),
        "asks for a coordinate system in WKT, and the file has GeoTIFF keys alone", false);
    row("keys for WKT", 6, instead(headOf(4, 6, 17), {keysRecord()}),
        "given in WKT, and the file has GeoTIFF keys alone", false);
    row("WKT without a word", 1, instead(headOf(4, 1, 1), {lasfiles::wktRecord(kWkt)}),
        "in WKT, but the header does not say so", true);
    row("waveforms inside and beside", 1, put(6, std::uint16_t(7)), "in this file and in one beside it", false);
    row("waveforms without their bit", 9, instead(headOf(4, 9, 17), {lasfiles::wktRecord(kWkt)}, waveforms),
        "The waveforms are in this file, but the header does not say so.", true);
    row("waveforms elsewhere", 9, instead(headOf(4, 9, 19), {lasfiles::wktRecord(kWkt)}, waveforms),
        "position of the waveforms is not where they are", true);
    row(
        "waveforms of 1.3 elsewhere", 4,
        [=](Bytes& b) {
            instead(headOf(3, 4, 3), {keysRecord()}, waveforms)(b);
            lasfiles::set(b, 227, std::uint64_t(b.size() - 10));
        },
        "position of the waveforms is not where they are", true);
    row(
        "times of one week", 1,
        [](Bytes& b) {
            for (std::size_t i = 0; i < kPoints; ++i)
                lasfiles::set(b, lasfiles::get<std::uint32_t>(b, 96) + 28 * i + 20, 1000.0 + double(i));
        },
        "all of them lie in the week from 2011-09-14 on (1000 to 1299)", false);
    Bytes shortHead = headOf(4, 1, 1);
    shortHead.resize(227);
    lasfiles::set(shortHead, 94, std::uint16_t(227));
    row("short header", 1, instead(shortHead, {keysRecord()}), "should have 375 bytes, but has 227", false);
    row("coarse degrees", 1, instead(headOf(2, 1, 1), {keysRecord(2, 2048, 4326)}),
        "A step of X is 0.01 degrees, some 1113 m.", false);
    row(
        "no points", 1,
        [](Bytes& b) {
            b.resize(lasfiles::get<std::uint32_t>(b, 96));
            lasfiles::set(b, 107, 0u);
        },
        "The file has no points.", false);
    row("no returns", 1, point(14, std::uint8_t(1)), "1 point has 0 returns of their pulse", false);
    const auto described = [](std::initializer_list<std::pair<unsigned, const char*>> fields) {
        Bytes data;
        for (const auto& [type, name] : fields) {
            Bytes descriptor(192);
            descriptor[2] = std::byte(type);
            std::memcpy(descriptor.data() + 4, name, std::strlen(name));
            lasfiles::append(data, descriptor);
        }
        return lasfiles::record("LASF_Spec", 4, data);
    };
    const auto extra = [&](const Bytes& record) { return instead(headOf(2, 1, 1, 2), {keysRecord(), record}); };
    row("reserved type", 1, extra(described({{99, "odd"}})), "has the reserved type 99", false);
    row("without a name", 1, extra(described({{3, ""}})), "a description without a name", false);
    row("one name twice", 1, extra(described({{1, "a"}, {1, "a"}})), "have the name \"a\"", false);
    row("not described", 1, extra(described({{1, "a"}})), "1 bytes of each point are not described", false);
    row(
        "cut", 3, [](Bytes& b) { b.resize(b.size() - 34 * 10 - 7); },
        "The header says 300 points, the file holds 289.", true);
}

void DoctorTest::faults()
{
    QFETCH(int, format);
    QFETCH(std::function<void(Bytes&)>, damage);
    QFETCH(QString, fault);
    QFETCH(bool, repairable);
    const Bytes whole = sound(std::uint8_t(format));
    Bytes damaged = whole;
    damage(damaged);
    const fs::path file = path("a.las"), out = path("b.las");
    lasfiles::writeFile(file, damaged);
    const auto findings = examined(file).diagnosis.findings;
    const std::string all = told(findings, repairable);
    QVERIFY2(all.find(fault.toStdString()) != std::string::npos, told(findings).c_str());

    Progress progress;
    const las::RepairReport report = las::repair(file, out, progress);
    QCOMPARE(told(report.mended), told(findings, true));
    QCOMPARE(told(report.left), told(findings, false));
    QCOMPARE(report.written, !report.mended.empty());
    QCOMPARE(fs::exists(out), report.written);
    QVERIFY(lasfiles::readFile(file) == damaged);
    if (!report.written) return;
    // nothing but the header differs, and what was mended is as in the sound file
    const Bytes mended = lasfiles::readFile(out);
    const std::size_t header = lasfiles::get<std::uint16_t>(damaged, 94);
    QVERIFY(std::equal(mended.begin() + std::ptrdiff_t(header), mended.end(),
                       damaged.begin() + std::ptrdiff_t(header), damaged.end()));
    const auto again = examined(out).diagnosis.findings;
    QVERIFY2(told(again, true).empty(), told(again).c_str());
    if (damaged.size() == whole.size() && told(report.left).empty()) QVERIFY(mended == whole);
    // LASzip's own API reads it to its end
    const auto points = std::size_t(report.points);
    const Bytes records =
        lasfiles::recordsByLaszip(out, std::uint8_t(format), lasfiles::recordLength(std::uint8_t(format)), points);
    const std::size_t at = lasfiles::get<std::uint32_t>(damaged, 96);
    QVERIFY(std::equal(records.begin(), records.end(), damaged.begin() + std::ptrdiff_t(at)));
}

void DoctorTest::whatWasSavedIsLookedAt()
{
    // the faults of the file that was opened are none of the one that was saved, with points left out
    Bytes damaged = sound(1);
    lasfiles::set(damaged, 107, 0u);
    lasfiles::writeFile(path("a.las"), damaged);
    Progress progress;
    const auto cloud = las::load(path("a.las"), progress);
    QVERIFY(!told(las::examine(*cloud, progress).diagnosis.findings).empty());
    auto deleted = std::make_shared<PointSet>(kPoints);
    deleted->insert(PointRange{0, 20});
    cloud->setDeleted(deleted);
    las::write(*cloud, path("b.las"), {}, progress);
    const las::Examination saved = las::examine(*cloud, progress);
    QCOMPARE(saved.figures.points, std::uint64_t(kPoints - 20));
    QVERIFY2(told(saved.diagnosis.findings).empty(), told(saved.diagnosis.findings).c_str());
    lasfiles::writeFile(path("b.las"), damaged);
    QVERIFY_EXCEPTION_THROWN(las::examine(*cloud, progress), Error);
}

void DoctorTest::damagedChunksAreTold()
{
    Bytes damaged = soundLaz(7);
    const std::size_t begin = lasfiles::get<std::uint32_t>(damaged, 96) + 8;
    std::fill_n(damaged.begin() + std::ptrdiff_t(begin) + 36, 40, std::byte(0xFF));
    lasfiles::set(damaged, 90, std::uint16_t(400));  // a day that is none: nothing to repair
    lasfiles::writeFile(path("a.laz"), damaged);
    Progress progress;
    const auto cloud = las::load(path("a.laz"), progress);
    const las::Diagnosis diagnosis = las::examine(*cloud, progress).diagnosis;
    const std::string all = told(diagnosis.findings);
    QVERIFY2(all.find("100 points cannot be read, since their chunks are damaged.") != std::string::npos,
             all.c_str());
    QVERIFY2(!diagnosis.repairable(), all.c_str());
    lasfiles::set(damaged, 100, 100u);  // records that are not there
    lasfiles::writeFile(path("a.laz"), damaged);
    QVERIFY(examined(path("a.laz")).diagnosis.repairable());
}

void DoctorTest::repairIsCancelledWhole()
{
    Bytes damaged = sound(6);
    lasfiles::set(damaged, 247, std::uint64_t(1));
    lasfiles::writeFile(path("a.las"), damaged);
    Progress progress;
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(las::repair(path("a.las"), path("b.las"), progress), Cancelled);
    QCOMPARE(std::distance(fs::directory_iterator(path("")), fs::directory_iterator()), std::ptrdiff_t(1));
}

void DoctorTest::repairKeepsTheOriginal()
{
    Bytes damaged = sound(6);
    lasfiles::set(damaged, 247, std::uint64_t(1));
    lasfiles::writeFile(path("a.las"), damaged);
    Progress progress;
    QVERIFY_EXCEPTION_THROWN(las::repair(path("a.las"), path("a.las"), progress), Error);
    QVERIFY_EXCEPTION_THROWN(las::repair(path("a.las"), path("b.laz"), progress), Error);
    QVERIFY(lasfiles::readFile(path("a.las")) == damaged);
    QVERIFY(!fs::exists(path("b.laz")));
}

void DoctorTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    for (const char* const folder : {"", "cases", "more"})
        for (const fs::path& file : lasfiles::sharedFiles(fs::path(PUNCTUM_TEST_DATA) / folder))
            QTest::newRow(file.filename().c_str()) << QString::fromStdString(file.string());
    if (lasfiles::sharedFiles(PUNCTUM_TEST_DATA).empty()) QTest::newRow("real files") << QString();
}

void DoctorTest::realFiles()
{
    QFETCH(QString, file);
    if (file.isEmpty()) QSKIP("There is no folder of real files here.");
    const fs::path in = file.toStdString(), out = path(in.filename().string());
    Progress progress;
    const las::RepairReport report = las::repair(in, out, progress);
    for (const las::Finding& finding : report.left)
        QVERIFY2(finding.fault.ends_with('.') && finding.mend.ends_with('.'), finding.fault.c_str());
    if (!report.written) return;
    const Bytes before = lasfiles::readFile(in), after = lasfiles::readFile(out);
    const std::size_t header = lasfiles::get<std::uint16_t>(before, 94);
    QVERIFY(std::equal(after.begin() + std::ptrdiff_t(header), after.end(), before.begin() + std::ptrdiff_t(header),
                       before.end()));
    QVERIFY(told(examined(out).diagnosis.findings, true).empty());
    std::size_t points = 0;
    lasfiles::forEachByLaszip(out, std::size_t(report.points), [&](const laszip_point&) { ++points; });
    QCOMPARE(points, std::size_t(report.points));
}

QTEST_APPLESS_MAIN(DoctorTest)
#include "DoctorTest.moc"
