// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/Text.h"
#include "core/las/File.h"
#include "core/las/Reader.h"
#include "core/las/SourceParser.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/ReadRecords.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::recordsByUs;
namespace fs = std::filesystem;

/// Writing LAS and LAZ. What is written is judged by LASzip's own API and byte by byte.
class LasWriterTest : public QObject
{
    Q_OBJECT

private slots:
    void chunksAreThoseOfSerialLaszip_data();
    void chunksAreThoseOfSerialLaszip();
    void emptyClouds();
    void editChangesOnlyItsField();
    void addedAttributesBecomeExtraBytes_data();
    void addedAttributesBecomeExtraBytes();
    void replacedExtraBytesChangeType();
    void madeCloudHasSoundHeader();
    void upgradeAndBack();
    void lossesAreRefused_data();
    void lossesAreRefused();
    void versionsChange();
    void evlrsAndWaveformsMove();
    void announcedRecordsAreThoseThatAreThere();
    void startOfNoRecordsMoves();
    void negativeZeroTimesAreKept_data();
    void negativeZeroTimesAreKept();
    void copcBecomesOrdinary();
    void damagedPointsAreLeftOut();
    void fullDiskLeavesTarget();
    void cancelLeavesTarget();
    void badTargets();
    void modeAndLinksAreKept();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        lasfiles::writeFile(temp(name), bytes);
        return temp(name);
    }
    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& e : fs::directory_iterator(m_dir.path().toStdString()))
            all.push_back(e.path().filename().string());
        std::sort(all.begin(), all.end());
        return all;
    }
    static std::shared_ptr<PointCloud> load(const fs::path& path, las::ReadResult* result = nullptr)
    {
        Progress progress;
        return las::load(path, progress, result);
    }
    static las::WriteReport save(const PointCloud& cloud, const fs::path& path, las::WriteOptions options = {})
    {
        Progress progress;
        options.compressed = las::isCompressedName(path);
        return las::write(cloud, path, options, progress);
    }
    static std::string errorOf(const PointCloud& cloud, const fs::path& path, las::WriteOptions options = {})
    {
        try {
            save(cloud, path, options);
        } catch (const Error& e) {
            return e.what();
        }
        return {};
    }

    QTemporaryDir m_dir;
};

namespace
{

bool hasNote(const las::WriteReport& report, const std::string& part)
{
    return std::any_of(report.notes.begin(), report.notes.end(),
                       [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

}  // namespace

void LasWriterTest::chunksAreThoseOfSerialLaszip_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (const int format : {0, 3, 4, 6, 7, 10}) QTest::addRow("format %d", format) << format << format % 4;
}

void LasWriterTest::chunksAreThoseOfSerialLaszip()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + extra);
    const std::size_t count = 120001;  // two full chunks and a part
    const Bytes points = lasfiles::randomRecords(f, length, count, std::uint32_t(format), true);
    const Bytes expected = lasfiles::lazFile(f, length, points);
    const fs::path in = make("serial.laz", expected);
    const fs::path out = temp("parallel.laz");
    save(*load(in), out);
    QVERIFY(lasfiles::readFile(out) == expected);
}

void LasWriterTest::emptyClouds()
{
    for (const std::uint8_t format : {1, 7}) {
        const auto length = lasfiles::recordLength(format);
        const fs::path in = make(
            "empty.las", lasfiles::file(lasfiles::header(lasfiles::minorFor(format), format, length, 0), {}, {}));
        const auto cloud = load(in);
        QCOMPARE(cloud->size(), PointIndex(0));
        save(*cloud, temp("empty2.laz"));
        const auto again = load(temp("empty2.laz"));
        QCOMPARE(again->size(), PointIndex(0));
        save(*again, temp("empty3.las"));
        QVERIFY(lasfiles::readFile(temp("empty3.las")) == lasfiles::readFile(in));
    }
}

