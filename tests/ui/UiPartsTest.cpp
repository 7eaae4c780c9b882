// SPDX-License-Identifier: MIT
// The parts of ui that need no window: navigation, texts, icons.
#include "ui/Navigation.h"
#include "ui/Text.h"
#include "ui/marks/ScaleBar.h"
#include "ui/style/Icons.h"

#include <QDir>
#include <QFile>
#include <QTest>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

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
    void countsAndClasses()
    {
        QCOMPARE(pointsText(1), QStringLiteral("1 point"));
        QCOMPARE(pointsText(1204), QStringLiteral("1,204 points"));
        QCOMPARE(coordinateText(637012.2449, 0.01), QStringLiteral("637,012.24"));
        QCOMPARE(coordinateText(12.0, 0.0), QStringLiteral("12.000"));
        QCOMPARE(classText(2), QStringLiteral("2 Ground"));
        QCOMPARE(classText(77), QStringLiteral("77 User defined"));
        QCOMPARE(valueText(Value(std::uint64_t(18446744073709551615u))),
                 QStringLiteral("18,446,744,073,709,551,615"));
    }
    void roundLengths()
    {
        QCOMPARE(roundLength(137.0), 100.0);
        QCOMPARE(roundLength(0.6), 0.5);
        QCOMPARE(roundLength(20.0), 20.0);
        QCOMPARE(roundLength(0.0), 0.0);
        QCOMPARE(roundLength(-1.0), 0.0);
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
