// SPDX-License-Identifier: MIT
#include "core/Text.h"
#include "core/edit/Command.h"
#include "core/las/GeoKeys.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

/// Saving what the file's own point format cannot hold.
class LasUpgradeTest : public QObject
{
    Q_OBJECT

private slots:
    void highClassesNeedAnotherFormat_data();
    void highClassesNeedAnotherFormat();
    void lowClassesFoldBack();
    void addedFieldsNeedAnotherFormat_data();
    void addedFieldsNeedAnotherFormat();
    void oddColumnsStayExtraBytes();
    void askedFormatIsKeptOrRefused();
    void geoTiffBecomesWkt_data();
    void geoTiffBecomesWkt();
    void geoTiffThatCannotBeTranslatedStays_data();
    void geoTiffThatCannotBeTranslatedStays();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    std::shared_ptr<PointCloud> make(std::uint8_t format, const Bytes& points, std::uint16_t length,
                                     const std::vector<Bytes>& vlrs = {}) const
    {
        lasfiles::writeFile(temp("in.las"), lasfiles::file(lasfiles::header(lasfiles::minorFor(format), format,
                                                                            length, points.size() / length),
                                                           vlrs, points));
        return load(temp("in.las"));
    }
    static las::WriteReport save(const PointCloud& cloud, const fs::path& path, bool upgrade)
    {
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(path);
        options.upgrade = upgrade;
        return las::write(cloud, path, options, progress);
    }
    /// A file of format 1 with such records, written in the format that wants WKT.
    las::WriteReport saveAsFormat6(const std::string& name, const std::vector<Bytes>& vlrs) const
    {
        Progress progress;
        las::WriteOptions options;
        options.pointFormat = 6;
        return las::write(*make(1, lasfiles::randomRecords(1, 28, 10, 1), 28, vlrs), temp(name), options, progress);
    }
    /// What write() would ask; fails the test when it asks nothing.
    static las::WriteQuestion question(const PointCloud& cloud, const fs::path& path)
    {
        try {
            save(cloud, path, false);
        } catch (const las::WriteQuestion& q) {
            if (fs::exists(path)) throw std::runtime_error("something was written");
            return q;
        }
        throw std::runtime_error("no question");
    }
    static bool hasNote(const las::WriteReport& report, const std::string& part)
    {
        return std::any_of(report.notes.begin(), report.notes.end(),
                           [&](const std::string& n) { return n.find(part) != std::string::npos; });
    }

    QTemporaryDir m_dir;
};

namespace
{

std::unique_ptr<Command> reclassify(PointCloud& cloud, const std::string& text)
{
    Progress progress;
    const ParsedStep parsed = parseStep(text);
    auto command = parsed.step->run(cloud, parsed.values, progress);
    command->apply(cloud);
    return command;
}

/// A record of GeoTIFF keys: id and value in turn, all short.
Bytes geoKeys(const QList<int>& keys)
{
    const auto count = std::size_t(keys.size()) / 2;
    Bytes b(8 + 8 * count);
    lasfiles::set<std::uint16_t>(b, 0, 1);
    lasfiles::set<std::uint16_t>(b, 2, 1);
    lasfiles::set<std::uint16_t>(b, 6, std::uint16_t(count));
    for (std::size_t k = 0; k < count; ++k) {
        lasfiles::set<std::uint16_t>(b, 8 + 8 * k, std::uint16_t(keys[2 * k]));
        lasfiles::set<std::uint16_t>(b, 12 + 8 * k, 1);
        lasfiles::set<std::uint16_t>(b, 14 + 8 * k, std::uint16_t(keys[2 * k + 1]));
    }
    return b;
}

constexpr std::size_t kCount = 3000;

}  // namespace

void LasUpgradeTest::highClassesNeedAnotherFormat_data()
{
    QTest::addColumn<int>("from");
    QTest::addColumn<int>("to");
    const int formats[][2] = {{0, 6}, {1, 6}, {2, 7}, {3, 7}, {4, 9}, {5, 10}};
    for (const auto& f : formats) QTest::addRow("%d", f[0]) << f[0] << f[1];
}

