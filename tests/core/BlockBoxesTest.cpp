// SPDX-License-Identifier: MIT
#include "core/cloud/LeastMost.h"
#include "tests/core/ExactBoxes.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <algorithm>
#include <random>
#include <thread>

using namespace punctum;

namespace
{

std::shared_ptr<PointCloud> randomCloud(PointIndex points)
{
    const auto cloud = makeFrame(points);
    std::mt19937 random(7);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int32_t& v : rawAxis(*cloud, axis)) v = std::int32_t(random());
    return cloud;
}

RawBounds includeRange(BlockBoxes& boxes, const PointCloud& cloud, PointRange range)
{
    return boxes.include(range, cloud.rawX().data() + range.first, cloud.rawY().data() + range.first,
                         cloud.rawZ().data() + range.first);
}

}  // namespace

/// The boxes of stretches of points; those of real files are tested where files are read.
class BlockBoxesTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void leastAndMostOfAnyCount()
    {
        std::mt19937 random(3);
        std::vector<std::int32_t> values(300);
        for (std::int32_t& v : values) v = std::int32_t(random());
        values[40] = INT32_MIN;
        values[41] = INT32_MAX;
        for (std::size_t first = 0; first < 60; first += 7)
            for (std::size_t count = 0; first + count <= values.size(); ++count) {
                LeastMost expected;
                for (std::size_t k = first; k < first + count; ++k) {
                    expected.least = std::min(expected.least, values[k]);
                    expected.most = std::max(expected.most, values[k]);
                }
                const LeastMost found = leastAndMost(values.data() + first, count),
                                plain = leastAndMostBaseline(values.data() + first, count);
                QVERIFY(found.least == expected.least && found.most == expected.most);
                QVERIFY(plain.least == expected.least && plain.most == expected.most);
            }
    }

    void madeCloudsHaveThem()
    {
        QVERIFY(boxesAreExact(*makeFrame(0)));
        for (const PointIndex points : {1, 16'383, 16'384, 16'385, 100'000})
            QVERIFY(boxesAreExact(*randomCloud(points)));
        const auto cloud = randomCloud(1000);
        QVERIFY(cloud->boxes() == cloud->boxes());  // found once
    }

    /// Batches that end anywhere, of four threads, none of them in order.
    void batchesShareStretches()
    {
        const auto cloud = randomCloud(1'000'003);
        const auto boxes = std::make_shared<BlockBoxes>(cloud->size());
        cloud->setArriving(boxes);
        std::vector<PointRange> batches;
        std::mt19937 random(11);
        for (PointIndex first = 0; first < cloud->size(); first = batches.back().last)
            batches.push_back({first, std::min<PointIndex>(cloud->size(), first + 1 + random() % 40'000)});
        std::shuffle(batches.begin(), batches.end(), random);
        std::vector<std::thread> threads;
        std::array<RawBounds, 4> seen;
        for (std::size_t t = 0; t < 4; ++t)
            threads.emplace_back([&, t] {
                for (std::size_t k = t; k + 1 < batches.size(); k += 4)
                    seen[t].include(includeRange(*boxes, *cloud, batches[k]));
            });
        for (std::thread& thread : threads) thread.join();
        QVERIFY(!boxes->complete());
        QVERIFY(boxesAreExact(*cloud) &&
                cloud->boxes().get() != boxes.get());  // made for those who asked too early
        RawBounds all = includeRange(*boxes, *cloud, batches.back());
        for (const RawBounds& part : seen) all.include(part);
        QVERIFY(boxes->complete());
        QVERIFY(cloud->boxes().get() == boxes.get() && boxesAreExact(*cloud));
        QVERIFY(all == boxes->bounds());
    }

    /// Points of one cloud that arrive through another one, a part whose columns lie within.
    void partsFillTheWhole()
    {
        const auto whole = randomCloud(50'000);
        const auto boxes = std::make_shared<BlockBoxes>(whole->size());
        whole->setArriving(boxes);
        RawBounds all;
        for (const PointRange part : {PointRange{20'000, 50'000}, PointRange{0, 20'000}})
            all.include(includeRange(*boxes, *whole, part));
        QVERIFY(boxesAreExact(*whole) && whole->boxes().get() == boxes.get());
        QVERIFY(all == whole->computeBounds());
    }
};

QTEST_APPLESS_MAIN(BlockBoxesTest)
#include "BlockBoxesTest.moc"