void LasWriterTest::editChangesOnlyItsField()
{
    const std::size_t count = 5000;
    const Bytes points = lasfiles::randomRecords(7, 40, count, 7);
    const fs::path in = make("edit.las", lasfiles::file(lasfiles::header(4, 7, 40, count), {}, points));
    const auto cloud = load(in);
    for (std::size_t i = 0; i < count; i += 3)
        cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>()[i] = 200;
    save(*cloud, in);
    Bytes expected = points;
    for (std::size_t i = 0; i < count; i += 3) expected[i * 40 + 16] = std::byte(200);
    const Bytes written = lasfiles::readFile(in);
    QVERIFY(std::equal(expected.begin(), expected.end(), written.begin() + 375));
    const Bytes head = lasfiles::header(4, 7, 40, count);
    QVERIFY(std::equal(head.begin(), head.end(), written.begin()));

    // moved points: the box follows, and nothing else
    cloud->columns()[0]->values<std::int32_t>()[0] = INT32_MAX;
    save(*cloud, in);
    QCOMPARE(lasfiles::get<double>(lasfiles::readFile(in), 179), INT32_MAX * 0.01);
}

void LasWriterTest::addedAttributesBecomeExtraBytes_data()
{
    QTest::addColumn<QString>("ending");
    QTest::addColumn<int>("extra");
    QTest::addColumn<bool>("described");
    for (const char* ending : {".las", ".laz"}) {
        QTest::addRow("none before, %s", ending) << QString(ending) << 0 << false;
        QTest::addRow("300 undocumented, %s", ending) << QString(ending) << 300 << false;
        QTest::addRow("described, %s", ending) << QString(ending) << 12 << true;
    }
}

void LasWriterTest::addedAttributesBecomeExtraBytes()
{
    QFETCH(QString, ending);
    QFETCH(int, extra);
    QFETCH(bool, described);
    const std::size_t count = 3000;
    const auto length = std::uint16_t(34 + extra);
    std::vector<Bytes> vlrs;
    if (described) {  // 8 of the 12 bytes, in two records
        Bytes a(192), b(192);
        a[2] = std::byte(9);
        std::memcpy(a.data() + 4, "Echo", 4);
        b[2] = std::byte(6);
        std::memcpy(b.data() + 4, "Number", 6);
        vlrs = {lasfiles::record("LASF_Spec", 4, a), lasfiles::record("other", 9, Bytes(5)),
                lasfiles::record("LASF_Spec", 4, b)};
    }
    const Bytes points = lasfiles::randomRecords(3, length, count, 3);
    const fs::path in = make("plain.las", lasfiles::file(lasfiles::header(2, 3, length, count), vlrs, points));
    const auto cloud = load(in);
    for (const char* name : {"NormalX", "NormalY", "NormalZ"}) {
        auto column = cloud->addColumn(std::make_shared<Column>(name, ScalarType::F32, count));
        for (std::size_t i = 0; i < count; ++i) column->values<float>()[i] = float(i) * 0.25f + float(name[6]);
        Attribute a;
        a.name = name;
        a.columns[0] = column;
        cloud->addAttribute(a);
    }
    addComposite(*cloud, "Normal", AttributeKind::Vector, {"NormalX", "NormalY", "NormalZ"});
    const fs::path out = temp("normals" + ending.toStdString());
    const auto report = save(*cloud, out);
    QVERIFY(hasNote(report, "NormalX, NormalY, NormalZ"));

    las::ReadResult result;
    const auto back = load(out, &result);
    QVERIFY(result.warnings.empty());
    QCOMPARE(back->source()->extraBytesRecords().size(), std::size_t(1));
    QCOMPARE(back->source()->layout.length, std::uint16_t(length + 12));
    QVERIFY(back->findAttribute("Normal") != nullptr);
    QCOMPARE(back->findAttribute("Normal")->kind, AttributeKind::Vector);
    for (const char* name : {"NormalX", "NormalY", "NormalZ"})
        for (std::size_t i = 0; i < count; i += 7)
            QCOMPARE(back->findAttribute(name)->number(i), double(float(i) * 0.25f + float(name[6])));
    if (described) {
        QVERIFY(back->findAttribute("Echo") != nullptr);
        QVERIFY(back->findAttribute("Number") != nullptr);
    }
    const Bytes written = lasfiles::recordsByLaszip(out, 3, std::uint16_t(length + 12), count);
    for (std::size_t i = 0; i < count; ++i)
        QVERIFY(std::memcmp(written.data() + i * (length + 12u), points.data() + i * length, length) == 0);

    // a second saving of what was read back has nothing to change
    save(*back, temp("again" + ending.toStdString()));
    QVERIFY(lasfiles::readFile(temp("again" + ending.toStdString())) == lasfiles::readFile(out));
}

