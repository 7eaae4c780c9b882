// SPDX-License-Identifier: MIT
// The history: which edits are in force, what differs from what was saved, and where what it keeps is.
#include "core/edit/History.h"

#include "core/edit/ClassCommand.h"
#include "core/edit/DeleteCommand.h"
#include "core/edit/ListCommand.h"
#include "core/edit/SpillFile.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/CutSpillFile.h"
#include "tests/core/MadeEdits.h"

#include <QTemporaryDir>
#include <QTest>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

using namespace punctum;

class HistoryTest : public QObject
{
    Q_OBJECT

private slots:
    void historyKeepsItsRules();
    void historyKnowsWhatWasSaved();
    void historyTellsWhatDiffers();
    void historyAnswersWhileItChanges();
    void spilledPiecesComeBackAndTheirRoomIsUsedAgain();
    void columnsThatTheCloudLacksAreSpilled();
    void aFullDiskLeavesEditsInMemory();
    void whatCannotBeReadBackChangesNothing();
};

void HistoryTest::historyKeepsItsRules()
{
    const auto cloud = makeFrame(1000);
    auto classes = cloud->columns()[3]->values<std::uint8_t>();
    History history(cloud);
    QVERIFY(!history.canUndo() && !history.canRedo());
    history.undo();
    history.redo();
    history.push(nullptr);
    QVERIFY(history.names().empty() && history.undoName().empty() && history.redoName().empty());

    history.push(setValue<std::uint8_t>(*cloud, "Classification", 1, 2));
    history.push(setValue<std::uint8_t>(*cloud, "Classification", 2, 6));
    history.push(setValue<std::int32_t>(*cloud, "Z", 2, 9));
    QCOMPARE(history.position(), std::size_t(3));
    QCOMPARE(QString::fromStdString(history.undoName()), QString("set Z"));
    history.undo();
    history.undo();
    QCOMPARE(int(classes[0]), 2);
    QCOMPARE(cloud->rawZ()[0], 0);
    QCOMPARE(history.position(), std::size_t(1));
    QCOMPARE(QString::fromStdString(history.redoName()), QString("set Classification"));
    history.redo();
    QCOMPARE(int(classes[0]), 6);
    QCOMPARE(int(classes[1]), 2);
    history.undo();

    history.push(setValue<std::int32_t>(*cloud, "X", 1, 4));
    QVERIFY(!history.canRedo());
    QVERIFY((history.names() == std::vector<std::string>{"set Classification", "set X"}));
    history.undo();
    history.undo();
    QVERIFY(!history.canUndo());
    QCOMPARE(int(classes[0]), 0);
    QCOMPARE(cloud->rawX()[0], 0);
}

void HistoryTest::historyKnowsWhatWasSaved()
{
    const auto cloud = makeFrame(10);
    {
        History never(cloud);
        never.forgetSaved();
        never.push(setValue<std::uint8_t>(*cloud, "Classification", 3, 1));
        never.undo();
        QVERIFY(never.modified());
        QVERIFY((never.changedPoints() == std::vector<PointIndex>{4}));
    }
    History history(cloud);
    const auto change = [&] { history.push(setValue<std::uint8_t>(*cloud, "Classification", 1, 2)); };
    QVERIFY(!history.modified());
    change();
    QVERIFY(history.modified());
    history.undo();
    QVERIFY(!history.modified());
    history.redo();
    change();
    history.markSaved();
    QVERIFY(!history.modified());
    history.undo();
    QVERIFY(history.modified());
    history.redo();
    QVERIFY(!history.modified());
    history.undo();
    change();  // the saved state is gone for good
    QVERIFY(history.modified());
    history.undo();
    QVERIFY(history.modified());
    history.redo();
    QVERIFY(history.modified());
    history.markSaved();
    QVERIFY(!history.modified());
}

