// SPDX-License-Identifier: MIT
#include "core/edit/DeleteCommand.h"
#include "core/las/GeoKeys.h"
#include "core/las/GpsTime.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

#include <cmath>
#include <filesystem>
#include <optional>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kCount = 600;
constexpr std::size_t kTimeAt = 22;  ///< of formats 6-10

const std::string kUtm =
    R"(PROJCS["NAD83 / UTM zone 10N",GEOGCS["NAD83",DATUM["North_American_Datum_1983",)"
    R"(SPHEROID["GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"]],AUTHORITY["EPSG","6269"]],)"
    R"(PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],)"
    R"(AUTHORITY["EPSG","4269"]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
    R"(PARAMETER["central_meridian",-123],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],)"
    R"(PARAMETER["false_northing",0],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],)"
    R"(AXIS["Northing",NORTH],AUTHORITY["EPSG","26910"]])";

/// Records of formats 6-10 that every version and format holds: few returns, low classes, whole degrees, no times.
Bytes plainRecords(std::uint8_t format, std::size_t count = kCount)
{
    const std::size_t length = lasfiles::recordLength(format);
    Bytes records(count * length);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i * length;
        for (std::size_t a = 0; a < 3; ++a) lasfiles::set(records, at + 4 * a, std::int32_t(i * (a + 3) % 977));
        lasfiles::set(records, at + 12, std::uint16_t(i));
        records[at + 14] = std::byte((1 + i % 3) | 3 << 4);
        records[at + 16] = std::byte(i % 11);
        lasfiles::set(records, at + 18, std::int16_t(std::lround((int(i % 41) - 20) / 0.006)));
        lasfiles::set(records, at + 20, std::uint16_t(7));
    }
    return records;
}

struct Made {
    std::uint8_t minor = 4, format = 6;
    std::uint16_t encoding = 17;
    Bytes records = plainRecords(6);
    std::vector<Bytes> vlrs{lasfiles::wktRecord(kUtm)};
    std::uint16_t timeOffset = 0;
    Bytes userBytes, evlrs;
    std::uint32_t evlrCount = 0;
};

}  // namespace

class LasVersionsTest : public QObject
{
    Q_OBJECT

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }

    std::shared_ptr<PointCloud> make(const Made& made, const std::string& name = "in.las") const
    {
        const std::uint16_t length = lasfiles::recordLength(made.format);
        const std::size_t count = made.records.size() / length;
        Bytes head = lasfiles::header(made.minor, made.format, length, count);
        lasfiles::set(head, 6, made.encoding);
        if (made.minor == 5) {
            GpsRange range;
            for (std::size_t i = 0; i < count; ++i)
                range.include(lasfiles::get<double>(made.records, i * length + kTimeAt));
            lasfiles::set(head, 375, range.max);
            lasfiles::set(head, 383, range.min);
            lasfiles::set(head, 391, made.timeOffset);
        }
        lasfiles::append(head, made.userBytes);
        lasfiles::set(head, 94, std::uint16_t(head.size()));
        if (made.evlrCount != 0) {
            std::uint64_t at = head.size() + made.records.size();
            for (const Bytes& v : made.vlrs) at += v.size();
            lasfiles::set(head, 235, at);
            lasfiles::set(head, 243, made.evlrCount);
        }
        lasfiles::writeFile(temp(name), lasfiles::file(head, made.vlrs, made.records, made.evlrs));
        return load(temp(name));
    }

    using GpsRange = las::GpsRange;

    static las::WriteReport write(const PointCloud& cloud, const fs::path& path, std::optional<std::uint8_t> minor,
                                  std::optional<std::uint8_t> format = {}, bool lossy = false)
    {
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(path);
        options.versionMinor = minor;
        options.pointFormat = format;
        options.lossy = lossy;
        return las::write(cloud, path, options, progress);
    }

    /// The question that is asked instead of writing; nothing is written.
    static std::string asked(const PointCloud& cloud, const fs::path& path, std::optional<std::uint8_t> minor,
                             std::optional<std::uint8_t> format = {})
    {
        try {
            write(cloud, path, minor, format);
        } catch (const las::WriteQuestion& question) {
            if (fs::exists(path) || question.kind() != las::WriteQuestion::Kind::Lossy) return "wrong";
            return question.what();
        }
        return "nothing asked";
    }

    static bool noted(const las::WriteReport& report, const std::string& part)
    {
        return std::any_of(report.notes.begin(), report.notes.end(),
                           [&](const std::string& n) { return n.find(part) != std::string::npos; });
    }

    /// The records of an uncompressed file.
    static Bytes recordsOf(const Bytes& file)
    {
        const auto at = lasfiles::get<std::uint32_t>(file, 96);
        const auto bytes = std::size_t(lasfiles::get<std::uint16_t>(file, 105)) *
                           (file[25] >= std::byte(4) ? lasfiles::get<std::uint64_t>(file, 247)
                                                     : lasfiles::get<std::uint32_t>(file, 107));
        return {file.begin() + at, file.begin() + std::ptrdiff_t(at + bytes)};
    }

    static void setTime(Made& made, std::size_t i, double time)
    {
        lasfiles::set(made.records, i * lasfiles::recordLength(made.format) + kTimeAt, time);
    }

    QTemporaryDir m_dir;

