// SPDX-License-Identifier: MIT
// Commands and History: what is done can be undone, exactly, and the history keeps its rules.
#include "core/edit/History.h"

#include "core/edit/ClassCommand.h"
#include "core/edit/DeleteCommand.h"
#include "core/edit/ListCommand.h"
#include "core/edit/SpillFile.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/CutSpillFile.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <random>
#include <thread>

using namespace punctum;

namespace
{

/// Every `step`th point of the cloud.
std::shared_ptr<PointSet> everyNth(PointIndex size, PointIndex step)
{
    auto points = std::make_shared<PointSet>(size);
    for (PointIndex i = 0; i < size; i += step) points->insert(i);
    return points;
}

template <typename T>
std::vector<std::byte> repeated(T value, PointIndex count)
{
    std::vector<std::byte> bytes(count * sizeof(T));
    for (PointIndex i = 0; i < count; ++i) std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
    return bytes;
}

template <typename T>
std::unique_ptr<Command> setValue(const PointCloud& cloud, const std::string& name, PointIndex step, T value)
{
    auto points = everyNth(cloud.size(), step);
    const PointIndex count = points->count();
    return std::make_unique<ValueCommand>("set " + name, *cloud.findAttribute(name), std::move(points),
                                          repeated(value, count));
}

/// A float32 attribute whose values are `value`, with its own column.
Attribute filled(const std::string& name, PointIndex size, float value)
{
    Attribute a;
    a.name = name;
    a.columns[0] = std::make_shared<Column>(name, ScalarType::F32, size);
    for (float& v : a.columns[0]->values<float>()) v = value;
    return a;
}

/// Three components and the vector that shows them.
std::vector<Attribute> normals(PointIndex size, float value)
{
    std::vector<Attribute> list{filled("NormalX", size, value), filled("NormalY", size, value + 1),
                                filled("NormalZ", size, value + 2)};
    Attribute vector = list[0];
    vector.name = "Normal";
    vector.kind = AttributeKind::Vector;
    vector.components = 3;
    for (std::size_t c = 0; c < 3; ++c) vector.columns[c] = list[c].columns[0];
    list.push_back(vector);
    return list;
}

/// Rows of a test of what a history keeps.
void keptInMemoryOrOnTheDisk()
{
    QTest::addColumn<bool>("onDisk");
    QTest::newRow("in memory") << false;
    QTest::newRow("on the disk") << true;
}

}  // namespace

class EditTest : public QObject
{
    Q_OBJECT

private slots:
    void valuesSwapAndComeBack_data();
    void valuesSwapAndComeBack();
    void bitFieldLeavesItsNeighborsAlone();
    void wideElementsSwap();
    void noticeNamesAttributeAndPoints();
    void oneMillionOfTwentyComesAndGoes_data();
    void oneMillionOfTwentyComesAndGoes();
    void attributesComeAndGo();
    void attributesReplaceInPlace();
    void attributesReplaceAnotherType();
    void attributesReplaceWithoutVector();
    void randomEditsComeBack_data();
    void randomEditsComeBack();
    void spilledPiecesComeBackAndTheirRoomIsUsedAgain();
    void columnsThatTheCloudLacksAreSpilled();
    void aFullDiskLeavesEditsInMemory();
    void whatCannotBeReadBackChangesNothing();
    void classFieldsAnywhereInAByte();
    void historyKeepsItsRules();
    void historyKnowsWhatWasSaved();
    void historyTellsWhatDiffers();
    void historyAnswersWhileItChanges();
    void writerGetsInWhileReadersRead();
};

void EditTest::valuesSwapAndComeBack_data()
{
    QTest::addColumn<qulonglong>("size");
    QTest::addColumn<qulonglong>("step");
    QTest::newRow("one point") << 1ull << 1ull;
    QTest::newRow("a word") << 64ull << 1ull;
    QTest::newRow("odd end") << 100001ull << 3ull;
    QTest::newRow("sparse") << 1000000ull << 70001ull;
}

