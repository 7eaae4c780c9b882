// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "render/order/SlotOrder.h"
#include "render/scene/PointIds.h"

#include <QTest>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

using namespace punctum;
using namespace punctum::render;

class SlotOrderTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void bijection_data();
    void bijection();
    void windowsAreSpread();
    void idsAreNeverDealtTwice();
    void idsStandForSlots();
};

void SlotOrderTest::bijection_data()
{
    QTest::addColumn<int>("kind");
    QTest::addColumn<quint64>("points");
    for (const quint64 n : {0, 1, 2, 3, 7, 8, 63, 64, 65, 1000, 4096, 65537, 300'001})
        for (const OrderKind kind : {OrderKind::Prime, OrderKind::Stratified})
            QTest::addRow("%s %llu", kind == OrderKind::Prime ? "prime" : "stratified", n) << int(kind) << n;
}

void SlotOrderTest::bijection()
{
    QFETCH(int, kind);
    QFETCH(quint64, points);
    const SlotOrder order(OrderKind(kind), points);
    QVERIFY(order.slotCount() >= points);
    QVERIFY(order.slotCount() <= points + std::max<quint64>(1024, points / 50));
    QCOMPARE(order.slotCount() % order.windowSize() == 0 || order.kind() == OrderKind::Prime, true);
    std::vector<bool> taken(order.slotCount(), false);
    std::vector<Slot> slotList(points);
    order.slotsOf({0, points}, slotList.data());
    for (quint64 i = 0; i < points; ++i) {
        const Slot slot = order.slotOf(i);
        QVERIFY(slot < order.slotCount());
        QCOMPARE(slotList[i], slot);
        QVERIFY(!taken[slot]);
        taken[slot] = true;
        QCOMPARE(order.indexOf(slot), i);
    }
    for (Slot s = 0; s < order.slotCount(); ++s)
        if (!taken[s]) QVERIFY(order.indexOf(s) >= points);
}

// A window holds its share of each hundredth of the file: within five standard deviations of a random subset.
void SlotOrderTest::windowsAreSpread()
{
    constexpr PointIndex kPoints = 1'000'000;
    for (const OrderKind kind : {OrderKind::Prime, OrderKind::Stratified}) {
        const SlotOrder order(kind, kPoints);
        const Slot run = std::max<Slot>(order.windowSize(), 20'000) / order.windowSize() * order.windowSize();
        for (Slot first = 0; first + run <= order.slotCount(); first += 7 * run) {
            std::vector<int> hundredths(100, 0);
            for (Slot s = first; s < first + run; ++s) {
                const PointIndex i = order.indexOf(s);
                if (i < kPoints) ++hundredths[std::size_t(i * 100 / kPoints)];
            }
            const double expected = double(run) / 100.0;
            for (const int n : hundredths) QVERIFY(std::abs(n - expected) < 6 * std::sqrt(expected) + 1);
        }
    }
}

// Two clouds of half of all ids each have more than there are together: the second is refused and would not begin
// anew at 0.
void SlotOrderTest::idsAreNeverDealtTwice()
{
    PointIds ids;
    QCOMPARE(ids.take(0x80000000u), PointId(0));
    QVERIFY_EXCEPTION_THROWN(ids.take(0x80000000u), Error);
    QVERIFY_EXCEPTION_THROWN(ids.take(0x7FFF0001u), Error);
    QCOMPARE(ids.layers(), std::size_t(1));                 // a refusal takes nothing
    QCOMPARE(ids.take(0x7FFEFFFFu), PointId(0x80000000u));  // and one number of its last block is nobody's
    QCOMPARE(ids.take(0), PointId(0xFFFF0000u));
    QVERIFY_EXCEPTION_THROWN(ids.take(1), Error);
    QVERIFY(!ids.find(0xFFFEFFFFu) && !ids.find(0xFFFF0000u) && !ids.find(kNoPoint));
    for (const PointId id : {0u, 1u, 0x7FFFFFFFu}) {
        QVERIFY(ids.find(id).has_value());
        QVERIFY(ids.find(id)->layer == 0 && ids.find(id)->slot == id);
    }
    QVERIFY(ids.find(0x80000000u)->layer == 1 && ids.find(0x80000000u)->slot == 0);
    QVERIFY(ids.find(0xFFFEFFFEu)->layer == 1 && ids.find(0xFFFEFFFEu)->slot == 0x7FFEFFFEu);

    PointIds others;
    QCOMPARE(others.take(0xFFFF0000u), PointId(0));  // all there are
    QVERIFY(others.find(0xFFFEFFFFu) && !others.find(0xFFFF0000u));
    QVERIFY_EXCEPTION_THROWN(others.take(1), Error);
    try {
        others.take(kNoPoint);
        QVERIFY(false);
    } catch (const Error& e) {
        QCOMPARE(QString::fromStdString(e.what()),
                 QStringLiteral("A view holds up to 4,294,901,760 points, and these clouds together have more; "
                                "leave one out."));
    }
    others.clear();
    QVERIFY(others.layers() == 0 && !others.find(0));

    // The largest cloud there may be fits, with its padding.
    const SlotOrder largest(OrderKind::Stratified, 0xFFFF0000u);
    QVERIFY(largest.slotCount() >= 0xFFFF0000u);
    QCOMPARE(others.take(largest.slotCount()), PointId(0));
    QVERIFY_EXCEPTION_THROWN(SlotOrder(OrderKind::Stratified, 0xFFFF0001u), Error);
}

// Each number is found to be its layer's slot, or nobody's: brute force over many small layers.
void SlotOrderTest::idsStandForSlots()
{
    std::mt19937 random(3);
    PointIds ids;
    std::vector<std::pair<PointId, Slot>> layers;
    for (int k = 0; k < 40; ++k) {
        const Slot count = k % 7 == 3 ? 0 : Slot(random() % 200'000);
        layers.emplace_back(ids.take(count), count);
    }
    QCOMPARE(ids.layers(), layers.size());
    std::uint64_t found = 0, all = 0;
    for (const auto& [first, count] : layers) all += count;
    for (PointId id = 0; id < 6'000'000; ++id) {
        const auto place = ids.find(id);
        if (!place) continue;
        ++found;
        if (layers[place->layer].first + place->slot != id || place->slot >= layers[place->layer].second)
            QFAIL(qPrintable(QString::number(id)));
    }
    QCOMPARE(found, all);
}

QTEST_APPLESS_MAIN(SlotOrderTest)
#include "SlotOrderTest.moc"