private slots:
    void newestIsKeptAsItIs();
    void newestFrom14();
    void newestFromOldFormats();
    void newestRefusesOldFormats();
    void timesStayTrueAfterEdits();
    void offsetTimesGoDown();
    void lossyIsAskedFor();
    void lossyValues();
    void lossyRecords();
    void waveformsAmongOtherRecords();
    void versionDecidesTheFormat();
    void wktBecomesKeys();
    void realFiles_data();
    void realFiles();
};

void LasVersionsTest::newestIsKeptAsItIs()
{
    Made made;
    made.minor = 5;
    made.encoding = 1 | 16 | 64;
    made.timeOffset = 1355;
    for (std::size_t i = 5; i < kCount; ++i) setTime(made, i, 1000.0 + double(i * 37 % kCount));
    const auto cloud = make(made);
    QVERIFY(cloud->source()->warnings.empty());
    QCOMPARE(las::gpsClockText(cloud->source()->header), std::string("GPS seconds - 1,355,000,000 (offset 1355)"));
    write(*cloud, temp("out.las"), {});
    QVERIFY(lasfiles::readFile(temp("out.las")) == lasfiles::readFile(temp("in.las")));
    write(*cloud, temp("out.laz"), {});
    write(*load(temp("out.laz")), temp("back.las"), {});
    QVERIFY(lasfiles::readFile(temp("back.las")) == lasfiles::readFile(temp("in.las")));
    write(*cloud, temp("out.las"), std::uint8_t(5), std::uint8_t(6));  // asked for what it is
    QVERIFY(lasfiles::readFile(temp("out.las")) == lasfiles::readFile(temp("in.las")));
    made.encoding = 16 | 64;  // an offset of times that are said to have none
    const auto contradicts = make(made)->source();
    QVERIFY(contradicts->warnings.size() == 1 && contradicts->warnings[0].find("denies it") != std::string::npos);
}