void LasWriterTest::replacedExtraBytesChangeType()
{
    // NormalX as float64 in the file, computed anew as float32
    Bytes d(192);
    d[2] = std::byte(10);
    std::memcpy(d.data() + 4, "NormalX", 7);
    const std::size_t count = 100;
    const Bytes points = lasfiles::randomRecords(0, 28, count, 1);
    const fs::path in = make("f64.las", lasfiles::file(lasfiles::header(2, 0, 28, count),
                                                       {lasfiles::record("LASF_Spec", 4, d)}, points));
    const auto cloud = load(in);
    cloud->removeAttribute("NormalX");
    Attribute a;
    a.name = "NormalX";
    a.columns[0] = cloud->addColumn(std::make_shared<Column>("NormalX", ScalarType::F32, count));
    a.columns[0]->values<float>()[5] = 0.5f;
    cloud->addAttribute(a);
    save(*cloud, temp("f32.las"));
    const auto back = load(temp("f32.las"));
    QCOMPARE(back->source()->layout.length, std::uint16_t(24));
    QCOMPARE(back->findAttribute("NormalX")->type(), ScalarType::F32);
    QCOMPARE(back->findAttribute("NormalX")->number(5), 0.5);

    // and taken out altogether
    cloud->removeAttribute("NormalX");
    const auto report = save(*cloud, temp("gone.las"));
    QVERIFY(hasNote(report, "No longer in the file: NormalX."));
    QCOMPARE(load(temp("gone.las"))->source()->layout.length, std::uint16_t(20));
}

void LasWriterTest::madeCloudHasSoundHeader()
{
    const std::vector<las::ExtraBytesField> fields = {{"Reflectance", ScalarType::U16, "dB", 0.01, {}},
                                                      {"Deviation", ScalarType::F32, "", {}, {}}};
    const CoordinateScale scale{{0.001, 0.001, 0.001}, {500000, 5000000, 100}};
    const PointIndex count = 1000;
    const auto source = las::makeSource(
        7, fields, scale, R"(LOCAL_CS["x",LOCAL_DATUM["d",0],UNIT["metre",1],AXIS["E",EAST],AXIS["N",NORTH]])",
        count);
    PointCloud cloud(count, scale);
    las::makeColumns(cloud, source->layout);
    cloud.setSource(source);
    for (PointIndex i = 0; i < count; ++i) {
        cloud.columns()[0]->values<std::int32_t>()[i] = std::int32_t(i) - 300;
        cloud.findAttribute("ReturnNumber")->columns[0]->values<std::uint8_t>()[i] =
            std::uint8_t(i % 3 + 1) | 3 << 4;
    }
    QVERIFY(cloud.findAttribute("RGB") != nullptr);
    for (const char* name : {"made.las", "made.laz"}) {
        const auto report = save(cloud, temp(name));
        QVERIFY(report.notes.empty());
        const Bytes b = lasfiles::readFile(temp(name));
        QCOMPARE(lasfiles::get<std::uint8_t>(b, 25), std::uint8_t(4));
        QCOMPARE(lasfiles::get<std::uint16_t>(b, 6), std::uint16_t(17));
        QCOMPARE(lasfiles::get<std::uint32_t>(b, 107), 0u);
        QCOMPARE(lasfiles::get<std::uint64_t>(b, 247), std::uint64_t(count));
        QCOMPARE(lasfiles::get<std::uint64_t>(b, 255), std::uint64_t(334));
        QCOMPARE(lasfiles::get<std::uint64_t>(b, 263), std::uint64_t(333));
        QCOMPARE(lasfiles::get<double>(b, 179), 699 * 0.001 + 500000);
        QCOMPARE(lasfiles::get<double>(b, 187), -300 * 0.001 + 500000);
        QVERIFY(lasfiles::get<std::uint16_t>(b, 90) >= 1 && lasfiles::get<std::uint16_t>(b, 90) <= 366);
        QVERIFY(lasfiles::get<std::uint16_t>(b, 92) >= 2024);
        las::ReadResult result;
        const auto back = load(temp(name), &result);
        QVERIFY(result.warnings.empty());
        QVERIFY(back->findAttribute("Reflectance")->scaled);
        QVERIFY(back->source()->crs.starts_with("LOCAL_CS"));
    }

    // the same without saying where it comes from
    cloud.setSource(nullptr);
    save(cloud, temp("bare.las"));
    const auto bare = load(temp("bare.las"));
    QCOMPARE(int(bare->source()->layout.format), 7);
    QVERIFY(bare->findAttribute("Deviation") != nullptr);
    QCOMPARE(bare->rawX()[0], -300);

    // with columns of the older formats
    PointCloud old(10, scale);
    for (const char* axis : {"X", "Y", "Z"}) old.addColumn(std::make_shared<Column>(axis, ScalarType::I32, 10));
    old.addColumn(std::make_shared<Column>("Classes", ScalarType::U8, 10))->values<std::uint8_t>()[4] = 0x45;
    old.addColumn(std::make_shared<Column>("Red", ScalarType::U16, 10));
    old.addColumn(std::make_shared<Column>("GpsTime", ScalarType::F64, 10));
    las::WriteOptions options;
    options.pointFormat = 6;
    QVERIFY(errorOf(old, temp("old.las"), options).find("lacks a field") != std::string::npos);
    save(old, temp("old.las"));
    const auto again = load(temp("old.las"));
    QCOMPARE(int(again->source()->layout.format), 3);
    QCOMPARE(again->findAttribute("Classification")->number(4), 5.0);
}

