// SPDX-License-Identifier: MIT
// Steps that number objects: no two of them get the same number, also where some points alone are numbered anew.
#include "core/process/ObjectNumbers.h"

#include "core/Error.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;

constexpr PointIndex kSquare = 21;  ///< points a side

/// Three slanting squares of 6 by 6 over level ground, in meters: each is a cluster, a plane and a tree. The points
/// of square k are 441 k and those after it; then comes the ground.
Cloud makeSquares()
{
    constexpr PointIndex kGround = 80 * 40;
    const auto cloud = makeFrame(3 * kSquare * kSquare + kGround, {glm::dvec3(0.01), glm::dvec3(0)});
    setMeters(*cloud);
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    const auto put = [&](PointIndex i, double x, double y, double z, std::uint8_t code) {
        rawAxis(*cloud, 0)[i] = std::int32_t(std::lround(100 * x));
        rawAxis(*cloud, 1)[i] = std::int32_t(std::lround(100 * y));
        rawAxis(*cloud, 2)[i] = std::int32_t(std::lround(100 * z));
        classes[i] = code;
    };
    for (PointIndex i = 0; i < 3 * kSquare * kSquare; ++i) {
        const double x = 0.3 * double(i % kSquare), y = 0.3 * double(i / kSquare % kSquare);
        put(i, x + 7 + 20 * double(i / (kSquare * kSquare)), y + 7, 10 + 0.3 * x + 0.1 * y, 1);
    }
    for (PointIndex i = 0; i < kGround; ++i)
        put(3 * kSquare * kSquare + i, 0.8 * double(i % 80), 0.5 * double(i / 80), 0, 2);
    return cloud;
}

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text, const PointSet* within = nullptr)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress, within);
}

/// The number of each square; -1 where its points have several.
std::array<int, 3> numbersOfSquares(const PointCloud& cloud, const std::string& name)
{
    const Attribute& ids = *cloud.findAttribute(name);
    std::array<int, 3> numbers{};
    for (PointIndex k = 0; k < 3; ++k) {
        numbers[k] = int(ids.number(k * kSquare * kSquare));
        for (PointIndex i = k * kSquare * kSquare; i < (k + 1) * kSquare * kSquare; ++i)
            if (int(ids.number(i)) != numbers[k]) numbers[k] = -1;
    }
    return numbers;
}

PointSet pointsOfSquare(const PointCloud& cloud, PointIndex square)
{
    PointSet points(cloud.size());
    points.insert(PointRange{square * kSquare * kSquare, (square + 1) * kSquare * kSquare});
    return points;
}

}  // namespace

class ObjectNumbersTest : public QObject
{
    Q_OBJECT

private slots:
    void numbersGoOn_data()
    {
        QTest::addColumn<QByteArray>("step");
        QTest::addColumn<QByteArray>("name");
        QTest::newRow("clusters") << QByteArray("clusters tolerance=1 points=10") << QByteArray("ClusterId");
        QTest::newRow("planes") << QByteArray("planes tolerance=0.1 points=50 cell=1") << QByteArray("PlaneId");
        QTest::newRow("trees") << QByteArray("trees window=10") << QByteArray("TreeId");
    }
    void numbersGoOn()
    {
        QFETCH(QByteArray, step);
        QFETCH(QByteArray, name);
        const std::string attribute = name.toStdString();
        const Cloud cloud = makeSquares();
        run(*cloud, step.toStdString())->apply(*cloud);
        const auto before = numbersOfSquares(*cloud, attribute);
        QVERIFY(std::all_of(before.begin(), before.end(), [](int n) { return n > 0; }));
        QCOMPARE(std::set<int>(before.begin(), before.end()).size(), std::size_t(3));
        // what others have is no one's again: also of the first square, whose number was 1 of those alone
        for (PointIndex square = 0; square < 3; ++square) {
            const Attribute& ids = *cloud->findAttribute(attribute);
            int highest = 0;
            const PointSet within = pointsOfSquare(*cloud, square);
            for (PointIndex i = 0; i < cloud->size(); ++i)
                if (!within.contains(i)) highest = std::max(highest, int(ids.number(i)));
            const auto were = numbersOfSquares(*cloud, attribute);
            run(*cloud, step.toStdString(), &within)->apply(*cloud);
            auto expected = were;
            expected[square] = highest + 1;
            QVERIFY(numbersOfSquares(*cloud, attribute) == expected);
        }
        // nobody keeps a number
        const PointSet all = PointSet::all(cloud->size());
        run(*cloud, step.toStdString(), &all)->apply(*cloud);
        QVERIFY(numbersOfSquares(*cloud, attribute) == before);
    }

    /// A tree of which no point may change gets no number, and is not told.
    void treesOutsideAreNotCounted()
    {
        const Cloud cloud = makeSquares();
        const PointSet within = pointsOfSquare(*cloud, 2);
        const auto command = run(*cloud, "trees window=10", &within);
        QVERIFY2(command->finding().starts_with("1 tree, "), command->finding().c_str());
        command->apply(*cloud);
        QVERIFY((numbersOfSquares(*cloud, "TreeId") == std::array{0, 0, 1}));
    }

    /// An attribute of the file's own type may be too narrow.
    void numbersMustFit()
    {
        const Cloud cloud = makeSquares();
        const auto ids = addScalar<std::uint8_t>(*cloud, "ClusterId");
        const PointSet within = pointsOfSquare(*cloud, 0);
        ids[0] = 255;  // of a point that gets another
        ids[500] = 254;
        run(*cloud, "clusters tolerance=1", &within)->apply(*cloud);
        QCOMPARE(numbersOfSquares(*cloud, "ClusterId")[0], 255);
        cloud->findAttribute("ClusterId")->columns[0]->values<std::uint8_t>()[500] = 255;
        QCOMPARE(QString::fromStdString(complaint([&] { run(*cloud, "clusters tolerance=1", &within); })),
                 QString("ClusterId holds numbers up to 255, and 256 is needed; rename or remove it first."));
    }
    void lessThanNothingIsNoNumber()
    {
        const Cloud cloud = makeSquares();
        const auto ids = addScalar<std::int64_t>(*cloud, "ClusterId");
        const PointSet within = pointsOfSquare(*cloud, 0);
        std::fill(ids.begin(), ids.end(), -1);
        run(*cloud, "clusters tolerance=1", &within)->apply(*cloud);
        QVERIFY((numbersOfSquares(*cloud, "ClusterId") == std::array{1, -1, -1}));
        cloud->findAttribute("ClusterId")->columns[0]->values<std::int64_t>()[500] = std::int64_t(1) << 40;
        QVERIFY(complaint([&] { run(*cloud, "clusters tolerance=1", &within); }).find(" holds numbers up to ") !=
                std::string::npos);
    }
};

QTEST_APPLESS_MAIN(ObjectNumbersTest)
#include "ObjectNumbersTest.moc"