void LasVersionsTest::newestFrom14()
{
    Made made;
    made.encoding = 1;  // GeoTIFF keys, as LAS 1.4 does not allow here, and a reserved bit
    made.encoding |= 64;
    Bytes keys(32);
    for (std::size_t k = 0; const int word : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 26910, 3076, 0, 1, 9001})
        lasfiles::set(keys, 2 * k++, std::uint16_t(word));
    made.vlrs = {lasfiles::record("other", 3, Bytes(5)), lasfiles::record("LASF_Projection", 34735, keys)};
    made.userBytes = Bytes(9, std::byte(0xAB));
    setTime(made, 3, -8.5);
    setTime(made, 9, 77.25);
    const auto report = write(*make(made), temp("out.las"), std::uint8_t(5));
    QVERIFY(noted(report, "kept before the points") && noted(report, "translated from GeoTIFF keys to WKT"));
    const Bytes file = lasfiles::readFile(temp("out.las"));
    QCOMPARE(int(file[25]), 5);
    QCOMPARE(int(lasfiles::get<std::uint16_t>(file, 94)), 393);
    QCOMPARE(int(lasfiles::get<std::uint16_t>(file, 6)), 1 | 16);
    QCOMPARE(lasfiles::get<double>(file, 375), 77.25);
    QCOMPARE(lasfiles::get<double>(file, 383), -8.5);
    QCOMPARE(int(lasfiles::get<std::uint16_t>(file, 391)), 0);
    QCOMPARE(lasfiles::get<std::uint64_t>(file, 247), std::uint64_t(kCount));
    QCOMPARE(lasfiles::get<std::uint32_t>(file, 107), 0u);
    QVERIFY(recordsOf(file) == made.records);
    const auto back = load(temp("out.las"))->source();
    QVERIFY(back->warnings.empty());
    QVERIFY(back->gapBeforePoints == made.userBytes);
    QCOMPARE(back->vlrs.size(), std::size_t(2));
    QVERIFY(back->vlrs[1].is("LASF_Projection", 2112));
    // and back again: what 1.5 adds goes
    write(*load(temp("out.las")), temp("back.las"), std::uint8_t(4));
    const Bytes old = lasfiles::readFile(temp("back.las"));
    QCOMPARE(int(lasfiles::get<std::uint16_t>(old, 94)), 375);
    QVERIFY(recordsOf(old) == made.records);

    made.vlrs.push_back(lasfiles::wktRecord(kUtm));  // both: the keys go
    QVERIFY(noted(write(*make(made), temp("both.las"), std::uint8_t(5)), "The GeoTIFF keys are left out"));
    QVERIFY(load(temp("both.las"))->source()->findVlr("LASF_Projection", 34735) == nullptr);

    Made wide;  // bytes of its own that leave no room for a longer header
    wide.minor = 2;
    wide.format = 1;
    wide.records = Bytes(28 * 5);
    wide.userBytes = Bytes(65200);
    const auto refused = make(wide);
    QVERIFY_EXCEPTION_THROWN(write(*refused, temp("wide.las"), std::uint8_t(4)), Error);

    Made bare;  // no system, no times
    bare.vlrs.clear();
    const auto told = write(*make(bare), temp("bare.las"), std::uint8_t(5));
    QVERIFY(noted(told, "asks for a coordinate system"));
    const Bytes zeros = lasfiles::readFile(temp("bare.las"));
    QCOMPARE(int(lasfiles::get<std::uint16_t>(zeros, 6)) & 16, 16);
    QVERIFY(lasfiles::get<double>(zeros, 375) == 0.0 && lasfiles::get<double>(zeros, 383) == 0.0);
}

void LasVersionsTest::newestFromOldFormats()
{
    constexpr int kBecomes[] = {6, 6, 7, 7, 9, 10};
    for (std::uint8_t format = 0; format < 6; ++format) {
        const std::uint16_t length = lasfiles::recordLength(format);
        const Bytes records = lasfiles::randomRecords(format, length, kCount, format, true);
        lasfiles::writeFile(
            temp("old.las"),
            lasfiles::file(lasfiles::header(lasfiles::minorFor(format), format, length, kCount), {}, records));
        const auto report = write(*load(temp("old.las")), temp("new.las"), std::uint8_t(5));
        QVERIFY(noted(report, "has no point format " + std::to_string(format)));
        const auto source = load(temp("new.las"))->source();
        QCOMPARE(int(source->layout.format), kBecomes[format]);
        QCOMPARE(int(source->header.versionMinor()), 5);
        QVERIFY(source->warnings.empty());
        // nothing was lost on the way: what came back is what went
        write(*load(temp("new.las")), temp("again.las"), std::uint8_t(lasfiles::minorFor(format)), format);
        QVERIFY2(recordsOf(lasfiles::readFile(temp("again.las"))) == records, std::to_string(format).c_str());
    }
}