void LasWriterTest::upgradeAndBack()
{
    const std::size_t count = 4096;
    const Bytes points = lasfiles::randomRecords(3, 36, count, 11);
    const fs::path in = make("old.las", lasfiles::file(lasfiles::header(2, 3, 36, count), {}, points));
    const auto cloud = load(in);
    las::WriteOptions options;
    options.pointFormat = 7;
    const fs::path up = temp("new.laz");
    const auto report = save(*cloud, up, options);
    QVERIFY(hasNote(report, "LAS 1.4"));
    const auto extended = load(up);
    QCOMPARE(int(extended->source()->layout.format), 7);
    QCOMPARE(extended->source()->header.version(), std::string("1.4"));
    for (const char* name :
         {"X", "Intensity", "ReturnNumber", "NumberOfReturns", "ScanDirectionFlag", "EdgeOfFlightLine",
          "Classification", "Synthetic", "KeyPoint", "Withheld", "UserData", "PointSourceId", "Red"})
        for (std::size_t i = 0; i < count; ++i)
            QCOMPARE(extended->findAttribute(name)->number(i), cloud->findAttribute(name)->number(i));
    for (std::size_t i = 0; i < count; ++i) {
        const double degrees = cloud->findAttribute("ScanAngle")->number(i);
        QVERIFY(std::fabs(extended->findAttribute("ScanAngle")->number(i) - degrees) <= 0.003 + 1e-9);
        QCOMPARE(extended->findAttribute("Overlap")->number(i),
                 cloud->findAttribute("Classification")->number(i) == 12 ? 1.0 : 0.0);
    }
    las::WriteOptions back;
    back.pointFormat = 3;
    back.versionMinor = 2;
    save(*extended, temp("back.las"), back);
    QVERIFY(recordsByUs(temp("back.las")) == points);
}

void LasWriterTest::lossesAreRefused_data()
{
    QTest::addColumn<int>("from");
    QTest::addColumn<int>("to");
    QTest::addColumn<QString>("attribute");
    QTest::addColumn<int>("value");
    QTest::addColumn<QString>("said");
    QTest::newRow("class") << 6 << 1 << "Classification" << 40 << "3 points have a class above 31";
    QTest::newRow("returns") << 6 << 1 << "ReturnNumber" << 9 << "3 points have more than 7 returns";
    QTest::newRow("overlap") << 6 << 1 << "Overlap" << 8 << "3 points have the overlap flag";
    QTest::newRow("channel") << 6 << 1 << "ScannerChannel" << 16 << "3 points have a scanner channel";
    QTest::newRow("angle") << 6 << 1 << "ScanAngle" << 100 << "3 points have a scan angle that is no whole degree";
    QTest::newRow("colors") << 3 << 1 << "Green" << 1 << "3 points have colors";
    QTest::newRow("time") << 1 << 0 << "GpsTime" << 1 << "3 points have a GPS time";
    QTest::newRow("nir") << 8 << 7 << "NIR" << 1 << "3 points have near infrared";
    QTest::newRow("waveform") << 4 << 1 << "WaveformDescriptorIndex" << 1 << "3 points have a waveform";
}

