// SPDX-License-Identifier: MIT
// The parts of ui that need no window: navigation, texts, icons.
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/SavingText.h"
#include "ui/marks/ScaleBar.h"
#include "ui/select/SelectionSteps.h"
#include "ui/style/Icons.h"
#include "ui/view/FrameShares.h"
#include "ui/view/Navigation.h"

#include <QDir>
#include <QFile>
#include <QTest>

#include <glm/geometric.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

using namespace punctum;
using namespace punctum::ui;

namespace
{

render::Camera cameraOver(const glm::dvec3& center)
{
    render::Camera camera;
    camera.fit({center - glm::dvec3(50.0), center + glm::dvec3(50.0)}, {800, 600});
    return camera;
}

}  // namespace

class UiPartsTest : public QObject
{
    Q_OBJECT
private slots:
    /// Of a survey of many files, what is the same of several is said once, and not all is said at once.
    void savedSurveysAreToldShortly()
    {
        SaveOutcome outcome;
        std::vector<SessionPart> files(6);
        for (std::size_t k = 0; k < files.size(); ++k) {
            const std::string name = "tile" + std::to_string(k) + ".laz";
            files[k].path = name;
            outcome.parts.push_back(k);
            outcome.report.notes.push_back(name + ": " + std::to_string(k + 1) + " points are left out.");
            outcome.report.notes.push_back(name + ": Stored as extra bytes: TreeId.");
        }
        const QString text = savedPartsText(outcome, files, true, {});
        QCOMPARE(text.count(QStringLiteral("Stored as extra bytes")), 1);
        QVERIFY2(text.contains(QStringLiteral("6 files: Stored as extra bytes: TreeId.")), qPrintable(text));
        QVERIFY2(text.endsWith(QStringLiteral("tile0.laz: 1 points are left out. tile1.laz: 2 points are left out. "
                                              "4 more in the details.")),
                 qPrintable(text));
    }
    void clickMovesNothing()
    {
        Navigation navigation;
        navigation.setSize({800, 600});
        render::Camera camera = cameraOver({500000, 4500000, 100});
        const render::Camera before = camera;
        navigation.begin(Navigation::Drag::Orbit, {400, 300});
        QVERIFY(!navigation.move({401, 301}, camera));
        QVERIFY(!navigation.moved());
        QCOMPARE(camera == before, true);
    }
    void orbitKeepsPivotOnScreen()
    {
        Navigation navigation;
        navigation.setSize({800, 600});
        render::Camera camera = cameraOver({500000, 4500000, 100});
        const glm::dvec3 before = camera.project(camera.pivot, {800, 600});
        const double yaw = camera.yaw;
        navigation.begin(Navigation::Drag::Orbit, {400, 300});
        QVERIFY(navigation.move({520, 340}, camera));
        const glm::dvec3 after = camera.project(camera.pivot, {800, 600});
        QVERIFY(std::abs(before.x - after.x) < 1e-6 && std::abs(before.y - after.y) < 1e-6);
        QVERIFY(std::abs(before.z - after.z) < 1e-6);
        // The scene follows the hand: the near side goes right, so the camera turns to the right.
        QVERIFY(std::remainder(camera.yaw - yaw, 2 * std::numbers::pi) < 0);
    }
    void panFollowsTheMouse()
    {
        Navigation navigation;
        navigation.setSize({800, 600});
        render::Camera camera = cameraOver({0, 0, 0});
        const glm::dvec3 mark = camera.pivot;
        const glm::dvec3 before = camera.project(mark, {800, 600});
        navigation.begin(Navigation::Drag::Pan, {400, 300});
        QVERIFY(navigation.move({460, 270}, camera));
        const glm::dvec3 after = camera.project(mark, {800, 600});
        QVERIFY(std::abs(after.x - before.x - 60) < 1e-6);
        QVERIFY(std::abs(after.y - before.y + 30) < 1e-6);
    }
    void panFollowsWhatIsUnderTheMouse()
    {
        Navigation navigation;
        navigation.setSize({800, 600});
        render::Camera camera = cameraOver({0, 0, 0});
        // A place twice as far away as the pivot, under the mouse.
        const glm::dvec3 mark = camera.eye + (camera.pivot - camera.eye) * 2.0 + camera.right() * 3.0;
        const glm::dvec3 before = camera.project(mark, {800, 600});
        navigation.begin(Navigation::Drag::Pan, glm::dvec2(before), before.z);
        QVERIFY(navigation.move(glm::dvec2(before) + glm::dvec2(60, -30), camera));
        const glm::dvec3 after = camera.project(mark, {800, 600});
        QVERIFY(std::abs(after.x - before.x - 60) < 1e-6);
        QVERIFY(std::abs(after.y - before.y + 30) < 1e-6);
    }
    /// The wheel goes on for ever: through what is as near as can be, on to what lies behind it.
    void zoomingInNeverSticks()
    {
        const glm::dvec3 center(1000, 2000, 30);
        render::Camera camera = cameraOver(center);
        const ViewReach reach =
            ViewReach::of({center - glm::dvec3(50.0), center + glm::dvec3(50.0)}, camera.stretch);
        const double first = camera.pivotDepth();
        std::vector<glm::dvec3> points;
        for (const double share : {0.5, 0.7, 1.0, 1.2})
            points.push_back(camera.eye + camera.forward() * (first * share));
        std::size_t passed = 0;
        for (int notch = 0; notch < 400 && passed < points.size(); ++notch)
            if (!Navigation::zoom(1.0, points[passed], camera, reach)) {
                const double depth = glm::dot(points[passed] - camera.eye, camera.forward());
                QVERIFY2(depth < 0, qPrintable(QString::number(depth)));
                ++passed;
            }
        QCOMPARE(passed, points.size());
        // Where there is nothing, the wheel flies on.
        const glm::dvec3 before = camera.eye;
        for (int notch = 0; notch < 500; ++notch)
            Navigation::zoom(1.0, camera.unproject({400, 300}, {800, 600}), camera, reach, false);
        QVERIFY(glm::length(camera.eye - before) > reach.size / 10);
        QVERIFY(camera.pivotDepth() > reach.size * 1e-4);
    }
    void zoomingOutEnds()
    {
        const glm::dvec3 center(1000, 2000, 30);
        render::Camera camera = cameraOver(center);
        const ViewReach reach =
            ViewReach::of({center - glm::dvec3(50.0), center + glm::dvec3(50.0)}, camera.stretch);
        for (int notch = 0; notch < 300; ++notch) Navigation::zoom(-1.0, camera.pivot, camera, reach);
        const double distance = glm::length(camera.eye - reach.middle);
        QVERIFY2(distance > 15 * reach.size && distance < 20.001 * reach.size,
                 qPrintable(QString::number(distance)));
        Navigation::zoom(1.0, camera.pivot, camera, reach);
        QVERIFY(glm::length(camera.eye - reach.middle) < distance * 0.9);
    }
    void zoomKeepsTheTargetInPlace()
    {
        render::Camera camera = cameraOver({1000, 2000, 30});
        const glm::dvec3 target = camera.pivot + glm::dvec3(20, -10, 5);
        const glm::dvec3 before = camera.project(target, {800, 600});
        const double distance = glm::length(camera.eye - target);
        Navigation::zoom(2.0, target, camera);
        const glm::dvec3 after = camera.project(target, {800, 600});
        QVERIFY(std::abs(before.x - after.x) < 1e-6 && std::abs(before.y - after.y) < 1e-6);
        QVERIFY(glm::length(camera.eye - target) < distance * 0.7);
    }
    void flightEndsWhereItShould()
    {
        const render::Camera from = cameraOver({0, 0, 0});
        render::Camera to = Navigation::centered(from, {30, 10, 5});
        QVERIFY(glm::length(to.pivot - glm::dvec3(30, 10, 5)) < 1e-12);
        const glm::dvec3 middle = to.project(to.pivot, {800, 600});
        QVERIFY(std::abs(middle.x - 400) < 1e-6 && std::abs(middle.y - 300) < 1e-6);
        QCOMPARE(Navigation::between(from, to, 1.0) == to, true);
        const render::Camera start = Navigation::between(from, to, 0.0);
        QVERIFY(glm::length(start.eye - from.eye) < 1e-9);
        // From -170 to 170 degrees the way is 20 degrees long, not 340.
        render::Camera left = from, right = from;
        left.yaw = -170 * std::numbers::pi / 180;
        right.yaw = 170 * std::numbers::pi / 180;
        const double yaw = Navigation::between(left, right, 0.5).yaw;
        QVERIFY(std::abs(std::remainder(yaw - std::numbers::pi, 2 * std::numbers::pi)) < 1e-9);
    }
    void numbers_data()
    {
        QTest::addColumn<double>("value");
        QTest::addColumn<QString>("text");
        QTest::newRow("zero") << 0.0 << "0";
        QTest::newRow("whole") << 4095.0 << "4,095";
        QTest::newRow("thousands") << 637012.25 << "637,012.3";
        QTest::newRow("small") << 0.0251 << "0.0251";
        QTest::newRow("negative") << -12.5 << "-12.5";
        QTest::newRow("tiny") << 1.25e-9 << "1.25e-09";
        QTest::newRow("none") << std::nan("") << "none";
    }
    void numbers()
    {
        QFETCH(double, value);
        QTEST(numberText(value), "text");
    }
    void readsWhatPeopleType_data()
    {
        QTest::addColumn<QLocale>("locale");
        QTest::addColumn<QString>("typed");
        QTest::addColumn<QString>("plain");  // empty: refused
        const QLocale english(QLocale::English, QLocale::UnitedStates), german(QLocale::German, QLocale::Germany),
            swiss(QLocale::German, QLocale::Switzerland), french(QLocale::French, QLocale::France);
        const auto row = [](const char* name, const QLocale& locale, const QString& typed, const char* plain) {
            QTest::newRow(name) << locale << typed << QString::fromLatin1(plain);
        };
        row("english", english, QStringLiteral("42.5"), "42.5");
        row("english, the comma is no decimal sign", english, QStringLiteral("42,5"), "");
        row("english, groups", english, QStringLiteral("1,234,567.25"), "1234567.25");
        row("english, a group of two", english, QStringLiteral("1,23,456"), "");
        row("english, four before the group", english, QStringLiteral("1234,567"), "");
        row("english, a group behind the point", english, QStringLiteral("0.123,456"), "");
        row("english, blanks", english, QStringLiteral(" 12 345 "), "12345");
        row("english, mixed separators", english, QStringLiteral("1,234 567"), "");
        row("english, no whole part", english, QStringLiteral("-.5"), "-0.5");
        row("english, exponent", english, QStringLiteral("2.5e-7"), "2.5e-7");
        row("english, beyond all numbers", english, QStringLiteral("1e999"), "");
        row("english, a unit", english, QStringLiteral("5 m"), "");
        row("english, digits of 64 bits", english, QStringLiteral("18446744073709551615"), "18446744073709551615");
        row("english, nothing", english, QStringLiteral("  "), "");
        row("english, words", english, QStringLiteral("nan"), "");
        row("german", german, QStringLiteral("42,5"), "42.5");
        row("german, the point is no decimal sign", german, QStringLiteral("42.5"), "");
        row("german, groups", german, QStringLiteral("1.234.567,25"), "1234567.25");
        row("german, typed with a minus sign", german, QStringLiteral("\u22121.234"), "-1234");
        row("swiss", swiss, QStringLiteral("1\u2019234.5"), "1234.5");
        row("swiss, with an apostrophe", swiss, QStringLiteral("1'234.5"), "1234.5");
        row("swiss, with a comma", swiss, QStringLiteral("42,5"), "");
        row("french", french, QStringLiteral("1\u202f234,5"), "1234.5");
        row("french, with a common blank", french, QStringLiteral("1 234,5"), "1234.5");
        row("french, with a point", french, QStringLiteral("42.5"), "");
        row("other digits", QLocale(QLocale::Arabic, QLocale::Egypt), QStringLiteral("\u0664\u0662\u066b\u0665"),
            "42.5");
    }
    void readsWhatPeopleType()
    {
        QFETCH(QLocale, locale);
        QFETCH(QString, typed);
        QFETCH(QString, plain);
        const NumberRead read = readNumber(typed, locale);
        QCOMPARE(read.plain, plain);
        QCOMPARE(bool(read), !plain.isEmpty());
        if (!read) QVERIFY2(read.problem.endsWith(QLatin1Char('.')), qPrintable(read.problem));
        if (!read) return;
        QCOMPARE(read.value, plain.toDouble());
        // what is written can be typed again, in each language
        for (const QLocale& other : {QLocale(QLocale::English), QLocale(QLocale::German), QLocale(QLocale::French),
                                     QLocale(QLocale::German, QLocale::Switzerland), QLocale(QLocale::Hindi)})
            QCOMPARE(readNumber(localNumber(plain, other), other).plain, plain);
    }
    void writesNumbers()
    {
        const auto german = [](const QString& plain) { return localNumber(plain, QLocale(QLocale::German)); };
        QCOMPARE(german(QStringLiteral("-1234.50")), QStringLiteral("-1.234,50"));
        QCOMPARE(german(QStringLiteral("123")), QStringLiteral("123"));
        QCOMPARE(german(QStringLiteral("1e-05")), QStringLiteral("1e-05"));
        QCOMPARE(german(QStringLiteral("none")), QStringLiteral("none"));
        QCOMPARE(localNumber(QStringLiteral("1234567.5"), QLocale(QLocale::French)),
                 QStringLiteral("1\u202f234\u202f567,5"));
    }
    /// A point of a file that lacks the attribute has no 0.
    void pointsWithoutAValueHaveNone()
    {
        Attribute red;
        red.name = "Red";
        red.columns[0] = std::make_shared<Column>("Red", ScalarType::U16, 4);
        red.columns[0]->setAbsent({{0, 2}});
        red.columns[0]->values<std::uint16_t>()[3] = 12;
        QCOMPARE(shownValueOf(red, 1), QStringLiteral("none"));
        QCOMPARE(shownValueOf(red, 2), QStringLiteral("0"));
        QCOMPARE(shownValueOf(red, 3), QStringLiteral("12"));
    }
    void pathsKeepTheirBytes_data()
    {
        QTest::addColumn<QByteArray>("bytes");
        QTest::newRow("plain") << QByteArray("/a/b.las");
        QTest::newRow("UTF-8") << QByteArray("/a/\xc3\xa4\xf0\x9f\x8c\xb2.las");
        QTest::newRow("Latin-1") << QByteArray("/a/caf\xe9.las");
        QTest::newRow("cut UTF-8") << QByteArray("/a/\xf0\x9f\x8c");
        QTest::newRow("a replacement character of its own") << QByteArray("/\xef\xbf\xbd\xff");
        QTest::newRow("a surrogate in UTF-8") << QByteArray("/\xed\xb2\x80");
    }
    void pathsKeepTheirBytes()
    {
        QFETCH(QByteArray, bytes);
        const std::filesystem::path path(bytes.toStdString());
        QCOMPARE(toPath(toQString(path)).string(), bytes.toStdString());
    }
    void selectionStepsGoBackAndOn()
    {
        SelectionSteps steps;
        const auto kept = [](PointIndex size) {
            auto k = std::make_shared<KeptSelection>();
            k->plain = std::make_shared<const PointSet>(size);
            return k;
        };
        QVERIFY(!steps.undo() && !steps.redo());
        steps.push({QStringLiteral("a"), 0, kept(64)});
        steps.push({QStringLiteral("b"), 1, kept(64)});
        QCOMPARE(steps.undo()->name, QStringLiteral("b"));
        QCOMPARE(steps.undo(1)->name, QStringLiteral("a"));
        QVERIFY(!steps.undo(2));
        steps.moveBack(kept(64));
        QCOMPARE(steps.redo()->name, QStringLiteral("b"));
        QCOMPARE(steps.undo()->edits, std::size_t(0));
        steps.moveOn(kept(64));
        QVERIFY(!steps.redo());
        steps.moveBack(kept(64));
        steps.push({QStringLiteral("c"), 1, kept(64)});  // what was undone is gone
        QVERIFY(!steps.redo());
        // bounded, and the newest stays
        for (int k = 0; k < 20; ++k) steps.push({QString::number(k), 1, kept(SelectionSteps::kMostBytes)});
        std::size_t count = 0;
        while (steps.undo(count)) ++count;
        QCOMPARE(count, std::size_t(8));
        QCOMPARE(steps.undo()->name, QStringLiteral("19"));
        steps.push({QStringLiteral("vast"), 1, kept(SelectionSteps::kMostBytes * 16)});
        QVERIFY(steps.undo() && !steps.undo(1));
    }
    void countsAndClasses()
    {
        QCOMPARE(pointsText(1), QStringLiteral("1 point"));
        QCOMPARE(pointsText(1204), QStringLiteral("1,204 points"));
        const CoordinateScale steps{glm::dvec3(0.01, 0.25, 1e-7), glm::dvec3(0.0)};
        QCOMPARE(shownCoordinate(steps, 0, 637012.2449), QStringLiteral("637,012.24"));
        QCOMPARE(shownCoordinate(steps, 1, 12.25), QStringLiteral("12.25"));
        QCOMPARE(shownCoordinate(steps, 2, 6.3600176), QStringLiteral("6.3600176"));
        // two ends of a range are told apart
        QCOMPARE(numberText(245383.3992), QStringLiteral("245,383.4"));
        QCOMPARE(numberText(245383.3992, 0.5), QStringLiteral("245,383.3992"));
        QCOMPARE(numberText(637012.25, 1200.0), QStringLiteral("637,012.3"));
        QCOMPARE(classText(2), QStringLiteral("2 Ground"));
        QCOMPARE(classText(77), QStringLiteral("77 User defined"));
        QCOMPARE(classText(40), QStringLiteral("40 Reserved"));
        QCOMPARE(classText(7), QStringLiteral("7 Low Noise"));
        QCOMPARE(valueText(Value(std::uint64_t(18446744073709551615u))),
                 QStringLiteral("18,446,744,073,709,551,615"));
    }
    void roundLengths()
    {
        QCOMPARE(roundLengthUpTo(137.0), 100.0);
        QCOMPARE(roundLengthUpTo(0.6), 0.5);
        QCOMPARE(roundLengthUpTo(20.0), 20.0);
        QCOMPARE(roundLengthUpTo(0.0), 0.0);
        QCOMPARE(roundLengthUpTo(-1.0), 0.0);
    }
    /// Views have the time of one frame together, whoever needs more or less of it.
    void viewsShareAFrame()
    {
        using std::chrono::milliseconds;
        const auto begun = FrameShares::Clock::now();
        const FrameShares shares(0.016);
        const auto after = [&](int ms) { return begun + milliseconds(ms); };
        QVERIFY(std::abs(shares.next(2, after(0)) - 0.008) < 0.001);
        QVERIFY(std::abs(shares.next(1, after(4)) - 0.012) < 0.001);   // the first was quick
        QVERIFY(std::abs(shares.next(1, after(13)) - 0.003) < 0.001);  // it took longer than its share
        QCOMPARE(shares.next(1, after(30)), 0.0);
    }
    void iconsCanBeRead()
    {
        const QDir folder(QStringLiteral(PUNCTUM_SOURCE_DIR "/resources/icons"));
        const QStringList files = folder.entryList({QStringLiteral("*.svg")});
        QVERIFY(files.size() > 15);
        for (const QString& file : files) {
            const QString name = file.chopped(4);
            const auto shapes = iconShapes(name);
            QVERIFY2(!shapes.empty(), qPrintable(name + QStringLiteral(" is empty or not in ui/icons.qrc")));
            for (const IconShape& shape : shapes) {
                const QRectF box = shape.path.boundingRect();
                QVERIFY2(box.left() >= 1 && box.top() >= 1 && box.right() <= 23 && box.bottom() <= 23,
                         qPrintable(name));
            }
        }
        QVERIFY(iconShapes(QStringLiteral("no such icon")).empty());
        QVERIFY(readSvgShapes("not a picture").empty());
        QCOMPARE(readSvgShapes("<svg><path d='M1 1h10v10H1Z'/></svg>").size(), std::size_t(1));
    }
};

QTEST_GUILESS_MAIN(UiPartsTest)
#include "UiPartsTest.moc"
