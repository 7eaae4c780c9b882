// SPDX-License-Identifier: MIT
// Steps that are made of neighborhoods: normals and outliers.
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/neighbors/KdOrder.h"
#include "core/sample/Sample.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/CancelAfter.h"
#include "tests/core/TroubleClouds.h"

#include <QTest>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <thread>

using namespace punctum;

Q_DECLARE_METATYPE(punctum::CoordinateUnits)

class NeighborStepsTest : public QObject
{
    Q_OBJECT

private slots:
    void normalsStandOnPlanes_data();
    void normalsStandOnPlanes();
    void normalsOfPointsWithoutPlane();
    void slopesAreTrueInAnyUnits_data();
    void slopesAreTrueInAnyUnits();
    void slopeOfARealFile();
    void normalsKeepTheFilesType();
    void normalsRefuseAnotherType();
    void outliersMatchPlainLoop();
    void outliersOfFewPoints();
    void cancelAnswers_data();
    void cancelAnswers();
    void editsGetIn();
    void outliersAtThePresetAreFew();
};

void NeighborStepsTest::normalsStandOnPlanes_data()
{
    QTest::addColumn<QString>("step");
    QTest::addColumn<bool>("degrees");
    QTest::newRow("k") << "normals k=12" << false;
    QTest::newRow("radius") << "normals radius=5" << false;
    QTest::newRow("degrees") << "normals k=12" << true;
}

void NeighborStepsTest::normalsStandOnPlanes()
{
    QFETCH(QString, step);
    QFETCH(bool, degrees);
    // z = a x + b y far from the origin of its coordinates; raw steps are a millionth of the extent.
    CoordinateScale scale{glm::dvec3(0.001), glm::dvec3(4.5e6, 5.5e6, 1000.0)};
    if (degrees) scale = {glm::dvec3(1e-9), glm::dvec3(179.0, 52.0, 0.0)};
    const auto cloud = makeFrame(kFastBuild ? 60'000 : 15'000, scale);
    std::mt19937_64 random(5);
    const double a = 0.3, b = -1.7;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const double x = double(random() % 100'000), y = double(random() % 100'000);
        place(*cloud, i, x, y, std::floor(a * x + b * y + 0.5));
    }
    const auto command = runStep(*cloud, step.toStdString());
    QCOMPARE(command->changedPoints(), cloud->size());
    QVERIFY(cloud->findAttribute("NormalX") == nullptr);  // nothing changes before the command is applied
    command->apply(*cloud);
    const Attribute* normal = cloud->findAttribute("Normal");
    QVERIFY(normal != nullptr && normal->kind == AttributeKind::Vector && normal->type() == ScalarType::F32);
    const double length = std::sqrt(1 + a * a + b * b);
    double worst = 1;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const double nx = normal->number(i, 0), ny = normal->number(i, 1), nz = normal->number(i, 2);
        QVERIFY(std::abs(nx * nx + ny * ny + nz * nz - 1) < 1e-5 && nz >= 0);
        worst = std::min(worst, (-a * nx - b * ny + nz) / length);
    }
    QVERIFY2(worst > 0.9999, qPrintable(QString::number(worst)));
    command->apply(*cloud);
    QVERIFY(cloud->findAttribute("NormalX") == nullptr && cloud->columns().size() == 4);
}

void NeighborStepsTest::slopesAreTrueInAnyUnits_data()
{
    using Kind = CoordinateUnits::Kind;
    constexpr double kFoot = 0.3048;
    QTest::addColumn<CoordinateUnits>("units");
    QTest::addColumn<double>("xStep");  // of X and of Z, for a length
    QTest::addColumn<double>("zStep");
    QTest::addColumn<QString>("unit");
    QTest::newRow("none stated") << CoordinateUnits() << 1.0 << 1.0 << "";
    QTest::newRow("meters") << CoordinateUnits{Kind::Lengths, "m", "m", 1.0, 1.0} << 1.0 << 1.0 << "m";
    QTest::newRow("feet") << CoordinateUnits{Kind::Lengths, "ft", "ft", kFoot, kFoot} << 1.0 << 1.0 << "ft";
    QTest::newRow("heights in feet") << CoordinateUnits{Kind::Lengths, "m", "ft", 1.0, kFoot} << 1.0 << 1.0 / kFoot
                                     << "m";
    QTest::newRow("heights in meters") << CoordinateUnits{Kind::Lengths, "ft", "m", kFoot, 1.0} << 1.0 << kFoot
                                       << "ft";
    // of longitude at a latitude of 52 degrees, on the ellipsoid
    QTest::newRow("degrees") << CoordinateUnits::degreesAndMeters() << 1.0 / 68678.0 << 1.0 << "m";
}

