// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <bit>
#include <limits>

using namespace punctum;
using expression::Rule;

namespace
{

constexpr PointIndex kPoints = 70'001;  // more than a task, and not whole words

std::shared_ptr<PointCloud> makeCloud(bool narrow)
{
    auto cloud = makeFrame(kPoints, {glm::dvec3(0.01), glm::dvec3(100.0)}, narrow);
    std::mt19937_64 random(8);
    for (const auto values = addScalar<std::uint16_t>(*cloud, "Intensity"); auto& value : values)
        value = std::uint16_t(random() % 4000);
    for (const auto values = addScalar<double>(*cloud, "Height"); auto& value : values)
        value = random() % 9 == 0 ? std::numeric_limits<double>::quiet_NaN() : double(random() % 1000);
    for (const char* name : {"Red", "Green", "Blue"})
        for (const auto values = addScalar<std::uint16_t>(*cloud, name); auto& value : values)
            value = std::uint16_t(random());
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    for (const auto& column : cloud->columns())
        if (column->name() == "ClassFlags" || column->name() == "Classification")
            for (auto& byte : column->values<std::uint8_t>()) byte = std::uint8_t(random());
    return cloud;
}

/// Of all components of all points, to the last bit.
std::vector<std::uint64_t> valuesOf(const Attribute& attribute)
{
    std::vector<std::uint64_t> values;
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        for (PointIndex i = 0; i < attribute.size(); ++i)
            values.push_back(std::bit_cast<std::uint64_t>(attribute.number(i, c)));
    return values;
}

}  // namespace

class PreviewTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void isWhatApplyingGives_data()
    {
        QTest::addColumn<QString>("rule");
        QTest::addColumn<bool>("narrow");
        QTest::addColumn<int>("attributes");
        QTest::addRow("classes") << "Classification = 7 if Intensity > 1000 else 2" << false << 1;
        QTest::addRow("classes of five bits") << "Classification = 7 if Intensity > 1000" << true << 1;
        QTest::addRow("too narrow for the new class") << "Classification = 200 if Intensity > 1000" << true << 1;
        QTest::addRow("one bit") << "Withheld = 1 if Classification == 4" << true << 1;
        QTest::addRow("expression") << "Intensity = Intensity / 3 if Height < 500" << false << 1;
        QTest::addRow("none") << "Height = 1 / 0 if Intensity > 3000" << false << 1;
        QTest::addRow("shown with others") << "Green = Red if Classification < 100" << false << 2;
    }
    void isWhatApplyingGives()
    {
        QFETCH(QString, rule);
        QFETCH(bool, narrow);
        QFETCH(int, attributes);
        const auto cloud = makeCloud(narrow);
        PointSet within(kPoints), gone(kPoints);
        for (PointIndex i = 0; i < kPoints; i += 3) within.insert(i);
        for (PointIndex i = 0; i < kPoints; i += 5) gone.insert(i);
        cloud->setDeleted(std::make_shared<PointSet>(gone));
        const auto before = snapshot(*cloud);
        const auto names = attributeNames(*cloud);
        Progress progress;
        for (const bool limited : {false, true}) {
            const PointSet* const scope = limited ? &within : nullptr;
            const auto preview = Rule(rule.toStdString()).preview(*cloud, scope, progress);
            QVERIFY(preview);
            QVERIFY(snapshot(*cloud) == before && attributeNames(*cloud) == names);
            QCOMPARE(int(preview->attributes.size()), attributes);
            const auto command = Rule(rule.toStdString()).run(*cloud, scope, progress);
            QVERIFY(*preview->points == *command->points());
            command->apply(*cloud);
            for (const Attribute& after : preview->attributes)
                QVERIFY(valuesOf(after) == valuesOf(*cloud->findAttribute(after.name)));
            command->apply(*cloud);
            QVERIFY(snapshot(*cloud) == before);
        }
    }

    void endsWithoutAny()
    {
        const auto cloud = makeCloud(false);
        Progress progress;
        QVERIFY(!Rule("Intensity = Intensity").preview(*cloud, nullptr, progress));
        QVERIFY_THROWS_EXCEPTION(Error, Rule("Intensity = 70000").preview(*cloud, nullptr, progress));
        progress.cancel();
        QVERIFY_THROWS_EXCEPTION(Cancelled, Rule("Intensity = 7").preview(*cloud, nullptr, progress));
    }
};

QTEST_APPLESS_MAIN(PreviewTest)
#include "PreviewTest.moc"
