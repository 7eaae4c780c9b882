// SPDX-License-Identifier: MIT
#include "render/order/SlotOrder.h"
#include "render/scene/PointIds.h"

#include <QTest>

#include <cmath>
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

// Two clouds of half of all ids each have one slot too many together: the second is refused and would not begin
// anew at 0.
void SlotOrderTest::idsAreNeverDealtTwice()
{
    PointIds ids;
    QCOMPARE(ids.take(0x80000000u), PointId(0));
    QVERIFY_EXCEPTION_THROWN(ids.take(0x80000000u), Error);
    QCOMPARE(ids.take(0x7FFFFFFEu), PointId(0x80000000u));  // a refusal takes nothing
    QCOMPARE(ids.take(1), kNoPoint - 1);
    QCOMPARE(ids.take(0), kNoPoint);
    QVERIFY_EXCEPTION_THROWN(ids.take(1), Error);

    PointIds others;
    QCOMPARE(others.take(kNoPoint), PointId(0));  // all there are, without the one that stands for none
    QVERIFY_EXCEPTION_THROWN(others.take(1), Error);
    try {
        others.take(kNoPoint);
    } catch (const Error& e) {
        QCOMPARE(QString::fromStdString(e.what()),
                 QStringLiteral("A view holds up to 4,294,967,295 points, and these clouds together have more; "
                                "leave one out."));
    }
}

QTEST_APPLESS_MAIN(SlotOrderTest)
#include "SlotOrderTest.moc"
