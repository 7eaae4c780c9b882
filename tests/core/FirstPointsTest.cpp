// SPDX-License-Identifier: MIT
#include "core/Memory.h"
#include "core/SummedText.h"
#include "core/cloud/BlockBoxes.h"
#include "core/las/Reader.h"
#include "core/survey/Overview.h"
#include "core/survey/Survey.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <algorithm>
#include <atomic>
#include <mutex>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

/// Which points a reader told of.
class Told
{
public:
    explicit Told(PointIndex points) : m_times(points, 0) {}
    void operator()(PointRange range)
    {
        const std::lock_guard lock(m_mutex);
        for (PointIndex i = range.first; i < range.last; ++i) ++m_times[i];
    }
    PointIndex points() const
    {
        return PointIndex(std::count_if(m_times.begin(), m_times.end(), [](int n) { return n != 0; }));
    }
    /// Each once, but for these, of which some were told before they turned out to be damaged.
    bool eachOnceBut(const std::vector<PointRange>& missing) const
    {
        std::vector<int> expected(m_times.size(), 1);
        for (const PointRange& range : missing)
            for (PointIndex i = range.first; i < range.last; ++i) expected[i] = m_times[i] > 1 ? 1 : m_times[i];
        return expected == m_times;
    }

private:
    std::mutex m_mutex;
    std::vector<int> m_times;
};

bool sameRanges(const std::vector<PointRange>& a, const std::vector<PointRange>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PointRange& x, const PointRange& y) {
        return x.first == y.first && x.last == y.last;
    });
}

bool sameValues(const PointCloud& a, const PointCloud& b, PointRange range)
{
    for (std::size_t k = 0; k < a.columns().size(); ++k) {
        const std::size_t bytes = a.columns()[k]->elementBytes();
        if (std::memcmp(a.columns()[k]->data() + range.first * bytes, b.columns()[k]->data() + range.first * bytes,
                        range.size() * bytes) != 0)
            return false;
    }
    return true;
}

/// The columns and the boxes of two clouds; says which differ, empty where none do.
std::string difference(const PointCloud& a, const PointCloud& b, bool boxesToo = true)
{
    if (a.size() != b.size() || a.columns().size() != b.columns().size()) return "sizes";
    for (std::size_t k = 0; k < a.columns().size(); ++k)
        if (!std::equal(a.columns()[k]->data(), a.columns()[k]->data() + a.size() * a.columns()[k]->elementBytes(),
                        b.columns()[k]->data()))
            return a.columns()[k]->name();
    if (!boxesToo) return {};
    const auto boxes = a.boxes(), others = b.boxes();
    for (std::size_t k = 0; k < boxes->size(); ++k)
        if ((*boxes)[k] != (*others)[k]) return "boxes";
    return {};
}

}  // namespace

/// Points that are read before all others change nothing of what is read.
class FirstPointsTest : public QObject
{
    Q_OBJECT

private slots:
    void files_data()
    {
        QTest::addColumn<QString>("name");
        for (const char* name : {"bcts_1.laz", "autzen_trim.las", "autzen_trim.laz", "autzen_trim_7.las",
                                 "tls_clip.laz", "lone-star.laz", "lion_takanawa.copc.laz", "MixedConifer.laz",
                                 "extra.laz", "plane.laz", "broken_type.laz", "fullwave.laz"})
            QTest::newRow(name) << name;
    }
    void files()
    {
        QFETCH(QString, name);
        const fs::path path = fs::path(PUNCTUM_TEST_DATA) / name.toStdString();
        if (!fs::exists(path)) QSKIP("The test data is missing.");
        std::unique_ptr<las::Reader> reader;
        try {
            reader = las::Reader::open(path);
        } catch (const std::exception&) {
            return;  // no file of points
        }
        compare(*reader);
    }

    /// Damage behind the first points of a chunk: none of the chunk's points is there then.
    void damage_data()
    {
        QTest::addColumn<QString>("name");
        QTest::newRow("layers") << "bcts_1.laz";
        QTest::newRow("pointwise") << "autzen_trim.laz";
    }
    void damage()
    {
        QFETCH(QString, name);
        const fs::path path = fs::path(PUNCTUM_TEST_DATA) / name.toStdString();
        if (!fs::exists(path)) QSKIP("The test data is missing.");
        lasfiles::Bytes bytes = lasfiles::readFile(path);
        std::size_t found = 0;
        for (const double share : {0.3, 0.5, 0.7}) {
            lasfiles::Bytes damaged = bytes;
            const auto at = std::size_t(share * double(bytes.size()));
            for (std::size_t k = 0; k < 2000; ++k) damaged[at + k] = std::byte(0);
            const fs::path file = fs::path(m_dir.path().toStdString()) / path.filename();
            lasfiles::writeFile(file, damaged);
            const auto reader = las::Reader::open(file);
            compare(*reader);
            if (QTest::currentTestFailed()) return;
            found += reader->source()->asRead->get().missing.size();
        }
        QVERIFY(found >= 2);
    }