void LasUpgradeTest::highClassesNeedAnotherFormat()
{
    QFETCH(int, from);
    QFETCH(int, to);
    const auto f = std::uint8_t(from), t = std::uint8_t(to);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + 5);
    const Bytes points = lasfiles::randomRecords(f, length, kCount, std::uint32_t(from));
    const auto cloud = make(f, points, length);
    const auto command = reclassify(*cloud, "reclassify attribute=UserData min=0 max=99 class=64");
    const std::string count = grouped(command->changedPoints());
    for (const char* name : {"up.las", "up.laz"}) {
        const fs::path path = temp(name);
        fs::remove(path);
        const las::WriteQuestion q = question(*cloud, path);
        QCOMPARE(q.kind(), las::WriteQuestion::Kind::Upgrade);
        QVERIFY2(std::string(q.what()).find(count + " points have a class above 31") != std::string::npos,
                 q.what());
        QCOMPARE(q.becomes(), "point format " + std::to_string(to) + " of LAS 1.4");
        const auto report = save(*cloud, path, true);
        QVERIFY(hasNote(report, "point format " + std::to_string(to)));
        QCOMPARE(hasNote(report, "GPS time"), from == 0 || from == 2);
        QCOMPARE(hasNote(report, "near infrared"), from == 5);

        const auto newLength = std::uint16_t(lasfiles::recordLength(t) + 5);
        const Bytes written = lasfiles::recordsByLaszip(path, t, newLength, kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            const std::byte *was = points.data() + i * length, *is = written.data() + i * newLength;
            const auto old = std::to_integer<unsigned>(was[15]), now = std::to_integer<unsigned>(is[16]);
            const unsigned user = std::to_integer<unsigned>(was[17]);
            QCOMPARE(now, user <= 99 ? 64u : old & 31u);
            QCOMPARE(std::to_integer<unsigned>(is[15]) & 7u, old >> 5);  // synthetic, key point, withheld
            QCOMPARE((std::to_integer<unsigned>(is[15]) >> 3) & 1u, now == 12 ? 1u : 0u);
            QVERIFY(std::memcmp(was, is, 14) == 0);
            QVERIFY(std::memcmp(was + length - 5, is + newLength - 5, 5) == 0);
        }
        const auto header = las::Reader::open(path)->source()->header;
        QCOMPARE(header.version(), std::string("1.4"));
        QCOMPARE(header.get(las::at::kLegacyCount), 0u);
        QCOMPARE(header.get(las::at::kPointCount), std::uint64_t(kCount));
    }
    // undone, the file is what it was
    command->apply(*cloud);
    save(*cloud, temp("back.las"), false);
    QVERIFY(lasfiles::readFile(temp("back.las")) == lasfiles::readFile(temp("in.las")));
}

void LasUpgradeTest::lowClassesFoldBack()
{
    // widened, then all high classes lowered: the format holds it again, and flags beside the class stay
    Bytes points = lasfiles::randomRecords(1, 28, kCount, 9);
    const auto cloud = make(1, points, 28);
    const auto up = reclassify(*cloud, "reclassify attribute=UserData min=0 max=99 class=64");
    const auto down = reclassify(*cloud, "reclassify attribute=Classification min=64 max=64 class=6");
    for (std::size_t i = 0; i < kCount; ++i)
        if (std::to_integer<unsigned>(points[i * 28 + 17]) <= 99)
            points[i * 28 + 15] = (points[i * 28 + 15] & std::byte(0xE0)) | std::byte(6);
    for (const char* name : {"low.las", "low.laz"}) {
        const auto report = save(*cloud, temp(name), false);
        QVERIFY(report.notes.empty());
        QVERIFY(lasfiles::recordsByLaszip(temp(name), 1, 28, kCount) == points);
    }
}

void LasUpgradeTest::addedFieldsNeedAnotherFormat_data()
{
    QTest::addColumn<int>("from");
    QTest::addColumn<int>("to");
    QTest::addColumn<QString>("added");
    const auto row = [](int from, int to, const char* added) {
        QTest::addRow("%d and %s", from, added) << from << to << QString(added);
    };
    row(0, 2, "color");
    row(1, 3, "color");
    row(4, 5, "color");
    row(6, 7, "color");
    row(9, 10, "color");
    row(0, 1, "time");
    row(2, 3, "time");
    row(0, 3, "color time");
    row(3, 8, "nir");
    row(6, 8, "nir");
    row(7, 8, "nir");
    row(9, 10, "nir");
    row(1, 8, "color nir");
}