void HistoryTest::historyTellsWhatDiffers()
{
    const auto cloud = makeFrame(1000);
    addBits(*cloud, "Low", "Classification", 0, 4);
    addBits(*cloud, "High", "Classification", 4, 4);
    History history(cloud);
    Progress progress;
    using Changes = std::vector<AttributeChange>;
    const auto changes = [&] { return history.changes(progress).value_or(Changes{{"unknown", 0}}); };
    const auto one = [&](const std::string& name, PointIndex i, int value) {
        auto points = std::make_shared<PointSet>(cloud->size());
        points->insert(i);
        history.push(std::make_unique<ValueCommand>("one", *cloud->findAttribute(name), std::move(points),
                                                    repeated(std::uint8_t(value), 1)));
    };
    const auto set = [&](PointIndex i, int value) { one("Classification", i, value); };
    QCOMPARE(changes().size(), std::size_t(0));
    set(1, 0x12);
    set(2, 0x02);
    QVERIFY((changes() == Changes{{"Classification", 2}, {"Low", 2}, {"High", 1}}));
    set(1, 0x10);  // back, in part
    QVERIFY((changes() == Changes{{"Classification", 2}, {"Low", 1}, {"High", 1}}));
    set(1, 0);
    set(2, 0);
    QVERIFY(changes().empty() && history.modified());
    history.undo();
    history.markSaved();
    QVERIFY(changes().empty());
    history.undo();
    history.undo();
    QVERIFY((changes() == Changes{{"Classification", 1}, {"Low", 1}, {"High", 1}}));  // seen from the other side
    history.redo();
    history.redo();
    QVERIFY(changes().empty());

    // a new attribute is no change of values, nor is an edit of it; one that takes another's values is
    const auto made = [&](ScalarType type) {
        Attribute a;
        a.name = "New";
        a.columns[0] = std::make_shared<Column>("New", type, cloud->size());
        a.columns[0]->data()[0] = std::byte(1);
        std::vector<Attribute> list{a};
        return std::make_unique<AttributesCommand>("new", list);
    };
    history.push(made(ScalarType::U8));
    one("New", 5, 7);
    QVERIFY(changes().empty());
    history.markSaved();
    history.push(made(ScalarType::U8));  // point 5 is 0 again
    QVERIFY((changes() == Changes{{"New", 1}}));
    history.push(made(ScalarType::U16));
    QVERIFY((changes() == Changes{{"New", 1000}}));
    history.undo();
    QVERIFY((changes() == Changes{{"New", 1}}));

    // the saved state is gone
    history.undo();
    history.undo();
    set(3, 3);
    QVERIFY(!history.changes(progress).has_value());
    progress.cancel();
    history.markSaved();
    set(3, 4);
    QVERIFY_THROWS_EXCEPTION(Cancelled, history.changes(progress));
}

void HistoryTest::historyAnswersWhileItChanges()
{
    const auto cloud = makeFrame(30000);
    History history(cloud);
    std::atomic<bool> done{false};
    std::thread asker([&] {
        while (!done) {
            const auto names = history.names();
            const auto position = history.position();
            if (position > 50 || names.size() > 50) qFatal("impossible answer");
            (void)history.undoName();
            (void)history.modified();
            std::this_thread::sleep_for(std::chrono::microseconds(50));  // else the lock is hardly ever free
        }
    });
    std::vector<std::thread> changers;
    for (int t = 0; t < 2; ++t)
        changers.emplace_back([&, t] {
            for (int i = 0; i < 25; ++i) {
                history.push(setValue<std::uint8_t>(*cloud, "Classification", PointIndex(t + 2), std::uint8_t(i)));
                history.undo();
                history.redo();
            }
        });
    for (auto& t : changers) t.join();
    done = true;
    asker.join();
    while (history.canUndo()) history.undo();
    for (const std::uint8_t c : cloud->columns()[3]->values<std::uint8_t>()) QCOMPARE(int(c), 0);
}

