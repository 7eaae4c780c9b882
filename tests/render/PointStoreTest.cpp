// SPDX-License-Identifier: MIT
#include "core/Memory.h"
#include "core/expression/Rule.h"
#include "core/task/Progress.h"
#include "render/store/AttributeEncoder.h"
#include "render/store/PointStore.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

#include <algorithm>
#include <bit>
#include <thread>

using namespace punctum;
using namespace punctum::render;

class PointStoreTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void filledInAnyOrder_data();
    void filledInAnyOrder();
    void pointsAheadAreCountedOnce_data();
    void pointsAheadAreCountedOnce();
    void pointsAheadAreThoseOfAnOverview();
    void framesHoldWildExtents();
    void wrongFirstBoundsAreMended();
    void damagedPointsAreWithdrawn();
    void framesEndWhereTheySay();
    void firstAttributeIsWhatVaries();
    void eightBitColorsAreShownAsSuch();
    void bitDepthOfColors_data();
    void bitDepthOfColors();
    void filesWithoutColorsAreNotBlack();
    void gpsTimeKeepsItsDigits();
    void editsReachVisibleSlotsFirst();
    void previewIsShownInsteadAndTakenBack();
};

void PointStoreTest::filledInAnyOrder_data()
{
    QTest::addColumn<int>("kind");
    QTest::addColumn<int>("batch");
    for (const int batch : {1, 777, 16384, 50000})
        for (const OrderKind kind : {OrderKind::Prime, OrderKind::Stratified})
            QTest::addRow("%d %d", int(kind), batch) << int(kind) << batch;
}

void PointStoreTest::filledInAnyOrder()
{
    QFETCH(int, kind);
    QFETCH(int, batch);
    const auto cloud = test::makeCloud(100'003);
    PointStore store(cloud, cloud->computeBounds(), OrderKind(kind));
    const auto step = PointIndex(batch);
    // Odd batches first, then even ones, as two threads.
    const auto fillEvery = [&](PointIndex parity) {
        for (PointIndex b = parity; b * step < cloud->size(); b += 2)
            store.fill({b * step, std::min(cloud->size(), (b + 1) * step)});
    };
    std::thread other([&] { fillEvery(1); });
    fillEvery(0);
    other.join();
    QCOMPARE(store.filled(), cloud->size());
    QVERIFY(!store.outgrown());
    if (batch > 1) QCOMPARE(store.encoder()->attribute().name, std::string("RGB"));
    const auto& frame = store.frame();
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const Slot s = store.order().slotOf(i);
        const LocalPosition p = store.positions()[s];
        QCOMPARE(p.x + frame.origin.x, std::int64_t(cloud->rawX()[i]));
        QCOMPARE(p.y + frame.origin.y, std::int64_t(cloud->rawY()[i]));
        QCOMPARE(p.z + frame.origin.z, std::int64_t(cloud->rawZ()[i]));
        QCOMPARE(unsigned(store.classes()[s]), unsigned(cloud->findAttribute("Classification")->number(i)));
        const auto index = std::uint32_t(i);
        std::uint32_t word = 0;
        store.encoder()->encode({&index, 1}, &word);
        QCOMPARE(store.words()[s], word);
    }
}

void PointStoreTest::pointsAheadAreCountedOnce_data()
{
    QTest::addColumn<int>("kind");
    QTest::addColumn<int>("windows");
    QTest::newRow("some windows") << int(OrderKind::Stratified) << 8;
    QTest::newRow("all windows") << int(OrderKind::Stratified) << 64;
    QTest::newRow("prime") << int(OrderKind::Prime) << 8;
}

