// SPDX-License-Identifier: MIT
// Maps of points: cells against brute force, the surface against the whole triangulation, relief of known planes.
#include "MadeCloud.h"
#include "core/Error.h"
#include "core/cloud/BlockBoxes.h"
#include "core/raster/Maps.h"
#include "core/raster/Rasterize.h"
#include "core/raster/Relief.h"
#include "core/raster/Terrain.h"
#include "core/surface/Triangulation.h"
#include "core/task/Progress.h"

#include <QTest>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

using namespace punctum;

namespace
{

/// Points on hills, in blocks as scanners deliver them; some are noise, some ground.
std::shared_ptr<PointCloud> hills(PointIndex points, double side, unsigned seed = 1)
{
    const CoordinateScale grid{{0.01, 0.01, 0.01}, {400000.0, 5000000.0, 100.0}};
    auto cloud = makeFrame(points, grid);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-side / 2, side / 2);
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    const auto intensity = addScalar<std::uint16_t>(*cloud, "Intensity");
    const auto strength = addScalar<float>(*cloud, "Strength");
    for (PointIndex i = 0; i < points; ++i) {
        const double x = place(random), y = place(random), z = 10 * std::sin(x / 20) + 5 * std::cos(y / 15);
        rawAxis(*cloud, 0)[i] = std::int32_t(std::lround(x * 100));
        rawAxis(*cloud, 1)[i] = std::int32_t(std::lround(y * 100));
        rawAxis(*cloud, 2)[i] = std::int32_t(std::lround(z * 100));
        classes[i] = random() % 50 == 0 ? 7 : random() % 3 == 0 ? 5 : 2;
        intensity[i] = std::uint16_t(random() % 500);
        strength[i] = random() % 20 == 0 ? NAN : float(random() % 1000) / 7;
    }
    return cloud;
}

bool sameValues(const Raster& a, const Raster& b)
{
    if (!(a.frame() == b.frame())) return false;
    return std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                      [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); });
}

double bruteStatistic(std::vector<double> v, const Statistic& s)
{
    std::sort(v.begin(), v.end());
    double sum = 0, squares = 0;
    std::map<double, int> counts;
    for (const double x : v) {
        sum += x;
        ++counts[x];
    }
    const double mean = sum / double(v.size());
    for (const double x : v) squares += (x - mean) * (x - mean);
    switch (s.kind) {
        case Statistic::Kind::Min:
            return v.front();
        case Statistic::Kind::Max:
            return v.back();
        case Statistic::Kind::Range:
            return v.back() - v.front();
        case Statistic::Kind::Mean:
            return mean;
        case Statistic::Kind::Sum:
            return sum;
        case Statistic::Kind::Count:
            return double(v.size());
        case Statistic::Kind::StandardDeviation:
            return std::sqrt(squares / double(v.size()));
        case Statistic::Kind::Majority:
            return std::max_element(counts.begin(), counts.end(),
                                    [](const auto& a, const auto& b) { return a.second < b.second; })
                ->first;
        case Statistic::Kind::Percentile:
            break;
    }
    const double at = s.percent / 100 * double(v.size() - 1);
    const double low = v[std::size_t(std::floor(at))], high = v[std::size_t(std::ceil(at))];
    return low + (high - low) * (at - std::floor(at));
}