void EditTest::valuesSwapAndComeBack()
{
    QFETCH(qulonglong, size);
    QFETCH(qulonglong, step);
    const auto cloud = makeFrame(size);
    auto time = addScalar<double>(*cloud, "GpsTime");
    for (PointIndex i = 0; i < size; ++i) time[i] = double(i) + 0.5;
    auto intensity = addScalar<std::uint16_t>(*cloud, "Intensity");
    for (PointIndex i = 0; i < size; ++i) intensity[i] = std::uint16_t(i * 7);
    const auto before = snapshot(*cloud);

    const auto a = setValue<double>(*cloud, "GpsTime", step, -1.25);
    const auto b = setValue<std::uint16_t>(*cloud, "Intensity", step, 65535);
    const auto c = setValue<std::int32_t>(*cloud, "Z", step, -7);
    QCOMPARE(a->changedPoints(), PointIndex((size + step - 1) / step));
    for (const auto& command : {a.get(), b.get(), c.get()}) command->apply(*cloud);
    for (PointIndex i = 0; i < size; ++i) {
        const bool in = i % step == 0;
        QCOMPARE(time[i], in ? -1.25 : double(i) + 0.5);
        QCOMPARE(intensity[i], in ? 65535 : std::uint16_t(i * 7));
        QCOMPARE(cloud->rawZ()[i], in ? -7 : 0);
    }
    const auto after = snapshot(*cloud);
    for (const auto& command : {c.get(), b.get(), a.get()}) command->apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
    for (const auto& command : {a.get(), b.get(), c.get()}) command->apply(*cloud);
    QVERIFY(snapshot(*cloud) == after);
}

void EditTest::bitFieldLeavesItsNeighborsAlone()
{
    const auto cloud = makeFrame(200, {}, true);
    auto bytes = cloud->columns()[3]->values<std::uint8_t>();
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(0x80 | (i % 32));
    const auto before = snapshot(*cloud);
    const auto command =
        setValue<std::uint8_t>(*cloud, "Classification", 2, 0xFF);  // flags of the value do not count
    // A flag changed between making and doing the command stays as it is.
    bytes[4] &= 0x7F;
    command->apply(*cloud);
    QCOMPARE(int(bytes[4]), 0x1F);
    QCOMPARE(int(bytes[6]), 0x9F);
    QCOMPARE(int(bytes[7]), 0x87);
    command->apply(*cloud);
    bytes[4] |= 0x80;
    QVERIFY(snapshot(*cloud) == before);
}

void EditTest::wideElementsSwap()
{
    const auto cloud = makeFrame(1000);
    Attribute a;
    a.name = "Bytes";
    a.kind = AttributeKind::Opaque;
    a.columns[0] = cloud->addColumn(std::make_shared<Column>("Bytes", ScalarType::U8, 1000, 5));
    cloud->addAttribute(a);
    auto bytes = a.columns[0]->values<std::uint8_t>();
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i);
    const auto before = snapshot(*cloud);
    auto points = everyNth(1000, 10);
    ValueCommand command("set", a, points, std::vector<std::byte>(100 * 5, std::byte(9)));
    command.apply(*cloud);
    for (std::size_t i = 0; i < bytes.size(); ++i) QCOMPARE(bytes[i], std::uint8_t(i / 5 % 10 == 0 ? 9 : i));
    command.apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
}

void EditTest::noticeNamesAttributeAndPoints()
{
    const auto cloud = makeFrame(100);
    std::vector<ChangeNotice> notices;
    bool lockWasFree = false;
    const auto subscription = cloud->subscribe([&](const ChangeNotice& n) {
        notices.push_back(n);
        std::thread([&] {  // a thread may not try a lock it may hold
            if (cloud->mutex().try_lock()) {
                lockWasFree = true;
                cloud->mutex().unlock();
            }
        })
            .join();
    });
    setValue<std::uint8_t>(*cloud, "Classification", 3, 6)->apply(*cloud);
    QCOMPARE(notices.size(), std::size_t(1));
    QVERIFY(notices[0].kind == ChangeNotice::Kind::Values);
    QVERIFY(notices[0].attributes == std::vector<std::string>{"Classification"});
    QVERIFY(notices[0].points && *notices[0].points == *everyNth(100, 3));
    QVERIFY(lockWasFree);
}