void HistoryTest::spilledPiecesComeBackAndTheirRoomIsUsedAgain()
{
    const QTemporaryDir folder;
    const auto file = SpillFile::create(folder.path().toStdString() + "/made/here");
    std::mt19937_64 random(4);
    struct Kept {
        SpillFile::Piece piece;
        std::vector<std::byte> bytes;
    };
    std::vector<Kept> all;
    std::uint64_t written = 0, kept = 0, most = 0;
    for (int k = 0; k < 4000; ++k) {
        if (all.size() > 40 || (!all.empty() && random() % 3 == 0)) {
            Kept& one = all[random() % all.size()];
            std::vector<std::byte> back(one.piece.size());
            one.piece.read(back);
            QVERIFY(back == one.bytes);
            kept -= back.size();
            std::swap(one, all.back());
            all.pop_back();
            continue;
        }
        std::vector<std::byte> bytes(1 + random() % 5000);
        for (std::byte& b : bytes) b = std::byte(random());
        written += bytes.size();
        kept += bytes.size();
        most = std::max(most, kept);
        all.push_back({file->write(bytes), bytes});
    }
    QVERIFY2(file->length() < 2 * most && written > 10 * most,
             qPrintable(QStringLiteral("%1 of %2").arg(file->length()).arg(most)));
    all.clear();
    QCOMPARE(file->length(), std::uint64_t(0));
}

void HistoryTest::columnsThatTheCloudLacksAreSpilled()
{
    constexpr PointIndex kSize = 10'100;  // no whole number of pages
    const QTemporaryDir folder;
    const auto cloud = makeFrame(kSize, {}, true);
    auto old = addScalar<double>(*cloud, "NormalX");  // of another type than the new ones
    for (PointIndex i = 0; i < kSize; ++i) old[i] = double(i);
    History history(cloud, {0, 0, folder.path().toStdString()});
    std::vector<std::vector<std::vector<std::byte>>> states{snapshot(*cloud)};
    std::vector<std::vector<std::string>> names{attributeNames(*cloud)};
    const auto push = [&](std::unique_ptr<Command> command) {
        history.push(std::move(command));
        states.push_back(snapshot(*cloud));
        names.push_back(attributeNames(*cloud));
    };
    const auto classes = [&](std::uint8_t code) {
        return makeClassCommand("classes", *cloud->findAttribute("Classification"), everyNth(kSize, 3), code);
    };
    push(std::make_unique<AttributesCommand>("new", normals(kSize, 2.0f)));
    push(setValue<float>(*cloud, "NormalY", 7, 0.5f));
    push(std::make_unique<AttributesCommand>("again", normals(kSize, 9.0f)));
    push(classes(40));
    push(ListCommand::rename(*cloud->findAttribute("NormalZ"), "Up"));
    push(ListCommand::remove(*cloud->findAttribute("NormalY")));
    push(classes(50));
    const std::size_t tails = 10 * 4096;  // what is no whole page of a column
    QVERIFY(history.kept().file > 4 * kSize * sizeof(float) && history.kept().memory < tails);
    for (int round = 0; round < 2; ++round) {
        for (std::size_t k = states.size(); k-- > 0; history.undo()) {
            QVERIFY(snapshot(*cloud) == states[k]);
            QVERIFY(attributeNames(*cloud) == names[k]);
        }
        QVERIFY(history.kept().memory < tails);
        for (std::size_t k = 0; k < states.size(); ++k, history.redo()) QVERIFY(snapshot(*cloud) == states[k]);
    }
    // whoever still has a column reads it, while it is in the file and after the command has gone
    history.undo();
    history.undo();
    const auto column = cloud->findAttribute("NormalY")->columns[0];
    history.redo();
    QVERIFY(cloud->findAttribute("NormalY") == nullptr);
    for (const float v : column->values<float>()) QCOMPARE(v, 10.0f);
    while (history.canUndo()) history.undo();
    const std::vector<float> before(column->values<float>().begin(), column->values<float>().end());
    QCOMPARE(before[1], 3.0f);
    history.push(setValue<std::int32_t>(*cloud, "X", 1, 4));
    QVERIFY(!history.canRedo());
    QVERIFY(std::equal(before.begin(), before.end(), column->values<float>().begin()));
}

