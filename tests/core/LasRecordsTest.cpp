// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/ExtraBytes.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

#include <bit>
#include <cmath>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
using lasfiles::save;
namespace fs = std::filesystem;

/// What stands beside the points and follows them when they change: ranges of extra bytes, their descriptions, the
/// records of LAStools, files of waveforms.
class LasRecordsTest : public QObject
{
    Q_OBJECT

private slots:
    void rangesFollowEdits_data();
    void rangesFollowEdits();
    void rangesOfUnsignedValues();
    void rangesOfRealValues();
    void recordsThatGo();
    void addedAttributesKeepWhatTheySay();
    void sourcesAreMade();
    void manyAttributesGoIntoAnExtendedRecord();
    void tileRecordsGoWithOtherPoints();
    void waveformsGoAlong_data();
    void waveformsGoAlong();

private:
    fs::path path(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    static bool hasNote(const las::WriteReport& report, const std::string& part)
    {
        return std::any_of(report.notes.begin(), report.notes.end(),
                           [&](const std::string& n) { return n.find(part) != std::string::npos; });
    }

    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kCount = 500;
constexpr std::int16_t kNone = -9999;
constexpr std::size_t kNoDataAt = 40, kMinAt = 64, kMaxAt = 88;

/// Format 6 with one int16 "Depth" that states no data (or not), minimum and maximum; the latter are as given.
Bytes fileWithRange(bool noData, std::int64_t min, std::int64_t max)
{
    las::ExtraBytesDescriptor d = las::makeDescriptor({"Depth", ScalarType::I16, "", {}, {}});
    d.bytes[3] = std::byte(2 | 4 | (noData ? 1 : 0));
    const std::int64_t none = kNone;
    std::memcpy(d.bytes.data() + kNoDataAt, &none, 8);
    std::memcpy(d.bytes.data() + kMinAt, &min, 8);
    std::memcpy(d.bytes.data() + kMaxAt, &max, 8);
    Bytes points = lasfiles::randomRecords(6, 32, kCount, 3);
    for (std::size_t i = 0; i < kCount; ++i)
        lasfiles::set(points, i * 32 + 30, i == 7 ? kNone : std::int16_t(int(i) - 100));
    return lasfiles::file(lasfiles::header(4, 6, 32, kCount),
                          {lasfiles::record("LASF_Spec", 4, Bytes(d.bytes.begin(), d.bytes.end()))}, points);
}

std::int64_t stated(const fs::path& file, std::size_t at)
{
    const auto cloud = [&] {
        Progress progress;
        return las::load(file, progress);
    }();
    return lasfiles::get<std::int64_t>(cloud->source()->extraBytesRecords().front()->data, at);
}

}  // namespace

void LasRecordsTest::rangesFollowEdits_data()
{
    QTest::addColumn<bool>("noData");
    QTest::addColumn<QString>("name");
    for (const bool noData : {false, true})
        for (const char* name : {"out.las", "out.laz"})
            QTest::addRow("%s, %s", noData ? "no data" : "all data", name) << noData << QString(name);
}

void LasRecordsTest::rangesFollowEdits()
{
    QFETCH(bool, noData);
    QFETCH(QString, name);
    const fs::path in = path("in.las"), out = path(name.toStdString());
    lasfiles::writeFile(in, fileWithRange(noData, -100, 399));
    const auto cloud = load(in);
    const auto depth = cloud->findAttribute("Depth")->columns[0]->values<std::int16_t>();
    // another attribute changes: what is stated stays, right or wrong
    cloud->findAttribute("Intensity")->columns[0]->values<std::uint16_t>()[0] ^= 1;
    save(*cloud, out);
    QCOMPARE(stated(out, kMinAt), std::int64_t(-100));
    QCOMPARE(stated(out, kMaxAt), std::int64_t(399));
    depth[3] = 1000;
    depth[0] = -50;  // was the least
    save(*cloud, out);
    QCOMPARE(stated(out, kMinAt), std::int64_t(noData ? -99 : kNone));
    QCOMPARE(stated(out, kMaxAt), std::int64_t(1000));
    // and back: the file that was read
    depth[3] = -97;
    depth[0] = -100;
    cloud->findAttribute("Intensity")->columns[0]->values<std::uint16_t>()[0] ^= 1;
    save(*cloud, path("back.las"));
    QVERIFY(lasfiles::readFile(path("back.las")) == lasfiles::readFile(in));
}

void LasRecordsTest::rangesOfUnsignedValues()
{
    Bytes bytes = fileWithRange(false, 0, 65535);
    bytes[375 + 54 + 2] = std::byte(3);  // uint16
    const fs::path in = path("unsigned.las"), out = path("unsigned out.las");
    lasfiles::writeFile(in, bytes);
    const auto cloud = load(in);
    for (std::uint16_t& v : cloud->findAttribute("Depth")->columns[0]->values<std::uint16_t>()) v = v / 2 + 7;
    save(*cloud, out);
    QCOMPARE(stated(out, kMinAt), std::int64_t(7));
    QCOMPARE(stated(out, kMaxAt), std::int64_t(65535 / 2 + 7));
}

void LasRecordsTest::rangesOfRealValues()
{
    las::ExtraBytesDescriptor d = las::makeDescriptor({"Height", ScalarType::F32, "", {}, {}});
    d.bytes[3] = std::byte(2 | 4);
    const double most = 99;
    std::memcpy(d.bytes.data() + kMaxAt, &most, 8);
    Bytes points(kCount * 34);
    for (std::size_t i = 0; i < kCount; ++i)
        lasfiles::set(points, i * 34 + 30, i == 7 ? std::nanf("") : float(i % 100));
    lasfiles::writeFile(
        path("real.las"),
        lasfiles::file(lasfiles::header(4, 6, 34, kCount),
                       {lasfiles::record("LASF_Spec", 4, Bytes(d.bytes.begin(), d.bytes.end()))}, points));
    const auto cloud = load(path("real.las"));
    cloud->findAttribute("Height")->columns[0]->values<float>()[3] = -2.5f;
    save(*cloud, path("real out.las"));
    QCOMPARE(std::bit_cast<double>(stated(path("real out.las"), kMinAt)), -2.5);
    QCOMPARE(std::bit_cast<double>(stated(path("real out.las"), kMaxAt)), 99.0);
}

void LasRecordsTest::recordsThatGo()
{
    // a description in an extended record, whose only attribute is removed; an index of the points as they lay
    // before
    Bytes d(192);
    d[2] = std::byte(1);
    d[4] = std::byte('A');
    const Bytes records = lasfiles::randomRecords(6, 31, kCount, 5);
    Bytes head = lasfiles::header(4, 6, 31, kCount);
    lasfiles::set(head, 235, std::uint64_t(head.size() + records.size()));
    lasfiles::set(head, 243, std::uint32_t(1));
    lasfiles::set(head, 6, std::uint16_t(16));
    lasfiles::writeFile(path("one.las"),
                        lasfiles::file(head, {}, records, lasfiles::record("LASF_Spec", 4, d, true)));
    const auto cloud = load(path("one.las"));
    cloud->removeAttribute("A");
    QVERIFY(hasNote(save(*cloud, path("none.las")), "No longer in the file: A."));
    const auto source = load(path("none.las"))->source();
    QVERIFY(source->evlrs.empty() && source->header.get(las::at::kEvlrCount) == 0 && source->warnings.empty());

    // one of three values that one description covers
    d[2] = std::byte(21);
    const Bytes three = lasfiles::randomRecords(0, 23, kCount, 5);
    lasfiles::writeFile(path("three.las"), lasfiles::file(lasfiles::header(2, 0, 23, kCount),
                                                          {lasfiles::record("LASF_Spec", 4, d)}, three));
    const auto vector = load(path("three.las"));
    vector->removeAttribute("A[1]");
    save(*vector, path("two.las"));
    const auto two = load(path("two.las"));
    QVERIFY(two->findAttribute("A[0]") != nullptr && two->findAttribute("A[1]") == nullptr);
    QCOMPARE(two->findAttribute("A[2]")->number(7), double(std::to_integer<int>(three[7 * 23 + 22])));

    Bytes laz = lasfiles::lazFile(1, 28, lasfiles::randomRecords(1, 28, kCount, 5));
    const std::size_t begin = lasfiles::get<std::uint32_t>(laz, 96);
    const Bytes lax = lasfiles::record("LAStools", 30, Bytes(20));
    laz.insert(laz.begin() + std::ptrdiff_t(begin), lax.begin(), lax.end());
    lasfiles::set(laz, 96, std::uint32_t(begin + lax.size()));
    lasfiles::set(laz, 100, lasfiles::get<std::uint32_t>(laz, 100) + 1);
    lasfiles::set(laz, begin + lax.size(),
                  lasfiles::get<std::int64_t>(laz, begin + lax.size()) + std::int64_t(lax.size()));
    lasfiles::writeFile(path("index.laz"), laz);
    const auto indexed = load(path("index.laz"));
    QVERIFY(indexed->source()->findVlr("LAStools", 30) != nullptr && indexed->source()->warnings.empty());
    for (const char* name : {"left.laz", "left.las"}) {
        QVERIFY(hasNote(save(*indexed, path(name)), "LAX spatial index is left out"));
        QVERIFY(load(path(name))->source()->findVlr("LAStools", 30) == nullptr);
    }
}

void LasRecordsTest::addedAttributesKeepWhatTheySay()
{
    const std::size_t count = 20;
    lasfiles::writeFile(path("say.las"), lasfiles::file(lasfiles::header(2, 0, 20, count), {},
                                                        lasfiles::randomRecords(0, 20, count, 3)));
    const auto cloud = load(path("say.las"));
    Attribute depth;
    depth.name = "Height above the river's edge:\xC3\xBC\xC3\xBC";  // the 32nd byte is in the middle of a letter
    depth.name.insert(0, "+");
    depth.noData = std::int64_t(-9999);
    depth.columns[0] = cloud->addColumn(std::make_shared<Column>("Depth", ScalarType::I16, count));
    cloud->addAttribute(depth);
    Attribute blob;
    blob.name = "Blob";
    blob.kind = AttributeKind::Opaque;
    blob.columns[0] = cloud->addColumn(std::make_shared<Column>("Blob", ScalarType::U8, count, 300));
    for (std::size_t k = 0; k < count * 300; ++k) blob.columns[0]->data()[k] = std::byte(k % 251);
    cloud->addAttribute(blob);
    cloud->addColumn(std::make_shared<Column>("Bare", ScalarType::U8, count));  // no attribute shows it
    save(*cloud, path("said.laz"));
    const auto back = load(path("said.laz"));
    QVERIFY(back->source()->warnings.empty());
    const Attribute* const there = back->findAttribute(depth.name.substr(0, 31));
    QVERIFY(there != nullptr && there->noData == Value(std::int64_t(-9999)));
    QVERIFY(back->findAttribute("Bare") != nullptr);
    // more bytes than one description can cover: two
    const Attribute *const first = back->findAttribute("Blob"), *const rest = back->findAttribute("Blob#2");
    QVERIFY(first != nullptr && rest != nullptr);
    QCOMPARE(first->columns[0]->components(), 255u);
    QVERIFY(std::memcmp(first->columns[0]->data() + 255, blob.columns[0]->data() + 300, 255) == 0);
    QVERIFY(std::memcmp(rest->columns[0]->data() + 45, blob.columns[0]->data() + 300 + 255, 45) == 0);
}

void LasRecordsTest::sourcesAreMade()
{
    const std::vector<las::ExtraBytesField> many(342, {"V", ScalarType::U8, "", {}, {}});
    QVERIFY_EXCEPTION_THROWN(las::makeSource(6, many, {}, "", 1), Error);
    QVERIFY_EXCEPTION_THROWN(las::makeSource(11, {}, {}, "", 1), Error);
    QCOMPARE(las::makeSource(6, {}, {}, "no WKT", 1)->warnings.size(), std::size_t(1));
    // a coordinate system that is too long for an ordinary record
    const std::string wkt = "LOCAL_CS[\"here\",UNIT[\"metre\",1],REMARK[\"" + std::string(70'000, 'x') + "\"]]";
    const auto cloud = std::make_shared<PointCloud>(3, CoordinateScale{});
    const auto source = las::makeSource(6, {}, {}, wkt, 3);
    QVERIFY(source->vlrs.empty() && source->evlrs.size() == 1);
    las::makeColumns(*cloud, source->layout);
    cloud->setSource(source);
    save(*cloud, path("long wkt.las"));
    const auto written = load(path("long wkt.las"));
    const las::Vlr* const record = written->source()->findVlr("LASF_Projection", 2112);
    QVERIFY(record != nullptr && record->extended && record->data.size() == wkt.size() + 1);
}

void LasRecordsTest::manyAttributesGoIntoAnExtendedRecord()
{
    constexpr int kMany = 400;  // descriptors of 192 bytes: more than 65535
    for (const std::uint8_t minor : {std::uint8_t(2), std::uint8_t(4)}) {
        const fs::path in = path("few.las"), out = path("many.laz");
        fs::remove(out);
        lasfiles::writeFile(in, lasfiles::file(lasfiles::header(minor, 1, 28, kCount), {},
                                               lasfiles::randomRecords(1, 28, kCount, 5)));
        const auto cloud = load(in);
        for (int k = 0; k < kMany; ++k) {
            const auto values = addScalar<std::uint8_t>(*cloud, "Many" + std::to_string(k));
            for (std::size_t i = 0; i < kCount; ++i) values[i] = std::uint8_t(i * std::size_t(k));
        }
        if (minor == 2) {
            try {
                save(*cloud, out);
                QFAIL("written");
            } catch (const Error& e) {
                QVERIFY2(std::string(e.what()).find("LAS 1.4 can") != std::string::npos, e.what());
            }
            QVERIFY(!fs::exists(out));
            continue;
        }
        save(*cloud, out);
        const auto again = load(out);
        const auto records = again->source()->extraBytesRecords();
        QCOMPARE(records.size(), std::size_t(1));
        QVERIFY(records.front()->extended);
        for (const int k : {0, 1, 399}) {
            const Attribute* a = again->findAttribute("Many" + std::to_string(k));
            QVERIFY(a != nullptr);
            for (std::size_t i = 0; i < kCount; ++i)
                QCOMPARE(a->columns[0]->values<std::uint8_t>()[i], std::uint8_t(i * std::size_t(k)));
        }
    }
}

void LasRecordsTest::tileRecordsGoWithOtherPoints()
{
    const fs::path in = path("tile.las"), out = path("moved.las");
    lasfiles::writeFile(in, lasfiles::file(lasfiles::header(4, 6, 30, kCount),
                                           {lasfiles::record("LAStools", 10, Bytes(28)),
                                            lasfiles::record("LAStools", 20, Bytes(176)),
                                            lasfiles::record("somebody", 7, Bytes(5))},
                                           lasfiles::randomRecords(6, 30, kCount, 9)));
    const auto cloud = load(in);
    cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>()[1] ^= 1;
    QVERIFY(!hasNote(save(*cloud, out), "LAStools"));
    QCOMPARE(load(out)->source()->vlrs.size(), std::size_t(3));
    cloud->columns()[0]->values<std::int32_t>()[2] = INT32_MAX;
    QVERIFY(hasNote(save(*cloud, out), "LAStools' records"));
    const auto moved = load(out)->source();
    QCOMPARE(moved->vlrs.size(), std::size_t(1));
    QVERIFY(moved->findVlr("somebody", 7) != nullptr);
}

void LasRecordsTest::waveformsGoAlong_data()
{
    QTest::addColumn<QString>("ending");
    QTest::newRow("wdp") << QStringLiteral(".wdp");
    QTest::newRow("WDP") << QStringLiteral(".WDP");
}

void LasRecordsTest::waveformsGoAlong()
{
    QFETCH(QString, ending);
    const std::string end = ending.toStdString();
    const std::string name = "wave" + end.substr(1);
    Bytes head = lasfiles::header(3, 4, 57, kCount);
    lasfiles::set<std::uint16_t>(head, 6, 4);  // the packets are in a file of their own
    const fs::path in = path(name + ".las");
    lasfiles::writeFile(in, lasfiles::file(head, {}, lasfiles::randomRecords(4, 57, kCount, 11)));
    Bytes packets(100'000);
    for (std::size_t k = 0; k < packets.size(); ++k) packets[k] = std::byte(k * 7);
    lasfiles::writeFile(path(name + end), packets);
    const auto cloud = load(in);

    const fs::path out = path(name + "copy.laz"), copied = path(name + "copy" + end);
    QVERIFY(hasNote(save(*cloud, out), "waveforms were copied"));
    QVERIFY(lasfiles::readFile(copied) == packets);
    // over the same file again: they are there
    QVERIFY(!hasNote(save(*cloud, out), "waveforms"));
    // beside packets of another file: those stay
    const Bytes others(10, std::byte(1));
    lasfiles::writeFile(path(name + "new" + end), others);
    QVERIFY(hasNote(save(*cloud, path(name + "new.las")), "were not copied"));
    QVERIFY(lasfiles::readFile(path(name + "new" + end)) == others);
    // a save that fails leaves none behind
    fs::create_directory(path(name + "taken.las"));
    try {
        save(*cloud, path(name + "taken.las"));
        QFAIL("written");
    } catch (const Error&) {
    }
    QVERIFY(!fs::exists(path(name + "taken" + end)));
}

QTEST_GUILESS_MAIN(LasRecordsTest)
#include "LasRecordsTest.moc"