// A plane that rises by a tenth, and one of 45 degrees, in points that are one unit of length apart along X and Y.
void NeighborStepsTest::slopesAreTrueInAnyUnits()
{
    QFETCH(CoordinateUnits, units);
    QFETCH(double, xStep);
    QFETCH(double, zStep);
    QFETCH(QString, unit);
    constexpr int kSide = 40;
    constexpr double kScale = 1e-9;
    const bool degrees = units.kind == CoordinateUnits::Kind::Degrees;
    const double yStep = degrees ? 1.0 / 111267.0 : xStep;
    const double xyScale = degrees ? kScale : 0.001;
    for (const double rise : {0.1, 1.0}) {
        const auto cloud = makeFrame(kSide * kSide, {{xyScale, xyScale, 0.001}, {13.0, 52.0, 0.0}});
        cloud->setUnits(units);
        for (int k = 0; k < kSide * kSide; ++k) {
            const double x = k % kSide, y = k / kSide;
            place(*cloud, PointIndex(k), std::round(x * xStep / xyScale), std::round(y * yStep / xyScale),
                  std::round(x * rise * zStep / 0.001));
        }
        // by so many points, and by a radius, which is a length too
        for (const char* step : {"normals k=9", "normals radius=1.45"}) {
            runStep(*cloud, step)->apply(*cloud);
            const auto z = cloud->findAttribute("NormalZ")->columns[0]->values<float>();
            const double expected = 1.0 / std::sqrt(1.0 + rise * rise);
            for (const float found : z)
                QVERIFY2(
                    std::abs(double(found) - expected) < 0.002,
                    qPrintable(QStringLiteral("%1, %2: %3").arg(QLatin1String(step)).arg(expected).arg(found)));
        }
        Progress progress;
        const KdOrder order(*cloud, progress);
        QCOMPARE(QString::fromStdString(order.lengths().unit), unit);
        std::vector<KdOrder::Found> found;
        const auto middle = std::uint32_t(kSide * kSide / 2 + kSide / 2);
        const double aside = std::sqrt(1.0 + rise * rise);
        QVERIFY(order.within(middle, aside * 1.01, found, progress));
        QCOMPARE(found.size(), std::size_t(5));
        order.nearest(middle, 2, found);
        QVERIFY(std::abs(std::sqrt(found[1].squared) - 1.0) < 0.002);  // along the slope nothing rises
    }
}

void NeighborStepsTest::slopeOfARealFile()
{
    const std::filesystem::path path = std::filesystem::path(PUNCTUM_TEST_DATA) / "cases" / "slope-m-ftus.las";
    if (!std::filesystem::exists(path)) QSKIP("slope-m-ftus.las is not here.");
    Progress progress;
    const auto cloud = las::load(path, progress);
    runStep(*cloud, "normals k=16")->apply(*cloud);
    const auto z = cloud->findAttribute("NormalZ")->columns[0]->values<float>();
    const double mean = std::accumulate(z.begin(), z.end(), 0.0) / double(z.size());
    QVERIFY2(std::abs(mean - 0.707) < 0.01, qPrintable(QString::number(mean)));
}

void NeighborStepsTest::normalsOfPointsWithoutPlane()
{
    for (const char* kind : {"one place", "line", "isolated", "corners", "doubled"}) {
        const auto cloud = makeTrouble(kind, kFastBuild ? 8'000 : 3'000);
        for (const char* step : {"normals k=8", "normals radius=0.05"}) {
            runStep(*cloud, step)->apply(*cloud);
            const Attribute* normal = cloud->findAttribute("Normal");
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                double length = 0;
                for (std::uint32_t c = 0; c < 3; ++c) length += normal->number(i, c) * normal->number(i, c);
                // a NaN is neither
                QVERIFY2(length == 0.0 || std::abs(length - 1) < 1e-4, kind);
                QVERIFY(normal->number(i, 2) >= 0);
                if (std::string(kind) == "one place") QVERIFY(length == 0.0);
            }
        }
    }
}

void NeighborStepsTest::normalsKeepTheFilesType()
{
    const auto cloud = makeTrouble("plane", 5000);
    for (const char* name : {"NormalX", "NormalY", "NormalZ"}) addScalar<double>(*cloud, name);
    addComposite(*cloud, "Normal", AttributeKind::Vector, {"NormalX", "NormalY", "NormalZ"});
    addScalar<std::uint8_t>(*cloud, "After");
    const auto columns = cloud->columns();
    const auto before = snapshot(*cloud);
    const auto command = runStep(*cloud, "normals");
    command->apply(*cloud);
    QVERIFY(cloud->columns() == columns);  // in their places in the record
    QVERIFY(cloud->findAttribute("NormalZ")->type() == ScalarType::F64);
    QVERIFY(cloud->findAttribute("Normal")->number(9, 2) > 0.5);
    command->apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
}

void NeighborStepsTest::normalsRefuseAnotherType()
{
    const auto cloud = makeTrouble("plane", 50);
    addScalar<std::int16_t>(*cloud, "NormalY");
    try {
        runStep(*cloud, "normals");
        QFAIL("accepted");
    } catch (const Error& e) {
        QCOMPARE(QString(e.what()), QString("The cloud's attribute NormalY does not hold plain decimal numbers, so "
                                            "that these values cannot be kept in it; rename or remove it first."));
    }
}

