// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/edit/ClassCommand.h"
#include "core/edit/CommandGroup.h"
#include "core/edit/CommandPreview.h"
#include "core/edit/DeleteCommand.h"
#include "core/edit/ListCommand.h"
#include "core/expression/Rule.h"
#include "core/task/Progress.h"
#include "tests/core/MadeEdits.h"

#include <QTest>

#include <bit>
#include <cstring>
#include <limits>
#include <map>

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

std::map<std::string, std::vector<std::uint64_t>> valuesByName(const PointCloud& cloud)
{
    std::map<std::string, std::vector<std::uint64_t>> values;
    for (const Attribute& attribute : cloud.attributes()) values[attribute.name] = valuesOf(attribute);
    return values;
}

/// With a column of its own.
Attribute copyOf(const Attribute& attribute)
{
    Attribute copy = attribute;
    copy.columns[0] = std::make_shared<Column>(attribute.name, attribute.type(), attribute.size());
    std::memcpy(copy.columns[0]->data(), attribute.columns[0]->data(),
                attribute.size() * attribute.columns[0]->elementBytes());
    return copy;
}

std::unique_ptr<Command> classCommand(const PointCloud& cloud, unsigned code)
{
    return makeClassCommand("classes", *cloud.findAttribute("Classification"), everyNth(cloud.size(), 3), code);
}

std::unique_ptr<Command> commandOf(int kind, const PointCloud& cloud)
{
    Progress progress;
    std::vector<std::unique_ptr<Command>> parts;
    switch (kind) {
        case 0:
            return setValue<std::uint16_t>(cloud, "Intensity", 4, 1234);
        case 1:
            return classCommand(cloud, 7);
        case 2:
            return classCommand(cloud, 200);
        case 3:
            return Rule(cloud.findAttribute("Withheld") ? "Withheld = 1 if Intensity > 1000"
                                                        : "Height = 3 if Intensity > 1000")
                .run(cloud, nullptr, progress);
        case 4:
            return std::make_unique<AttributesCommand>("normals", normals(cloud.size(), 0.5f));
        case 5: {
            Attribute height = copyOf(*cloud.findAttribute("Height"));
            for (PointIndex i = 0; i < cloud.size(); i += 9) height.columns[0]->values<double>()[i] = 5;
            return std::make_unique<AttributesCommand>("height", std::vector{height});
        }
        case 6:
            return std::make_unique<AttributesCommand>("height", std::vector{filled("Height", cloud.size(), 4)});
        case 7:
            parts.push_back(classCommand(cloud, 200));
            parts.push_back(
                std::make_unique<AttributesCommand>("more", std::vector{filled("More", cloud.size(), 4)}));
            return std::make_unique<CommandGroup>("both", std::move(parts), cloud.size() / 3);
        default:
            return setValue<std::uint16_t>(cloud, "Green", 4, 1234);
    }
}