void HistoryTest::aFullDiskLeavesEditsInMemory()
{
    const QTemporaryDir folder;
    const auto cloud = makeFrame(50'000);
    const auto before = snapshot(*cloud);
    History history(cloud, {0, 1 << 10, folder.path().toStdString()});
    const auto fill = [&] {
        for (int k = 2; k < 12; ++k)
            history.push(setValue<std::uint8_t>(*cloud, "Classification", PointIndex(k), std::uint8_t(k)));
    };
    // a disk that takes no more than 10,000 bytes of a file
    rlimit limit{};
    QCOMPARE(::getrlimit(RLIMIT_FSIZE, &limit), 0);
    const rlimit small{10'000, limit.rlim_max};
    const auto handler = ::signal(SIGXFSZ, SIG_IGN);
    QCOMPARE(::setrlimit(RLIMIT_FSIZE, &small), 0);
    fill();
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::signal(SIGXFSZ, handler);
    const auto after = snapshot(*cloud);
    QVERIFY(history.kept().memory > 20'000);
    const std::string warning = history.takeWarning();
    QVERIFY2(warning.find("stays in memory") != std::string::npos, warning.c_str());
    QCOMPARE(history.takeWarning(), std::string());
    while (history.canUndo()) history.undo();
    QVERIFY(snapshot(*cloud) == before);
    while (history.canRedo()) history.redo();
    QVERIFY(snapshot(*cloud) == after);
    QVERIFY(history.kept().memory <= 1 << 10);  // there is room again

    // no folder can be made there
    History other(cloud, {0, 0, "/dev/null/nowhere"});
    other.push(setValue<std::uint8_t>(*cloud, "Classification", 1, 3));
    QVERIFY(!other.takeWarning().empty() && other.kept().memory > 0);
    other.undo();
    QVERIFY(snapshot(*cloud) == after);
}

void HistoryTest::whatCannotBeReadBackChangesNothing()
{
    const QTemporaryDir folder;
    const auto cloud = makeFrame(5000);
    History history(cloud, {0, 0, folder.path().toStdString()});
    history.push(setValue<std::uint8_t>(*cloud, "Classification", 3, 2));
    QCOMPARE(history.kept().memory, std::size_t(0));
    const auto before = snapshot(*cloud);
    QCOMPARE(cutSpillFiles(folder.path().toStdString()), 1);
    for (int round = 0; round < 2; ++round) {
        const std::string told = complaint([&] { history.undo(); });
        QVERIFY2(told.find("cannot be read back") != std::string::npos, told.c_str());
        QVERIFY(snapshot(*cloud) == before);
        QCOMPARE(history.position(), std::size_t(1));
    }
    history.push(setValue<std::uint8_t>(*cloud, "Classification", 5, 7));
    history.undo();
    QVERIFY(snapshot(*cloud) == before);

    // bytes that are others: of the set (with more points then), or of the values behind it
    for (const bool ofSet : {true, false}) {
        const QTemporaryDir other;
        History damaged(cloud, {0, 0, other.path().toStdString()});
        damaged.push(setValue<std::uint8_t>(*cloud, "Classification", 3, 2));
        const auto done = snapshot(*cloud);
        for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
            std::error_code ignored;
            const auto target = std::filesystem::read_symlink(entry.path(), ignored).string();
            if (!target.starts_with(other.path().toStdString())) continue;
            const int file = ::open(entry.path().c_str(), O_WRONLY);
            const off_t at = ofSet ? 0 : ::lseek(file, 0, SEEK_END) - 5;
            QCOMPARE(::pwrite(file, "\xFF\xFF\xFF\xFF\xFF", 5, at), ssize_t(5));
            ::close(file);
        }
        const std::string told = complaint([&] { damaged.undo(); });
        QVERIFY2(told.find("damaged on the disk") != std::string::npos, told.c_str());
        QVERIFY(snapshot(*cloud) == done);
        for (std::uint8_t& c : cloud->columns()[3]->values<std::uint8_t>()) c = 0;
    }

    // a column that went, and that somebody still has when its history ends: there, if not what it was
    std::shared_ptr<Column> held;
    {
        History ends(cloud, {0, 0, folder.path().toStdString()});
        ends.push(std::make_unique<AttributesCommand>("add", std::vector{filled("Extra", 5000, 4.5f)}));
        held = cloud->findAttribute("Extra")->columns[0];
        ends.undo();
        QVERIFY(ends.kept().file >= 5000 / 1024 * 4096);
        QCOMPARE(cutSpillFiles(folder.path().toStdString()), 2);
    }
    QCOMPARE(held->values<float>()[0], 0.0f);
    QCOMPARE(held->values<float>()[4999], 4.5f);  // of no whole page
}

QTEST_GUILESS_MAIN(HistoryTest)
#include "HistoryTest.moc"
