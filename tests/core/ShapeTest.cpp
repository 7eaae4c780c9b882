// SPDX-License-Identifier: MIT
// Normals and their orientation, features, splat radius, clusters and lonely points: known answers, other programs'
// normals, degenerate clouds, any number of threads, cancel.
#include "core/Error.h"
#include "core/cloud/NormalParts.h"
#include "core/las/Reader.h"
#include "core/sample/Sample.h"
#include "core/shape/Spread.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <thread>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;

void put(PointCloud& cloud, PointIndex i, double x, double y, double z)
{
    rawAxis(cloud, 0)[i] = std::int32_t(std::lround(x * 1000));
    rawAxis(cloud, 1)[i] = std::int32_t(std::lround(y * 1000));
    rawAxis(cloud, 2)[i] = std::int32_t(std::lround(z * 1000));
}

Cloud inMillimeters(PointIndex n)
{
    return makeFrame(n, {glm::dvec3(0.001), glm::dvec3(457000.0, 5552000.0, 100.0)});
}

/// A sphere of 10 units about the origin of the offsets.
Cloud makeSphere(PointIndex n)
{
    const auto cloud = inMillimeters(n);
    for (PointIndex i = 0; i < n; ++i) {
        const double z = 1 - (2 * double(i) + 1) / double(n), r = std::sqrt(1 - z * z),
                     angle = 2.399963 * double(i);
        put(*cloud, i, 10 * r * std::cos(angle), 10 * r * std::sin(angle), 10 * z);
    }
    return cloud;
}

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text, const PointSet* within = nullptr)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress, within);
}

double number(const PointCloud& cloud, const char* name, PointIndex i)
{
    return cloud.findAttribute(name)->number(i);
}

/// How far a point's normal looks away from the middle of the sphere: 1, outward.
double outward(const PointCloud& cloud, PointIndex i)
{
    double sum = 0;
    const auto& columns = cloud.columns();
    for (std::uint32_t a = 0; a < 3; ++a)
        sum += cloud.findAttribute("Normal")->number(i, a) * double(columns[a]->values<std::int32_t>()[i]) / 10000;
    return sum;
}

const char* const kSteps[] = {"normals k=8",
                              "normals radius=2",
                              "normals k=8 orientation=tree",
                              "features k=8",
                              "features radius=2",
                              "splat-radius k=8",
                              "clusters tolerance=1.5 points=2",
                              "radius-outliers radius=1.2 neighbors=3",
                              "outliers k=4"};

}  // namespace

class ShapeTest : public QObject
{
    Q_OBJECT

private slots:
    void spreadOfKnownPoints();
    void normalsLookToTheViewpoint();
    void normalsAgreeAlongATree();
    void normalsOfOtherPrograms();
    void normalsKeepScaledNumbers();
    void featuresOfLinePlaneAndVolume();
    void featuresThatAreChosen();
    void splatRadiusOfAGrid();
    void clustersAreTold();
    void lonelyPointsAreTold();
    void degenerateCloudsWork();
    void sameOnAnyNumberOfThreads();
    void badValuesAreRefused();
    void withinChangesNoOthers();
    void cancels();
};

void ShapeTest::spreadOfKnownPoints()
{
    // variances 16, 4, 1 along turned axes
    const double c = std::cos(0.4), s = std::sin(0.4);
    std::vector<std::array<float, 3>> points;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            std::array<double, 3> p{};
            p[std::size_t(axis)] = sign * std::sqrt(3.0) * (axis == 0 ? 4 : axis == 1 ? 2 : 1);
            points.push_back({float(c * p[0] - s * p[2] + 100), float(p[1] - 50), float(s * p[0] + c * p[2] + 7)});
        }
    const Spread spread = spreadOf(points);
    QVERIFY(std::abs(spread.l1() - 16) < 1e-4 && std::abs(spread.l2() - 4) < 1e-4 &&
            std::abs(spread.l3() - 1) < 1e-4);
    QVERIFY(std::abs(std::abs(-s * spread.least[0] + c * spread.least[2]) - 1) < 1e-6);
    QVERIFY(std::abs(spread.mean[0] - 100) < 1e-4);
    QVERIFY(spreadOf({}).sum() == 0);
    const std::vector<std::array<float, 3>> line = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {-3, -6, -9}};
    QVERIFY(spreadOf(line).least == Spread::Vector{} && spreadOf(line).l1() > 0);
    const std::vector<std::array<float, 3>> one(9, {3, 3, 3});
    QVERIFY(spreadOf(one).least == Spread::Vector{} && spreadOf(one).sum() == 0);
}

