// SPDX-License-Identifier: MIT
// The Delaunay triangulation against its definition, in exact arithmetic, on places that are hard on it.
#include "core/surface/Triangulation.h"

#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <set>

using namespace punctum;

namespace
{

__extension__ using Wide = __int128;
using Points = std::vector<SurfacePoint>;
using Corner = std::pair<std::int32_t, std::int32_t>;
using Corners = std::array<Corner, 3>;

/// A whole number of any size, slow and plain: digits of 2^24 with signs.
struct Whole {
    std::vector<std::int64_t> digits;
    Whole() = default;
    explicit Whole(std::int64_t value)
    {
        for (; value != 0; value /= 1 << 24) digits.push_back(value % (1 << 24));
    }
    Whole& carry()
    {
        for (std::size_t i = 0; i < digits.size(); ++i) {
            const std::int64_t over = digits[i] / (1 << 24);
            digits[i] %= 1 << 24;
            if (over != 0 && i + 1 == digits.size()) digits.push_back(0);
            if (over != 0) digits[i + 1] += over;
        }
        return *this;
    }
    friend Whole operator*(const Whole& a, const Whole& b)
    {
        Whole c;
        c.digits.resize(a.digits.size() + b.digits.size());
        for (std::size_t i = 0; i < a.digits.size(); ++i)
            for (std::size_t j = 0; j < b.digits.size(); ++j) c.digits[i + j] += a.digits[i] * b.digits[j];
        return c.carry();
    }
    Whole& add(const Whole& b, std::int64_t sign)
    {
        digits.resize(std::max(digits.size(), b.digits.size()));
        for (std::size_t i = 0; i < b.digits.size(); ++i) digits[i] += sign * b.digits[i];
        return carry();
    }
    friend Whole operator+(Whole a, const Whole& b) { return a.add(b, 1); }
    friend Whole operator-(Whole a, const Whole& b) { return a.add(b, -1); }
    int sign() const
    {
        // each digit is less than 2^24 by its amount: the first that is not 0 decides
        for (std::size_t i = digits.size(); i-- > 0;)
            if (digits[i] != 0) return digits[i] > 0 ? 1 : -1;
        return 0;
    }
};

int inCircleOf(const Corners& t, Corner p, PlaneMetric metric)
{
    std::array<Whole, 3> x, y, lift;
    for (std::size_t i = 0; i < 3; ++i) {
        x[i] = Whole(std::int64_t(t[i].first) - p.first);
        y[i] = Whole(std::int64_t(t[i].second) - p.second);
        lift[i] = Whole(metric.x) * x[i] * x[i] + Whole(metric.y) * y[i] * y[i];
    }
    return (lift[0] * (x[1] * y[2] - x[2] * y[1]) + lift[1] * (x[2] * y[0] - x[0] * y[2]) +
            lift[2] * (x[0] * y[1] - x[1] * y[0]))
        .sign();
}

Wide twiceArea(Corner a, Corner b, Corner c)
{
    return Wide(std::int64_t(b.first) - a.first) * (std::int64_t(c.second) - a.second) -
           Wide(std::int64_t(b.second) - a.second) * (std::int64_t(c.first) - a.first);
}

/// Corners of the convex hull, counterclockwise (Andrew's chains).
std::vector<Corner> hullOf(const Points& points)
{
    std::vector<Corner> sorted, hull;
    for (const SurfacePoint& p : points) sorted.push_back({p.x, p.y});
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    for (int chain = 0; chain < 2; ++chain) {
        const std::size_t first = hull.size();
        for (const Corner& p : sorted) {
            while (hull.size() >= first + 2 && twiceArea(hull[hull.size() - 2], hull.back(), p) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        if (!hull.empty()) hull.pop_back();
        std::reverse(sorted.begin(), sorted.end());
    }
    return hull;
}

Corners cornersOf(const Triangulation& net, std::size_t t)
{
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
        const SurfacePoint& v = net.vertices()[net.triangles()[t][i]];
        corners[i] = {v.x, v.y};
    }
    return corners;
}

/// With the least corner first.
std::set<Corners> setOf(const Triangulation& net)
{
    std::set<Corners> all;
    for (std::size_t t = 0; t < net.size(); ++t) {
        Corners c = cornersOf(net, t);
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        all.insert(c);
    }
    return all;
}

Points pointsOf(const std::string& kind)
{
    Points points;
    std::mt19937 random(3);
    const auto upTo = [&](std::int32_t most) { return std::int32_t(random() % std::uint32_t(most)); };
    const auto add = [&](std::int32_t x, std::int32_t y) {
        points.push_back({x, y, upTo(5000), std::uint32_t(points.size())});
    };
    if (kind == "random") {
        for (int i = 0; i < 6000; ++i) add(upTo(1000000), upTo(700000));
    } else if (kind == "grid") {
        for (int i = 0; i < 4900; ++i) add(i % 70 * 1000, i / 70 * 1000 - 12345678);
    } else if (kind == "turned grid") {
        for (int i = 0; i < 4900; ++i) add(i % 70 * 3 - i / 70 * 4, i % 70 * 4 + i / 70 * 3);
    } else if (kind == "doubled") {
        for (int i = 0; i < 5000; ++i) add(upTo(30), upTo(30));
    } else if (kind == "clustered") {
        for (int i = 0; i < 5000; ++i) {
            const int cluster = i % 7;
            add(cluster * cluster * 10000000 + upTo(500), cluster * 7654321 % 1000003 * 100 + upTo(500));
        }
        add(INT32_MAX, INT32_MIN);
    } else if (kind == "circle") {  // a^2 + b^2 = 5^2 13^2 17^2, and a few inside
        for (int a = -1105; a <= 1105; ++a) {
            const int b = int(std::lround(std::sqrt(1105.0 * 1105 - double(a) * a)));
            if (a * a + b * b != 1105 * 1105) continue;
            add(a * 1000000, b * 1000000);
            add(a * 1000000, -b * 1000000);
        }
        for (int i = 0; i < 5; ++i) add(upTo(1000) - 500, upTo(1000) - 500);
    } else if (kind == "line and one") {
        for (int i = 0; i < 500; ++i) add(i * 3, i * 5);
        add(700, 1);
    } else if (kind == "corners") {  // the whole range of int32
        for (int i = 0; i < 400; ++i)
            add(std::int32_t(random() % 2 != 0 ? INT32_MAX - upTo(3) : INT32_MIN + upTo(3)),
                std::int32_t(random() % 2 != 0 ? INT32_MAX - upTo(3) : INT32_MIN + upTo(3)));
        for (int i = 0; i < 400; ++i) add(std::int32_t(random()), std::int32_t(random()));
    } else if (kind == "parabola") {
        for (int i = 0; i < 3000; ++i) add(i, i * i);
    } else if (std::filesystem::exists(std::filesystem::path(PUNCTUM_TEST_DATA) / kind)) {
        Progress progress;
        const auto cloud = las::load(std::filesystem::path(PUNCTUM_TEST_DATA) / kind, progress);
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (cloud->findAttribute("Classification")->number(i) == 2.0)
                points.push_back({cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i], std::uint32_t(i)});
    }
    return points;
}

}  // namespace

