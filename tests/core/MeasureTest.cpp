// SPDX-License-Identifier: MIT
#include "core/measure/Measurement.h"
#include "core/measure/Nearest.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <glm/geometric.hpp>

#include <QTest>

#include <algorithm>
#include <cmath>

using namespace punctum;

/// Figures between points, their CSV, and the points nearest to one.
class MeasureTest : public QObject
{
    Q_OBJECT

private slots:
    void figures_data();
    void figures();
    void tooFewPoints();
    void stretched();
    void csv();
    void nearest_data();
    void nearest();
};

namespace
{

std::vector<MeasuredPoint> pointsAt(const std::vector<glm::dvec3>& places)
{
    std::vector<MeasuredPoint> points;
    for (const glm::dvec3& p : places) points.push_back({points.size() * 10, p});
    return points;
}

double valueOf(const std::vector<Quantity>& quantities, const std::string& name)
{
    for (const Quantity& q : quantities)
        if (q.name == name) return q.value;
    return NAN;
}

const glm::dvec3 kFar(5'000'000.25, 600'000.5, 100.125);  // where floats would lose the decimals

}  // namespace

void MeasureTest::figures_data()
{
    QTest::addColumn<QString>("kind");
    QTest::addColumn<int>("corners");
    QTest::addColumn<QString>("name");
    QTest::addColumn<double>("value");
    const auto row = [](const char* kind, int corners, const char* name, double value) {
        QTest::addRow("%s of %d: %s", kind, corners, name) << QString(kind) << corners << QString(name) << value;
    };
    row("distance", 2, "Distance", 13);
    row("distance", 2, "Horizontal", 5);
    row("distance", 2, "dx", 3);
    row("distance", 2, "dy", -4);
    row("distance", 2, "dz", 12);
    row("height", 2, "Height", 12);
    row("height", 2, "Slope", std::atan2(12.0, 5.0) * 180 / std::acos(-1.0));
    row("box", 2, "Volume", 3 * 4 * 12);
    row("box", 2, "Base", 12);
    row("angle", 3, "Angle", 90);
    row("angle", 3, "Horizontal angle", 90);
    row("area", 3, "Area", 7.5);
    row("area", 3, "Horizontal area", 6);
    row("area", 3, "Perimeter", 3 + 5 + std::sqrt(34.0));
    row("area", 4, "Area", 12);
    row("area", 4, "Perimeter", 14);
    row("volume", 3, "Area", 6);
    row("volume", 3, "Perimeter", 12);
}

void MeasureTest::figures()
{
    QFETCH(QString, kind);
    QFETCH(int, corners);
    QFETCH(QString, name);
    QFETCH(double, value);
    std::vector<glm::dvec3> places{kFar, kFar + glm::dvec3(3, -4, 12)};
    if (kind == "angle") places = {kFar + glm::dvec3(2, 0, 0), kFar, kFar + glm::dvec3(0, 7, 0)};
    if ((kind == "area" || kind == "volume") && corners == 3)
        places = {kFar, kFar + glm::dvec3(3, 0, 0), kFar + glm::dvec3(0, 4, 3)};
    if (kind == "area" && corners == 4)
        places = {kFar, kFar + glm::dvec3(3, 0, 0), kFar + glm::dvec3(3, 4, 0), kFar + glm::dvec3(0, 4, 0)};
    const auto quantities = quantitiesOf(*measureKindOf(kind.toStdString()), pointsAt(places), glm::dvec3(1));
    QVERIFY2(std::abs(valueOf(quantities, name.toStdString()) - value) < 1e-7,
             qPrintable(QString::number(valueOf(quantities, name.toStdString()), 'g', 12)));
}

void MeasureTest::tooFewPoints()
{
    for (const char* name : {"distance", "height", "angle", "area", "box", "volume", "point"}) {
        const MeasureKind kind = *measureKindOf(name);
        QCOMPARE(nameOf(kind), std::string_view(name));
        const std::size_t needed = pointsOf(kind) == 0 ? 3 : pointsOf(kind);
        std::vector<glm::dvec3> places(needed - 1, kFar);
        QVERIFY(quantitiesOf(kind, pointsAt(places), glm::dvec3(1)).empty());
        places.push_back(kFar);
        QVERIFY(!quantitiesOf(kind, pointsAt(places), glm::dvec3(1)).empty());
    }
    QVERIFY(!measureKindOf("length"));
}

void MeasureTest::stretched()
{
    // a ten-thousandth of a degree to the north, and 10 m up
    const auto quantities = quantitiesOf(MeasureKind::Distance, pointsAt({{13, 52, 40}, {13, 52.0001, 50}}),
                                         glm::dvec3(68'000, 111'000, 1));
    QVERIFY(std::abs(valueOf(quantities, "dy") - 11.1) < 1e-6);
    QVERIFY(std::abs(valueOf(quantities, "Distance") - std::hypot(11.1, 10)) < 1e-6);
}

void MeasureTest::csv()
{
    Measurement m;
    m.kind = MeasureKind::Distance;
    m.file = "a \"b\", c.las";
    m.length = "m";
    m.coordinates = {glm::dvec3(0.01, 0.25, 0.001), glm::dvec3(0)};
    m.decimals = lengthDecimals(m.coordinates, glm::dvec3(1));
    QCOMPARE(m.decimals, 6);
    QCOMPARE(lengthDecimals({glm::dvec3(1e-7, 1e-7, 0.01), glm::dvec3(0)}, {68'000, 111'000, 1}), 6);
    m.points = pointsAt({{849148.2, 2, 3}, {849618.48, 2, 3}});
    // a step of hundredths, without what doubles leave behind it
    m.quantities = quantitiesOf(m.kind, m.points, glm::dvec3(1));
    QVERIFY(QString::fromStdString(toCsv({m})).contains(",dx,470.28,m\r\n"));
    m.points = pointsAt({{0.1, 2, 3}, {0.1, 2, 4.5}});
    m.quantities = quantitiesOf(m.kind, m.points, glm::dvec3(1));
    const QStringList lines = QString::fromStdString(toCsv({m, m})).split("\r\n");
    QCOMPARE(lines.front(), QString("number,kind,file,name,value,unit"));
    QCOMPARE(lines[1], QString("1,distance,\"a \"\"b\"\", c.las\",Distance,1.5,m"));
    QVERIFY(lines.contains("2,distance,\"a \"\"b\"\", c.las\",Point 1 X,0.10,"));
    QVERIFY(lines.contains("2,distance,\"a \"\"b\"\", c.las\",Point 2 index,10,"));
    QCOMPARE(lines.size(), 2 + 2 * (5 + 8));
    QVERIFY(lines.back().isEmpty());
}

void MeasureTest::nearest_data()
{
    QTest::addColumn<int>("points");
    for (const int n : {1, 3, 5, 1000, 200'000}) QTest::addRow("%d", n) << n;
}

void MeasureTest::nearest()
{
    QFETCH(int, points);
    const CoordinateScale scale{glm::dvec3(0.001, 0.001, 0.01), glm::dvec3(1000, 2000, 0)};
    const auto cloud = makeFrame(PointIndex(points), scale);
    std::mt19937 random(5);
    for (int axis = 0; axis < 3; ++axis)
        for (std::int32_t& v : cloud->columns()[std::size_t(axis)]->values<std::int32_t>())
            v = std::int32_t(random() % 5000) - (axis == 0 ? INT32_MAX / 2 : 0);
    const glm::dvec3 stretch(2, 3, 1);
    const auto raw = [&](PointIndex i) {
        return glm::dvec3(cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i]) * scale.scale * stretch;
    };
    for (const PointIndex at : {PointIndex(0), PointIndex(points / 2), PointIndex(points - 1)}) {
        std::vector<std::pair<double, PointIndex>> all;
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (i != at) all.emplace_back(glm::dot(raw(i) - raw(at), raw(i) - raw(at)), i);
        std::sort(all.begin(), all.end());
        Progress progress;
        const auto found = nearestTo(*cloud, at, 6, stretch, progress);
        QCOMPARE(found.size(), std::min<std::size_t>(6, all.size()));
        for (std::size_t k = 0; k < found.size(); ++k)
            QVERIFY(std::abs(found[k].distance - std::sqrt(all[k].first)) < 1e-9);
    }
    Progress cancelled;
    cancelled.cancel();
    QVERIFY_EXCEPTION_THROWN(nearestTo(*cloud, 0, 6, stretch, cancelled), Cancelled);
}

QTEST_GUILESS_MAIN(MeasureTest)
#include "MeasureTest.moc"