void LasWriterTest::lossesAreRefused()
{
    QFETCH(int, from);
    QFETCH(int, to);
    QFETCH(QString, attribute);
    QFETCH(int, value);
    QFETCH(QString, said);
    const auto f = std::uint8_t(from);
    const std::size_t count = 10;
    const auto length = lasfiles::recordLength(f);
    const fs::path in = make("loss.las", lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, count),
                                                        {}, Bytes(count * length)));
    const auto cloud = load(in);
    las::WriteOptions options;
    options.pointFormat = std::uint8_t(to);
    save(*cloud, temp("fits.las"), options);  // all zero: nothing is lost
    const auto column = cloud->findAttribute(attribute.toStdString())->columns[0];
    for (const std::size_t i : {1u, 4u, 9u}) column->data()[i * column->elementBytes()] = std::byte(value);
    const auto before = names();
    QVERIFY(QString::fromStdString(errorOf(*cloud, temp("lost.las"), options)).contains(said));
    QCOMPARE(names(), before);
}

void LasWriterTest::versionsChange()
{
    const std::size_t count = 50;
    const Bytes points = lasfiles::randomRecords(1, 28, count, 2);
    Bytes head = lasfiles::header(2, 1, 28, count);
    lasfiles::append(head, Bytes(9, std::byte('u')));  // user bytes after the header
    lasfiles::set<std::uint16_t>(head, 94, std::uint16_t(head.size()));
    const fs::path in = make("v2.las", lasfiles::file(head, {lasfiles::record("me", 1, Bytes(3))}, points));
    const auto cloud = load(in);
    las::WriteOptions options;
    options.versionMinor = 4;
    save(*cloud, temp("v4.las"), options);
    const Bytes up = lasfiles::readFile(temp("v4.las"));
    QCOMPARE(lasfiles::get<std::uint16_t>(up, 94), std::uint16_t(375 + 9));
    QCOMPARE(lasfiles::get<std::uint64_t>(up, 247), std::uint64_t(count));
    QCOMPARE(lasfiles::get<std::uint32_t>(up, 107), std::uint32_t(count));
    QVERIFY(up[375] == std::byte('u'));
    QVERIFY(lasfiles::recordsByLaszip(temp("v4.las"), 1, 28, count) == points);

    options.versionMinor = 2;
    options.pointFormat = 6;
    QVERIFY(errorOf(*cloud, temp("no.las"), options).find("needs LAS 1.4") != std::string::npos);
    options.pointFormat = 11;
    QVERIFY(!errorOf(*cloud, temp("no.las"), options).empty());
    options = {};
    options.versionMinor = 7;
    QVERIFY(!errorOf(*cloud, temp("no.las"), options).empty());
    QVERIFY(!fs::exists(temp("no.las")));

    // down again: the EVLR that was added becomes a VLR
    const auto extended = load(temp("v4.las"));
    Bytes withEvlr = up;
    lasfiles::set<std::uint64_t>(withEvlr, 235, withEvlr.size());
    lasfiles::set<std::uint32_t>(withEvlr, 243, 1);
    lasfiles::append(withEvlr, lasfiles::record("late", 5, Bytes(70), true));
    options.versionMinor = 2;
    const auto report = save(*load(make("evlr.las", withEvlr)), temp("down.las"), options);
    QVERIFY(hasNote(report, "late/5"));
    QVERIFY(las::Reader::open(temp("down.las"))->source()->findVlr("late", 5) != nullptr);
    QVERIFY(recordsByUs(temp("down.las")) == points);
}