class TriangulationTest : public QObject
{
    Q_OBJECT

private slots:
    void isDelaunay_data();
    void isDelaunay();
    void heights();
    void nearTheHull();
    void fewPoints();
    void metrics();
    void cancelled();
};

void TriangulationTest::isDelaunay_data()
{
    QTest::addColumn<QString>("kind");
    QTest::addColumn<uint>("weightX");
    QTest::addColumn<uint>("weightY");
    for (const char* const kind : {"random", "grid", "turned grid", "doubled", "clustered", "circle",
                                   "line and one", "corners", "parabola", "ign/mnx_bat.laz", "isprs/samp11.laz"})
        QTest::newRow(kind) << kind << 1u << 1u;
    QTest::newRow("random, degrees") << "random" << 385413u << 1017721u;
    QTest::newRow("grid, stretched") << "grid" << 1u << 100u;
    QTest::newRow("corners, stretched") << "corners" << PlaneMetric::kMost << PlaneMetric::kMost - 1;
}

void TriangulationTest::isDelaunay()
{
    QFETCH(QString, kind);
    QFETCH(uint, weightX);
    QFETCH(uint, weightY);
    Points points = pointsOf(kind.toStdString());
    if (points.empty()) QSKIP(qPrintable(kind + " is not here."));
    const PlaneMetric metric{weightX, weightY};
    const Triangulation net(points, metric);

    std::map<Corner, SurfacePoint> lowest;
    for (const SurfacePoint& p : points) {
        const auto [at, isNew] = lowest.insert({{p.x, p.y}, p});
        if (!isNew && (p.z < at->second.z || (p.z == at->second.z && p.index < at->second.index))) at->second = p;
    }
    QCOMPARE(net.vertices().size(), lowest.size());
    for (const SurfacePoint& v : net.vertices()) QCOMPARE(v, lowest.at({v.x, v.y}));

    // Counterclockwise, neighbors agree, and no edge is one that Delaunay would flip; together they are the hull.
    Wide area = 0;
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < net.size(); ++t) {
        const Corners c = cornersOf(net, t);
        const Wide own = twiceArea(c[0], c[1], c[2]);
        QVERIFY(own > 0);
        area += own;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t other = net.neighbors()[t][i];
            if (other == Triangulation::kNone) continue;
            const std::array<std::uint32_t, 3>& v = net.triangles()[other];
            std::size_t j = 0;
            while (j < 3 && net.neighbors()[other][j] != t) ++j;
            QVERIFY(j < 3);
            QCOMPARE(v[j], net.triangles()[t][(i + 1) % 3]);
            QCOMPARE(v[(j + 1) % 3], net.triangles()[t][i]);
            wrong += inCircleOf(c, cornersOf(net, other)[(j + 2) % 3], metric) > 0;
        }
    }
    QCOMPARE(wrong, 0u);
    const std::vector<Corner> hull = hullOf(points);
    Wide hullArea = 0;
    for (std::size_t i = 2; i < hull.size(); ++i) hullArea += twiceArea(hull[0], hull[i - 1], hull[i]);
    QVERIFY(area == hullArea);

    // The triangles are a function of the places: in another order, and in pieces.
    const std::set<Corners> triangles = setOf(net);
    QCOMPARE(triangles.size(), net.size());
    std::shuffle(points.begin(), points.end(), std::mt19937(8));
    QVERIFY(setOf(Triangulation(points, metric)) == triangles);
    Delaunay grown(metric);
    const std::span<const SurfacePoint> all(points);
    grown.insert(all.first(1));
    grown.insert(all.subspan(1, all.size() / 3));
    grown.insert(all.subspan(1 + all.size() / 3));
    QVERIFY(setOf(Triangulation(std::move(grown))) == triangles);
}

