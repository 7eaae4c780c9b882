// SPDX-License-Identifier: MIT
#include "core/las/Crs.h"

#include "core/edit/Extract.h"
#include "core/las/HeaderWords.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"

#include <glm/geometric.hpp>

#include <QTemporaryDir>
#include <QTest>

#include <cmath>
#include <cstdlib>
#include <filesystem>

using namespace punctum;
using lasfiles::Bytes;
using Kind = CoordinateUnits::Kind;

namespace
{

const QByteArray kDatum = R"(DATUM["D",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0])";

QByteArray geographic(const QByteArray& unit = R"(UNIT["degree",0.0174532925199433])")
{
    return "GEOGCS[\"NAD83\"," + kDatum + "," + unit + "]";
}

QByteArray projectedIn(const QByteArray& unit)
{
    return "PROJCS[\"x\"," + geographic() + ",PROJECTION[\"Transverse_Mercator\"]," + unit + "]";
}

QByteArray compound(const QByteArray& horizontal, const QByteArray& heightUnit)
{
    return "COMPD_CS[\"both\"," + horizontal + ",VERT_CS[\"heights\",VERT_DATUM[\"v\",2005]," + heightUnit + "]]";
}

const QByteArray kMetre = R"(UNIT["metre",1])", kFoot = R"(UNIT["foot",0.3048])",
                 kSurveyFoot = R"(UNIT["US survey foot",0.3048006096012192])";

/// A file of two points whose records say the coordinate system.
struct Stated {
    QByteArray wkt;               ///< bytes of the record; none when empty
    QList<int> keys;              ///< GeoTIFF: id and value of each; none when empty
    std::vector<double> doubles;  ///< a value of a key above 100,000 is the place among these
    QByteArray ascii;
    bool announced = true;  ///< the WKT
    glm::dvec3 scale{0.01}, offset{0};
    std::array<std::int32_t, 6> points{0, 0, 0, 100000, 100000, 1000};
};

Bytes bytesOf(const QByteArray& text)
{
    Bytes bytes(std::size_t(text.size()));
    if (!bytes.empty()) std::memcpy(bytes.data(), text.constData(), bytes.size());
    return bytes;
}

}  // namespace

class CrsTest : public QObject
{
    Q_OBJECT

private:
    std::shared_ptr<PointCloud> open(const Stated& stated)
    {
        std::vector<Bytes> vlrs;
        if (!stated.wkt.isEmpty()) vlrs.push_back(lasfiles::record("LASF_Projection", 2112, bytesOf(stated.wkt)));
        if (!stated.keys.isEmpty()) {
            std::vector<std::uint16_t> words{1, 1, 0, std::uint16_t(stated.keys.size() / 2)};
            for (int k = 0; k + 1 < stated.keys.size(); k += 2) {
                const int value = stated.keys[k + 1];
                const bool text = value < 0, real = value >= 100000;
                words.push_back(std::uint16_t(stated.keys[k]));
                words.push_back(std::uint16_t(text ? 34737 : real ? 34736 : 0));
                // -1: up to the first bar, -2: what follows it
                const auto bar = stated.ascii.indexOf('|') + 1;
                words.push_back(std::uint16_t(!text ? 1 : value == -1 ? bar : stated.ascii.size() - bar));
                words.push_back(std::uint16_t(text ? (value == -1 ? 0 : bar) : real ? value - 100000 : value));
            }
            Bytes data(words.size() * 2);
            std::memcpy(data.data(), words.data(), data.size());
            vlrs.push_back(lasfiles::record("LASF_Projection", 34735, data));
        }
        if (!stated.doubles.empty()) {
            Bytes data(stated.doubles.size() * 8);
            std::memcpy(data.data(), stated.doubles.data(), data.size());
            vlrs.push_back(lasfiles::record("LASF_Projection", 34736, data));
        }
        if (!stated.ascii.isEmpty())
            vlrs.push_back(lasfiles::record("LASF_Projection", 34737, bytesOf(stated.ascii)));
        Bytes head = lasfiles::header(4, 1, 28, 2), points(56);
        lasfiles::set<std::uint16_t>(head, 6, stated.announced ? 16 : 0);
        for (std::size_t k = 0; k < 3; ++k) {
            lasfiles::set<double>(head, 131 + 8 * k, stated.scale[int(k)]);
            lasfiles::set<double>(head, 155 + 8 * k, stated.offset[int(k)]);
            lasfiles::set(points, 4 * k, stated.points[k]);
            lasfiles::set(points, 28 + 4 * k, stated.points[3 + k]);
        }
        const auto path = std::filesystem::path(m_dir.path().toStdString()) / "crs.las";
        lasfiles::writeFile(path, lasfiles::file(head, vlrs, points));
        Progress progress;
        const auto reader = las::Reader::open(path);
        auto cloud = reader->createCloud();
        reader->read(*cloud, progress);
        return cloud;
    }