void LasWriterTest::evlrsAndWaveformsMove()
{
    // 1.4, an ordinary EVLR, then the waveforms that the header points at; then a tail
    const std::size_t count = 20;
    const Bytes points = lasfiles::randomRecords(9, 59, count, 4);
    Bytes head = lasfiles::header(4, 9, 59, count);
    lasfiles::set<std::uint16_t>(head, 6, 16 | 2);
    const std::size_t end = head.size() + points.size();
    Bytes after(5, std::byte('g'));
    lasfiles::append(after, lasfiles::record("first", 1, Bytes(100), true));
    lasfiles::append(after, lasfiles::record("LASF_Spec", 65535, Bytes(333, std::byte('w')), true));
    lasfiles::append(after, Bytes(3, std::byte('t')));
    lasfiles::set<std::uint64_t>(head, 235, end + 5);
    lasfiles::set<std::uint32_t>(head, 243, 2);
    lasfiles::set<std::uint64_t>(head, 227, end + 5 + 160);
    const fs::path in = make("wave.las", lasfiles::file(head, {}, points, after));
    const auto cloud = load(in);
    save(*cloud, temp("wave2.laz"));
    const Bytes laz = lasfiles::readFile(temp("wave2.laz"));
    const auto start = lasfiles::get<std::uint64_t>(laz, 227);
    QCOMPARE(lasfiles::get<std::uint16_t>(laz, std::size_t(start) + 18), std::uint16_t(65535));
    QCOMPARE(start, lasfiles::get<std::uint64_t>(laz, 235) + 160);
    save(*load(temp("wave2.laz")), temp("wave3.las"));
    QVERIFY(lasfiles::readFile(temp("wave3.las")) == lasfiles::readFile(in));

    // 1.3: one waveform record, which nothing but the header's position announces
    Bytes old = lasfiles::header(3, 4, 57, count);
    const Bytes oldPoints = lasfiles::randomRecords(4, 57, count, 5);
    lasfiles::set<std::uint16_t>(old, 6, 2);
    lasfiles::set<std::uint64_t>(old, 227, old.size() + oldPoints.size());
    const fs::path in3 = make(
        "wave13.las", lasfiles::file(old, {}, oldPoints, lasfiles::record("LASF_Spec", 65535, Bytes(77), true)));
    save(*load(in3), temp("wave13.laz"));
    const Bytes laz3 = lasfiles::readFile(temp("wave13.laz"));
    QCOMPARE(lasfiles::get<std::uint64_t>(laz3, 227), std::uint64_t(laz3.size() - 137));
    save(*load(temp("wave13.laz")), temp("wave13b.las"));
    QVERIFY(lasfiles::readFile(temp("wave13b.las")) == lasfiles::readFile(in3));
}

void LasWriterTest::announcedRecordsAreThoseThatAreThere()
{
    // A count that is wrong is not written again: LASzip refuses it.
    const Bytes points = lasfiles::randomRecords(3, 34, 100, 5, true);
    const Bytes vlr = lasfiles::record("a", 1, Bytes(20));
    for (const std::uint32_t said : {2u, 1069128089u, UINT32_MAX}) {
        Bytes bytes = lasfiles::file(lasfiles::header(2, 3, 34, 100), {vlr}, points);
        lasfiles::set(bytes, 100, said);
        const auto cloud = load(make("announced.las", bytes));
        for (const char* name : {"announced2.las", "announced2.laz"}) {
            const auto report = save(*cloud, temp(name));
            QVERIFY(hasNote(report, grouped(said)));
            const Bytes written = lasfiles::readFile(temp(name));
            QCOMPARE(lasfiles::get<std::uint32_t>(written, 100), std::string(name).ends_with("laz") ? 2u : 1u);
            QVERIFY(lasfiles::recordsByLaszip(temp(name), 3, 34, 100) == points);
        }
    }
}

void LasWriterTest::startOfNoRecordsMoves()
{
    // Where the header has a place for extended records, but none: it goes on to mean the end of the points.
    Bytes head = lasfiles::header(4, 6, 30, 500);
    lasfiles::set<std::uint64_t>(head, 235, head.size() + 500 * 30);
    const Bytes bytes = lasfiles::file(head, {}, lasfiles::randomRecords(6, 30, 500, 5, true));
    save(*load(make("start.las", bytes)), temp("start.laz"));
    const Bytes laz = lasfiles::readFile(temp("start.laz"));
    QCOMPARE(lasfiles::get<std::uint64_t>(laz, 235), std::uint64_t(laz.size()));
    save(*load(temp("start.laz")), temp("start2.las"));
    QVERIFY(lasfiles::readFile(temp("start2.las")) == bytes);
}

void LasWriterTest::negativeZeroTimesAreKept_data()
{
    QTest::addColumn<int>("format");
    for (int format = 0; format <= 10; ++format)
        if (lasfiles::hasTime(std::uint8_t(format))) QTest::addRow("format %d", format) << format;
}