    void surveys_data()
    {
        QTest::addColumn<QStringList>("names");
        QTest::addColumn<bool>("beyond");  // memory
        const auto add = [](const char* name, const QStringList& names) {
            QTest::newRow(name) << names << false;
            QTest::addRow("%s, beyond memory", name) << names << true;
        };
        add("one file", {"bcts_1.laz"});
        add("one format", {"bcts_1.laz", "bcts_2.laz"});
        add("formats of both kinds", {"autzen_trim_7.las", "autzen_trim.las", "autzen_trim.laz", "extra.laz"});
        add("other places and coordinate systems",
            {"autzen_trim.laz", "bcts_1.laz", "epsg_4326.las", "megaplot.las", "MixedConifer.laz"});
    }
    void surveys()
    {
        QFETCH(QStringList, names);
        QFETCH(bool, beyond);
        std::vector<fs::path> files;
        for (const QString& name : names) {
            files.push_back(fs::path(PUNCTUM_TEST_DATA) / name.toStdString());
            if (!fs::exists(files.back())) QSKIP("The test data is missing.");
        }
        const auto plain = Survey::open(files, m_progress);
        const las::ReadResult expected = plain->read(m_progress, {});
        if (beyond) setMemoryBudget(1 << 20);
        const auto ahead = Survey::open(files, m_progress);
        const PointIndex points = ahead->cloud()->size();
        Told told(points), first(points);
        std::atomic<bool> begun{false}, late{false};
        const las::ReadResult result = ahead->read(m_progress,
                                                   [&](PointRange range) {
                                                       begun = true;
                                                       told(range);
                                                   },
                                                   {.sink =
                                                        [&](PointRange range) {
                                                            if (begun) late = true;
                                                            first(range);
                                                        },
                                                    .from = 0,
                                                    .chunks = 64,
                                                    .points = kPoints,
                                                    .pointsBeyond = 4 * kPoints});
        setMemoryBudget(0);
        QVERIFY(!late);
        QVERIFY(first.points() >= files.size() * kPoints * (beyond ? 4 : 1));
        QCOMPARE(first.points() % (kPoints * (beyond ? 4 : 1)), PointIndex(0));
        QVERIFY(first.eachOnceBut({{0, points}}));
        QVERIFY(told.eachOnceBut(result.missing));
        QCOMPARE(difference(*plain->cloud(), *ahead->cloud()), std::string());
        QCOMPARE(result.warnings, expected.warnings);
        QVERIFY(result.bounds == expected.bounds);
    }

    void keptBetweenOpenings_data() { surveys_data(); }
    /// What is kept of a survey is shown when it is opened again, and changes nothing of what is read, even if it
    /// lies.
    void keptBetweenOpenings()
    {
        QFETCH(QStringList, names);
        QFETCH(bool, beyond);
        const QTemporaryDir cache("/var/tmp/punctum-kept-XXXXXX");
        qputenv("XDG_CACHE_HOME", cache.path().toUtf8());
        std::vector<fs::path> files;
        for (const QString& name : names) {
            files.push_back(fs::path(PUNCTUM_TEST_DATA) / name.toStdString());
            if (!fs::exists(files.back())) QSKIP("The test data is missing.");
        }
        const auto plain = Survey::open(files, m_progress);
        const las::ReadResult expected = plain->read(m_progress, {});
        for (const char* turn : {"first", "again", "a lie"}) {
            if (turn == std::string("a lie")) changeKept();
            if (beyond) setMemoryBudget(1 << 20);
            const auto survey = Survey::open(files, m_progress);
            std::mutex mutex;
            std::size_t pieces = 0, unlike = 0;
            const auto sink = [&](PointRange range) {
                const std::lock_guard lock(mutex);
                ++pieces;
                unlike += sameValues(*survey->cloud(), *plain->cloud(), range) ? 0 : 1;
            };
            const las::ReadResult result = survey->read(
                m_progress, [](PointRange) {}, aheadOf(sink));
            setMemoryBudget(0);
            QVERIFY2(pieces >= files.size(), turn);
            QCOMPARE(unlike, std::size_t(turn == std::string("a lie") ? 1 : 0));
            QCOMPARE(difference(*plain->cloud(), *survey->cloud(), unlike == 0), std::string());
            QCOMPARE(result.warnings, expected.warnings);
            QVERIFY(result.bounds == expected.bounds);
        }
        qunsetenv("XDG_CACHE_HOME");
    }

