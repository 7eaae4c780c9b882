// SPDX-License-Identifier: MIT
// What is looked at is read first, and what is read is the same whatever anybody looks at.
#include "core/cloud/BlockBoxes.h"
#include "core/las/RecordBlocks.h"
#include "core/session/Session.h"
#include "core/survey/ReadingOrder.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <set>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr std::uint8_t kTileFormat = 1;
constexpr std::size_t kTilePoints = 700;
constexpr std::uint32_t kTileChunk = 100;  ///< points
constexpr double kTileSide = 1000.0;
constexpr std::size_t kMinXAt = 187;  ///< in the header: Max X, Min X, Max Y, Min Y, Max Z, Min Z from 179

/// Points along a line in X, chunk after chunk, in a tile of its own.
lasfiles::Bytes tileAt(std::size_t k)
{
    const std::uint16_t length = lasfiles::recordLength(kTileFormat);
    lasfiles::Bytes records = lasfiles::randomRecords(kTileFormat, length, kTilePoints, std::uint32_t(k), true);
    const double scale = 0.01, side = kTileSide * double(k);
    for (std::size_t i = 0; i < kTilePoints; ++i) {
        const double at[3] = {side + 900.0 * double(i) / kTilePoints, double(i % 7), double(i % 5)};
        for (std::size_t axis = 0; axis < 3; ++axis)
            lasfiles::set<std::int32_t>(records, i * length + 4 * axis, std::int32_t(at[axis] / scale));
    }
    auto bytes = lasfiles::lazFile(kTileFormat, length, records, kTileChunk);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        lasfiles::set<double>(bytes, 131 + 8 * axis, scale);
        lasfiles::set<double>(bytes, 155 + 8 * axis, 0.0);
        const double low = axis == 0 ? side : 0.0, high = axis == 0 ? side + 900.0 : axis == 1 ? 6.0 : 4.0;
        lasfiles::set<double>(bytes, 179 + 16 * axis, high);
        lasfiles::set<double>(bytes, kMinXAt + 16 * axis, low);
    }
    return bytes;
}

/// Looks at what lies between two places in X.
ReadingOrder::Sight sightOf(double from, double to)
{
    return [from, to](const WorldBounds& box) {
        return std::max(0.0, std::min(to, box.max.x) - std::max(from, box.min.x));
    };
}

ReadingOrder::Sight sightOfTile(std::size_t k)
{
    return sightOf(kTileSide * double(k) + 1.0, kTileSide * double(k) + 899.0);
}