void LasUpgradeTest::addedFieldsNeedAnotherFormat()
{
    QFETCH(int, from);
    QFETCH(int, to);
    QFETCH(QString, added);
    const auto f = std::uint8_t(from), t = std::uint8_t(to);
    const std::uint16_t length = lasfiles::recordLength(f);
    const auto cloud = make(f, lasfiles::randomRecords(f, length, kCount, 1), length);
    std::vector<std::string> names;
    if (added.contains("color")) names = {"Red", "Green", "Blue"};
    if (added.contains("nir")) names.push_back("NIR");
    for (const std::string& name : names) {
        const auto values = addScalar<std::uint16_t>(*cloud, name);
        for (std::size_t i = 0; i < kCount; ++i) values[i] = std::uint16_t(i * 7 + name.size());
    }
    if (added.contains("time")) {
        const auto values = addScalar<double>(*cloud, "GpsTime");
        for (std::size_t i = 0; i < kCount; ++i) values[i] = double(i) * 0.1;
        names.push_back("GpsTime");
    }
    const fs::path path = temp("added.laz");
    fs::remove(path);
    const las::WriteQuestion q = question(*cloud, path);
    QVERIFY(std::string(q.what()).find("added") != std::string::npos);
    const auto report = save(*cloud, path, true);
    QVERIFY(!hasNote(report, "extra bytes"));
    const auto back = load(path);
    QCOMPARE(int(back->source()->layout.format), to);
    QCOMPARE(back->source()->layout.length, lasfiles::recordLength(t));
    for (const std::string& name : names)
        for (std::size_t i = 0; i < kCount; i += 11)
            QCOMPARE(back->findAttribute(name)->number(i), cloud->findAttribute(name)->number(i));
    if (added.contains("color")) QVERIFY(back->findAttribute("RGB") != nullptr);
}

void LasUpgradeTest::oddColumnsStayExtraBytes()
{
    // a Red that is no standard color, and colors without blue
    const auto cloud = make(1, lasfiles::randomRecords(1, 28, kCount, 1), 28);
    addScalar<float>(*cloud, "Red");
    addScalar<std::uint16_t>(*cloud, "Green");
    const auto report = save(*cloud, temp("odd.las"), false);
    QVERIFY(hasNote(report, "Stored as extra bytes: Red, Green."));
    QCOMPARE(int(load(temp("odd.las"))->source()->layout.format), 1);
}

void LasUpgradeTest::askedFormatIsKeptOrRefused()
{
    const auto cloud = make(1, lasfiles::randomRecords(1, 28, kCount, 1), 28);
    const auto command = reclassify(*cloud, "reclassify attribute=UserData min=0 max=99 class=64");
    Progress progress;
    las::WriteOptions options;
    options.upgrade = true;
    options.pointFormat = 3;
    try {
        las::write(*cloud, temp("asked.las"), options, progress);
        QFAIL("classes were cut");
    } catch (const las::WriteQuestion& e) {
        QVERIFY(e.kind() == las::WriteQuestion::Kind::Lossy);  // not an upgrade: another format was asked for
        QVERIFY2(std::string(e.what()).find("class above 31") != std::string::npos, e.what());
    }
    options.pointFormat = 8;  // more than is needed
    las::write(*cloud, temp("asked.las"), options, progress);
    QCOMPARE(int(load(temp("asked.las"))->source()->layout.format), 8);
    // a version that the needed format does not have
    options.pointFormat.reset();
    options.versionMinor = 2;
    QVERIFY_EXCEPTION_THROWN(las::write(*cloud, temp("asked2.las"), options, progress), Error);
    QVERIFY(!fs::exists(temp("asked2.las")));
}