void LasWriterTest::negativeZeroTimesAreKept()
{
    // LASzip takes -0 for 0 in the formats 6 to 10. Beside both stand times that are near to what they become when
    // they are moved away from 0, and some that are no numbers.
    QFETCH(int, format);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + 2);
    const std::size_t count = 6000, at = f < 6 ? 20 : 22;
    std::mt19937_64 random(2);
    const std::uint64_t chosen[] = {0,
                                    1ull << 63,
                                    0,
                                    1ull << 63,
                                    0xFFFFFFFF00000000ull,
                                    0x7FFFFFFF00000000ull,
                                    0x7FF8000000000001ull,
                                    5,
                                    0xFFFFFFFFFFFFFFFFull,
                                    0x4111111100000000ull};
    for (const bool often : {true, false}) {
        Bytes points = lasfiles::randomRecords(f, length, count, 6, true);
        std::uint64_t time = 0x4100000000000000ull;
        for (std::size_t i = 0; i < count; ++i) {
            time += random() % 5000;
            const bool other = random() % (often ? 2 : 500) == 0;
            lasfiles::set(points, i * length + at, other ? chosen[random() % std::size(chosen)] : time);
        }
        const fs::path in = make(
            "minus.las", lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, count), {}, points));
        save(*load(in), temp("minus.laz"));
        QVERIFY(recordsByUs(temp("minus.laz")) == points);
        QVERIFY(lasfiles::recordsByLaszip(temp("minus.laz"), f, length, count) == points);
    }
}

void LasWriterTest::copcBecomesOrdinary()
{
    const fs::path path = fs::path(PUNCTUM_TEST_DATA) / "lion_takanawa.copc.laz";
    if (!fs::exists(path)) QSKIP("lion_takanawa.copc.laz is not here");
    const auto report = save(*load(path), temp("lion.las"));
    QVERIFY(hasNote(report, "COPC"));
    const auto source = las::Reader::open(temp("lion.las"))->source();
    for (const auto* list : {&source->vlrs, &source->evlrs})
        for (const las::Vlr& v : *list) QVERIFY(v.user() != "copc");
    QVERIFY(recordsByUs(temp("lion.las")) == recordsByUs(path));
    QCOMPARE(source->header.get(las::at::kEvlrCount), 0u);
    QCOMPARE(source->header.get(las::at::kEvlrStart), std::uint64_t(0));
}

void LasWriterTest::damagedPointsAreLeftOut()
{
    const std::size_t count = 1000;
    const Bytes points = lasfiles::randomRecords(6, 30, count, 8);
    Bytes laz = lasfiles::lazFile(6, 30, points, 100);
    const fs::path in = make("good.laz", laz);
    las::File file(in);
    const auto chunk = las::parseFile(file).chunks[4];
    lasfiles::set<std::uint32_t>(laz, std::size_t(chunk.offset) + 30, 99);  // its own count
    const fs::path bad = make("bad.laz", laz);
    las::ReadResult result;
    const auto cloud = load(bad, &result);
    QCOMPARE(result.missing, (std::vector<PointRange>{{400, 500}}));
    const auto report = save(*cloud, temp("rest.laz"));
    QVERIFY(hasNote(report, "100 points"));
    QCOMPARE(report.points, PointIndex(900));
    Bytes rest = points;
    rest.erase(rest.begin() + 400 * 30, rest.begin() + 500 * 30);
    QVERIFY(recordsByUs(temp("rest.laz")) == rest);
    QCOMPARE(lasfiles::get<std::uint64_t>(lasfiles::readFile(temp("rest.laz")), 247), std::uint64_t(900));
}

void LasWriterTest::fullDiskLeavesTarget()
{
    const std::size_t count = 20000;
    const Bytes points = lasfiles::randomRecords(3, 34, count, 9);
    const fs::path in = make("whole.las", lasfiles::file(lasfiles::header(2, 3, 34, count), {}, points));
    const auto cloud = load(in);
    for (const char* name : {"target.las", "target.laz"}) {
        const Bytes old(1000, std::byte('o'));
        const fs::path target = make(name, old);
        const auto before = names();
        for (const std::size_t limit : {0u, 1u, 100u, 227u, 300u, 65536u, 400000u}) {
            struct rlimit was {
            };
            getrlimit(RLIMIT_FSIZE, &was);
            const struct rlimit low {
                rlim_t(limit), was.rlim_max
            };
            setrlimit(RLIMIT_FSIZE, &low);
            const std::string said = errorOf(*cloud, target);
            setrlimit(RLIMIT_FSIZE, &was);
            QVERIFY2(said.find("nothing was changed") != std::string::npos, said.c_str());
            QVERIFY(lasfiles::readFile(target) == old);
            QCOMPARE(names(), before);
        }
        save(*cloud, target);
        QVERIFY(recordsByUs(target) == points);
    }
}