void LasVersionsTest::newestRefusesOldFormats()
{
    const auto cloud = make({});
    for (const std::uint8_t format : {0, 1, 2, 3, 4, 5}) {
        try {
            write(*cloud, temp("no.las"), std::uint8_t(5), format);
            QFAIL("written");
        } catch (const Error& e) {
            QVERIFY2(std::string(e.what()).find("only 6 to 10") != std::string::npos, e.what());
        }
    }
    Made made;
    made.minor = 5;
    made.encoding = 16;
    const auto report = write(*make(made), temp("down.las"), {}, std::uint8_t(1));  // the version follows
    QVERIFY(noted(report, "the last version that has point format 1"));
    QCOMPARE(int(lasfiles::readFile(temp("down.las"))[25]), 4);
    // such a file is read all the same, and kept
    Bytes odd = lasfiles::readFile(temp("in.las"));
    Bytes head = lasfiles::header(5, 3, 34, 10);
    lasfiles::writeFile(temp("odd.las"), lasfiles::file(head, {}, Bytes(340)));
    const auto read = load(temp("odd.las"));
    QVERIFY(read->source()->warnings[0].find("LAS 1.5 has no point format 3") != std::string::npos);
    write(*read, temp("kept.las"), {});
    QVERIFY(lasfiles::readFile(temp("kept.las")) == lasfiles::readFile(temp("odd.las")));
}

void LasVersionsTest::timesStayTrueAfterEdits()
{
    Made made;
    made.minor = 5;
    for (std::size_t i = 10; i < kCount; ++i) setTime(made, i, double(i));
    const auto cloud = make(made);
    auto gone = std::make_shared<PointSet>(kCount);
    for (PointIndex i = 0; i < 50; ++i) gone->insert(i);
    gone->insert(kCount - 1);
    cloud->setDeleted(gone);
    write(*cloud, temp("less.las"), {});
    const Bytes less = lasfiles::readFile(temp("less.las"));
    QCOMPARE(lasfiles::get<double>(less, 375), double(kCount - 2));
    QCOMPARE(lasfiles::get<double>(less, 383), 50.0);
    // a value that an edit changed
    cloud->setDeleted(nullptr);
    for (const auto& column : cloud->columns())
        if (column->name() == "GpsTime") column->values<double>()[0] = 1e6;
    write(*cloud, temp("changed.laz"), {});
    const auto header = load(temp("changed.laz"))->source()->header;
    QCOMPARE(header.get(las::at::kMaxGpsTime), 1e6);
    QCOMPARE(header.get(las::at::kMinGpsTime), 10.0);
}

void LasVersionsTest::offsetTimesGoDown()
{
    Made made;
    made.minor = 5;
    made.encoding = 1 | 16 | 64;
    made.timeOffset = 1000;  // what LAS 1.4 means
    for (std::size_t i = 1; i < kCount; ++i) setTime(made, i, 4e8 + double(i) / 64);
    auto report = write(*make(made), temp("same.las"), std::uint8_t(4));
    QVERIFY(recordsOf(lasfiles::readFile(temp("same.las"))) == made.records);
    QCOMPARE(int(lasfiles::get<std::uint16_t>(lasfiles::readFile(temp("same.las")), 6)), 1 | 16);

    made.timeOffset = 1355;  // exact in another origin: 1/64 s
    report = write(*make(made), temp("exact.las"), std::uint8_t(4));
    QVERIFY(noted(report, "GPS times are counted as LAS 1.4 does") && report.losses.empty());
    const Bytes exact = recordsOf(lasfiles::readFile(temp("exact.las")));
    QCOMPARE(lasfiles::get<double>(exact, kTimeAt), 0.0);  // none stays none
    QCOMPARE(lasfiles::get<double>(exact, 30 * 7 + kTimeAt), 4e8 + 355e6 + 7.0 / 64);

    setTime(made, 2, 1.0 + 1e-13);  // too fine
    const auto cloud = make(made);
    QVERIFY(asked(*cloud, temp("fine.las"), std::uint8_t(4)).find("1 point has a GPS time that is rounded") !=
            std::string::npos);
    report = write(*cloud, temp("fine.las"), std::uint8_t(4), {}, true);
    QCOMPARE(report.losses.size(), std::size_t(1));
    QCOMPARE(report.losses[0].points, std::uint64_t(1));
    QCOMPARE(lasfiles::get<double>(recordsOf(lasfiles::readFile(temp("fine.las"))), 30 * 2 + kTimeAt), 355e6 + 1.0);
}