    QTemporaryDir m_dir;

private slots:
    void lengthsAreTrue();
    void wkt_data();
    void wkt();
    void geoTiff_data();
    void geoTiff();
    void whatCannotBeUnderstood_data();
    void whatCannotBeUnderstood();
    void whatLooksLikeDegrees();
    void geocentricHasNoHeights();
    void partsKeepTheirUnits();
    void realFiles_data();
    void realFiles();
    void withoutTheDatabase();
};

void CrsTest::lengthsAreTrue()
{
    const struct {
        double latitude, along, across;
    } table[] = {{0, 110574, 111320}, {45, 111132, 78847}, {60, 111412, 55800}, {-60, 111412, 55800}};
    const CoordinateUnits degrees = CoordinateUnits::degreesAndMeters();
    for (const auto& row : table) {
        const TrueLengths t = trueLengths(degrees, {{7, row.latitude - 1, 0}, {9, row.latitude + 1, 10}});
        QVERIFY(std::abs(t.stretch.y - row.along) < 1 && std::abs(t.stretch.x - row.across) < 1);
        QVERIFY(t.stretch.z == 1.0 && t.unit == "m" && t.meters == 1.0);
    }
    const WorldBounds box{{-94.5, 44.99, 100}, {-94.49, 45.01, 150}};
    const auto lengths = [&](const char* across, double acrossMeters, const char* up, double upMeters) {
        return trueLengths({Kind::Lengths, across, up, acrossMeters, upMeters, false}, box);
    };
    QCOMPARE(lengths("m", 1, "m", 1).stretch, glm::dvec3(1));
    QCOMPARE(lengths("m", 1, "ft", 0.3048).stretch, glm::dvec3(1, 1, 0.3048));
    QCOMPARE(lengths("ft", 0.3048, "ft", 0.3048).stretch, glm::dvec3(1));
    QVERIFY(lengths("ft", 0.3048, "m", 1).unit == "ft");
    QVERIFY(std::abs(lengths("ft", 0.3048, "m", 1).stretch.z - 3.280839895) < 1e-9);
    QCOMPARE(lengths("ft", 0.3048, "", 0).stretch, glm::dvec3(1));
    CoordinateUnits feetUp = degrees;
    feetUp.verticalSize = 0.3048;
    QCOMPARE(trueLengths(feetUp, box).stretch.z, 0.3048);
    QVERIFY(trueLengths(degrees, {{0, -1e6, 0}, {1, 1e6, 1}}).stretch.x > 0);  // no latitudes
    QVERIFY(trueLengths(CoordinateUnits{}, box) == TrueLengths{});             // nothing known: nothing stretched
    QCOMPARE(las::unitsText({}), std::string("not known"));
    QCOMPARE(las::unitsText(degrees), std::string("deg, heights in m"));
    QCOMPARE(las::unitsText({Kind::Lengths, "m", "m", 1, 1, false}), std::string("m"));
    for (const auto& [meters, name] : {std::pair(1.0, "m"),
                                       {0.3048, "ft"},
                                       {1200.0 / 3937.0, "ftUS"},
                                       {0.304801, "ftUS"},
                                       {1000.0, "km"},
                                       {0.9144, "yard"}})
        QCOMPARE(QString::fromStdString(lengthName(meters, "yard")), QString(name));
}