void NeighborStepsTest::outliersMatchPlainLoop()
{
    for (const char* kind : {"volume", "isolated", "scanner", "doubled"}) {
        const auto cloud = makeTrouble(kind, kFastBuild ? 3000 : 1000);
        auto classes = cloud->columns()[3]->values<std::uint8_t>();
        classes[0] = 18;
        std::vector<double> mean(cloud->size());
        double sum = 0, squares = 0;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const auto d = allDistances(*cloud, i, 9);
            for (std::size_t j = 1; j <= 8; ++j) mean[i] += std::sqrt(d[j]) / 8;
            sum += mean[i];
            squares += mean[i] * mean[i];
        }
        const auto n = double(cloud->size());
        const double threshold = sum / n + 1.5 * std::sqrt((squares - sum * sum / n) / (n - 1));
        const auto command = runStep(*cloud, "outliers k=8 deviations=1.5 class=18");
        if (command) command->apply(*cloud);
        PointIndex outliers = 0;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            if (std::abs(mean[i] - threshold) < 1e-5 * threshold) continue;
            QVERIFY2((classes[i] == 18) == (mean[i] > threshold || i == 0), kind);
            outliers += mean[i] > threshold;
        }
        QVERIFY2(outliers > 0 || std::string(kind) == "doubled", kind);
    }
}

void NeighborStepsTest::outliersOfFewPoints()
{
    QVERIFY(runStep(*makeTrouble("volume", 8), "outliers k=8") == nullptr);
    QVERIFY(runStep(*makeTrouble("one place", 5000), "outliers") == nullptr);
    // a class that the field has no bits for
    Progress progress;
    const auto cloud = makeFrame(100, {}, true);
    for (PointIndex i = 0; i < 100; ++i) place(*cloud, i, double(i * i), 0, 0);  // sparser and sparser
    const auto narrow = runStep(*cloud, "outliers k=8 deviations=0 class=31");
    const auto wide = runStep(*cloud, "outliers k=8 deviations=0 class=64");
    QVERIFY(narrow && wide);
    QCOMPARE(wide->changedPoints(), narrow->changedPoints());
    wide->apply(*cloud);
    QCOMPARE(countValues(*cloud->findAttribute("Classification"), progress)[64], wide->changedPoints());
}

void NeighborStepsTest::cancelAnswers_data()
{
    QTest::addColumn<QString>("step");
    QTest::addColumn<int>("after");
    for (const char* step : {"normals k=16", "normals radius=50", "outliers k=1000"})
        for (const int after : {0, 40, 200, 800})
            QTest::newRow(qPrintable(QString("%1 after %2 ms").arg(step).arg(after))) << QString(step) << after;
}

void NeighborStepsTest::cancelAnswers()
{
    QFETCH(QString, step);
    QFETCH(int, after);
    static const auto cloud = [] {
        Progress progress;
        return makeSample(kFastBuild ? 3'000'000 : 300'000, 3, progress);
    }();
    const ParsedStep parsed = parseStep(step.toStdString());
    const auto [cancelled, ms] =
        cancelAfter(after, [&](Progress& progress) { (void)parsed.step->run(*cloud, parsed.values, progress); });
    QVERIFY(cancelled || !kFastBuild);  // a small cloud may be done before
    qInfo("stopped %.1f ms after the cancel", ms);
    QVERIFY(ms < 1000.0 || !kFastBuild);  // the rule is 100 ms; test machines are shared
}

void NeighborStepsTest::editsGetIn()
{
    // While normals are worked out, an edit waits for the lock no longer than some milliseconds, not to their end.
    const auto cloud = makeTrouble("plane", kFastBuild ? 1'000'000 : 30'000);
    Progress progress;
    std::atomic<bool> done{false};
    const ParsedStep parsed = parseStep("normals k=16");
    std::thread worker([&] {
        (void)parsed.step->run(*cloud, parsed.values, progress);
        done = true;
    });
    double worst = 0;
    while (!done) {
        const auto start = std::chrono::steady_clock::now();
        cloud->mutex().lock();
        cloud->mutex().unlock();
        worst = std::max(
            worst, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    worker.join();
    QVERIFY2(worst < 250.0 || !kFastBuild, qPrintable(QString::number(worst)));
}

// At the preset few points of an ordinary survey are strays.
void NeighborStepsTest::outliersAtThePresetAreFew()
{
    Progress progress;
    const auto cloud = makeSample(60'000, 5, progress);
    const auto command = runStep(*cloud, "outliers");
    const PointIndex strays = command ? command->changedPoints() : 0;
    QVERIFY2(strays < cloud->size() / 50, qPrintable(QString::number(strays)));
}

QTEST_APPLESS_MAIN(NeighborStepsTest)
#include "NeighborStepsTest.moc"