void TriangulationTest::heights()
{
    const Points points = pointsOf("random");
    const Triangulation net(points);
    std::mt19937 random(5);
    std::uint32_t near = 0;
    for (int k = 0; k < 500; ++k) {
        const double x = double(random() % 1100000) - 50000.25, y = double(random() % 800000) - 50000.125;
        // in the triangle of all that has it
        double expected = NAN;
        for (std::size_t t = 0; t < net.size() && std::isnan(expected); ++t) {
            std::array<double, 3> share{};
            for (std::size_t i = 0; i < 3; ++i) {
                const SurfacePoint &a = net.vertices()[net.triangles()[t][(i + 1) % 3]],
                                   &b = net.vertices()[net.triangles()[t][(i + 2) % 3]];
                share[i] = (double(b.x) - a.x) * (y - a.y) - (double(b.y) - a.y) * (x - a.x);
            }
            if (share[0] < 0 || share[1] < 0 || share[2] < 0) continue;
            expected = 0;
            for (std::size_t i = 0; i < 3; ++i)
                expected += share[i] / (share[0] + share[1] + share[2]) * net.vertices()[net.triangles()[t][i]].z;
        }
        const std::optional<double> height = net.height(x, y, near);
        QCOMPARE(height.has_value(), !std::isnan(expected));
        if (height) QVERIFY2(std::abs(*height - expected) < 1e-6, qPrintable(QString::number(*height - expected)));
    }
    for (const SurfacePoint& v : net.vertices()) QVERIFY(std::abs(net.height(v.x, v.y, near).value() - v.z) < 1e-9);
}

