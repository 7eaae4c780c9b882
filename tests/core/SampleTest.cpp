// SPDX-License-Identifier: MIT
// The synthetic survey: the same everywhere, consistent as a scanner's data are, and like a country.
#include "core/sample/Sample.h"

#include "core/Error.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"
#include "tests/core/CancelAfter.h"
#include "tests/core/MadeCloud.h"

#include <tbb/global_control.h>

#include <QTest>

#include <cmath>
#include <set>

using namespace punctum;

namespace
{

std::shared_ptr<PointCloud> make(PointIndex points, std::uint64_t seed = 1)
{
    Progress progress;
    return makeSample(points, seed, progress);
}

/// FNV-1a over every column.
std::uint64_t fingerprint(const PointCloud& cloud)
{
    std::uint64_t h = 0xCBF29CE484222325u;
    for (const auto& column : snapshot(cloud))
        for (const std::byte b : column) h = (h ^ std::uint64_t(b)) * 0x100000001B3u;
    return h;
}

}  // namespace

class SampleTest : public QObject
{
    Q_OBJECT

private slots:
    void initTestCase() { m_cloud = make(kPoints); }
    void isTheSameEverywhere();
    void isTheSameOnAnyNumberOfThreads();
    void seedsDiffer();
    void hasTheAskedNumber_data();
    void hasTheAskedNumber();
    void isPointFormatSeven();
    void returnsAreConsistent();
    void timeRises();
    void linesOverlap();
    void classesAreThere();
    void valuesAreInRange();
    void cancels();
    void refusesAbsurdSizes();

private:
    static constexpr PointIndex kPoints = 400'000;
    std::shared_ptr<PointCloud> m_cloud;

    template <typename T>
    std::span<const T> column(const std::string& name) const
    {
        for (const auto& c : m_cloud->columns())
            if (c->name() == name) return std::as_const(*c).values<T>();
        qFatal("no column");
    }
};

