// SPDX-License-Identifier: MIT
// Deleted points: nothing touches or sees them, they come back, and saving leaves out exactly them.
#include "core/edit/DeleteCommand.h"

#include "core/cloud/Visibility.h"
#include "core/edit/Extract.h"
#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/expression/Rule.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/measure/Nearest.h"
#include "core/neighbors/KdOrder.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
using lasfiles::save;
namespace fs = std::filesystem;

namespace
{

std::shared_ptr<PointSet> randomSet(PointIndex size, std::uint64_t seed, unsigned oneOf)
{
    std::mt19937_64 random(seed);
    auto points = std::make_shared<PointSet>(size);
    for (PointIndex i = 0; i < size; ++i)
        if (random() % oneOf == 0) points->insert(i);
    return points;
}

/// Those records that are not in the set.
Bytes without(const Bytes& records, std::size_t length, const PointSet& gone)
{
    Bytes left;
    for (PointIndex i = 0; i < gone.size(); ++i)
        if (!gone.contains(i))
            left.insert(left.end(), records.begin() + std::ptrdiff_t(i * length),
                        records.begin() + std::ptrdiff_t((i + 1) * length));
    return left;
}

void remove(History& history, const std::shared_ptr<const PointSet>& points)
{
    history.push(std::make_unique<DeleteCommand>("Delete", points));
}

/// Points at random places, of which some are deleted.
struct Thinned {
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<const PointSet> gone;
    PointSet all;

    Thinned(PointIndex size, std::uint32_t extent, unsigned oneOf)
        : cloud(makeFrame(size)), gone(randomSet(size, size, oneOf)), all(size)
    {
        std::mt19937 random(3);
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::int32_t& v : rawAxis(*cloud, axis)) v = std::int32_t(random() % extent);
        History history(cloud);
        remove(history, gone);
        all.invert();
    }
};

/// What the header must say of these records, from the standard's tables.
void checkFigures(const Bytes& file, const Bytes& records)
{
    const auto format = std::uint8_t(lasfiles::get<std::uint8_t>(file, 104) & 0x3F);
    const auto length = lasfiles::get<std::uint16_t>(file, 105);
    const std::size_t count = records.size() / length;
    std::array<std::uint64_t, 16> returns{};
    std::array<std::int32_t, 3> low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
    for (std::size_t i = 0; i < count; ++i) {
        ++returns[std::to_integer<unsigned>(records[i * length + 14]) & (format >= 6 ? 15u : 7u)];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto v = lasfiles::get<std::int32_t>(records, i * length + 4 * axis);
            low[axis] = std::min(low[axis], v);
            high[axis] = std::max(high[axis], v);
        }
    }
    const bool legacy = format < 6;
    QCOMPARE(lasfiles::get<std::uint32_t>(file, 107), legacy ? std::uint32_t(count) : 0u);
    for (std::size_t k = 0; k < 5; ++k)
        QCOMPARE(lasfiles::get<std::uint32_t>(file, 111 + 4 * k), legacy ? std::uint32_t(returns[k + 1]) : 0u);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        QCOMPARE(lasfiles::get<double>(file, 179 + 16 * axis), count == 0 ? 0.0 : double(high[axis]) * 0.01);
        QCOMPARE(lasfiles::get<double>(file, 187 + 16 * axis), count == 0 ? 0.0 : double(low[axis]) * 0.01);
    }
    if (lasfiles::get<std::uint8_t>(file, 25) < 4) return;
    QCOMPARE(lasfiles::get<std::uint64_t>(file, 247), std::uint64_t(count));
    for (std::size_t k = 0; k < 15; ++k) QCOMPARE(lasfiles::get<std::uint64_t>(file, 255 + 8 * k), returns[k + 1]);
}

}  // namespace