void ShapeTest::normalsLookToTheViewpoint()
{
    const auto cloud = makeSphere(5000);
    run(*cloud, "normals k=12 orientation=viewpoint viewpoint=457000,5552000,100")->apply(*cloud);
    for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(outward(*cloud, i) < -0.98);
    run(*cloud, "normals k=12 orientation=up")->apply(*cloud);
    for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(number(*cloud, "NormalZ", i) >= 0);
    QVERIFY_EXCEPTION_THROWN(run(*cloud, "normals orientation=viewpoint"), Error);
    QVERIFY_EXCEPTION_THROWN(run(*cloud, "normals orientation=viewpoint viewpoint=1,2"), Error);
    QVERIFY_EXCEPTION_THROWN(run(*cloud, "normals orientation=viewpoint viewpoint=1,2,x"), Error);
}

void ShapeTest::normalsAgreeAlongATree()
{
    const auto cloud = makeSphere(5000);
    run(*cloud, "normals k=12 orientation=tree curvature=yes")->apply(*cloud);
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        QVERIFY(outward(*cloud, i) > 0.98);
        QVERIFY(number(*cloud, "Curvature", i) > 0 && number(*cloud, "Curvature", i) < 0.01);
    }
    // Two spheres apart: each for itself.
    const auto two = inMillimeters(4000);
    const auto half = makeSphere(2000);
    for (PointIndex i = 0; i < 4000; ++i) {
        for (std::size_t a = 0; a < 3; ++a) rawAxis(*two, a)[i] = rawAxis(*half, a)[i % 2000];
        if (i >= 2000) rawAxis(*two, 0)[i] += 100'000;
    }
    run(*two, "normals k=12 orientation=tree")->apply(*two);
    for (PointIndex i = 0; i < 4000; ++i) {
        const double away = i < 2000 ? 0 : 10.0 * two->findAttribute("Normal")->number(i, 0);
        QVERIFY(outward(*two, i) - away > 0.97);
    }
}

void ShapeTest::normalsOfOtherPrograms()
{
    const auto path = std::filesystem::path(PUNCTUM_TEST_DATA) / "cases" / "normals-metashape.las";
    if (!std::filesystem::exists(path)) QSKIP("normals-metashape.las is not here.");
    Progress progress;
    const auto cloud = las::load(path, progress);
    const auto parts = normalParts(*cloud);
    QVERIFY(parts.has_value());
    const Attribute* const normal = cloud->findAttribute("Normal");
    QVERIFY(normal != nullptr && normal->kind == AttributeKind::Vector);
    const std::string name = (*parts)[2]->name;
    const ScalarType type = (*parts)[2]->type();
    const std::size_t attributes = cloud->attributes().size();
    const std::size_t columns = cloud->columns().size();
    // in its own type, under its own name; what is computed fits what the program computed in its type
    const auto command = run(*cloud, "normals k=8");
    command->apply(*cloud);
    QCOMPARE(cloud->attributes().size(), attributes);
    QCOMPARE(cloud->columns().size(), columns);
    QVERIFY(cloud->findAttribute(name)->type() == type);
    PointIndex unit = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        double length = 0;
        for (std::uint32_t c = 0; c < 3; ++c) length += std::pow(cloud->findAttribute("Normal")->number(i, c), 2);
        unit += std::abs(length - 1) < 0.05 || length == 0;
        QVERIFY(number(*cloud, name.c_str(), i) >= 0);
    }
    QCOMPARE(unit, cloud->size());
    command->apply(*cloud);
}

void ShapeTest::normalsKeepScaledNumbers()
{
    const auto cloud = makeSphere(2000);
    for (const char* name : {"nx", "ny", "nz"}) {
        addScalar<std::int8_t>(*cloud, name);
        Attribute scaled = *cloud->findAttribute(name);
        scaled.scaled = true;
        scaled.scale = 1.0 / 127;
        cloud->replaceAttribute(scaled);
    }
    addNormalVector(*cloud);
    QVERIFY(cloud->findAttribute("Normal") != nullptr);
    const auto before = snapshot(*cloud);
    const auto command = run(*cloud, "normals k=12 orientation=tree");
    command->apply(*cloud);
    QVERIFY(cloud->findAttribute("NormalX") == nullptr);
    for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(outward(*cloud, i) > 0.95);
    QVERIFY(cloud->findAttribute("nx")->type() == ScalarType::I8);
    command->apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
}