    /// Points that were kept of a chunk that is damaged now are missing, like its others.
    void keptOfWhatIsDamaged()
    {
        const QTemporaryDir cache("/var/tmp/punctum-kept-XXXXXX");
        qputenv("XDG_CACHE_HOME", cache.path().toUtf8());
        const fs::path path = fs::path(PUNCTUM_TEST_DATA) / "bcts_1.laz";
        if (!fs::exists(path)) QSKIP("The test data is missing.");
        lasfiles::Bytes bytes = lasfiles::readFile(path);
        const std::vector<fs::path> files = {fs::path(m_dir.path().toStdString()) / "a.laz",
                                             fs::path(m_dir.path().toStdString()) / "b.laz"};
        for (const fs::path& file : files) lasfiles::writeFile(file, bytes);
        const auto nothing = [](PointRange) {};
        (void)Survey::open(files, m_progress)->read(m_progress, nothing, aheadOf(nothing));
        const auto written = fs::last_write_time(files[0]);
        std::uint32_t points = 0;
        std::memcpy(&points, bytes.data() + 96, sizeof(points));
        for (std::size_t k = 0; k < 2000; ++k) bytes[points + 20'000 + k] = std::byte(0);
        lasfiles::writeFile(files[0], bytes);
        fs::last_write_time(files[0], written);
        const auto plain = Survey::open(files, m_progress), kept = Survey::open(files, m_progress);
        const las::ReadResult expected = plain->read(m_progress, {});
        std::atomic<std::size_t> shown{0};
        const las::ReadResult result =
            kept->read(m_progress, nothing, aheadOf([&](PointRange range) { shown += range.first == 0; }));
        QCOMPARE(shown.load(), std::size_t(1));
        QVERIFY(!expected.missing.empty() && expected.missing[0].first == 0);
        QVERIFY(sameRanges(result.missing, expected.missing));
        QCOMPARE(difference(*plain->cloud(), *kept->cloud(), false), std::string());
        qunsetenv("XDG_CACHE_HOME");
    }

private:
    static constexpr std::uint64_t kPoints = 100;

    static Survey::Ahead aheadOf(las::Reader::BatchSink sink)
    {
        return {.sink = std::move(sink),
                .from = 0,
                .chunks = 8,
                .points = kPoints,
                .pointsBeyond = 4 * kPoints,
                .keptFrom = 0};
    }
    /// A value of the last piece becomes another one, and the sum is right.
    static void changeKept()
    {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(Overview::folder())) found.push_back(entry.path());
        QCOMPARE(found.size(), std::size_t(1));
        lasfiles::Bytes bytes = lasfiles::readFile(found.front());
        const std::size_t end = bytes.size() - sizeof(std::uint32_t);
        bytes[end - 1] ^= std::byte(1);
        const std::uint32_t sum = crc32(0, {reinterpret_cast<const char*>(bytes.data()), end});
        std::memcpy(bytes.data() + end, &sum, sizeof(sum));
        lasfiles::writeFile(found.front(), bytes);
    }

    void compare(const las::Reader& reader)
    {
        const auto plain = reader.createCloud(), ahead = reader.createCloud();
        const las::ReadResult expected = reader.read(*plain, m_progress);
        const las::PointsAsRead figures = reader.source()->asRead->get();
        Told told(ahead->size()), first(ahead->size());
        const auto firsts = reader.readFirsts(*ahead, {40, 0, 30}, kPoints, m_progress, std::ref(first));
        QCOMPARE(first.points(), firsts.size() * kPoints);
        for (std::size_t k = 0; k < firsts.size(); ++k) {
            QCOMPARE(firsts[k].size(), kPoints);
            if (k > 0) QVERIFY(firsts[k - 1].last < firsts[k].first);
        }
        const las::ReadResult result = reader.read(*ahead, m_progress, std::ref(told), firsts);
        QVERIFY(told.eachOnceBut(result.missing));
        QVERIFY(sameRanges(result.missing, expected.missing));
        QCOMPARE(result.warnings, expected.warnings);
        QVERIFY(result.bounds == expected.bounds);
        QCOMPARE(reader.source()->asRead->get().byReturn, figures.byReturn);
        QCOMPARE(difference(*plain, *ahead), std::string());
        if (expected.missing.empty() && ahead->size() > (1 << 17)) QVERIFY(!firsts.empty());
    }

    QTemporaryDir m_dir;
    Progress m_progress;
};

QTEST_APPLESS_MAIN(FirstPointsTest)
#include "FirstPointsTest.moc"