class DeleteTest : public QObject
{
    Q_OBJECT
private slots:
    void keptPointsMapBothWays()
    {
        for (const unsigned oneOf : {1u, 2u, 5u, 300u}) {
            const PointIndex size = 1003;
            const auto gone = randomSet(size, oneOf, oneOf);
            const KeptPoints kept = KeptPoints({{0, 500}, {500, 500}, {510, size}}).without(*gone);
            std::vector<PointIndex> expected;
            for (PointIndex i = 0; i < size; ++i)
                if ((i < 500 || i >= 510) && !gone->contains(i)) expected.push_back(i);
            QCOMPARE(kept.count(), PointIndex(expected.size()));
            for (PointIndex k = 0; k < kept.count(); ++k) {
                QCOMPARE(kept.index(k), expected[k]);
                QCOMPARE(kept.placeOf(expected[k]), k);
            }
            for (PointIndex i = 0; i <= size; ++i) {
                const auto before = std::lower_bound(expected.begin(), expected.end(), i) - expected.begin();
                QCOMPARE(kept.placeOf(i), PointIndex(before));
            }
            std::vector<PointIndex> walked;
            const PointIndex first = kept.count() / 3, last = kept.count() - kept.count() / 4;
            kept.forEachRun({first, last}, [&](PointRange run, PointIndex place) {
                QCOMPARE(place, first + walked.size());
                for (PointIndex i = run.first; i < run.last; ++i) walked.push_back(i);
            });
            QVERIFY(walked == std::vector<PointIndex>(expected.begin() + std::ptrdiff_t(first),
                                                      expected.begin() + std::ptrdiff_t(last)));
            const auto some = randomSet(size, 9, 3);
            const PointSet places = kept.places(*some);
            for (PointIndex k = 0; k < kept.count(); ++k) QCOMPARE(places.contains(k), some->contains(expected[k]));
        }
    }

    void deletedAndBack()
    {
        const auto cloud = makeFrame(1000);
        std::vector<ChangeNotice> notices;
        const auto subscription = cloud->subscribe([&](const ChangeNotice& n) { notices.push_back(n); });
        History history(cloud, {0});  // every command but the nearest is packed
        const auto first = randomSet(1000, 1, 3);
        auto second = randomSet(1000, 2, 3);
        second->remove(*first);
        remove(history, first);
        QVERIFY(*cloud->deleted() == *first);
        QVERIFY(notices.size() == 1 && notices[0].kind == ChangeNotice::Kind::Deleted);
        QVERIFY(*notices[0].points == *first);
        remove(history, second);
        QCOMPARE(cloud->deleted()->count(), first->count() + second->count());
        Progress progress;
        history.push(makeCommand({"restore", {}, nullptr}, *cloud, progress));
        QVERIFY(cloud->deleted() == nullptr);
        QVERIFY(makeCommand({"restore", {}, nullptr}, *cloud, progress) == nullptr);
        history.undo();
        history.undo();
        QVERIFY(*cloud->deleted() == *first);
        history.undo();
        QVERIFY(cloud->deleted() == nullptr);
        for (int k = 0; k < 2; ++k) history.redo();
        QCOMPARE(cloud->deleted()->count(), first->count() + second->count());
        QCOMPARE(history.names(), (std::vector<std::string>{"Delete", "Delete", "Restore deleted points"}));
    }