// They are in their slots before all others, and nothing else is; told of once more, they count no more.
void PointStoreTest::pointsAheadAreCountedOnce()
{
    QFETCH(int, kind);
    QFETCH(int, windows);
    const auto cloud = test::makeCloud(100'003);
    PointStore store(cloud, cloud->computeBounds(), OrderKind(kind)),
        whole(cloud, cloud->computeBounds(), OrderKind(kind));
    whole.fillAll();
    const std::vector<PointRange> ahead{{0, 100}, {5000, 6024}, {49'990, 50'500}, {99'900, 100'003}};
    const bool prime = OrderKind(kind) == OrderKind::Prime;
    const auto taken = [&](PointIndex i) {
        return std::any_of(ahead.begin(), ahead.end(), [&](const PointRange& range) {
            if (i < range.first || i >= range.last) return false;
            return prime ? i < range.first + 32
                         : store.order().slotOf(i) / store.order().windowSize() < Slot(windows);
        });
    };
    for (const PointRange& range : ahead) store.fillAhead(range, std::uint32_t(windows));
    PointIndex expected = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        QCOMPARE(store.isFilled(i), taken(i));
        expected += taken(i) ? 1 : 0;
    }
    QCOMPARE(store.filled(), expected);
    QVERIFY(expected < 2000 && expected >= 4 * 32);

    // A copy on a device is told of the slots that have them, of no other window.
    std::vector<SlotRange> arrived;
    QVERIFY(store.arrivedSlots(0, store.arrivals(), {0, store.slotCount()}, arrived));
    std::vector<bool> brought(store.slotCount());
    for (const SlotRange& run : arrived)
        for (Slot slot = run.first; slot < run.last; ++slot) {
            brought[slot] = true;
            QVERIFY(prime || slot / store.order().windowSize() < Slot(windows));
        }
    for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(!taken(i) || brought[store.order().slotOf(i)]);

    // some are damaged
    PointIndex gone = 0;
    for (PointIndex i = 5500; i < 5600; ++i) gone += taken(i) ? 1 : 0;
    store.withdraw({5500, 5600});
    QCOMPARE(store.filled(), expected - gone);

    const PointIndex before = store.filled();
    store.fill({5600, 6024});  // all but those ahead are new
    PointIndex fresh = 0;
    for (PointIndex i = 5600; i < 6024; ++i) fresh += taken(i) ? 0 : 1;
    QCOMPARE(store.filled(), before + fresh);
    for (PointIndex first = 0; first < cloud->size(); first += 777)
        for (const PointRange& part :
             {PointRange{first, std::min(first + 777, PointIndex(5500))},
              PointRange{std::max(first, PointIndex(6024)), std::min(first + 777, cloud->size())}})
            if (part.first < part.last) store.fill(part);
    QCOMPARE(store.filled(), cloud->size() - 100);
    QVERIFY(!store.full());
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        if (i >= 5500 && i < 5600) continue;
        const Slot slot = store.order().slotOf(i);
        QVERIFY(store.positions()[slot].x == whole.positions()[slot].x &&
                store.positions()[slot].z == whole.positions()[slot].z);
        QCOMPARE(store.words()[slot], whole.words()[slot]);
        QCOMPARE(store.classes()[slot], whole.classes()[slot]);
    }
}