void ShapeTest::featuresOfLinePlaneAndVolume()
{
    std::mt19937_64 random(4);
    const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
    for (int dimensions = 1; dimensions <= 3; ++dimensions) {
        const auto cloud = inMillimeters(4000);
        const double side = dimensions == 1 ? 4000 : dimensions == 2 ? 63.2 : 15.9;  // a point by unit
        for (PointIndex i = 0; i < 4000; ++i)
            put(*cloud, i, unit() * side, dimensions > 1 ? unit() * side : 0, dimensions > 2 ? unit() * side : 0);
        run(*cloud, "features k=40")->apply(*cloud);
        double linearity = 0, planarity = 0, sphericity = 0, density = 0;
        for (PointIndex i = 0; i < 4000; ++i) {
            const double l = number(*cloud, "Linearity", i), p = number(*cloud, "Planarity", i),
                         s = number(*cloud, "Sphericity", i);
            QVERIFY(std::abs(l + p + s - 1) < 1e-5);
            QVERIFY(std::abs(number(*cloud, "Anisotropy", i) + s - 1) < 1e-5);
            linearity += l / 4000;
            planarity += p / 4000;
            sphericity += s / 4000;
            density += number(*cloud, "Density", i) / 4000;
            if (dimensions == 2) {
                QVERIFY(number(*cloud, "Verticality", i) < 1e-6 && number(*cloud, "Roughness", i) < 1e-6);
                QVERIFY(number(*cloud, "Curvature", i) < 1e-12 && number(*cloud, "Omnivariance", i) < 1e-3);
            }
        }
        if (dimensions == 1) QVERIFY(linearity > 0.999);
        if (dimensions == 2) QVERIFY(planarity > 0.6 && sphericity < 1e-9 && density > 0.9 && density < 1.1);
        if (dimensions == 3) QVERIFY(sphericity > 0.4);
    }
}

void ShapeTest::featuresThatAreChosen()
{
    const auto cloud = makeSphere(500);
    run(*cloud, "features k=12 which=\"planarity, Roughness\"")->apply(*cloud);
    QVERIFY(cloud->findAttribute("Planarity") != nullptr && cloud->findAttribute("Roughness") != nullptr);
    QVERIFY(cloud->findAttribute("Linearity") == nullptr);
    QVERIFY_EXCEPTION_THROWN(run(*cloud, "features which=Roundness"), Error);
}

void ShapeTest::splatRadiusOfAGrid()
{
    const auto cloud = inMillimeters(400);
    for (PointIndex i = 0; i < 400; ++i) put(*cloud, i, double(i % 20), double(i / 20), 0);
    run(*cloud, "splat-radius k=8")->apply(*cloud);
    // the eighth neighbor is at the diagonal of a cell: 2 sqrt(2 / 8)
    QVERIFY(std::abs(number(*cloud, "SplatRadius", 10 * 20 + 10) - 1.0) < 1e-6);
}

void ShapeTest::clustersAreTold()
{
    // Three groups on a line: 50, 30 and 5 points, steps of 1, with gaps of 4.
    const auto cloud = inMillimeters(85);
    double x = 0;
    for (PointIndex i = 0; i < 85; ++i) {
        put(*cloud, i, x, 0, 0);
        x += i == 4 || i == 34 ? 4 : 1;
    }
    const auto command = run(*cloud, "clusters tolerance=1.5 points=10");
    QCOMPARE(QString::fromStdString(command->finding()), QString("2 clusters."));
    command->apply(*cloud);
    QVERIFY(cloud->findAttribute("ClusterId")->kind == AttributeKind::Category);
    for (PointIndex i = 0; i < 85; ++i) QCOMPARE(number(*cloud, "ClusterId", i), i < 5 ? 0.0 : i < 35 ? 2.0 : 1.0);
    command->apply(*cloud);
    QVERIFY(cloud->findAttribute("ClusterId") == nullptr);
    // without a point in the middle its group falls in two
    PointSet some(85);
    for (PointIndex i = 0; i < 85; ++i)
        if (i != 60) some.insert(i);
    run(*cloud, "clusters tolerance=1.5 points=10", &some)->apply(*cloud);
    QCOMPARE(number(*cloud, "ClusterId", 59), 2.0);
    QCOMPARE(number(*cloud, "ClusterId", 60), 0.0);
    QCOMPARE(number(*cloud, "ClusterId", 61), 3.0);
}