    void nothingTouchesThem()
    {
        const PointIndex size = 5000;
        const Thinned thinned(size, 1000, 4);
        const auto& cloud = thinned.cloud;
        const auto& gone = thinned.gone;
        Progress progress;
        const auto hidden = hiddenPoints(*cloud, {}, progress);
        QVERIFY(hidden && *hidden == *gone);
        const auto touchesNone = [&](const Recipe& recipe) {
            const auto command = makeCommand(recipe, *cloud, progress);
            if (!command || !command->points()) return false;
            PointSet touched = *command->points();
            touched.intersect(*gone);
            return touched.count() == 0 && command->changedPoints() > 0;
        };
        const auto everything = std::make_shared<PointSet>(thinned.all);
        QVERIFY(touchesNone({"set", {{"rule", "Classification = 2"}}, nullptr}));
        QVERIFY(touchesNone({"set", {{"rule", "Classification = 2 if Z > 0"}}, everything}));
        QVERIFY(touchesNone(
            {"reclassify", {{"attribute", "Z"}, {"min", "0"}, {"max", "9999"}, {"class", "3"}}, nullptr}));
        QVERIFY(touchesNone({"outliers", {{"deviations", "0.1"}}, nullptr}));
        QVERIFY(touchesNone({"delete", {{"where", "Z > 0.5"}}, nullptr}));
        QVERIFY(touchesNone({"delete", {}, everything}));
        QVERIFY(makeCommand({"delete", {}, gone}, *cloud, progress) == nullptr);
        const KdOrder order(*cloud, progress);
        QCOMPARE(order.size(), std::size_t(size - gone->count()));
        for (const std::uint32_t i : order.points(1)) QVERIFY(!gone->contains(i));
        for (const NearPoint& p : nearestTo(*cloud, 17, 50, glm::dvec3(1), progress))
            QVERIFY(!gone->contains(p.index));
        const auto counts = countValues(*cloud->findAttribute("Classification"), progress, cloud->deleted().get());
        QCOMPARE(counts[0], std::uint64_t(size - gone->count()));
        QCOMPARE(extracted(*cloud, thinned.all, progress)->size(), size - gone->count());
    }

    void outliersAreThoseOfTheOthersAlone()
    {
        // The same points, once with others that are deleted in between.
        const PointIndex size = 3000;
        const Thinned thinned(size, 2000, 2);
        const auto& cloud = thinned.cloud;
        const auto& gone = thinned.gone;
        Progress progress;
        const auto part = extracted(*cloud, thinned.all, progress);
        const Recipe outliers{"outliers", {{"deviations", "1.5"}}, nullptr};
        const auto here = makeCommand(outliers, *cloud, progress), there = makeCommand(outliers, *part, progress);
        QVERIFY(here && there);
        QVERIFY(KeptPoints::all(size).without(*gone).places(*here->points()) == *there->points());
    }

    void savingLeavesOutThemAlone_data()
    {
        QTest::addColumn<int>("format");
        QTest::addColumn<QString>("name");
        QTest::addColumn<unsigned>("oneOf");
        for (int format = 0; format <= 10; ++format)
            for (const QString& name : {QStringLiteral("a.las"), QStringLiteral("a.laz")})
                for (const unsigned oneOf : {1u, 2u, 4000u})
                    QTest::newRow(
                        qPrintable(QStringLiteral("%1 of format %2, 1 of %3").arg(name).arg(format).arg(oneOf)))
                        << format << name << oneOf;
    }