void PointStoreTest::pointsAheadAreThoseOfAnOverview()
{
    const auto cloud = test::makeCloud(100'003);
    setMemoryBudget(1 << 20);
    PointStore store(cloud, cloud->computeBounds());
    setMemoryBudget(0);
    QVERIFY(store.beyondMemory());
    QCOMPARE(store.windowsOfGrowing(1'000'000), 16u);
    QCOMPARE(store.windowsOfGrowing(600'000), 16u);
    QCOMPARE(store.windowsOfGrowing(500'000'000), 1u);
    QCOMPARE(store.windowsOfGrowing(), 64u);  // of a small cloud all
    store.fillAhead({0, 1000});
    QCOMPARE(store.filled(), PointIndex(1000));
}

void PointStoreTest::framesHoldWildExtents()
{
    RawBounds all;
    all.include(INT32_MIN, INT32_MIN, INT32_MIN);
    all.include(INT32_MAX, INT32_MAX, INT32_MAX);
    QVERIFY(LocalFrame::around(all).holds(all));
    RawBounds one;
    one.include(INT32_MAX, 0, INT32_MIN);
    const LocalFrame frame = LocalFrame::around(one);
    QVERIFY(frame.holds(one));
    QCOMPARE(frame.shift, 0);
    QVERIFY(!frame.holds(all));
}

void PointStoreTest::wrongFirstBoundsAreMended()
{
    const auto cloud = test::makeCloud(5000);
    const auto x = cloud->columns()[0]->values<std::int32_t>();
    x[17] = INT32_MAX;
    x[18] = INT32_MIN;
    RawBounds wrong;
    wrong.include(0, 0, 0);
    PointStore store(cloud, wrong);
    store.fillAll();
    QVERIFY(store.outgrown());
    store.setBounds(cloud->computeBounds());
    QVERIFY(!store.outgrown());
    for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(store.isFilled(i));
    QCOMPARE(store.frame().shift, 2);
}

void PointStoreTest::damagedPointsAreWithdrawn()
{
    const auto cloud = test::makeCloud(5000);
    PointStore store(cloud, cloud->computeBounds());
    store.fill({0, 100});
    store.fill({2000, 5000});
    store.withdraw({50, 150});  // of which some had come
    QCOMPARE(store.filled(), PointIndex(3050));
    for (PointIndex i = 0; i < cloud->size(); ++i) QCOMPARE(store.isFilled(i), i < 50 || i >= 2000);
}

void PointStoreTest::framesEndWhereTheySay()
{
    RawBounds one;
    one.include(0, 0, 0);
    const std::int64_t origin = LocalFrame::around(one).origin.x;
    const std::int64_t first = origin + 1, last = origin + INT32_MAX - 1;
    // among the points that are taken four by four, and among the last ones
    for (const std::size_t at : {std::size_t(1), std::size_t(102)})
        for (const std::size_t axis : {0u, 1u, 2u})
            for (const std::int64_t v : {first - 1, first, last, last + 1}) {
                const auto cloud = test::makeCloud(103);
                for (std::size_t a = 0; a < 3; ++a)
                    for (auto& raw : cloud->columns()[a]->values<std::int32_t>()) raw = 0;
                cloud->columns()[axis]->values<std::int32_t>()[at] = std::int32_t(v);
                PointStore store(cloud, one);
                store.fillAll();
                const bool inside = v >= first && v <= last;
                QCOMPARE(store.outgrown(), !inside);
                const LocalPosition p = store.positions()[store.order().slotOf(at)];
                const std::int32_t local[] = {p.x, p.y, p.z};
                QCOMPARE(local[axis], inside ? std::int32_t(v - origin) : 0);
            }
}

void PointStoreTest::firstAttributeIsWhatVaries()
{
    const auto cloud = test::makeCloud(1000);
    const PointRange all{0, 1000};
    QCOMPARE(firstAttribute(*cloud, all), std::string("RGB"));
    for (const char* name : {"Red", "Green", "Blue"})
        for (auto& v : cloud->findAttribute(name)->columns[0]->values<std::uint16_t>()) v = 0;
    QCOMPARE(firstAttribute(*cloud, all), std::string("Intensity"));
    for (auto& v : cloud->findAttribute("Intensity")->columns[0]->values<std::uint16_t>()) v = 5;
    QCOMPARE(firstAttribute(*cloud, all), std::string("Classification"));
    for (auto& v : cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>()) v = 1;
    QCOMPARE(firstAttribute(*cloud, all), std::string("Z"));
}

void PointStoreTest::eightBitColorsAreShownAsSuch()
{
    const auto dark = test::makeCloud(40'000, {}, 255);
    PointStore eight(dark, dark->computeBounds());
    eight.fillAll();
    QCOMPARE(eight.encoder()->colorShift(), 0);
    QVERIFY(!eight.colorsMisjudged());

    // 16-bit colors late in the file: found out, and mended by showing the attribute again.
    const auto green = dark->findAttribute("Green")->columns[0]->values<std::uint16_t>();
    for (std::size_t i = 30'000; i < 40'000; ++i) green[i] = std::uint16_t(40'000 - i % 7);
    green[39'999] = 40'000;
    PointStore mixed(dark, dark->computeBounds());
    mixed.fill({0, 10'000});
    QCOMPARE(mixed.encoder()->colorShift(), 0);
    mixed.fill({10'000, 40'000});
    QVERIFY(mixed.colorsMisjudged());
    mixed.show(*dark->findAttribute("RGB"));
    QCOMPARE(mixed.encoder()->colorShift(), 8);
    while (mixed.stale()) mixed.refreshNext(1000);
    QVERIFY(!mixed.colorsMisjudged());
    QCOMPARE((mixed.words()[mixed.order().slotOf(39'999)] >> 8) & 255u, 40'000u >> 8);
}

void PointStoreTest::bitDepthOfColors_data()
{
    QTest::addColumn<int>("most");
    QTest::addColumn<int>("white");  // points that are as bright as 16 bits can be
    QTest::addColumn<int>("black");  // the first points have no color
    QTest::addColumn<int>("shift");
    QTest::newRow("8 bits") << 255 << 0 << 0 << 0;
    QTest::newRow("8 bits, one white") << 255 << 1 << 0 << 0;
    QTest::newRow("8 bits, some white") << 255 << 100 << 0 << 0;
    QTest::newRow("10 bits") << 1023 << 0 << 0 << 2;
    QTest::newRow("12 bits, one white") << 4095 << 1 << 0 << 4;
    QTest::newRow("16 bits") << 65535 << 0 << 0 << 8;
    QTest::newRow("16 bits, most are black") << 65535 << 0 << 19'700 << 8;
}

// What a few points say, and points without a color, do not decide how bright the others are.
void PointStoreTest::bitDepthOfColors()
{
    QFETCH(int, most);
    QFETCH(int, white);
    QFETCH(int, black);
    const auto cloud = test::makeCloud(20'000, {}, std::uint16_t(most));
    for (const char* name : {"Red", "Green", "Blue"}) {
        const auto values = cloud->findAttribute(name)->columns[0]->values<std::uint16_t>();
        for (int k = 0; k < white; ++k) values[std::size_t(k) * 197] = 65535;
        for (int k = 0; k < black; ++k) values[std::size_t(k)] = 0;
    }
    PointStore store(cloud, cloud->computeBounds());
    for (PointIndex first = 0; first < 20'000; first += 5'000) store.fill({first, first + 5'000});
    // As the renderer does it, and no more often than it takes.
    int again = 0;
    for (; again < 10; ++again) {
        if (store.encoder()->kind() == WordKind::Color && !store.colorsMisjudged()) break;
        store.show(*cloud->findAttribute("RGB"));
        while (store.stale()) store.refreshNext(1'000'000);
    }
    QVERIFY(again < 5);
    QTEST(store.encoder()->colorShift(), "shift");
    if (white > 0) QCOMPARE(store.words()[store.order().slotOf(0)], 0xFFFFFFFFu);
}

void PointStoreTest::filesWithoutColorsAreNotBlack()
{
    Attribute color;
    color.kind = AttributeKind::Color;
    color.components = 3;
    for (auto& column : color.columns) {
        column = std::make_shared<Column>("c", ScalarType::U16, 6);
        column->setAbsent({{0, 3}});
    }
    color.columns[1]->values<std::uint16_t>()[1] = 7;  // an edit gave it one
    const AttributeEncoder encoder(color, 0.0, 0);
    std::uint32_t words[6];
    encoder.encode(PointRange{0, 6}, words);
    for (const int k : {0, 2}) QCOMPARE(words[k], 0xFF808080u);
    QCOMPARE(words[1], 0xFF000700u);
    for (const int k : {3, 4, 5}) QCOMPARE(words[k], 0xFF000000u);
}

void PointStoreTest::gpsTimeKeepsItsDigits()
{
    const auto cloud = test::makeCloud(100'000);
    PointStore store(cloud, cloud->computeBounds());
    store.fillAll();
    store.show(*cloud->findAttribute("GpsTime"));
    while (store.stale()) store.refreshNext(1);
    const auto* time = cloud->findAttribute("GpsTime");
    for (PointIndex i = 0; i < cloud->size(); i += 97) {
        const double shown =
            double(std::bit_cast<float>(store.words()[store.order().slotOf(i)])) + store.encoder()->bias();
        QVERIFY(std::abs(shown - time->number(i)) < 1e-6);
    }
}

void PointStoreTest::editsReachVisibleSlotsFirst()
{
    const auto cloud = test::makeCloud(500'000);
    PointStore store(cloud, cloud->computeBounds());
    store.fillAll();
    const Attribute classes = *cloud->findAttribute("Classification");
    store.show(classes);
    QVERIFY(store.stale());
    const std::vector<Slot> visible{5, 77'777, 400'000};
    QCOMPARE(store.refresh(visible), std::size_t(3));
    QCOMPARE(store.refresh(visible), std::size_t(0));
    for (const Slot s : visible) {
        const PointIndex i = store.order().indexOf(s);
        QCOMPARE(store.words()[s], std::uint32_t(classes.number(i)));
    }
    while (store.stale()) store.refreshNext(100'000);
    // A few changed points are there at once.
    PointSet changed(cloud->size());
    for (const PointIndex i : {PointIndex(3), PointIndex(123'456), PointIndex(499'999)}) {
        classes.columns[0]->values<std::uint8_t>()[i] = 9;
        changed.insert(i);
    }
    store.markStale(&changed);
    QVERIFY(!store.stale());
    for (const PointIndex i : {PointIndex(3), PointIndex(123'456), PointIndex(499'999)}) {
        QCOMPARE(store.words()[store.order().slotOf(i)], 9u);
        QCOMPARE(unsigned(store.classes()[store.order().slotOf(i)]), 9u);
    }
}

void PointStoreTest::previewIsShownInsteadAndTakenBack()
{
    const auto cloud = test::makeCloud(300'000);
    PointStore store(cloud, cloud->computeBounds());
    store.fillAll();
    const Attribute classes = *cloud->findAttribute("Classification"),
                    intensity = *cloud->findAttribute("Intensity");
    const auto wordOf = [&](PointIndex i) {
        while (store.stale()) store.refreshNext(100'000);
        return store.words()[store.order().slotOf(i)];
    };
    Progress progress;
    const auto preview = [&](const char* rule) {
        return std::shared_ptr<const Preview>(expression::Rule(rule).preview(*cloud, nullptr, progress));
    };
    PointSet changed(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (intensity.number(i) > 1000 && classes.number(i) != 40) changed.insert(i);
    QVERIFY(changed.count() > 0 && changed.count() < cloud->size());

    // new classes, whatever is shown
    store.show(intensity);
    std::vector<std::uint32_t> before(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i) before[i] = wordOf(i);
    store.setPreview(preview("Classification = 40 if Intensity > 1000"));
    QVERIFY(store.encoder()->kind() == WordKind::Class);
    QCOMPARE(store.shown().name, intensity.name);
    for (PointIndex i = 0; i < cloud->size(); ++i)
        QCOMPARE(wordOf(i), changed.contains(i) ? 40u : std::uint32_t(classes.number(i)));
    for (PointIndex i = 0; i < cloud->size(); ++i)
        QCOMPARE(unsigned(store.classes()[store.order().slotOf(i)]), unsigned(classes.number(i)));
    store.setPreview(nullptr);
    for (PointIndex i = 0; i < cloud->size(); ++i) QCOMPARE(wordOf(i), before[i]);

    // another attribute: marks, until it is the one that is shown; the selection waits beneath
    store.show(classes);
    const auto brighter = preview("Intensity = 7 if Classification == 2");
    store.setPreview(brighter);
    for (PointIndex i = 0; i < cloud->size(); ++i)
        QCOMPARE(wordOf(i) >> 31, brighter->points->contains(i) ? 1u : 0u);
    PointSet some(cloud->size());
    some.insert(5);
    store.setSelection(std::make_shared<PointSet>(some));
    store.show(intensity);
    for (PointIndex i = 0; i < cloud->size(); i += 7) {
        const double value = double(std::bit_cast<float>(wordOf(i))) + store.encoder()->bias();
        QCOMPARE(value, classes.number(i) == 2 ? 7.0 : intensity.number(i));
    }
    store.setPreview(nullptr);
    for (PointIndex i = 0; i < cloud->size(); ++i) QCOMPARE(wordOf(i) & 1u, some.contains(i) ? 1u : 0u);
}

QTEST_APPLESS_MAIN(PointStoreTest)
#include "PointStoreTest.moc"