void CrsTest::wkt_data()
{
    QTest::addColumn<QByteArray>("wkt");
    QTest::addColumn<int>("kind");
    QTest::addColumn<QString>("horizontal");
    QTest::addColumn<QString>("vertical");
    const auto row = [](const char* name, const QByteArray& wkt, Kind kind, const char* horizontal,
                        const char* vertical) {
        QTest::newRow(name) << wkt << int(kind) << QString(horizontal) << QString(vertical);
    };
    row("meters", projectedIn(kMetre), Kind::Lengths, "m", "m");
    row("feet", projectedIn(kFoot), Kind::Lengths, "ft", "ft");
    row("survey feet", projectedIn(kSurveyFoot), Kind::Lengths, "ftUS", "ftUS");
    row("other lengths", projectedIn(R"(UNIT["Clarke's link",0.201166195164])"), Kind::Lengths, "Clarke's link",
        "Clarke's link");
    row("degrees", geographic(), Kind::Degrees, "deg", "m");
    row("gons", geographic(R"(UNIT["grad",0.015707963267949])"), Kind::Degrees, "grad", "m");
    row("meters and feet", compound(projectedIn(kMetre), kSurveyFoot), Kind::Lengths, "m", "ftUS");
    row("degrees and feet", compound(geographic(), kFoot), Kind::Degrees, "deg", "ft");
    row("heights alone", "VERT_CS[\"heights\",VERT_DATUM[\"v\",2005]," + kFoot + "]", Kind::Unknown, "", "ft");
    row("local", "LOCAL_CS[\"site\",LOCAL_DATUM[\"d\",0]," + kFoot + ",AXIS[\"E\",EAST],AXIS[\"N\",NORTH]]",
        Kind::Lengths, "ft", "ft");
    row("geocentric", "GEOCCS[\"WGS 84\"," + kDatum + "," + kMetre + "]", Kind::Geocentric, "m", "m");
    const QByteArray datum2 = R"(DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]])";
    row("WKT2 geocentric",
        "GEODCRS[\"WGS 84\"," + datum2 +
            R"x(,CS[Cartesian,3],AXIS["(X)",geocentricX],AXIS["(Y)",geocentricY],AXIS["(Z)",geocentricZ],)x"
            R"(LENGTHUNIT["metre",1]])",
        Kind::Geocentric, "m", "m");
    row("WKT2 in three dimensions",
        "GEOGCRS[\"WGS 84\"," + datum2 +
            R"(,CS[ellipsoidal,3],AXIS["latitude",north,ANGLEUNIT["degree",0.0174532925199433]],)"
            R"(AXIS["longitude",east,ANGLEUNIT["degree",0.0174532925199433]],)"
            R"(AXIS["height",up,LENGTHUNIT["foot",0.3048]]])",
        Kind::Degrees, "deg", "ft");
    row("with a shift",
        "PROJCS[\"x\",GEOGCS[\"g\",DATUM[\"D\",SPHEROID[\"GRS 1980\",6378137,298.257222101],"
        "TOWGS84[1,2,3,0,0,0,0]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
        "PROJECTION[\"Transverse_Mercator\"]," +
            kFoot + "]",
        Kind::Lengths, "ft", "ft");
    row("blanks before brackets", projectedIn(kSurveyFoot).replace('[', " \n["), Kind::Lengths, "ftUS", "ftUS");
    row("small letters", projectedIn(kSurveyFoot).replace("PROJCS", "projcs"), Kind::Lengths, "ftUS", "ftUS");
    row("round brackets", projectedIn(kSurveyFoot).replace('[', '(').replace(']', ')'), Kind::Lengths, "ftUS",
        "ftUS");
    row("byte order mark", "\xEF\xBB\xBF" + projectedIn(kFoot), Kind::Lengths, "ft", "ft");
    row("blanks about it", " \r\n" + projectedIn(kFoot) + "\n ", Kind::Lengths, "ft", "ft");
    row("rubbish after the NUL", projectedIn(kFoot) + QByteArray("\0\xfe\x01", 3), Kind::Lengths, "ft", "ft");
}

void CrsTest::wkt()
{
    QFETCH(QByteArray, wkt);
    QFETCH(int, kind);
    QFETCH(QString, horizontal);
    QFETCH(QString, vertical);
    Stated stated;
    stated.wkt = wkt + '\0';
    if (Kind(kind) == Kind::Geocentric) stated.offset.x = 6378000;
    const auto cloud = open(stated);
    QCOMPARE(int(cloud->units().kind), kind);
    QCOMPARE(QString::fromStdString(cloud->units().horizontal), horizontal);
    QCOMPARE(QString::fromStdString(cloud->units().vertical), vertical);
    QCOMPARE(QString::fromStdString(cloud->findAttribute("X")->unit), horizontal);
    QCOMPARE(QString::fromStdString(cloud->findAttribute("Z")->unit), vertical);
    QCOMPARE(cloud->source()->warnings.size(), std::size_t(Kind(kind) == Kind::Geocentric ? 1 : 0));
    QVERIFY(!cloud->source()->crs.empty() && cloud->source()->crs.find('\0') == std::string::npos);
}

void CrsTest::geoTiff_data()
{
    QTest::addColumn<QList<int>>("keys");
    QTest::addColumn<QString>("text");
    QTest::addColumn<int>("kind");
    QTest::addColumn<QString>("horizontal");
    QTest::addColumn<QString>("vertical");
    QTest::addColumn<int>("warnings");
    const auto row = [](const char* name, const QList<int>& keys, const char* text, Kind kind,
                        const char* horizontal, const char* vertical, int warnings = 0) {
        QTest::newRow(name) << keys << QString(text) << int(kind) << QString(horizontal) << QString(vertical)
                            << warnings;
    };
    row("meters by code", {1024, 1, 3072, 26910}, "EPSG:26910", Kind::Lengths, "m", "m");
    row("survey feet by code", {1024, 1, 3072, 2926}, "EPSG:2926", Kind::Lengths, "ftUS", "ftUS");
    row("feet by code", {1024, 1, 3072, 2994}, "EPSG:2994", Kind::Lengths, "ft", "ft");
    row("only the code", {3072, 2949}, "EPSG:2949", Kind::Lengths, "m", "m");
    row("degrees", {1024, 2, 2048, 4326}, "EPSG:4326", Kind::Degrees, "deg", "m");
    row("only the geographic code", {2048, 4326}, "EPSG:4326", Kind::Degrees, "deg", "m");
    row("gons by code", {1024, 2, 2048, 4807}, "EPSG:4807", Kind::Degrees, "grad", "m");
    row("units against the code", {1024, 1, 3072, 26910, 3076, 9003}, "EPSG:26910", Kind::Lengths, "ftUS", "ftUS",
        1);
    row("heights in feet", {1024, 1, 3072, 26910, 4099, 9002}, "EPSG:26910", Kind::Lengths, "m", "ft");
    row("heights by code", {1024, 1, 3072, 26910, 4096, 6360}, "EPSG:26910", Kind::Lengths, "m", "ftUS");
    row("heights of a datum", {1024, 1, 3072, 2263, 4096, 5103}, "EPSG:2263", Kind::Lengths, "ftUS", "m");
    row("user-defined, coded unit", {1024, 1, 3072, 32767, 3076, 9003, 3073, -1}, "here", Kind::Lengths, "ftUS",
        "ftUS");
    row("user-defined unit", {1024, 1, 3072, 32767, 3076, 32767, 3077, 100001}, "", Kind::Lengths,
        "user-defined unit", "user-defined unit");
    row("user-defined, no unit", {1024, 1, 3072, 32767, 1026, -1}, "here", Kind::Unknown, "", "");
    row("no such unit", {1024, 1, 3076, 32632, 4099, 9001}, "", Kind::Unknown, "", "m");
    row("no such system", {1024, 1, 3072, 29}, "EPSG:29", Kind::Unknown, "", "", 1);
    row("names nothing", {1024, 1}, "", Kind::Unknown, "", "");
    row("WKT in a citation", {1024, 1, 3072, 32767, 3073, -2}, "ESRI PE String = PROJCS[\"x\"", Kind::Lengths, "ft",
        "ft");
}

void CrsTest::geoTiff()
{
    QFETCH(QList<int>, keys);
    QFETCH(QString, text);
    QFETCH(int, kind);
    QFETCH(QString, horizontal);
    QFETCH(QString, vertical);
    QFETCH(int, warnings);
    Stated stated;
    stated.keys = keys;
    stated.doubles = {5.0, 0.5};
    stated.ascii = "here|ESRI PE String = " + projectedIn(kFoot) + "|";
    for (const bool announced : {false, true}) {  // announced: WKT, which is not there
        stated.announced = announced;
        const auto cloud = open(stated);
        QCOMPARE(QString::fromStdString(cloud->source()->crs).section(" (", 0, 0).section(",", 0, 0), text);
        QCOMPARE(int(cloud->units().kind), kind);
        QCOMPARE(QString::fromStdString(cloud->units().horizontal), horizontal);
        QCOMPARE(QString::fromStdString(cloud->units().vertical), vertical);
        QCOMPARE(int(cloud->source()->warnings.size()), warnings);
    }
    if (horizontal == "user-defined unit") QCOMPARE(open(stated)->units().horizontalSize, 0.5);
}

void CrsTest::whatCannotBeUnderstood_data()
{
    QTest::addColumn<QByteArray>("wkt");
    QTest::addColumn<QList<int>>("keys");
    QTest::addColumn<QString>("horizontal");
    QTest::addColumn<QString>("warning");
    QTest::newRow("nothing") << QByteArray() << QList<int>() << ""
                             << "";
    QTest::newRow("one NUL") << QByteArray(1, '\0') << QList<int>() << ""
                             << "";
    QTest::newRow("blanks") << QByteArray(" \n\0", 3) << QList<int>() << ""
                            << "";
    QTest::newRow("one NUL and keys") << QByteArray(1, '\0') << QList<int>{1024, 1, 3072, 2263} << "ftUS"
                                      << "";
    QTest::newRow("three letters") << QByteArray("abc") << QList<int>() << ""
                                   << "cannot be understood";
    QTest::newRow("random") << QByteArray(60000, '\x9c') << QList<int>() << ""
                            << "cannot be understood";
    QTest::newRow("no datum") << QByteArray(R"(GEOGCS["WGS 84",UNIT["degree",0.0174]])") << QList<int>() << ""
                              << "DATUM";
    QTest::newRow("no datum, but keys")
        << QByteArray(R"(GEOGCS["WGS 84",UNIT["degree",0.0174]])") << QList<int>{1024, 1, 3072, 2263} << "ftUS"
        << "keys are used";
    QTest::newRow("no system") << QByteArray(R"(ELLIPSOID["WGS 84",6378137,298.257223563])") << QList<int>() << ""
                               << "cannot be understood";
    QTest::newRow("deep") << QByteArray("PROJCS[").repeated(8000) << QList<int>() << ""
                          << "cannot be understood";
}

void CrsTest::whatCannotBeUnderstood()
{
    QFETCH(QByteArray, wkt);
    QFETCH(QList<int>, keys);
    QFETCH(QString, horizontal);
    QFETCH(QString, warning);
    Stated stated;
    stated.wkt = wkt;
    stated.keys = keys;
    const auto cloud = open(stated);
    QCOMPARE(QString::fromStdString(cloud->units().horizontal), horizontal);
    const auto& warnings = cloud->source()->warnings;
    QCOMPARE(warnings.size(), std::size_t(warning.isEmpty() ? 0 : 1));
    if (!warning.isEmpty())
        QVERIFY2(QString::fromStdString(warnings[0]).contains(warning) && warnings[0].back() == '.',
                 warnings[0].c_str());
}

void CrsTest::whatLooksLikeDegrees()
{
    Stated survey;  // 1 km by 1 km at 48 degrees north
    survey.scale = {1e-7, 1e-7, 0.01};
    survey.offset = {11.5, 48.1, 500};
    survey.points = {0, 0, 0, 130000, 90000, 1500};
    const auto cloud = open(survey);
    QVERIFY(cloud->units().guessed && cloud->units().kind == Kind::Degrees);
    QVERIFY(cloud->source()->crs.empty());
    QCOMPARE(cloud->source()->warnings.size(), std::size_t(1));
    QVERIFY(cloud->source()->warnings[0].find("look like degrees") != std::string::npos);
    const TrueLengths lengths = trueLengths(*cloud);
    const glm::dvec3 size = (cloud->world(1) - cloud->world(0)) * lengths.stretch;
    QVERIFY(std::abs(size.x - 967) < 5 && std::abs(size.y - 1001) < 5 && std::abs(size.z - 15) < 1e-9);

    Stated other = survey;
    other.scale.z = 1e-7;  // the same step for all: the shape tells
    other.points[5] = 150000000;
    QVERIFY(open(other)->units().guessed);
    other.points[5] = 100000;  // a small object, scanned finely
    QVERIFY(!open(other)->units().guessed);
    other = survey;
    other.keys = {1024, 1, 4099, 9002};  // nothing but the unit of the heights
    QVERIFY(open(other)->units().guessed && open(other)->units().vertical == "ft");
    other = survey;
    other.offset.y = 95;  // no latitude
    QVERIFY(!open(other)->units().guessed);
    other = survey;
    other.scale = {0.001, 0.001, 0.001};
    QVERIFY(!open(other)->units().guessed);
    other = survey;
    other.wkt = projectedIn(kMetre);  // said is said
    QVERIFY(!open(other)->units().guessed && open(other)->units().kind == Kind::Lengths);
    QVERIFY(open(other)->source()->warnings.empty());
}

void CrsTest::geocentricHasNoHeights()
{
    Stated stated;
    stated.wkt = "GEOCCS[\"WGS 84\"," + kDatum + "," + kMetre + "]";
    stated.offset = {4.2e6, 4.7e5, 4.76e6};
    const auto cloud = open(stated);
    QCOMPARE(int(cloud->units().kind), int(Kind::Geocentric));
    QVERIFY(cloud->source()->warnings[0].find("Z is no height") != std::string::npos);
    QCOMPARE(trueLengths(*cloud).stretch, glm::dvec3(1.0));
    stated.offset = {5.1e5, 4.9e6, 0};  // in truth a projected system: keys that say 3 for 1
    const auto wrong = open(stated);
    QCOMPARE(int(wrong->units().kind), int(Kind::Lengths));
    QVERIFY(wrong->source()->warnings[0].find("not near the earth's surface") != std::string::npos);
}

void CrsTest::partsKeepTheirUnits()
{
    Stated stated;
    stated.wkt = compound(projectedIn(kMetre), kFoot);
    const auto cloud = open(stated);
    PointSet points(2);
    points.insert(1);
    Progress progress;
    QVERIFY(extracted(*cloud, points, progress)->units() == cloud->units());
    QCOMPARE(trueLengths(*cloud).stretch.z, 0.3048);
}

void CrsTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<int>("kind");
    QTest::addColumn<QString>("horizontal");
    QTest::addColumn<QString>("vertical");
    const auto row = [](const char* file, Kind kind, const char* horizontal, const char* vertical) {
        QTest::newRow(file) << QString(file) << int(kind) << QString(horizontal) << QString(vertical);
    };
    row("cases/epsg2926-no-unit-key.las", Kind::Lengths, "ftUS", "ftUS");
    row("cases/slope-m-ftus.las", Kind::Lengths, "m", "ftUS");
    row("cases/wkt-blanks.las", Kind::Lengths, "ftUS", "ftUS");
    row("cases/wkt-only-nul.las", Kind::Unknown, "", "");
    row("cases/wkt2-geocentric.las", Kind::Geocentric, "m", "m");
    row("more/autzen-bmx-2023-m-ftus.las", Kind::Lengths, "m", "ftUS");
    row("more/lidr-topography.laz", Kind::Lengths, "m", "m");
    row("more/rlas-fwf.laz", Kind::Unknown, "", "m");
    row("autzen_trim.las", Kind::Lengths, "ft", "ft");
    row("mvk-thin.las", Kind::Lengths, "ftUS", "ftUS");
    row("lots_of_vlr.las", Kind::Lengths, "ftUS", "ftUS");
    row("epsg_4326.las", Kind::Degrees, "deg", "m");
    row("lone-star.laz", Kind::Lengths, "m", "m");
    row("fullwave.laz", Kind::Lengths, "m", "m");
    row("test1_4.las", Kind::Lengths, "ftUS", "ftUS");
    row("simple.las", Kind::Unknown, "", "");
}