    void savingLeavesOutThemAlone()
    {
        QFETCH(int, format);
        QFETCH(QString, name);
        QFETCH(unsigned, oneOf);
        const auto f = std::uint8_t(format);
        const auto length = std::uint16_t(lasfiles::recordLength(f) + 3 * (format % 3));
        const std::size_t count = 9500;
        const Bytes records = lasfiles::randomRecords(f, length, count, std::uint32_t(format), true);
        const fs::path path = temp(name.toStdString()), out = temp("out-" + name.toStdString());
        const bool compressed = las::isCompressedName(path);
        const Bytes kept(77, std::byte(5));
        if (compressed) {
            lasfiles::writeFile(path, lasfiles::lazFile(f, length, records, 1000));
        } else {
            const Bytes evlr = f >= 6 ? lasfiles::record("someone", 9, kept, true) : Bytes();
            Bytes file = lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, count),
                                        {lasfiles::record("someone", 8, kept)}, records, evlr);
            if (f >= 6) {
                lasfiles::set<std::uint64_t>(file, 235, file.size() - evlr.size());
                lasfiles::set<std::uint32_t>(file, 243, 1);
            }
            lasfiles::writeFile(path, file);
        }
        const auto cloud = load(path);
        History history(cloud);
        const auto gone = randomSet(count, oneOf, oneOf);
        remove(history, gone);
        const auto report = save(*cloud, out);
        const Bytes expected = without(records, length, *gone);
        QCOMPARE(report.points, PointIndex(expected.size() / length));
        QVERIFY(lasfiles::recordsByLaszip(out, f, length, expected.size() / length) == expected);
        const Bytes written = lasfiles::readFile(out);
        checkFigures(written, expected);
        if (compressed) {
            // A chunk of which nothing is missing is copied.
            std::size_t whole = 0;
            for (PointIndex first = 0; first < count; first += 1000) {
                bool any = false;
                for (PointIndex i = first; i < std::min<PointIndex>(count, first + 1000); ++i)
                    any = any || gone->contains(i);
                whole += any ? 0 : 1;
            }
            QCOMPARE(report.chunksCopied, std::uint64_t(whole));
        } else {
            const Bytes vlr = lasfiles::record("someone", 8, kept);
            QVERIFY(std::search(written.begin(), written.end(), vlr.begin(), vlr.end()) != written.end());
            if (f >= 6) {
                const Bytes evlr = lasfiles::record("someone", 9, kept, true);
                QVERIFY(Bytes(written.end() - std::ptrdiff_t(evlr.size()), written.end()) == evlr);
                QCOMPARE(lasfiles::get<std::uint64_t>(written, 235), std::uint64_t(written.size() - evlr.size()));
            }
        }
    }

    void theWindowGoesOnWithTheSavedFile_data()
    {
        QTest::addColumn<QString>("name");
        for (const char* name : {"a.las", "a.laz"}) QTest::newRow(name) << QString::fromLatin1(name);
    }

    /// Saved in place: what the file holds, what is unsaved, the journal, and all of it restored.
    void theWindowGoesOnWithTheSavedFile()
    {
        QFETCH(QString, name);
        const std::uint16_t length = lasfiles::recordLength(7);
        const std::size_t count = 9500;
        const Bytes records = lasfiles::randomRecords(7, length, count, 3, true);
        const fs::path path = temp("on-" + name.toStdString());
        lasfiles::writeFile(path, las::isCompressedName(path)
                                      ? lasfiles::lazFile(7, length, records, 1000)
                                      : lasfiles::file(lasfiles::header(4, 7, length, count), {}, records));
        const Bytes original = lasfiles::readFile(path);
        const auto cloud = load(path);
        History history(cloud);
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(path);
        const auto preview = [&](bool quick) {
            const auto changes = history.changes(progress);
            return las::previewSave(*cloud, path, path, options, progress, quick ? &*changes : nullptr).difference;
        };
        auto gone = std::make_shared<PointSet>(count);
        for (PointIndex i = 2500; i < 4500; ++i) gone->insert(i);
        remove(history, gone);
        for (const bool quick : {false, true}) {
            const las::Difference d = preview(quick);
            QCOMPARE(d.onlyA, PointIndex(2000));
            QCOMPARE(d.onlyB, PointIndex(0));
            QCOMPARE(d.differing, PointIndex(0));
            QVERIFY(QByteArray::fromStdString(las::summary(d)).startsWith("2,000 points left out"));
            QVERIFY(las::dropsOrUpgrades(d));
        }
        save(*cloud, path);
        history.markSaved();
        QVERIFY(preview(false).contentEqual());
        QVERIFY(preview(true).contentEqual());

        // A journal that is begun now is about the file as it is now, and tells its points' places there.
        const auto kept = cloud->source()->current->get().kept;
        QVERIFY(kept && kept->count() == 7500);
        const fs::path journal = temp("on.journal");
        const CloudKey key = keyOf(*cloud, progress, kept.get());
        QVERIFY(key == keyOf(*load(path), progress));
        history.setJournal(Journal::create(journal, key, path.string(), kept));
        const auto some = randomSet(count, 8, 7);
        some->remove(*gone);
        history.push(makeCommand({"set", {{"rule", "UserData = 9"}}, some}, *cloud, progress));
        history.push(makeCommand({"delete", {}, randomSet(count, 9, 50)}, *cloud, progress));
        QCOMPARE(history.journal()->failure(), std::string());
        const auto entries = readJournal(journal).entries;
        QCOMPARE(entries.size(), std::size_t(2));
        QVERIFY(entries[0].within && entries[0].within->size() == 7500);
        // Points of which the file knows nothing end it.
        history.push(makeCommand({"restore", {}, nullptr}, *cloud, progress));
        QVERIFY(history.journal()->failure().find("were deleted when the file was saved") != std::string::npos);
        history.setJournal(nullptr);
        history.undo();

        // Some more gone, some back.
        const las::Difference d = preview(false);
        QVERIFY(d.onlyA > 0 && d.onlyB == 0);
        QCOMPARE(d.attributes.size(), std::size_t(1));
        while (history.canUndo()) history.undo();
        const las::Difference back = preview(false);
        QCOMPARE(back.onlyA, PointIndex(0));
        QCOMPARE(back.onlyB, PointIndex(2000));
        QCOMPARE(back.differing, PointIndex(0));
        const auto report = save(*cloud, path);
        QVERIFY(lasfiles::recordsByLaszip(path, 7, length, count) == records);
        if (options.compressed)
            QCOMPARE(report.chunksCopied, std::uint64_t(7));  // the others were cut
        else
            QVERIFY(lasfiles::readFile(path) == original);
        QVERIFY(!cloud->source()->current->get().kept);
    }

    void diffComparesWhatIsInBoth()
    {
        const std::uint16_t length = lasfiles::recordLength(6);
        const std::size_t count = 3000;
        const Bytes records = lasfiles::randomRecords(6, length, count, 4);
        const auto gone = randomSet(count, 5, 3);
        Bytes left = without(records, length, *gone);
        const auto file = [&](const std::string& name, const Bytes& points) {
            lasfiles::writeFile(
                temp(name),
                name.ends_with("z")
                    ? lasfiles::lazFile(6, length, points, 500)
                    : lasfiles::file(lasfiles::header(4, 6, length, points.size() / length), {}, points));
            return temp(name);
        };
        Progress progress;
        for (const bool edited : {false, true}) {
            if (edited) left[100 * length + 16] ^= std::byte(1);  // a class
            for (const std::string& ending : {std::string("s"), std::string("z")})
                for (const std::string& other : {std::string("s"), std::string("z")}) {
                    const fs::path a = file("all.la" + ending, records), b = file("left.la" + other, left);
                    const las::Difference d = las::diffFiles(a, b, {}, progress);
                    QCOMPARE(d.onlyA, gone->count());
                    QCOMPARE(d.onlyB, PointIndex(0));
                    QCOMPARE(d.compared, count - gone->count());
                    QCOMPARE(d.differing, PointIndex(edited ? 1 : 0));
                    QVERIFY(!d.contentEqual());
                    const las::Difference back = las::diffFiles(b, a, {}, progress);
                    QCOMPARE(back.onlyB, gone->count());
                    QCOMPARE(back.differing, PointIndex(edited ? 1 : 0));
                }
        }
    }

    void aPartOfItIsAnotherFile()
    {
        const std::uint16_t length = lasfiles::recordLength(6);
        const Bytes records = lasfiles::randomRecords(6, length, 100, 1);
        lasfiles::writeFile(temp("whole.las"), lasfiles::file(lasfiles::header(4, 6, length, 100), {}, records));
        const auto cloud = load(temp("whole.las"));
        Progress progress;
        PointSet some(100);
        for (PointIndex i = 10; i < 20; ++i) some.insert(i);
        save(*extracted(*cloud, some, progress), temp("part.las"));
        QVERIFY(cloud->source()->current->get().path == temp("whole.las"));
        QCOMPARE(load(temp("part.las"))->size(), PointIndex(10));
    }

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    QTemporaryDir m_dir;
};

QTEST_GUILESS_MAIN(DeleteTest)
#include "DeleteTest.moc"