void LasVersionsTest::lossyIsAskedFor()
{
    Made made;
    made.records[16] = std::byte(64);
    const std::string sentence = asked(*make(made), temp("no.las"), std::uint8_t(2), std::uint8_t(1));
    QVERIFY2(
        sentence.find("Point format 1 of LAS 1.2 cannot hold all that is there: 1 point has a class above 31.") !=
            std::string::npos,
        sentence.c_str());
}

void LasVersionsTest::lossyValues()
{
    Made made;
    made.format = 8;
    made.records = plainRecords(8);
    const std::size_t length = lasfiles::recordLength(8);
    const auto byteOf = [&](std::size_t i, std::size_t at) -> std::byte& { return made.records[i * length + at]; };
    const struct {
        unsigned number, of, numberThen, ofThen;
    } returns[] = {{1, 9, 1, 7}, {6, 9, 6, 7},   {7, 9, 6, 7}, {8, 9, 6, 7},
                   {9, 9, 7, 7}, {15, 15, 7, 7}, {9, 5, 7, 5}};
    for (std::size_t i = 0; i < std::size(returns); ++i)
        byteOf(i, 14) = std::byte(returns[i].number | returns[i].of << 4);
    byteOf(20, 16) = std::byte(32);
    byteOf(21, 16) = std::byte(255);
    byteOf(22, 15) = std::byte(8);                                       // overlap
    byteOf(23, 15) = std::byte(2 << 4 | 0xC0 | 1);                       // channel 2; direction, edge, synthetic
    lasfiles::set(made.records, 24 * length + 18, std::int16_t(1000));   // 6 degrees
    lasfiles::set(made.records, 25 * length + 18, std::int16_t(-1084));  // -6.504
    lasfiles::set(made.records, 26 * length + 18, std::int16_t(30000));  // 180
    lasfiles::set(made.records, 27 * length + 30, std::uint16_t(500));   // red
    lasfiles::set(made.records, 28 * length + 36, std::uint16_t(600));   // near infrared
    setTime(made, 29, 12.5);
    const auto cloud = make(made);
    for (const char* part :
         {"2 points have a class above 31", "7 points have more than 7 returns", "1 point has the overlap flag",
          "1 point has a scanner channel", "points have a scan angle", "1 point has near infrared"})
        QVERIFY2(
            asked(*cloud, temp("values.las"), std::uint8_t(2), std::uint8_t(3)).find(part) != std::string::npos,
            part);
    for (const char* name : {"values.las", "values.laz"}) {
        const auto report = write(*cloud, temp(name), std::uint8_t(2), std::uint8_t(3), true);
        QCOMPARE(report.losses.size(), std::size_t(6));
        QVERIFY(noted(report, "2 points have a class above 31, which becomes class 1 (unclassified)."));
        write(*load(temp(name)), temp("plain.las"), {});
        const Bytes r = recordsOf(lasfiles::readFile(temp("plain.las")));
        QCOMPARE(r.size(), kCount * 34);
        const auto got = [&](std::size_t i, std::size_t at) { return std::to_integer<unsigned>(r[i * 34 + at]); };
        for (std::size_t i = 0; i < std::size(returns); ++i)
            QCOMPARE(got(i, 14), returns[i].numberThen | returns[i].ofThen << 3);
        QCOMPARE(got(20, 15), 1u);
        QCOMPARE(got(21, 15), 1u);
        QCOMPARE(got(22, 15), 22u % 11);  // its class stays
        QCOMPARE(got(23, 15), (23u % 11) | 1u << 5);
        QCOMPARE(got(23, 14) & 0xC0, 0xC0u);
        QCOMPARE(lasfiles::get<std::int8_t>(r, 24 * 34 + 16), std::int8_t(6));
        QCOMPARE(lasfiles::get<std::int8_t>(r, 25 * 34 + 16), std::int8_t(-7));
        QCOMPARE(lasfiles::get<std::int8_t>(r, 26 * 34 + 16), std::int8_t(127));
        QCOMPARE(int(lasfiles::get<std::uint16_t>(r, 27 * 34 + 28)), 500);
        QCOMPARE(lasfiles::get<double>(r, 29 * 34 + 20), 12.5);
        for (std::size_t i = 0; i < kCount; ++i)  // what fits is what it was
            QVERIFY(std::memcmp(&r[i * 34], &made.records[i * length], 14) == 0);
        const auto source = load(temp(name))->source();
        QVERIFY(source->warnings.empty());
        QCOMPARE(source->header.get(las::at::kLegacyCount), std::uint32_t(kCount));
    }
    // without times and colors: told, too
    const auto bare = write(*cloud, temp("bare.las"), {}, std::uint8_t(0), true);
    QVERIFY(noted(bare, "1 point has a GPS time, which is left out.") && noted(bare, "1 point has colors"));
}