void TriangulationTest::nearTheHull()
{
    for (const std::uint32_t weight : {1u, 9u}) {
        Points points = pointsOf("random");
        points.resize(200);
        const Triangulation net(points, {1, weight});
        std::mt19937 random(6);
        std::uint32_t near = 0;
        for (int k = 0; k < 1000; ++k) {
            const double x = double(random() % 4000000) - 1500000.25, y = double(random() % 3000000) - 1000000.125;
            std::uint32_t other = 0;
            if (net.locate(x, y, other)) continue;
            double best = INFINITY, expected = NAN;
            for (std::size_t t = 0; t < net.size(); ++t)
                for (std::size_t i = 0; i < 3; ++i) {
                    if (net.neighbors()[t][i] != Triangulation::kNone) continue;
                    const SurfacePoint &a = net.vertices()[net.triangles()[t][i]],
                                       &b = net.vertices()[net.triangles()[t][(i + 1) % 3]];
                    const double bx = double(b.x) - a.x, by = double(b.y) - a.y;
                    const double share = std::clamp(
                        ((x - a.x) * bx + (y - a.y) * by * weight) / (bx * bx + by * by * weight), 0.0, 1.0);
                    const double dx = x - a.x - share * bx, dy = y - a.y - share * by;
                    if (dx * dx + dy * dy * weight < best) {
                        best = dx * dx + dy * dy * weight;
                        expected = a.z + share * (double(b.z) - a.z);
                    }
                }
            QVERIFY(std::abs(net.heightNear(x, y, near).value() - expected) < 1e-6);
            QVERIFY(!net.height(x, y, near));
        }
    }
}

void TriangulationTest::fewPoints()
{
    std::uint32_t near = 0;
    QVERIFY(Triangulation().empty());
    QVERIFY(!Triangulation().height(0, 0, near));
    QVERIFY(Triangulation(Points{}).empty());
    QVERIFY(Triangulation(Points{{1, 2, 3, 0}}).empty());
    QVERIFY(Triangulation(Points(100, SurfacePoint{1, 2, 3, 0})).empty());
    Points line;
    for (int i = 0; i < 3000; ++i) line.push_back({i * 7 % 3000 * 2, i * 7 % 3000 * 3, i, std::uint32_t(i)});
    QVERIFY(Triangulation(line).empty());
    QVERIFY(!Triangulation(line).heightNear(0, 0, near));
    const Triangulation one(Points{{0, 0, 10, 0}, {10, 0, 20, 1}, {0, 10, 30, 2}, {0, 10, 29, 3}});
    QCOMPARE(one.size(), 1u);
    QCOMPARE(one.height(5, 5, near).value(), 24.5);
    QCOMPARE(one.slopeOf(0)[0], 1.0);
    QCOMPARE(one.slopeOf(0)[1], 1.9);
    QCOMPARE(one.squaredRadius(0), 50.0);
    QVERIFY(!one.height(NAN, 5, near));
    const Triangulation highest(Points{{0, 0, 1, 0}, {0, 0, 5, 1}, {9, 0, 1, 2}, {0, 9, 1, 3}}, {},
                                Delaunay::Keep::Highest);
    QCOMPARE(highest.height(0, 0, near).value(), 5.0);
}

void TriangulationTest::metrics()
{
    QCOMPARE(PlaneMetric::of(0.001, 0.001), (PlaneMetric{1, 1}));
    QCOMPARE(PlaneMetric::of(0.01, 0.001), (PlaneMetric{100, 1}));
    QCOMPARE(PlaneMetric::of(0.0025, 0.001), (PlaneMetric{25, 4}));
    QCOMPARE(PlaneMetric::of(0, 1), (PlaneMetric{1, 1}));
    QCOMPARE(PlaneMetric::of(1, 1e9), (PlaneMetric{1, PlaneMetric::kMost}));
    for (double degrees = 0.5; degrees < 89; degrees += 0.75) {
        const double ratio = std::cos(degrees / 57.29578);
        const PlaneMetric metric = PlaneMetric::of(ratio, 1.0);
        QVERIFY(std::abs(double(metric.x) / metric.y / (ratio * ratio) - 1) < 3e-3 / ratio * 1e-3);
        QVERIFY(metric.x >= 1 && metric.y >= 1 && metric.x <= PlaneMetric::kMost && metric.y <= PlaneMetric::kMost);
    }
}

void TriangulationTest::cancelled()
{
    Progress progress;
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(Triangulation(pointsOf("random"), {}, Delaunay::Keep::Lowest, &progress), Cancelled);
}

QTEST_APPLESS_MAIN(TriangulationTest)
#include "TriangulationTest.moc"
