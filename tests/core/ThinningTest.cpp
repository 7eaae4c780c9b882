// SPDX-License-Identifier: MIT
// How well the points that are kept stand for the surface of those that are not: docs/dev/thinning.md.
#include "core/las/Reader.h"
#include "core/neighbors/KdOrder.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "core/thin/Surface.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/parallel_for.h>

#include <chrono>
#include <cmath>
#include <filesystem>

using namespace punctum;

namespace
{

PointSet keptOf(const PointCloud& cloud, const std::string& text)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    const auto command = parsed.step->run(cloud, parsed.values, progress);
    PointSet kept = command ? *command->points() : PointSet(cloud.size());
    kept.invert();
    return kept;
}

struct Figures {
    double mean = 0, most = 0;  ///< distance to the plane of the six nearest kept points: mean, 99 of 100 below
    double apart = 0;           ///< to the nearest kept point, mean
};

/// Of a sample of the points that were not kept.
Figures measure(const PointCloud& cloud, const PointSet& kept)
{
    Progress progress;
    const KdOrder order(cloud, progress, &kept);
    std::vector<std::uint32_t> dropped;
    const PointIndex step = std::max<PointIndex>(1, cloud.size() / 100'000);
    for (PointIndex i = 0; i < cloud.size(); i += step)
        if (!kept.contains(i)) dropped.push_back(std::uint32_t(i));
    std::vector<double> off(dropped.size()), near(dropped.size());
    tbb::parallel_for(std::size_t(0), dropped.size(), [&](std::size_t k) {
        std::vector<KdOrder::Found> found;
        const KdOrder::Raw raw{cloud.rawX()[dropped[k]], cloud.rawY()[dropped[k]], cloud.rawZ()[dropped[k]]};
        order.nearest(KdOrder::place(raw), 6, found);
        std::vector<std::array<float, 3>> around;
        std::array<double, 3> mean{};
        for (const auto& f : found) {
            around.push_back(order.local(f.point, {double(raw[0]), double(raw[1]), double(raw[2])}));
            for (std::size_t a = 0; a < 3; ++a) mean[a] += double(around.back()[a]) / double(found.size());
        }
        const auto n = planeNormal(around);
        off[k] = std::fabs(double(n[0]) * mean[0] + double(n[1]) * mean[1] + double(n[2]) * mean[2]);
        near[k] = std::sqrt(found.front().squared);
    });
    Figures figures;
    for (std::size_t k = 0; k < off.size(); ++k) {
        figures.mean += off[k] / double(off.size());
        figures.apart += near[k] / double(off.size());
    }
    std::sort(off.begin(), off.end());
    figures.most = off.empty() ? 0 : off[off.size() * 99 / 100];
    return figures;
}

/// The radius by which Poisson disks keep about so many points.
double radiusFor(const PointCloud& cloud, PointIndex count)
{
    double low = 1e-4, high = 1e4;
    for (int k = 0; k < 24; ++k) {
        const double radius = std::sqrt(low * high);
        const PointIndex kept = keptOf(cloud, "thin method=distance radius=" + std::to_string(radius)).count();
        if (std::llabs(std::int64_t(kept) - std::int64_t(count)) < std::int64_t(count / 200)) return radius;
        (kept > count ? low : high) = radius;
    }
    return std::sqrt(low * high);
}

const char* const kMethods[] = {"normal-deviation", "entropy", "k-clustering"};

}  // namespace

class ThinningTest : public QObject
{
    Q_OBJECT

private slots:
    void ridgesKeepMore();
    void figuresOfRealFiles_data();
    void figuresOfRealFiles();
};

// A roof of 40 by 40 m, in whose ridge and eaves lies all that its surface needs.
void ThinningTest::ridgesKeepMore()
{
    const PointIndex n = 40'000;
    const auto cloud = makeFrame(n, {glm::dvec3(0.001), glm::dvec3(0.0)});
    std::mt19937_64 random(2);
    const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
    const auto height = [](double x) { return x < 10 ? 0.0 : 15 - std::fabs(x - 20) * 1.5; };
    for (PointIndex i = 0; i < n; ++i) {
        const double x = 40 * unit();
        rawAxis(*cloud, 0)[i] = std::int32_t(x * 1000);
        rawAxis(*cloud, 1)[i] = std::int32_t(40'000 * unit());
        rawAxis(*cloud, 2)[i] = std::int32_t(height(std::min(x, 30.0)) * 1000 + 4 * unit());
    }
    const Figures even = measure(*cloud, keptOf(*cloud, "thin method=number count=2000"));
    for (const char* method : kMethods) {
        const PointSet kept = keptOf(*cloud, std::string("thin-to count=2000 method=") + method);
        QCOMPARE(kept.count(), PointIndex(2000));
        double ridge = 0, flat = 0;
        kept.forEach([&](PointIndex i) {
            const double x = cloud->world(i).x;
            (std::fabs(x - 20) < 0.5 || std::fabs(x - 10) < 0.5 || std::fabs(x - 30) < 0.5 ? ridge : flat) += 1;
        });
        const double share = ridge / 3 / (flat / 37);  // per meter of x
        const Figures figures = measure(*cloud, kept);
        qInfo("%s: %.1f times as many on edges; off by %.4f m, evenly chosen %.4f", method, share, figures.mean,
              even.mean);
        QVERIFY2(share > 1.2, method);
        QVERIFY2(figures.mean < even.mean, method);
    }
}

// Run with PUNCTUM_FIGURES set: the table in docs/dev/thinning.md.
void ThinningTest::figuresOfRealFiles_data()
{
    QTest::addColumn<QString>("file");
    for (const char* file : {"lone-star.laz", "lion_takanawa.copc.laz", "bcts_2.laz"})
        QTest::newRow(file) << QString(file);
}

void ThinningTest::figuresOfRealFiles()
{
    QFETCH(QString, file);
    if (!qEnvironmentVariableIsSet("PUNCTUM_FIGURES")) QSKIP("PUNCTUM_FIGURES is not set");
    const auto path = std::filesystem::path(PUNCTUM_TEST_DATA) / file.toStdString();
    if (!std::filesystem::exists(path)) QSKIP(qPrintable(file + " is not there"));
    Progress progress;
    const auto cloud = las::load(path, progress);
    const PointIndex count = cloud->size() / 20;
    std::vector<std::string> steps{"thin method=number count=" + std::to_string(count),
                                   "thin method=distance radius=" + std::to_string(radiusFor(*cloud, count))};
    for (const char* method : kMethods)
        steps.push_back(std::string("thin-to method=") + method + " count=" + std::to_string(count));
    for (const std::string& step : steps) {
        const auto start = std::chrono::steady_clock::now();
        const PointSet kept = keptOf(*cloud, step);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const Figures f = measure(*cloud, kept);
        qInfo("| %s | %llu | %.5f | %.5f | %.5f | %.2f |", step.c_str(), qulonglong(kept.count()), f.mean, f.most,
              f.apart, seconds);
    }
}

QTEST_APPLESS_MAIN(ThinningTest)
#include "ThinningTest.moc"