void LasVersionsTest::lossyRecords()
{
    Made made;
    made.evlrs = lasfiles::record("big", 1, Bytes(70000, std::byte(7)), true);
    lasfiles::append(made.evlrs, lasfiles::record("small", 2, Bytes(10), true));
    made.evlrCount = 2;
    const auto cloud = make(made);
    const std::string sentence = asked(*cloud, temp("r.las"), std::uint8_t(2));
    QVERIFY2(sentence.find("the extended record big/1 of 70,000 bytes") != std::string::npos, sentence.c_str());
    const auto report = write(*cloud, temp("r.las"), std::uint8_t(2), {}, true);
    QVERIFY(noted(report, "The extended record big/1 of 70,000 bytes is left out."));
    const auto source = load(temp("r.las"))->source();
    QVERIFY(source->findVlr("big", 1) == nullptr && source->findVlr("small", 2) != nullptr);
    QCOMPARE(int(source->layout.format), 1);
}

void LasVersionsTest::waveformsAmongOtherRecords()
{
    // LAS 1.3 keeps the record of waveforms as the only extended one
    Made made;
    made.format = 9;
    made.encoding = 17 | las::encoding::kInternalWaveform;
    made.records = plainRecords(9);
    made.evlrs = lasfiles::record("small", 2, Bytes(10), true);
    const std::size_t before = made.evlrs.size();
    lasfiles::append(made.evlrs, lasfiles::record("LASF_Spec", 65535, Bytes(50, std::byte(9)), true));
    made.evlrCount = 2;
    make(made);
    Bytes bytes = lasfiles::readFile(temp("in.las"));
    lasfiles::set(bytes, 227, lasfiles::get<std::uint64_t>(bytes, 235) + before);
    lasfiles::writeFile(temp("in.las"), bytes);
    const auto cloud = load(temp("in.las"));
    QVERIFY(cloud->source()->waveformEvlr == std::size_t(1));
    write(*cloud, temp("three.las"), std::uint8_t(3));
    const auto three = load(temp("three.las"))->source();
    QVERIFY(three->warnings.empty() && three->waveformEvlr == std::size_t(0));
    QVERIFY(three->evlrs.at(0).data == Bytes(50, std::byte(9)) && three->findVlr("small", 2) != nullptr);
    QCOMPARE(int(three->layout.format), 4);

    // an index before it goes when the points are compressed
    bytes = lasfiles::readFile(temp("in.las"));
    const std::size_t at = std::size_t(lasfiles::get<std::uint64_t>(bytes, 235));
    std::memcpy(bytes.data() + at + 2, "LAStools\0", 9);
    lasfiles::set(bytes, at + 18, std::uint16_t(30));
    lasfiles::writeFile(temp("in.las"), bytes);
    write(*load(temp("in.las")), temp("moved.laz"), {});
    const auto moved = load(temp("moved.laz"))->source();
    QVERIFY(moved->evlrs.size() == 1 && moved->waveformEvlr == std::size_t(0));
}

void LasVersionsTest::versionDecidesTheFormat()
{
    const struct {
        std::uint8_t format, minor, becomes;
    } rows[] = {{6, 2, 1}, {7, 2, 3},  {8, 3, 3}, {9, 3, 4}, {10, 3, 5},
                {9, 2, 1}, {10, 2, 3}, {7, 5, 7}, {6, 4, 6}};
    for (const auto& row : rows) {
        Made made;
        made.format = row.format;
        made.records = plainRecords(row.format);
        if (row.format > 8) made.encoding |= las::encoding::kExternalWaveform;
        write(*make(made), temp("v.las"), row.minor);
        const auto source = load(temp("v.las"))->source();
        QCOMPARE(source->header.says(las::encoding::kExternalWaveform), row.becomes == 4 || row.becomes == 5);
        QCOMPARE(int(source->layout.format), int(row.becomes));
        QCOMPARE(int(source->header.versionMinor()), int(row.minor));
    }
}