void EditTest::oneMillionOfTwentyComesAndGoes_data()
{
    keptInMemoryOrOnTheDisk();
}

void EditTest::oneMillionOfTwentyComesAndGoes()
{
    QFETCH(bool, onDisk);
    const QTemporaryDir folder;
    constexpr PointIndex kPoints = 20'000'000;
    const auto cloud = makeFrame(kPoints);
    auto classes = cloud->columns()[3]->values<std::uint8_t>();
    std::fill(classes.begin(), classes.end(), std::uint8_t(1));
    History history(cloud, onDisk ? HistoryRoom{0, 0, folder.path().toStdString()} : HistoryRoom{});
    history.push(setValue<std::uint8_t>(*cloud, "Classification", 20, 6));
    QCOMPARE(history.kept().memory == 0, onDisk);
    std::vector<double> ms;
    for (int round = 0; round < 7; ++round) {
        const auto start = std::chrono::steady_clock::now();
        round % 2 == 0 ? history.undo() : history.redo();
        ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        QCOMPARE(std::count(classes.begin(), classes.end(), std::uint8_t(6)), round % 2 == 0 ? 0 : kPoints / 20);
    }
    std::sort(ms.begin(), ms.end());
    qInfo("undo of 1 M of 20 M points: %.1f ms (fastest %.1f, slowest %.1f)", ms[3], ms.front(), ms.back());
}

void EditTest::attributesComeAndGo()
{
    const auto cloud = makeFrame(100);
    const auto before = snapshot(*cloud);
    const auto namesBefore = attributeNames(*cloud);
    AttributesCommand command("Normals", normals(100, 2.0f));
    QCOMPARE(command.changedPoints(), PointIndex(100));
    std::vector<ChangeNotice> notices;
    const auto subscription = cloud->subscribe([&](const ChangeNotice& n) { notices.push_back(n); });
    for (int round = 0; round < 2; ++round) {
        command.apply(*cloud);
        QCOMPARE(cloud->columns().size(), before.size() + 3);
        QCOMPARE(cloud->findAttribute("Normal")->number(5, 2), 4.0);
        QCOMPARE(cloud->findAttribute("NormalY")->number(5), 3.0);
        command.apply(*cloud);
        QVERIFY(snapshot(*cloud) == before);
        QVERIFY(attributeNames(*cloud) == namesBefore);
    }
    QCOMPARE(notices.size(), std::size_t(4));
    QVERIFY(notices[0].kind == ChangeNotice::Kind::Attributes);
    QVERIFY((notices[0].attributes == std::vector<std::string>{"NormalX", "NormalY", "NormalZ", "Normal"}));
}

void EditTest::attributesReplaceInPlace()
{
    const auto cloud = makeFrame(100);
    AttributesCommand first("Normals", normals(100, 2.0f));
    first.apply(*cloud);
    addScalar<std::uint8_t>(*cloud, "Later");  // so that "at the end" is not the same as "in place"
    const auto before = snapshot(*cloud);
    const auto names = attributeNames(*cloud);
    const auto column = cloud->findAttribute("NormalX")->columns[0];

    AttributesCommand second("Normals", normals(100, 20.0f));
    std::vector<ChangeNotice> notices;
    const auto subscription = cloud->subscribe([&](const ChangeNotice& n) { notices.push_back(n); });
    for (int round = 0; round < 2; ++round) {
        second.apply(*cloud);
        QVERIFY(attributeNames(*cloud) == names);
        QCOMPARE(cloud->findAttribute("NormalX")->columns[0], column);
        QCOMPARE(cloud->findAttribute("Normal")->number(5, 0), 20.0);
        QCOMPARE(cloud->findAttribute("NormalZ")->number(5), 22.0);
        second.apply(*cloud);
        QVERIFY(snapshot(*cloud) == before);
    }
    QCOMPARE(notices.size(), std::size_t(4));
    QVERIFY(notices[0].kind == ChangeNotice::Kind::Values && notices[0].points == nullptr);
    QVERIFY(notices[0].concerns(*cloud->findAttribute("Normal")));
}