std::size_t openFiles()
{
    return std::size_t(std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

}  // namespace

class ReadingOrderTest : public QObject
{
    Q_OBJECT

private slots:
    void nobodyLooks()
    {
        makeTiles(6);
        const auto session = open();
        const std::vector<std::size_t> tiles = readAlone(*session);
        std::vector<std::size_t> expected;
        for (const std::uint32_t k : las::spreadOrder(6)) expected.push_back(k);
        QCOMPARE(tiles, expected);
        QVERIFY(session->readingOrder()->sightRead());
        const auto again = open();
        again->readingOrder()->look(sightOfTile(3));
        again->readingOrder()->look({});  // and away
        std::size_t read = 0;
        m_arrived = [&](std::size_t) { read += again->readingOrder()->sightRead() ? 1 : 0; };
        QCOMPARE(readAlone(*again), expected);
        m_arrived = nullptr;
        QCOMPARE(read, std::size_t(0));
    }

    void whatIsInSightComesFirst()
    {
        makeTiles(6);
        const auto plain = open();
        const las::ReadResult expected = plain->read(m_progress);
        const std::vector<std::uint32_t> spread = las::spreadOrder(6);
        for (std::size_t k = 0; k < 6; ++k) {
            const auto session = open();
            session->readingOrder()->look(sightOfTile(k));
            QVERIFY(!session->readingOrder()->sightRead());
            std::vector<std::size_t> tiles = readAlone(*session);
            QCOMPARE(tiles.front(), k);
            tiles.erase(tiles.begin());
            std::vector<std::size_t> others;  // as if nobody looked
            for (const std::uint32_t other : spread)
                if (other != k) others.push_back(other);
            QCOMPARE(tiles, others);
            QVERIFY(m_result.bounds == expected.bounds);
            QVERIFY(m_result.missing.empty() && m_result.warnings == expected.warnings);
            QVERIFY(sameClouds(*session, *plain));
        }
    }

    /// The larger on the screen, the earlier; of about the same size, as they are spread.
    void nearOnesComeFirst()
    {
        makeTiles(6);
        const auto session = open();
        session->readingOrder()->look([](const WorldBounds& box) {
            const auto k = std::size_t(box.min.x / kTileSide + 0.5);
            return k == 4 ? 700.0 : k == 1 ? 90.0 : k == 5 ? 0.0 : 300.0 + double(k);
        });
        std::vector<std::size_t> expected{4};
        for (const std::uint32_t k : las::spreadOrder(6))
            if (k == 0 || k == 2 || k == 3) expected.push_back(k);
        expected.insert(expected.end(), {1, 5});
        QCOMPARE(readAlone(*session), expected);
    }

    /// Another look while files are read: the next piece is of what is in sight now, and the rest comes later.
    void jumpsWhileReading()
    {
        makeTiles(6);
        const auto plain = open();
        plain->read(m_progress);
        const auto session = open();
        ReadingOrder& order = *session->readingOrder();
        order.look(sightOfTile(2));
        std::vector<std::size_t> tiles;  // of each piece
        bool readBefore = true;
        m_arrived = [&](std::size_t tile) {
            tiles.push_back(tile);
            if (tiles.size() == 3) {
                order.look(sightOfTile(5));
                readBefore = order.sightRead();
            }
        };
        (void)readAlone(*session);
        m_arrived = nullptr;
        std::vector<std::size_t> begun{2, 2, 2};
        begun.insert(begun.end(), kTilePoints / kTileChunk, 5);
        QVERIFY(std::equal(begun.begin(), begun.end(), tiles.begin()));
        QCOMPARE(std::count(tiles.begin(), tiles.end(), std::size_t(2)), std::ptrdiff_t(7));
        QVERIFY(!readBefore);
        QVERIFY(sameClouds(*session, *plain));
        // What was in sight is told of as read as soon as it is, not when all is.
        const auto again = open();
        ReadingOrder& other = *again->readingOrder();
        other.look(sightOfTile(3));
        std::vector<bool> read;
        m_arrived = [&](std::size_t) { read.push_back(other.sightRead()); };
        (void)readAlone(*again);
        m_arrived = nullptr;
        QVERIFY(std::none_of(read.begin(), read.begin() + kTilePoints / kTileChunk, [](bool b) { return b; }));
        QVERIFY(std::all_of(read.begin() + kTilePoints / kTileChunk, read.end(), [](bool b) { return b; }));
    }

    /// Of one large file it is the chunks that are told apart, by the points that were read ahead.
    void chunksOfAFile()
    {
        makeTiles(1);
        const auto survey = Survey::open(m_files, m_progress);
        ReadingOrder order;
        order.look(sightOf(520.0, 630.0));  // chunk 4
        std::vector<PointIndex> chunks;
        tbb::task_arena(1).execute([&] {
            survey->read(
                m_progress, [&](PointRange range) { chunks.push_back(range.first / kTileChunk); },
                {.sink = [](PointRange) {}, .from = 0, .points = 20}, &order);
        });
        QCOMPARE(chunks.size(), std::size_t(7));
        const std::vector<PointIndex> first{chunks[0], chunks[1], chunks[2]};
        QVERIFY(std::find(first.begin(), first.end(), PointIndex(4)) != first.end());
        // the last chunk, of which nobody knows where it ends, is taken for as large as the file
        for (const PointIndex far : {0, 1, 2}) QVERIFY(std::find(first.begin(), first.end(), far) == first.end());
    }

    void cancelled()
    {
        makeTiles(4);
        const auto session = open();
        session->readingOrder()->look(sightOfTile(1));
        Progress progress;
        QVERIFY_EXCEPTION_THROWN(session->read(progress, [&](PointRange) { progress.cancel(); }), Cancelled);
    }

    /// Whose turn has not come yet, in a survey of which not all files stay open.
    void vanishesWhileWaiting()
    {
        makeTiles(70);
        const auto session = open(), plain = open();
        plain->read(m_progress);
        session->readingOrder()->look(sightOfTile(40));
        std::size_t most = 0;
        const std::size_t before = openFiles();
        bool removed = false;
        std::size_t turn = 0;
        m_arrived = [&](std::size_t) {
            most = std::max(most, openFiles() - before);
            if (!removed) fs::remove(m_files[41]);
            removed = true;
            session->readingOrder()->look(sightOfTile(++turn % 70));  // all are begun before one is done
        };
        (void)readAlone(*session);
        m_arrived = nullptr;
        QCOMPARE(m_result.warnings.size(), std::size_t(1));
        QVERIFY2(m_result.warnings.front().find("Its points are missing.") != std::string::npos,
                 m_result.warnings.front().c_str());
        QCOMPARE(m_result.missing.size(), std::size_t(1));
        QCOMPARE(m_result.missing.front().first, PointIndex(41 * kTilePoints));
        QVERIFY(sameClouds(*session, *plain, 41));
        QVERIFY2(most <= 64, qPrintable(QString::number(most)));
        QVERIFY2(most > 32, qPrintable(QString::number(most)));
    }

    void manyUnitsAreSortedSoon()
    {
        ReadingOrder order;
        std::vector<ReadingOrder::Part> parts(10'000);
        std::vector<std::uint32_t> turns(10), places;
        for (std::uint32_t k = 0; k < 10; ++k) turns[k] = k;
        for (std::uint32_t k = 0; k < 10'000; ++k) {
            const glm::dvec3 low(kTileSide * k, 0, 0);
            parts[k] = {{low, low + glm::dvec3(900.0, 900.0, 10.0)}, turns};
            places.push_back(k);
        }
        order.begin(std::move(parts), places);
        order.look(sightOfTile(7'000));
        const auto began = std::chrono::steady_clock::now();
        const auto unit = order.take();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        QCOMPARE(unit->part, 7'000u);
        QVERIFY2(seconds < 0.5, qPrintable(QString::number(seconds)));  // some ms, where nobody else works
        order.drop(7'000);
        QCOMPARE(order.take()->part, 0u);
        QVERIFY(!order.sightRead());  // the piece that was taken is not done yet
        order.done(*unit);
        QVERIFY(order.sightRead());
    }

private:
    void makeTiles(std::size_t count)
    {
        m_folder = std::make_unique<QTemporaryDir>();
        m_files.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const std::string number = std::to_string(k);
            m_files.push_back(fs::path(m_folder->path().toStdString()) /
                              (std::string(3 - number.size(), '0') + number + ".laz"));
            lasfiles::writeFile(m_files.back(), tileAt(k));
        }
    }
    std::shared_ptr<Session> open() { return Session::open(m_files, {}, m_progress); }
    /// By one thread. Returns the tiles as they were begun.
    std::vector<std::size_t> readAlone(Session& session)
    {
        std::vector<std::size_t> tiles;
        tbb::task_arena(1).execute([&] {
            m_result = session.read(m_progress, [&](PointRange range) {
                const std::size_t tile = range.first / kTilePoints;
                if (std::find(tiles.begin(), tiles.end(), tile) == tiles.end()) tiles.push_back(tile);
                if (m_arrived) m_arrived(tile);
            });
        });
        return tiles;
    }
    bool sameClouds(const Session& a, const Session& b, std::size_t but = SIZE_MAX) const
    {
        const PointCloud &one = *a.cloud(), &other = *b.cloud();
        for (std::size_t k = 0; k < one.columns().size(); ++k) {
            const std::size_t bytes = one.columns()[k]->elementBytes() * kTilePoints;
            for (std::size_t tile = 0; tile < m_files.size(); ++tile)
                if (tile != but && !std::equal(one.columns()[k]->data() + tile * bytes,
                                               one.columns()[k]->data() + (tile + 1) * bytes,
                                               other.columns()[k]->data() + tile * bytes))
                    return false;
        }
        if (but != SIZE_MAX) return true;
        for (std::size_t k = 0; k < one.boxes()->size(); ++k)
            if ((*one.boxes())[k] != (*other.boxes())[k]) return false;
        return true;
    }

    Progress m_progress;
    std::unique_ptr<QTemporaryDir> m_folder;
    std::vector<fs::path> m_files;
    las::ReadResult m_result;
    std::function<void(std::size_t tile)> m_arrived;
};

QTEST_APPLESS_MAIN(ReadingOrderTest)
#include "ReadingOrderTest.moc"