void LasUpgradeTest::geoTiffBecomesWkt_data()
{
    QTest::addColumn<QList<int>>("keys");
    QTest::addColumn<QString>("inWkt");
    QTest::addColumn<QString>("unit");
    QTest::newRow("projected") << QList<int>{1024, 1, 3072, 26910, 3076, 9001} << R"(PROJCS["NAD83 / UTM zone 10N")"
                               << "m";
    QTest::newRow("feet") << QList<int>{1024, 1, 3072, 2994, 3076, 9002} << R"(AUTHORITY["EPSG","2994"])"
                          << "ft";
    QTest::newRow("geographic") << QList<int>{1024, 2, 2048, 4326, 4099, 9001} << R"(GEOGCS["WGS 84")"
                                << "deg";
    QTest::newRow("with heights") << QList<int>{1024, 1, 3072, 26910, 4096, 5703, 4099, 9001}
                                  << R"(VERT_CS["NAVD88 height")"
                                  << "m";
    QTest::newRow("heights of old") << QList<int>{1024, 1, 3072, 26910, 4096, 5103, 4099, 9003}
                                    << R"(AUTHORITY["EPSG","6360"])"
                                    << "m";
}

void LasUpgradeTest::geoTiffBecomesWkt()
{
    QFETCH(QList<int>, keys);
    QFETCH(QString, inWkt);
    QFETCH(QString, unit);
    const auto report = saveAsFormat6(
        "wkt.las",
        {lasfiles::record("other", 1, Bytes(3)), lasfiles::record("LASF_Projection", 34735, geoKeys(keys)),
         lasfiles::record("LASF_Projection", 34736, Bytes(8)), lasfiles::record("LASF_Projection", 34737, Bytes(8)),
         lasfiles::record("last", 2, Bytes(1))});
    QVERIFY(hasNote(report, "translated from GeoTIFF keys to WKT"));
    const auto source = las::Reader::open(temp("wkt.las"))->source();
    QCOMPARE(source->header.globalEncoding() & 16, 16);
    QCOMPARE(source->vlrs.size(), std::size_t(3));
    QVERIFY(source->vlrs[1].is("LASF_Projection", 2112));
    const auto& data = source->vlrs[1].data;
    QCOMPARE(data.back(), std::byte(0));
    const QString wkt = QString::fromUtf8(reinterpret_cast<const char*>(data.data()));
    QVERIFY2(wkt.contains(inWkt), qPrintable(wkt));
    QVERIFY(!wkt.contains('\n'));
    QCOMPARE(QString::fromStdString(source->layout.attributes[0].unit), unit);
    QVERIFY(source->warnings.empty());
}

void LasUpgradeTest::geoTiffThatCannotBeTranslatedStays_data()
{
    QTest::addColumn<QList<int>>("keys");
    QTest::newRow("user-defined") << QList<int>{1024, 1, 3072, 32767};
    QTest::newRow("no such code") << QList<int>{1024, 1, 3072, 29};
    QTest::newRow("no code") << QList<int>{1024, 1};
    QTest::newRow("another unit") << QList<int>{1024, 1, 3072, 26910, 3076, 9002};
    QTest::newRow("no such heights") << QList<int>{1024, 1, 3072, 26910, 4096, 32767};
    QTest::newRow("heights in another unit") << QList<int>{1024, 1, 3072, 26910, 4099, 9002};
    QTest::newRow("heights that are a plane") << QList<int>{1024, 1, 3072, 26910, 4096, 26910};
    QTest::newRow("a geographic one that is projected") << QList<int>{1024, 2, 2048, 26910};
}

void LasUpgradeTest::geoTiffThatCannotBeTranslatedStays()
{
    QFETCH(QList<int>, keys);
    const Bytes record = geoKeys(keys);
    const auto report = saveAsFormat6("keys.las", {lasfiles::record("LASF_Projection", 34735, record)});
    QVERIFY(hasNote(report, "stays in GeoTIFF keys"));
    const auto source = las::Reader::open(temp("keys.las"))->source();
    QCOMPARE(source->header.globalEncoding() & 16, 0);
    QCOMPARE(source->vlrs.size(), std::size_t(1));
    QVERIFY(source->vlrs[0].data == record);
}

QTEST_GUILESS_MAIN(LasUpgradeTest)
#include "LasUpgradeTest.moc"