void EditTest::attributesReplaceAnotherType()
{
    const auto cloud = makeFrame(100);
    auto old = addScalar<double>(*cloud, "NormalX");
    for (double& v : old) v = 0.125;
    const auto before = snapshot(*cloud);
    AttributesCommand command("Normals", normals(100, 2.0f));
    for (int round = 0; round < 2; ++round) {
        command.apply(*cloud);
        QVERIFY(cloud->findAttribute("NormalX")->type() == ScalarType::F32);
        QCOMPARE(cloud->findAttribute("NormalX")->number(0), 2.0);
        command.apply(*cloud);
        QCOMPARE(cloud->findAttribute("NormalX")->number(0), 0.125);
        QVERIFY(snapshot(*cloud) == before);
    }
}

void EditTest::attributesReplaceWithoutVector()
{
    // The cloud has the components, as a file may, but no vector: the new vector shows the cloud's columns.
    const auto cloud = makeFrame(100);
    for (const char* name : {"NormalX", "NormalY", "NormalZ"}) addScalar<float>(*cloud, name);
    const auto before = snapshot(*cloud);
    AttributesCommand command("Normals", normals(100, 5.0f));
    for (int round = 0; round < 2; ++round) {
        command.apply(*cloud);
        QCOMPARE(cloud->columns().size(), before.size());
        QCOMPARE(cloud->findAttribute("Normal")->number(7, 1), 6.0);
        QCOMPARE(cloud->findAttribute("NormalY")->number(7), 6.0);
        command.apply(*cloud);
        QVERIFY(snapshot(*cloud) == before);
        QVERIFY(cloud->findAttribute("Normal") == nullptr);
    }
}

void EditTest::historyKeepsItsRules()
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

void EditTest::historyKnowsWhatWasSaved()
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

void EditTest::historyTellsWhatDiffers()
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

void EditTest::historyAnswersWhileItChanges()
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