void CrsTest::realFiles()
{
    QFETCH(QString, file);
    QFETCH(int, kind);
    QFETCH(QString, horizontal);
    QFETCH(QString, vertical);
    const auto path = std::filesystem::path(PUNCTUM_TEST_DATA) / file.toStdString();
    if (!std::filesystem::exists(path)) QSKIP("the real file is not there");
    const auto source = las::Reader::open(path)->source();
    QCOMPARE(int(source->units.kind), kind);
    QCOMPARE(QString::fromStdString(source->units.horizontal), horizontal);
    QCOMPARE(QString::fromStdString(source->units.vertical), vertical);
}

void CrsTest::withoutTheDatabase()
{
    const QByteArray before = qgetenv("PROJ_DATA"), old = qgetenv("PROJ_LIB");
    qputenv("PROJ_DATA", m_dir.path().toUtf8());  // an empty folder
    qputenv("PROJ_LIB", m_dir.path().toUtf8());
    Stated stated;
    stated.keys = {1024, 1, 3072, 2263};
    const auto coded = open(stated);
    stated.wkt = projectedIn(kFoot);
    const auto written = open(stated);
    qputenv("PROJ_DATA", before);
    qputenv("PROJ_LIB", old);
    if (before.isNull()) qunsetenv("PROJ_DATA");
    if (old.isNull()) qunsetenv("PROJ_LIB");
    if (coded->units().kind != Kind::Unknown) QSKIP("this PROJ finds its database elsewhere");
    QCOMPARE(coded->source()->warnings.size(), std::size_t(1));
    QVERIFY2(coded->source()->warnings[0].find("proj.db") != std::string::npos,
             coded->source()->warnings[0].c_str());
    QVERIFY(written->units().horizontal == "ft");  // WKT says all of it
}

QTEST_GUILESS_MAIN(CrsTest)
#include "CrsTest.moc"
