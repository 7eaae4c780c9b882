// SPDX-License-Identifier: MIT
// Arrays beyond the memory budget: they hold what they hold, whatever is let go of, and the budget is kept to.
#include "core/Error.h"
#include "core/Memory.h"
#include "core/cloud/Buffer.h"
#include "core/cloud/Residency.h"
#include "core/edit/History.h"
#include "core/edit/Recipe.h"
#include "core/sample/Sample.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <span>
#include <thread>
#include <vector>

using namespace punctum;

namespace
{

constexpr std::uint64_t kMiB = std::uint64_t(1) << 20;

std::uint32_t madeValue(std::uint64_t i, std::uint32_t round)
{
    return std::uint32_t((i + round) * 2654435761U >> 3);
}

std::span<std::uint32_t> valuesOf(Buffer& buffer)
{
    return {reinterpret_cast<std::uint32_t*>(buffer.data()), buffer.size() / 4};
}

/// By two threads, which begin at opposite ends.
template <typename Visit>
void forAll(std::vector<Buffer>& buffers, const Visit& visit)
{
    const auto walk = [&](bool backward) {
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            const auto values = valuesOf(buffers[backward ? buffers.size() - 1 - k : k]);
            const std::size_t half = values.size() / 2;
            for (std::size_t i = 0; i < half; ++i)
                visit(values[backward ? values.size() - 1 - i : i], backward ? values.size() - 1 - i : i);
        }
    };
    std::thread other(walk, true);
    walk(false);
    other.join();
}

/// Sets the budget until the end of a test.
struct Budget {
    explicit Budget(std::uint64_t bytes) { setMemoryBudget(bytes); }
    ~Budget() { setMemoryBudget(0); }
    Budget(const Budget&) = delete;
    Budget& operator=(const Budget&) = delete;
};

}  // namespace

class ResidencyTest : public QObject
{
    Q_OBJECT
private slots:
    void initTestCase()
    {
        std::signal(SIGXFSZ, SIG_IGN);
        QVERIFY(m_folder.isValid());
        qputenv("XDG_CACHE_HOME", m_folder.path().toUtf8());
    }
    void cleanup()
    {
        QCOMPARE(Residency::instance().inMemory(), std::uint64_t(0));
        QCOMPARE(Residency::instance().inFiles(), std::uint64_t(0));
    }

    void firstComeIsMemory()
    {
        const Budget budget(64 * kMiB);
        const Buffer first(30 * kMiB, BufferUse::Points);
        QVERIFY(!first.inFile());
        const Buffer second(30 * kMiB, BufferUse::Points);
        QVERIFY(second.inFile());
        const Buffer drawn(20 * kMiB, BufferUse::Drawing);  // what is drawn comes before columns
        QVERIFY(!drawn.inFile());
        const Buffer work(500 * kMiB);
        QVERIFY(!work.inFile());
        QVERIFY(Residency::instance().residentMost() >= 64 * kMiB / 8);
    }

    void valuesStayWhileTheBudgetIsKept()
    {
        const Budget budget(64 * kMiB);
        std::vector<Buffer> buffers;
        for (int k = 0; k < 8; ++k) buffers.emplace_back(48 * kMiB, BufferUse::Points);
        Residency& residency = Residency::instance();
        QVERIFY(residency.inFiles() >= 300 * kMiB);
        for (std::uint32_t round = 1; round <= 2; ++round) {
            forAll(buffers, [&](std::uint32_t& value, std::size_t i) { value = madeValue(i, round); });
            std::atomic<std::size_t> wrong = 0;
            forAll(buffers,
                   [&](const std::uint32_t& value, std::size_t i) { wrong += value != madeValue(i, round); });
            QCOMPARE(wrong.load(), std::size_t(0));
        }
        QTRY_VERIFY2(residency.resident() <= residency.residentMost(),
                     qPrintable(QString::number(residency.resident() / kMiB)));
    }

    /// Who fills arrays faster than pages are let go of, and says so, is held to the bound meanwhile.
    void whoFillsKeepsUp()
    {
        const Budget budget(64 * kMiB);
        std::vector<Buffer> buffers;
        for (int k = 0; k < 8; ++k) buffers.emplace_back(48 * kMiB, BufferUse::Points);
        Residency& residency = Residency::instance();
        std::uint64_t most = 0;
        for (Buffer& buffer : buffers)
            for (std::size_t at = 0; at < buffer.size(); at += kMiB) {
                std::fill_n(buffer.data() + at, std::size_t(kMiB), std::byte(1));
                residency.keepUp(kMiB);
                most = std::max(most, residency.resident());
            }
        constexpr std::uint64_t kBetweenLooks = 24 * kMiB;
        QVERIFY2(most <= residency.residentMost() + kBetweenLooks, qPrintable(QString::number(most / kMiB)));
    }

    void freshOnesAreZeros()
    {
        const Budget budget(16 * kMiB);
        for (int round = 0; round < 2; ++round) {
            Buffer buffer(40 * kMiB, BufferUse::Points);
            QVERIFY(buffer.inFile());
            const auto values = valuesOf(buffer);
            QVERIFY(std::all_of(values.begin(), values.end(), [](std::uint32_t v) { return v == 0; }));
            std::fill(values.begin(), values.end(), 7U);
        }
    }

    void noRoomOnTheDiskIsAnError()
    {
        const Budget budget(16 * kMiB);
        rlimit before{};
        QCOMPARE(getrlimit(RLIMIT_FSIZE, &before), 0);
        rlimit small = before;
        small.rlim_cur = 8 * kMiB;
        QCOMPARE(setrlimit(RLIMIT_FSIZE, &small), 0);
        QString said;
        try {
            const Buffer buffer(40 * kMiB, BufferUse::Points);
        } catch (const Error& error) {
            said = error.what();
        }
        QCOMPARE(setrlimit(RLIMIT_FSIZE, &before), 0);
        QVERIFY2(said.contains("memory budget of 17 MB"), qPrintable(said));
        QVERIFY2(said.contains(m_folder.path()), qPrintable(said));
    }

    /// A step that adds attributes, undone until they are given away, and done again: as without a bound.
    void editsComeAndGo()
    {
        const auto heights = [](std::uint64_t bytes) {
            const Budget budget(bytes);
            Progress progress;
            const auto cloud = makeSample(1'500'000, 3, progress);
            HistoryRoom room;
            room.loose = room.memory = 1;
            room.folder = std::filesystem::temp_directory_path();
            History history(cloud, room);
            history.push(makeCommand({"normals", {{"k", "8"}}, nullptr}, *cloud, progress));
            history.undo();
            history.redo();
            history.push(
                makeCommand({"set", {{"rule", "Classification = 9 if Z > 100"}}, nullptr}, *cloud, progress));
            history.undo();
            history.undo();
            history.redo();
            std::vector<double> found(3 * 4096);
            for (std::uint32_t c = 0; c < 3; ++c)
                cloud->findAttribute("Normal")->read({700'000, 704'096}, found.data() + c * 4096, c);
            return found;
        };
        QVERIFY(heights(0) == heights(16 * kMiB));
    }

private:
    QTemporaryDir m_folder;
};

QTEST_GUILESS_MAIN(ResidencyTest)
#include "ResidencyTest.moc"