void EditTest::writerGetsInWhileReadersRead()
{
    // The lock as the steps use it: one thread that reads slab after slab must let an edit in between two.
    const auto cloud = makeFrame(1000);
    std::atomic<bool> done{false};
    std::thread reader([&] {
        while (!done) {
            const std::shared_lock lock(cloud->mutex());
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    });
    const auto start = std::chrono::steady_clock::now();
    setValue<std::uint8_t>(*cloud, "Classification", 1, 2)->apply(*cloud);
    const auto waited = std::chrono::steady_clock::now() - start;
    done = true;
    reader.join();
    QVERIFY(waited < std::chrono::milliseconds(200));
}

void EditTest::randomEditsComeBack_data()
{
    keptInMemoryOrOnTheDisk();
}

/// 1,000 edits of every kind of set and type, undone and redone; and what the commands keep is packed, or in a
/// file.
void EditTest::randomEditsComeBack()
{
    QFETCH(bool, onDisk);
    const QTemporaryDir folder;
    HistoryRoom room{1 << 20};
    if (onDisk) room = {2 << 10, 6 << 10, folder.path().toStdString()};
    constexpr PointIndex kSize = 20'077;
    const auto cloud = makeFrame(kSize, {}, true);
    addScalar<std::uint16_t>(*cloud, "Intensity");
    addScalar<double>(*cloud, "GpsTime");
    addScalar<std::uint64_t>(*cloud, "Id");
    std::mt19937_64 random(12);
    for (const auto& column : cloud->columns())
        for (std::size_t k = 0; k < column->size() * column->elementBytes(); ++k)
            column->data()[k] = std::byte(column->name() == "GpsTime" ? 0 : random() % 3);
    const char* const names[] = {"Classification", "Withheld", "Intensity", "GpsTime", "Id"};
    History history(cloud, room);
    std::size_t most = 0;
    const auto peak = [&] { most = std::max(most, history.kept().memory); };
    std::vector<std::vector<std::vector<std::byte>>> states{snapshot(*cloud)};
    std::size_t unpacked = 0;
    for (int k = 0; k < 1000; ++k) {
        const Attribute attribute = *cloud->findAttribute(names[random() % 5]);
        auto points = std::make_shared<PointSet>(kSize);
        const unsigned dense = 1 + unsigned(random() % 4) * 100;
        const PointIndex first = random() % kSize, last = first + random() % (kSize - first);
        for (PointIndex i = first; i <= last; i += 1 + random() % dense) points->insert(i);
        if (k % 10 == 5) {  // points are deleted, or what is deleted is restored
            const auto deleted = cloud->deleted();
            if (deleted && k % 30 == 5) {
                history.push(std::make_unique<DeleteCommand>("restore", deleted));
                continue;
            }
            if (deleted) points->remove(*deleted);
            history.push(std::make_unique<DeleteCommand>("delete", std::move(points)));
            continue;
        }
        const PointIndex count = points->count();
        std::vector<std::byte> values;
        const bool equal = random() % 2 == 0;
        for (std::size_t b = 0; b < count * attribute.columns[0]->elementBytes(); ++b)
            values.push_back(equal ? std::byte(1) : std::byte(random()));
        unpacked += values.size() + kSize / 8;
        history.push(std::make_unique<ValueCommand>("edit", attribute, std::move(points), std::move(values)));
        peak();
        if (k % 100 == 99) states.push_back(snapshot(*cloud));
    }
    const History::Kept kept = history.kept();
    qInfo("%zu bytes kept in memory and %zu in a file, %zu unpacked", kept.memory, kept.file, unpacked);
    QVERIFY(kept.memory + kept.file < unpacked);
    QCOMPARE(kept.file > 0, onDisk);
    QVERIFY(std::filesystem::is_empty(folder.path().toStdString()));  // it has no name
    for (int round = 0; round < 2; ++round) {
        for (std::size_t k = states.size(); k-- > 0;) {
            QVERIFY(snapshot(*cloud) == states[k]);
            for (int n = 0; n < 100 && k > 0; ++n, peak()) history.undo();
        }
        QVERIFY(!history.canUndo());
        for (std::size_t k = 0; k < states.size(); ++k) {
            QVERIFY(snapshot(*cloud) == states[k]);
            for (int n = 0; n < 100 && k + 1 < states.size(); ++n, peak()) history.redo();
        }
        QVERIFY(!history.canRedo());
    }
    qInfo("at most %zu bytes in memory", most);
    if (onDisk) QVERIFY(most <= room.memory);
    QCOMPARE(history.takeWarning(), std::string());
    // what is dropped leaves the file, too
    while (history.canUndo()) history.undo();
    history.push(setValue<std::uint16_t>(*cloud, "Intensity", 1000, 5));
    QCOMPARE(history.kept().file, std::size_t(0));
}

void EditTest::spilledPiecesComeBackAndTheirRoomIsUsedAgain()
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

void EditTest::columnsThatTheCloudLacksAreSpilled()
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

void EditTest::aFullDiskLeavesEditsInMemory()
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

void EditTest::whatCannotBeReadBackChangesNothing()
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

void EditTest::classFieldsAnywhereInAByte()
{
    const auto cloud = makeFrame(10, {}, true);
    Attribute shifted = *cloud->findAttribute("Classification");
    shifted.bitShift = 3;
    const auto points = everyNth(10, 2);
    const auto column = shifted.columns[0]->values<std::uint8_t>();
    column[2] = 0x07;
    const auto codes = [&](std::uint8_t code) { return std::vector<std::byte>(points->count(), std::byte(code)); };
    makeClassCommand("all", shifted, points, codes(31))->apply(*cloud);
    QCOMPARE(int(column[2]), 0xFF);
    makeClassCommand("all", shifted, points, std::uint32_t(1))->apply(*cloud);
    QCOMPARE(int(column[2]), 0x0F);
    QVERIFY(makeClassCommand("none", shifted, everyNth(0, 1), 1u) == nullptr);
    QVERIFY(complaint([&] { classAttribute(*cloud, 256); }).find("256 is no class") != std::string::npos);
    QVERIFY(makeClassCommand("none", shifted, points, std::vector<std::byte>()) == nullptr);
}

QTEST_APPLESS_MAIN(EditTest)
#include "EditTest.moc"
