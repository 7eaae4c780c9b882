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
#include "tests/core/MadeEdits.h"

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
    void classFieldsAnywhereInAByte();
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