void SampleTest::isTheSameEverywhere()
{
    // A change of the landscape changes this number on purpose; another machine or compiler must not.
    QCOMPARE(QString::number(fingerprint(*make(50'000)), 16), QString("79f38626175aab17"));
}

void SampleTest::isTheSameOnAnyNumberOfThreads()
{
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    QVERIFY(fingerprint(*make(kPoints)) == fingerprint(*m_cloud));
}

void SampleTest::seedsDiffer()
{
    QVERIFY(fingerprint(*make(20'000, 2)) != fingerprint(*make(20'000, 3)));
}

void SampleTest::hasTheAskedNumber_data()
{
    QTest::addColumn<qulonglong>("points");
    for (const qulonglong n : {0ull, 1ull, 2ull, 3ull, 10ull, 63ull, 1000ull, 12'345ull, 100'001ull})
        QTest::newRow(qPrintable(QString::number(n))) << n;
}

void SampleTest::hasTheAskedNumber()
{
    QFETCH(qulonglong, points);
    const auto cloud = make(points);
    QCOMPARE(cloud->size(), PointIndex(points));
    const Attribute* number = cloud->findAttribute("ReturnNumber");
    for (PointIndex i = 0; i < points; ++i) QVERIFY(number->number(i) >= 1);  // every point was written
}

void SampleTest::isPointFormatSeven()
{
    const auto& source = m_cloud->source();
    QVERIFY(source != nullptr);
    QCOMPARE(int(source->header.pointFormat()), 7);
    QCOMPARE(int(source->header.versionMinor()), 4);
    QCOMPARE(source->pointCount, kPoints);
    QCOMPARE(int(source->layout.length), 36 + 4 + 2);
    QVERIFY(source->crs.find("UTM zone 33N") != std::string::npos);
    QCOMPARE(m_cloud->columns().size(), source->layout.fields.size());
    for (const char* name : {"RGB", "Reflectance", "Deviation", "GpsTime", "ScanAngle", "Intensity"})
        QVERIFY2(m_cloud->findAttribute(name) != nullptr, name);
    QCOMPARE(m_cloud->coordinates().scale.x, 0.001);
    const auto bounds = m_cloud->coordinates().toWorld(m_cloud->computeBounds());
    QVERIFY(bounds.min.x > 450'000 && bounds.min.y > 5'500'000);
    const double density = double(kPoints) / ((bounds.max.x - bounds.min.x) * (bounds.max.y - bounds.min.y));
    QVERIFY2(density > 8 && density < 12, qPrintable(QString::number(density)));
}

void SampleTest::returnsAreConsistent()
{
    const auto returns = column<std::uint8_t>("Returns");
    const auto time = column<double>("GpsTime");
    int most = 0;
    for (PointIndex i = 0; i < kPoints;) {
        const int count = returns[i] >> 4;
        most = std::max(most, count);
        QVERIFY(count >= 1 && count <= 4 && i + PointIndex(count) <= kPoints);
        for (int k = 0; k < count; ++k) {
            QCOMPARE(int(returns[i + PointIndex(k)]), (k + 1) | (count << 4));
            QCOMPARE(time[i + PointIndex(k)], time[i]);
            // further along the beam: lower, but for the noise of the range
            if (k > 0) QVERIFY(m_cloud->rawZ()[i + PointIndex(k)] < m_cloud->rawZ()[i + PointIndex(k) - 1] + 150);
        }
        i += PointIndex(count);
    }
    QCOMPARE(most, 4);
}

void SampleTest::timeRises()
{
    const auto time = column<double>("GpsTime");
    const auto line = column<std::uint16_t>("PointSourceId");
    for (PointIndex i = 1; i < kPoints; ++i) {
        QVERIFY(time[i] >= time[i - 1]);
        QVERIFY(line[i] >= line[i - 1]);
        if (line[i] != line[i - 1]) QVERIFY(time[i] > time[i - 1] + 60.0);
    }
}

void SampleTest::linesOverlap()
{
    const auto flags = column<std::uint8_t>("Flags");
    const auto line = column<std::uint16_t>("PointSourceId");
    const auto angle = m_cloud->findAttribute("ScanAngle");
    PointIndex overlap = 0, edges = 0, forth = 0;
    std::set<std::uint16_t> lines;
    for (PointIndex i = 0; i < kPoints; ++i) {
        overlap += (flags[i] >> 3) & 1;
        forth += (flags[i] >> 6) & 1;
        edges += flags[i] >> 7;
        lines.insert(line[i]);
        QVERIFY(std::abs(angle->number(i)) < 21.0);
    }
    QVERIFY(lines.size() >= 2);
    QVERIFY(overlap > kPoints / 20 && overlap < kPoints / 2);
    QVERIFY(forth > kPoints / 3 && forth < kPoints * 2 / 3);
    QVERIFY(edges > 100 && edges < kPoints / 20);
}

void SampleTest::classesAreThere()
{
    Progress progress;
    const auto count = countValues(*m_cloud->findAttribute("Classification"), progress);
    for (const std::size_t code : {1, 2, 3, 4, 5, 6, 7, 9, 11, 14, 15, 18})
        QVERIFY2(count[code] > 0, qPrintable(QString::number(code)));
    QVERIFY(count[2] > kPoints / 3);
    QVERIFY(count[5] > kPoints / 20);
    QVERIFY(count[6] > kPoints / 100);
    QVERIFY(count[7] + count[18] < kPoints / 2000);
}

void SampleTest::valuesAreInRange()
{
    Progress progress;
    const auto statistics = [&](const char* name, std::uint32_t component = 0) {
        return computeStatistics(*m_cloud->findAttribute(name), component, progress);
    };
    for (std::uint32_t c = 0; c < 3; ++c) {
        const auto s = statistics("RGB", c);
        QVERIFY(toDouble(s.max) > 40'000);  // 16 bits are used
        QVERIFY(s.mean > 8'000 && s.mean < 40'000);
    }
    const auto reflectance = statistics("Reflectance");
    QVERIFY(toDouble(reflectance.min) >= -41 && toDouble(reflectance.max) <= 1);
    QVERIFY(reflectance.count == kPoints);
    QVERIFY(statistics("Intensity").mean > 5'000);
    QVERIFY(toDouble(statistics("Deviation").max) > 100);
    // decibels agree with the intensity they come from
    const Attribute db = *m_cloud->findAttribute("Reflectance"), intensity = *m_cloud->findAttribute("Intensity");
    for (PointIndex i = 0; i < kPoints; i += 997)
        if (intensity.number(i) > 100 && intensity.number(i) < 65000)
            QVERIFY(std::abs(db.number(i) - 10 * std::log10(intensity.number(i) / 90000.0)) < 0.06);
}

void SampleTest::cancels()
{
    // Asked at several moments of the work: it must stop within 100 ms, and does not return a cloud.
    for (const int after : {0, 20, 120, 400, 900}) {
        const auto [cancelled, ms] =
            cancelAfter(after, [&](Progress& progress) { makeSample(20'000'000, 1, progress); });
        QVERIFY(cancelled);
        qInfo("stopped %.1f ms after the cancel", ms);
        if (kFastBuild) QVERIFY2(ms < 1000.0, qPrintable(QString::number(after)));  // the rule is 100 ms
    }
}

void SampleTest::refusesAbsurdSizes()
{
    Progress progress;
    QVERIFY_EXCEPTION_THROWN(makeSample(PointIndex(1) << 60, 1, progress), Error);
}

QTEST_APPLESS_MAIN(SampleTest)
#include "SampleTest.moc"