void LasWriterTest::cancelLeavesTarget()
{
    const std::size_t count = 200000;
    const Bytes points = lasfiles::randomRecords(1, 28, count, 9, true);
    const auto cloud = load(make("long.las", lasfiles::file(lasfiles::header(2, 1, 28, count), {}, points)));
    for (const char* name : {"stop.las", "stop.laz"}) {
        const Bytes old(10, std::byte('o'));
        const fs::path target = make(name, old);
        const auto before = names();
        Progress progress;
        progress.cancel();
        las::WriteOptions options;
        options.compressed = las::isCompressedName(target);
        QVERIFY_EXCEPTION_THROWN(las::write(*cloud, target, options, progress), Cancelled);
        QVERIFY(lasfiles::readFile(target) == old);
        QCOMPARE(names(), before);
    }
}

void LasWriterTest::badTargets()
{
    const auto cloud = load(make("small.las", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20))));
    QVERIFY(errorOf(*cloud, m_dir.path().toStdString()).find("folder") != std::string::npos);
    QVERIFY(errorOf(*cloud, temp("no/such/folder/a.las")).find("does not exist") != std::string::npos);
    QVERIFY(errorOf(*cloud, "/dev/null").find("regular") != std::string::npos);
    fs::create_directory(temp("closed"));
    ::chmod(temp("closed").c_str(), 0555);
    const uid_t was = ::geteuid();
    if (was == 0) QCOMPARE(::chmod(m_dir.path().toStdString().c_str(), 0755), 0);
    if (was == 0) QCOMPARE(::seteuid(65534), 0);  // nothing is closed to root
    const std::string closed = errorOf(*cloud, temp("closed/a.las"));
    if (was == 0) QCOMPARE(::seteuid(was), 0);
    QVERIFY2(closed.find("read-only") != std::string::npos, closed.c_str());
    ::chmod(temp("closed").c_str(), 0700);
    // a name so long that a temporary one cannot contain it, and one with a line break
    for (const std::string& name : {std::string(251, 'x') + ".las", std::string("a\nb.las")}) {
        save(*cloud, temp(name));
        QVERIFY(fs::exists(temp(name)));
    }
    // a file that was damaged when it was read keeps its place
    Bytes cut = lasfiles::file(lasfiles::header(2, 0, 20, 3), {}, Bytes(50));
    const fs::path damaged = make("cut.las", cut);
    const auto half = load(damaged);
    QCOMPARE(half->size(), PointIndex(2));
    QVERIFY(errorOf(*half, damaged).find("another name") != std::string::npos);
    QVERIFY(lasfiles::readFile(damaged) == cut);
    save(*half, temp("repaired.las"));
    QCOMPARE(lasfiles::get<std::uint32_t>(lasfiles::readFile(temp("repaired.las")), 107), 2u);
}

void LasWriterTest::modeAndLinksAreKept()
{
    const auto cloud = load(make("mode.las", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20))));
    const fs::path target = make("private.las", Bytes(3));
    ::chmod(target.c_str(), 0640);
    fs::create_symlink("private.las", temp("link.las"));
    save(*cloud, temp("link.las"));
    QVERIFY(fs::is_symlink(temp("link.las")));
    struct stat s {
    };
    QCOMPARE(::stat(target.c_str(), &s), 0);
    QCOMPARE(s.st_mode & 0777u, 0640u);
    QVERIFY(lasfiles::readFile(target) == lasfiles::readFile(temp("mode.las")));
    fs::create_hard_link(target, temp("second.las"));
    QVERIFY(hasNote(save(*cloud, target), "hard links"));
}

QTEST_GUILESS_MAIN(LasWriterTest)
#include "LasWriterTest.moc"