/// Holds the preview to the values after the command, and its counts to both.
void compare(const std::map<std::string, std::vector<std::uint64_t>>& promised,
             const std::map<std::string, std::vector<std::uint64_t>>& now,
             const std::map<std::string, std::vector<std::uint64_t>>& old, const CommandPreview& found,
             const PointSet& gone)
{
    PointSet changed(kPoints);
    for (const auto& [name, values] : promised) QVERIFY2(values == now.at(name), name.c_str());
    for (const auto& [name, values] : now) {
        const bool isNew = !old.contains(name);
        if (!isNew && old.at(name) == values) continue;
        QVERIFY2(promised.contains(name), name.c_str());
        const std::size_t components = values.size() / kPoints;
        for (std::size_t k = 0; k < components * kPoints; ++k)
            if ((isNew || old.at(name)[k] != values[k]) && !gone.contains(k % kPoints)) changed.insert(k % kPoints);
    }
    QVERIFY(*found.preview->points == changed);
    QCOMPARE(found.changed, changed.count());
    std::map<std::pair<int, int>, PointIndex> counts, expected;
    for (const auto& c : found.classes) counts[{c.from, int(*c.to)}] = c.points;
    for (PointIndex i = 0; i < kPoints; ++i) {
        const auto a = int(std::bit_cast<double>(old.at("Classification")[i]));
        const auto b = int(std::bit_cast<double>(now.at("Classification")[i]));
        if (a != b && !gone.contains(i)) ++expected[{a, b}];
    }
    QVERIFY(counts == expected);
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

    void commandsShowWhatComes_data()
    {
        QTest::addColumn<int>("kind");
        QTest::addColumn<bool>("narrow");
        for (const bool narrow : {false, true}) {
            const char* const form = narrow ? "narrow" : "wide";
            QTest::addRow("values, %s", form) << 0 << narrow;
            QTest::addRow("classes, %s", form) << 1 << narrow;
            QTest::addRow("high classes, %s", form) << 2 << narrow;
            QTest::addRow("one bit, %s", form) << 3 << narrow;
            QTest::addRow("a new attribute, %s", form) << 4 << narrow;
            QTest::addRow("an attribute again, %s", form) << 5 << narrow;
            QTest::addRow("an attribute of another type, %s", form) << 6 << narrow;
            QTest::addRow("a group, %s", form) << 7 << narrow;
            QTest::addRow("shown with others, %s", form) << 8 << narrow;
        }
    }
    /// Of each kind of command: what the preview shows is what applying gives; then what it shows of the way back
    /// is what was before.
    void commandsShowWhatComes()
    {
        QFETCH(int, kind);
        QFETCH(bool, narrow);
        const auto cloud = makeCloud(narrow);
        auto gone = std::make_shared<PointSet>(kPoints);
        for (PointIndex i = 0; i < kPoints; i += 5) gone->insert(i);
        cloud->setDeleted(gone);
        const auto command = commandOf(kind, *cloud);
        const auto before = snapshot(*cloud);
        const auto old = valuesByName(*cloud);
        Progress progress;
        const CommandPreview found = previewOf(*command, *cloud, progress);
        QVERIFY(found.preview);
        QVERIFY(snapshot(*cloud) == before);
        std::map<std::string, std::vector<std::uint64_t>>
            promised;  // what it shares with the command trades places
        for (const Attribute& after : found.preview->attributes) {
            QVERIFY2(!promised.contains(after.name), after.name.c_str());
            promised[after.name] = valuesOf(after);
        }
        command->prepare();
        command->apply(*cloud);
        compare(promised, valuesByName(*cloud), old, found, *gone);
        const auto now = valuesByName(*cloud);
        command->stow();
        const CommandPreview back = previewOf(*command, *cloud, progress);
        QVERIFY(valuesByName(*cloud) == now);
        if (kind == 4) return;  // nothing was there
        QVERIFY(back.preview);
        if (kind != 7) QCOMPARE(back.changed, found.changed);  // of two, one was not there
        auto turned = back.classes;
        for (auto& change : turned) change = {*change.to, change.from, change.points};
        std::map<std::pair<int, int>, PointIndex> there, again;
        for (const auto& c : found.classes) there[{c.from, int(*c.to)}] = c.points;
        for (const auto& c : turned) again[{c.from, int(*c.to)}] = c.points;
        QVERIFY(there == again);
        for (const Attribute& after : back.preview->attributes)
            if (old.contains(after.name)) QVERIFY(valuesOf(after) == old.at(after.name));
        command->prepare();
        command->apply(*cloud);
        QVERIFY(valuesByName(*cloud) == old);
    }

    void deletesAndNames()
    {
        const auto cloud = makeCloud(false);
        Progress progress;
        auto points = everyNth(kPoints, 7);
        const DeleteCommand deletes("Delete", points);
        const CommandPreview found = previewOf(deletes, *cloud, progress);
        QVERIFY(found.preview && found.deletes && found.preview->attributes.empty());
        QVERIFY(*found.preview->points == *points);
        QCOMPARE(found.changed, points->count());
        PointIndex sum = 0;
        for (const auto& c : found.classes) {
            QVERIFY(!c.to);
            sum += c.points;
        }
        QCOMPARE(sum, found.changed);
        QVERIFY(
            !previewOf(*ListCommand::rename(*cloud->findAttribute("Height"), "Depth"), *cloud, progress).preview);
        // what changes nothing shows nothing
        AttributesCommand same("Height", {copyOf(*cloud->findAttribute("Height"))});
        QVERIFY(!previewOf(same, *cloud, progress).preview);
        progress.cancel();
        QVERIFY_THROWS_EXCEPTION(Cancelled,
                                 previewOf(*setValue<std::uint16_t>(*cloud, "Intensity", 3, 7), *cloud, progress));
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