void LasVersionsTest::wktBecomesKeys()
{
    const auto report = write(*make({}), temp("keys.las"), std::uint8_t(2));
    QVERIFY(noted(report, "translated from WKT, which is kept, to GeoTIFF keys: NAD83 / UTM zone 10N"));
    const auto source = load(temp("keys.las"))->source();
    QVERIFY(source->warnings.empty() && !source->header.says(las::encoding::kWkt));
    QVERIFY(source->crs.starts_with("EPSG:26910"));
    QVERIFY(source->units.horizontal == "m");
    QVERIFY(source->findVlr("LASF_Projection", 2112) != nullptr);

    Made local;  // a code that is not the system's: the scale is another one
    std::string wkt = kUtm;
    wkt.replace(wkt.find("0.9996"), 6, "0.9990");
    local.vlrs = {lasfiles::wktRecord(wkt)};
    const auto kept = write(*make(local), temp("none.las"), std::uint8_t(2));
    QVERIFY(noted(kept, "its record is kept"));
    QVERIFY(load(temp("none.las"))->source()->findVlr("LASF_Projection", 34735) == nullptr);
    std::string name;
    QVERIFY(las::keysOf("", name).empty() && las::keysOf("PROJCS[", name).empty());

    // with heights; and with a shift to another datum, which keys need not repeat
    const std::string heights =
        R"x(VERT_CS["NAVD88 height (ftUS)",VERT_DATUM["North American Vertical Datum 1988",2005,)x"
        R"(AUTHORITY["EPSG","5103"]],UNIT["US survey foot",0.304800609601219,AUTHORITY["EPSG","9003"]],)"
        R"(AXIS["Up",UP],AUTHORITY["EPSG","6360"]])";
    const auto wordsOf = [&](const std::string& system) {
        const Bytes bytes = las::keysOf(system, name);
        std::vector<std::uint16_t> words(bytes.size() / 2);
        if (!words.empty()) std::memcpy(words.data(), bytes.data(), bytes.size());
        return words;
    };
    QVERIFY((wordsOf("COMPD_CS[\"both\"," + kUtm + "," + heights + "]") ==
             std::vector<std::uint16_t>{1,    1, 0, 5,    1024, 0, 1, 1,    3072, 0, 1, 26910,
                                        3076, 0, 1, 9001, 4096, 0, 1, 6360, 4099, 0, 1, 9003}));
    std::string shifted = kUtm;
    const std::string spheroid = R"(AUTHORITY["EPSG","7019"]])";
    shifted.insert(shifted.find(spheroid) + spheroid.size(), ",TOWGS84[1,2,3,0,0,0,0]");
    QCOMPARE(wordsOf(shifted), wordsOf(kUtm));
    QVERIFY(wordsOf(R"(GEOCCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
                    R"(PRIMEM["Greenwich",0],UNIT["metre",1]])")
                .empty());
}

void LasVersionsTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    QTest::newRow("LAS") << "more/pdrf10-las15.las";
    QTest::newRow("LAZ") << "more/pdrf10-las15.laz";
}

void LasVersionsTest::realFiles()
{
    QFETCH(QString, file);
    const fs::path path = fs::path(PUNCTUM_TEST_DATA) / file.toStdString();
    if (!fs::exists(path)) QSKIP("the real file is not there");
    const auto cloud = load(path);
    for (const std::string& warning : cloud->source()->warnings)
        QVERIFY2(warning.find("1.5") == std::string::npos, warning.c_str());
    const fs::path out = temp("real" + path.extension().string());
    write(*cloud, out, {});
    QVERIFY(lasfiles::readFile(out) == lasfiles::readFile(path));
}

QTEST_GUILESS_MAIN(LasVersionsTest)
#include "LasVersionsTest.moc"