template <typename F>
std::string errorOf(F f)
{
    try {
        f();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace

class RasterTest : public QObject
{
    Q_OBJECT

private slots:
    /// Decimal cells and coordinates meet exactly: a point on a multiple of the cell is in the cell above it.
    void edgesAreTheCellsAbove()
    {
        QCOMPARE(std::floor(RasterFrame::inCells(0.3, 0.1)), 3.0);
        QCOMPARE(std::floor(RasterFrame::inCells(0.29999, 0.1)), 2.0);
        for (std::int64_t k = -30000000; k < 30000000; k += 77777) {
            const double edge = double(k) / 10;
            QCOMPARE(std::floor(RasterFrame::inCells(edge, 0.1)), double(k));
            QCOMPARE(std::floor(RasterFrame::inCells(edge - 0.0001, 0.1)), double(k - 1));
        }
        const RasterFrame frame = rasterFrame({{0.3, -0.25, 0}, {0.6, 0.3, 0}}, 0.1);
        QCOMPARE(frame.left, 3);
        QCOMPARE(frame.top, 4);
        QCOMPARE(frame.columns, std::size_t(4));
        QCOMPARE(frame.rows, std::size_t(7));
        const auto cloud = makeFrame(3, {{0.1, 0.1, 1}, {0, 0, 0}});
        rawAxis(*cloud, 0)[0] = 3, rawAxis(*cloud, 0)[1] = 4, rawAxis(*cloud, 0)[2] = 6;
        rawAxis(*cloud, 1)[0] = -2, rawAxis(*cloud, 1)[1] = 3, rawAxis(*cloud, 1)[2] = 3;
        const Raster counts = rasterize(*cloud, *cloud->findAttribute("Z"), {Statistic::Kind::Count}, frame,
                                        nullptr, *std::make_unique<Progress>());
        QCOMPARE(counts.at(0, 5), 1.0f);
        QCOMPARE(counts.at(1, 0), 1.0f);
        QCOMPARE(counts.at(3, 0), 1.0f);
        QCOMPARE(std::count(counts.values().begin(), counts.values().end(), 1.0f), 3);
    }

    void statisticsAreThoseOfBruteForce_data()
    {
        QTest::addColumn<QString>("attribute");
        QTest::addColumn<QString>("statistic");
        for (const char* attribute : {"Z", "Intensity", "Strength"})
            for (const char* word : {"min", "max", "mean", "median", "stddev", "range", "sum", "count", "majority",
                                     "p0", "p5", "p95", "p99.5", "p100"})
                QTest::addRow("%s %s", attribute, word) << attribute << word;
    }
    void statisticsAreThoseOfBruteForce()
    {
        QFETCH(QString, attribute);
        QFETCH(QString, statistic);
        const auto cloud = hills(40000, 300);
        auto deleted = std::make_shared<PointSet>(cloud->size());
        deleted->insert(PointRange{100, 5000});
        cloud->setDeleted(deleted);
        PointSet only(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (i % 7 != 0) only.insert(i);
        Progress progress;
        const Statistic chosen = *parseStatistic(statistic.toStdString());
        const Attribute& values = *cloud->findAttribute(attribute.toStdString());
        const RasterFrame frame = rasterFrame(boundsOfPoints(*cloud, &only, progress), 1.3);
        const Raster raster = rasterize(*cloud, values, chosen, frame, &only, progress);

        std::map<std::size_t, std::vector<double>> cells;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const double value = chosen.kind == Statistic::Kind::Count ? 1.0 : values.number(i);
            if (deleted->contains(i) || !only.contains(i) || std::isnan(value)) continue;
            // in whole hundredths: exact
            const auto cellOf = [](std::int64_t hundredths) { return hundredths / 130; };
            const auto column = std::size_t(cellOf(cloud->rawX()[i] + 40000000) - frame.left);
            const auto row = std::size_t(frame.top - 1 - cellOf(cloud->rawY()[i] + 500000000));
            QVERIFY(column < frame.columns && row < frame.rows);
            cells[row * frame.columns + column].push_back(value);
        }
        QVERIFY(cells.size() > 1000 && cells.size() < frame.cells());
        for (std::size_t k = 0; k < frame.cells(); ++k) {
            const auto found = cells.find(k);
            if (found == cells.end()) {
                if (chosen.kind == Statistic::Kind::Count)
                    QCOMPARE(raster.values()[k], 0.0f);
                else
                    QVERIFY(std::isnan(raster.values()[k]));
                continue;
            }
            const double wanted = bruteStatistic(found->second, chosen);
            QVERIFY2(std::abs(double(raster.values()[k]) - wanted) <= 1e-6 * std::max(1.0, std::abs(wanted)),
                     qPrintable(QString("cell %1: %2, not %3").arg(k).arg(double(raster.values()[k])).arg(wanted)));
        }
    }

    void theSameOnAnyThreadsAndInAnyOrder()
    {
        const auto cloud = hills(200000, 800);
        // the same points, the other way round: other stretches, other boxes
        const auto turned = hills(200000, 800);
        for (const auto& column : turned->columns()) {
            const std::size_t bytes = column->elementBytes();
            for (PointIndex i = 0; i < cloud->size() / 2; ++i)
                std::swap_ranges(column->data() + i * bytes, column->data() + (i + 1) * bytes,
                                 column->data() + (cloud->size() - 1 - i) * bytes);
        }
        Progress progress;
        for (const char* of : {"mean", "stddev", "dtm", "dsm", "chm"}) {
            MapRequest request;
            request.cell = 1.0;
            request.kind = parseMapKind(of).value_or(MapKind::Attribute);
            request.attribute = "Strength";
            request.bridge = 30;
            if (request.kind == MapKind::Attribute) request.statistic = *parseStatistic(of);
            const Raster two = makeMap(*cloud, request, progress).raster;
            QVERIFY(two.count() > 1000);
            {
                const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
                QVERIFY2(sameValues(makeMap(*cloud, request, progress).raster, two), of);
            }
            QVERIFY2(sameValues(makeMap(*turned, request, progress).raster, two), of);
        }
    }

    /// Piece by piece it is the one triangulation of all ground points.
    void terrainIsThatOfTheWholeTriangulation()
    {
        const auto cloud = hills(60000, 700, 3);
        // a lake that is too wide to be bridged, and one that is not
        auto deleted = std::make_shared<PointSet>(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const glm::dvec3 p = cloud->world(i) - glm::dvec3(400000, 5000000, 0);
            if (std::hypot(p.x, p.y) < 60 || std::hypot(p.x - 200, p.y - 200) < 15) deleted->insert(i);
        }
        cloud->setDeleted(deleted);
        Progress progress;
        MapRequest request;
        request.cell = 1.0;
        request.bridge = 50;
        const Raster dtm = makeMap(*cloud, request, progress).raster;

        std::vector<SurfacePoint> ground;
        const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (classes[i] == 2 && !deleted->contains(i))
                ground.push_back({cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i], std::uint32_t(i)});
        const Triangulation whole(ground);
        std::uint32_t near = 0;
        std::size_t filled = 0, empty = 0;
        for (std::size_t r = 0; r < dtm.rows(); ++r)
            for (std::size_t c = 0; c < dtm.columns(); ++c) {
                const glm::dvec2 at = (dtm.frame().middle(c, r) - glm::dvec2(400000, 5000000)) / 0.01;
                const auto height = whole.height(at.x, at.y, near);
                const bool there =
                    height && std::sqrt(whole.squaredRadius(*whole.locate(at.x, at.y, near))) * 0.01 <= 25.0;
                if (!there) {
                    QVERIFY(std::isnan(dtm.at(c, r)));
                    ++empty;
                    continue;
                }
                ++filled;
                QVERIFY(std::abs(double(dtm.at(c, r)) - (*height * 0.01 + 100)) < 1e-3);
            }
        QVERIFY2(filled > 400000 && empty > 5000, qPrintable(QString("%1 and %2").arg(filled).arg(empty)));
    }

    void reliefOfAPlane()
    {
        Progress progress;
        Raster plane(RasterFrame{2.0, 10, 20, 30, 25});
        for (std::size_t r = 0; r < plane.rows(); ++r)
            for (std::size_t c = 0; c < plane.columns(); ++c) {
                const glm::dvec2 p = plane.frame().middle(c, r);
                plane.at(c, r) = float(0.5 * p.x + 0.25 * p.y);
            }
        const glm::dvec3 plain(1.0);
        const double rise = std::hypot(0.5, 0.25);
        const Raster slope = slopeOf(plane, plain, progress), aspect = aspectOf(plane, plain, progress);
        const double down = std::fmod(std::atan2(-0.5, -0.25) * 180 / M_PI + 360, 360);
        for (const float v : slope.values()) QVERIFY(std::abs(double(v) - std::atan(rise) * 180 / M_PI) < 1e-3);
        for (const float v : aspect.values()) QVERIFY(std::abs(double(v) - down) < 1e-3);
        // heights in feet above meters: a third of the rise
        const Raster feet = slopeOf(plane, {1, 1, 0.3048}, progress);
        QVERIFY(std::abs(double(feet.at(5, 5)) - std::atan(rise * 0.3048) * 180 / M_PI) < 1e-4);
        // light from where it goes down is brightest, level ground is sin 45 degrees
        const Raster lit = hillshadeOf(plane, {down, 90 - std::atan(rise) * 180 / M_PI, 1}, plain, progress);
        QCOMPARE(lit.at(3, 3), 255.0f);
        const Raster level = hillshadeOf(Raster(plane.frame(), 7.0f), {}, plain, progress);
        QCOMPARE(level.at(0, 0), float(std::lround(1 + 254 * std::sqrt(0.5))));
        // a hole has no value, and its neighbors keep theirs
        plane.at(4, 4) = Raster::kNone;
        const Raster holed = slopeOf(plane, plain, progress);
        QVERIFY(std::isnan(holed.at(4, 4)));
        QVERIFY(std::abs(double(holed.at(3, 3) - slope.at(3, 3))) < 1e-4);
    }

    void holesAndPits()
    {
        Progress progress;
        Raster raster(RasterFrame{1.0, 0, 20, 20, 20}, 10.0f);
        for (std::size_t k = 5; k < 8; ++k) raster.at(k, 6) = Raster::kNone;  // narrow
        for (std::size_t r = 11; r < 20; ++r)
            for (std::size_t c = 11; c < 20; ++c) raster.at(c, r) = Raster::kNone;  // open
        raster.at(3, 15) = 2.0f;
        const Raster filled = holesFilled(raster, 3, progress);
        for (std::size_t k = 5; k < 8; ++k) QCOMPARE(filled.at(k, 6), 10.0f);
        QVERIFY(std::isnan(filled.at(16, 16)) && std::isnan(filled.at(19, 12)));
        QCOMPARE(filled.at(3, 15), 2.0f);
        QCOMPARE(pitsFilled(raster, 5.0, progress).at(3, 15), 10.0f);
        QCOMPARE(pitsFilled(raster, 9.0, progress).at(3, 15), 2.0f);
    }

    void surfaceAndCanopy()
    {
        const auto cloud = hills(60000, 200, 5);
        const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            if (classes[i] == 5) rawAxis(*cloud, 2)[i] += 1500;  // trees of 15 m
            if (classes[i] == 7) rawAxis(*cloud, 2)[i] += 90000;
        }
        Progress progress;
        MapRequest request;
        request.cell = 1.0;
        request.kind = MapKind::Chm;
        const MapOutcome chm = makeMap(*cloud, request, progress);
        std::size_t tall = 0;
        for (const float v : chm.raster.values()) {
            if (std::isnan(v)) continue;
            QVERIFY(v >= 0.0f && v < 20.0f);  // noise is left out
            tall += v > 13.0f ? 1 : 0;
        }
        QVERIFY(tall > 10000);
        request.kind = MapKind::Attribute;
        request.statistic = {Statistic::Kind::Max};
        request.noise = true;
        const Raster noisy = makeMap(*cloud, request, progress).raster;
        QVERIFY(std::any_of(noisy.values().begin(), noisy.values().end(), [](float v) { return v > 900.0f; }));
        request.kind = MapKind::Density;
        request.cell = 2.0;
        const Raster density = makeMap(*cloud, request, progress).raster;
        double points = 0;
        for (const float v : density.values()) points += double(v) * 4;
        QCOMPARE(std::llround(points), std::int64_t(cloud->size()));
    }

    void degenerateAndWrong()
    {
        Progress progress;
        MapRequest request;
        QVERIFY(errorOf([&] { makeMap(*makeFrame(0), request, progress); }).find("no points") != std::string::npos);
        for (const char* of : {"dsm", "density", "attribute", "chm", "dtm"})
            for (const int points : {1, 2, 3, 5}) {
                const auto cloud = makeFrame(PointIndex(points));
                for (int i = 0; i < points; ++i) rawAxis(*cloud, 0)[std::size_t(i)] = 1000 * i;
                request.kind = parseMapKind(of).value_or(MapKind::Attribute);
                const bool ground = request.kind == MapKind::Dtm || request.kind == MapKind::Chm;
                const std::string said = errorOf([&] { makeMap(*cloud, request, progress); });
                QCOMPARE(said.empty(), !ground);  // no point is ground
                request.ground = "0";
                QCOMPARE(errorOf([&] { makeMap(*cloud, request, progress); }).empty(), !ground || points >= 3);
                request.ground = "2";
            }
        const auto cloud = hills(1000, 100);
        request.kind = MapKind::Attribute;
        request.cell = 1e-4;
        QVERIFY(errorOf([&] { makeMap(*cloud, request, progress); }).find("larger cells") != std::string::npos);
        request.cell = 1.0;
        request.attribute = "Height";
        QVERIFY(errorOf([&] { makeMap(*cloud, request, progress); }).find("no attribute Height") !=
                std::string::npos);
        request.attribute = "Z";
        request.where = "Classification == 99";
        QVERIFY(!errorOf([&] { makeMap(*cloud, request, progress); }).empty());
        request.where = "Nonsense >";
        QVERIFY(!errorOf([&] { makeMap(*cloud, request, progress); }).empty());
        for (const char* word : {"", "p", "p101", "p-1", "p5x", "maximum"}) QVERIFY(!parseStatistic(word));
        request.where.clear();
        request.kind = MapKind::Dtm;
        progress.cancel();
        bool cancelled = false;
        try {
            makeMap(*cloud, request, progress);
        } catch (const Cancelled&) {
            cancelled = true;
        }
        QVERIFY(cancelled);
    }
};

QTEST_APPLESS_MAIN(RasterTest)
#include "RasterTest.moc"