void ShapeTest::lonelyPointsAreTold()
{
    const auto cloud = inMillimeters(101);
    for (PointIndex i = 0; i < 100; ++i) put(*cloud, i, double(i % 10), double(i / 10), 0);
    put(*cloud, 100, 50, 50, 0);
    run(*cloud, "radius-outliers radius=1 neighbors=3 class=7")->apply(*cloud);
    const auto classes = cloud->columns()[3]->values<std::uint8_t>();
    for (PointIndex i = 0; i < 101; ++i) {
        const bool corner = i < 100 && (i % 10 == 0 || i % 10 == 9) && (i / 10 == 0 || i / 10 == 9);
        QCOMPARE(classes[i] == 7, corner || i == 100);
    }
    QVERIFY(run(*cloud, "radius-outliers radius=1 neighbors=3 class=7") == nullptr);  // nothing changes again
}

void ShapeTest::degenerateCloudsWork()
{
    for (const char* step : kSteps)
        for (const PointIndex n : {0, 1, 2, 3, 40, 3000})
            for (int kind = 0; kind < 4; ++kind) {
                const auto cloud = inMillimeters(n);
                for (PointIndex i = 0; i < n; ++i) {
                    if (kind == 0) put(*cloud, i, 1, 2, 3);
                    if (kind == 1) put(*cloud, i, double(i), 2 * double(i), 0);
                    if (kind == 2) put(*cloud, i, double(i % 7), double(i / 7), 0);
                    if (kind == 3) put(*cloud, i, double(i % 3), double(i % 2), double(i % 5));
                }
                if (n > 2) {
                    auto deleted = std::make_shared<PointSet>(n);
                    deleted->insert(1);
                    cloud->setDeleted(deleted);
                }
                const auto command = run(*cloud, step);
                if (!command) continue;
                command->apply(*cloud);
                for (const Attribute& a : cloud->attributes())
                    for (std::uint32_t c = 0; c < a.components; ++c)
                        for (PointIndex i = 0; i < n; ++i) QVERIFY2(std::isfinite(a.number(i, c)), step);
            }
}

void ShapeTest::sameOnAnyNumberOfThreads()
{
    Progress progress;
    for (const char* step : kSteps) {
        std::vector<decltype(snapshot(*makeFrame(1)))> results;
        for (const std::size_t threads : {1, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            const auto cloud = makeSample(30'000, 9, progress);
            if (const auto command = run(*cloud, step)) command->apply(*cloud);
            results.push_back(snapshot(*cloud));
        }
        QVERIFY2(results[0] == results[1], step);
    }
}

void ShapeTest::badValuesAreRefused()
{
    const auto cloud = makeSphere(100);
    for (const char* text :
         {"normals k=2", "normals radius=0", "normals orientation=down", "features k=0", "features radius=-1",
          "clusters tolerance=0", "clusters points=0", "splat-radius k=0", "radius-outliers radius=nan",
          "radius-outliers neighbors=0", "normals curvature=maybe"})
        QVERIFY_EXCEPTION_THROWN(run(*cloud, text), Error);
}

void ShapeTest::withinChangesNoOthers()
{
    const auto cloud = makeSphere(1000);
    PointSet some(1000);
    for (PointIndex i = 0; i < 1000; i += 3) some.insert(i);
    for (const char* step : {"normals k=8", "features k=8", "splat-radius k=8", "normals k=8 orientation=tree"}) {
        run(*cloud, step, &some)->apply(*cloud);
        for (const Attribute& a : cloud->attributes()) {
            if (a.components != 1 || isFloating(a.type()) == false || a.name == "GpsTime") continue;
            for (PointIndex i = 0; i < 1000; ++i)
                if (!some.contains(i)) QCOMPARE(a.number(i), 0.0);
        }
        QVERIFY(run(*cloud, step, &some) != nullptr);
    }
}

void ShapeTest::cancels()
{
    Progress made;
    const auto cloud = makeSample(200'000, 2, made);
    for (const char* step : kSteps) {
        const ParsedStep parsed = parseStep(step);
        Progress progress;
        progress.cancel();
        QVERIFY_EXCEPTION_THROWN((void)parsed.step->run(*cloud, parsed.values, progress), Cancelled);
    }
}

QTEST_APPLESS_MAIN(ShapeTest)
#include "ShapeTest.moc"
