// SPDX-License-Identifier: MIT
// What the view shows and how it is moved: fitting to what is shown, keys, the mark of the pivot, lit tools.
#include "UiTest.h"

#include "core/las/Writer.h"
#include "core/sample/Sample.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/measure/MeasureTools.h"
#include "ui/view/Framing.h"
#include "ui/view/MessageArea.h"
#include "ui/view/PivotMark.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QToolButton>
#include <QWheelEvent>

#include <glm/geometric.hpp>

#include <cmath>
#include <utility>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// A survey of which some points are 60 km away.
void writeWithStrays(const QString& path, std::uint64_t points, std::uint64_t strays)
{
    Progress progress;
    const auto cloud = makeSample(points, 7, progress);
    const auto x = cloud->columns()[0]->values<std::int32_t>();
    for (std::uint64_t k = 0; k < strays; ++k)
        x[std::size_t(k * 53 + 5)] += std::int32_t(60'000 / cloud->coordinates().scale.x);
    las::WriteOptions options;
    options.verify = false;
    las::write(*cloud, toPath(path), options, progress);
}

/// How wide a box looks, as a share of the picture.
double seen(const Viewport& view, const WorldBounds& box)
{
    const QSize size = view.pictureSize();
    return view.camera().seenSize(box, {size.width(), size.height()}) / std::max(size.width(), size.height());
}

}  // namespace

class ViewTest : public QObject
{
    Q_OBJECT
private slots:
    void straysAreNoPartOfTheFirstView()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("strays.las"));
        writeWithStrays(path, 30'000, 3);
        const Document* const document = test.open(path);
        QVERIFY(document && test.settle());
        const Viewport& view = test.window->viewport();
        WorldBounds survey = document->bounds();
        QVERIFY(survey.max.x - survey.min.x > 50'000);
        survey.max.x -= 60'000;
        QVERIFY2(seen(view, survey) > 0.5, qPrintable(QString::number(seen(view, survey))));
        const QStringList said = test.window->viewport().messages().sentences();
        QCOMPARE(said.size(), 1);
        QVERIFY2(said.front().contains(QStringLiteral("3 points")), qPrintable(said.front()));

        // All are shown by F, and the survey by F once more; and when the user has moved the camera, that comes
        // first.
        const auto fitted = [&](bool all) {
            test.window->framing().fitAll();
            return waitFor([&] { return (seen(view, survey) < 0.05) == all; }, 10'000) && test.settle();
        };
        QVERIFY(fitted(true));
        QVERIFY(fitted(false));
        QVERIFY(fitted(true));
        QTest::keyClick(&test.window->viewport(), Qt::Key_Left);
        QVERIFY(fitted(false));
    }

    void straysAreRemovedByOneClick()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("strays.las"));
        writeWithStrays(path, 30'000, 3);
        Document* const document = test.open(path);
        QVERIFY(document && test.settle());
        WorldBounds survey = document->bounds();
        survey.max.x -= 60'000;
        test.window->framing().fitAll();  // with them
        QVERIFY(waitFor([&] { return seen(test.window->viewport(), survey) < 0.05; }, 10'000) && test.settle());
        auto* const action = test.window->findChild<QAction*>(QStringLiteral("removeStrays"));
        QVERIFY(action && action->isEnabled());
        action->trigger();
        QVERIFY(waitFor([&] { return deletedPoints(*document->cloud()) != nullptr; }, 10'000));
        QCOMPARE(deletedPoints(*document->cloud())->count(), PointIndex(3));
        QVERIFY(waitFor([&] { return seen(test.window->viewport(), survey) > 0.5; }, 10'000) && test.settle());
        QVERIFY(test.window->viewport().messages().sentences().back().contains(QStringLiteral("deleted")));
        // There are none any more, which a sentence says; and they come back.
        action->trigger();
        QVERIFY(waitFor(
            [&] {
                return test.window->viewport().messages().sentences().back().contains(QStringLiteral("no point"));
            },
            10'000));
        QVERIFY(test.settle());
        test.window->workspace().undo(*document);
        QVERIFY(waitFor(
            [&] {
                return deletedPoints(*document->cloud()) == nullptr ||
                       deletedPoints(*document->cloud())->count() == 0;
            },
            10'000));
        QVERIFY(test.settle());
    }

    void fitGoesByWhatIsShown()
    {
        TestWindow test;
        const Document* const document = test.openSample(30'000);
        QVERIFY(document);
        const WorldBounds all = document->bounds();
        const double middle = (all.min.x + all.max.x) / 2;
        test.window->viewFilter().setText(
            QStringLiteral("X < %1").arg(all.min.x + (middle - all.min.x) / 4, 0, 'f', 3));
        QVERIFY(test.settle());
        test.window->framing().fitAll();
        QVERIFY(waitFor(
            [&] { return test.window->viewport().camera().pivot.x < middle - (middle - all.min.x) / 2; }, 10'000));
        // The flight there ends in a quarter of a second.
        QTest::qWait(350);
        QVERIFY(test.settle());
        // Nothing at all is left: the view stays, and a sentence says why.
        test.window->viewFilter().setText(QStringLiteral("X < 0 and X > 0"));
        QVERIFY(test.settle());
        const render::Camera before = test.window->viewport().camera();
        test.window->framing().fitAll();
        QVERIFY(waitFor([&] { return !test.window->viewport().messages().sentences().isEmpty(); }, 10'000));
        QVERIFY(test.window->viewport().camera() == before);
    }

    void keysTurnMoveAndZoom()
    {
        TestWindow test;
        QVERIFY(test.openSample(30'000));
        Viewport& view = test.window->viewport();
        view.setFocus();
        const auto press = [&](Qt::Key key, Qt::KeyboardModifiers modifiers = {}) {
            const render::Camera before = view.camera();
            QTest::keyClick(&view, key, modifiers);
            waitFor([&] { return !(view.camera() == before); }, 5'000);
            const render::Camera after = view.camera();
            test.settle();  // zooming goes by the point that the picture shows
            return std::pair(before, after);
        };
        // Zooming moves the pivot to what is in the middle of the picture, which may be another tree each time: how
        // far away this is is what changes.
        const auto zoomed = [](const std::pair<render::Camera, render::Camera>& cameras) {
            const auto depth = [&](const render::Camera& camera) {
                return glm::dot((cameras.second.pivot - camera.eye) * camera.stretch, camera.forward());
            };
            return depth(cameras.second) / depth(cameras.first);
        };
        const auto turned = press(Qt::Key_Right);
        QVERIFY(turned.first.yaw != turned.second.yaw && turned.first.pitch == turned.second.pitch);
        const auto tilted = press(Qt::Key_Up);
        QVERIFY(tilted.second.pitch < tilted.first.pitch);  // more from above
        QVERIFY(tilted.second.pivot == tilted.first.pivot);
        const auto moved = press(Qt::Key_Right, Qt::ControlModifier);
        QVERIFY(moved.first.yaw == moved.second.yaw);
        QVERIFY(glm::dot(moved.second.eye - moved.first.eye, moved.first.right()) > 0);
        const auto nearer = press(Qt::Key_PageUp);
        QVERIFY2(std::abs(zoomed(nearer) - 0.8) < 1e-3, qPrintable(QString::number(zoomed(nearer))));
        const auto farther = press(Qt::Key_Minus, Qt::ControlModifier);
        QVERIFY(farther.second == nearer.first);
        const auto beyond = press(Qt::Key_PageDown);
        QVERIFY2(std::abs(zoomed(beyond) - 1.25) < 1e-3, qPrintable(QString::number(zoomed(beyond))));
        const double size = test.window->viewSettings().size();
        QTest::keyClick(&view, Qt::Key_Plus, Qt::ControlModifier);
        QCOMPARE(test.window->viewSettings().size(), size);
    }

    /// Whatever was in the middle on the way, and however far it went.
    void keysZoomBackToWhereTheyBegan()
    {
        TestWindow test;
        QVERIFY(test.openSample(30'000));
        Viewport& view = test.window->viewport();
        view.setFocus();
        const auto press = [&](Qt::Key key) {
            const render::Camera before = view.camera();
            QTest::keyClick(&view, key);
            return waitFor([&] { return !(view.camera() == before); }, 5'000) && test.settle();
        };
        const render::Camera start = view.camera();
        for (const auto& [there, back] :
             {std::pair(Qt::Key_PageUp, Qt::Key_PageDown), std::pair(Qt::Key_PageDown, Qt::Key_PageUp)}) {
            for (const int steps : {1, 6}) {
                std::vector<render::Camera> passed;
                for (int k = 0; k < steps; ++k) {
                    passed.push_back(view.camera());
                    QVERIFY(press(there));
                }
                for (; !passed.empty(); passed.pop_back()) {
                    QVERIFY(press(back));
                    QVERIFY(view.camera() == passed.back());
                }
            }
            QVERIFY(view.camera() == start);
        }
        // Pressed faster than one sees.
        for (const Qt::Key key :
             {Qt::Key_PageUp, Qt::Key_PageUp, Qt::Key_PageUp, Qt::Key_PageDown, Qt::Key_PageDown, Qt::Key_PageDown})
            QTest::keyClick(&view, key);
        QTest::qWait(100);
        QVERIFY(test.settle());
        QVERIFY(view.camera() == start);
        // Moved meanwhile: zooming goes on from there.
        QVERIFY(press(Qt::Key_PageUp) && press(Qt::Key_Left));
        const render::Camera turned = view.camera();
        QVERIFY(press(Qt::Key_PageDown));
        QVERIFY(view.camera().yaw == turned.yaw && !(view.camera() == start));
    }

    /// The wheel goes on zooming in for as long as it is turned.
    void wheelNeverSticks()
    {
        TestWindow test;
        const Document* const document = test.openSample(30'000);
        QVERIFY(document);
        Viewport& view = test.window->viewport();
        const QPointF middle(view.rect().center());
        for (int turn = 0; turn < 60; ++turn) {
            const render::Camera before = view.camera();
            QWheelEvent wheel(middle, view.mapToGlobal(middle), {}, {0, 360}, Qt::NoButton, Qt::NoModifier,
                              Qt::NoScrollPhase, false);
            QApplication::sendEvent(&view, &wheel);
            QVERIFY2(waitFor([&] { return !(view.camera() == before); }, 5'000),
                     qPrintable(QStringLiteral("stuck at turn %1").arg(turn)));
            QVERIFY(glm::length(view.camera().eye - before.eye) > 0);
        }
        for (int turn = 0; turn < 80; ++turn) {
            QWheelEvent wheel(middle, view.mapToGlobal(middle), {}, {0, -600}, Qt::NoButton, Qt::NoModifier,
                              Qt::NoScrollPhase, false);
            QApplication::sendEvent(&view, &wheel);
            QTest::qWait(5);
        }
        QVERIFY(test.settle());
        const WorldBounds& all = document->bounds();
        QVERIFY(glm::length(view.camera().eye - (all.min + all.max) * 0.5) < 30 * glm::length(all.max - all.min));
    }

    void pivotIsMarkedWhileTurning()
    {
        TestWindow test;
        QVERIFY(test.openSample(30'000));
        Viewport& view = test.window->viewport();
        const auto* const mark = view.findChild<PivotMark*>();
        QVERIFY(mark && !mark->isVisible());
        const QPoint middle = view.rect().center();
        QTest::mousePress(&view, Qt::LeftButton, {}, middle);
        QVERIFY(!mark->isVisible());
        QMouseEvent move(QEvent::MouseMove, middle + QPointF(60, 0), view.mapToGlobal(middle + QPointF(60, 0)),
                         Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&view, &move);
        QVERIFY(mark->isVisible());
        const QSize size = view.pictureSize();
        const glm::dvec3 px = view.camera().project(view.camera().pivot, {size.width(), size.height()});
        QVERIFY(std::abs(mark->geometry().center().x() * view.pixelRatio() - px.x) < 3);
        QVERIFY(std::abs(mark->geometry().center().y() * view.pixelRatio() - px.y) < 3);
        QTest::mouseRelease(&view, Qt::LeftButton, {}, middle + QPoint(60, 0));
        QVERIFY(waitFor([&] { return !mark->isVisible(); }, 5'000));
    }

    void rulerIsLitWhileItMeasures()
    {
        TestWindow test;
        auto* const button = test.window->findChild<QToolButton*>(QStringLiteral("measure"));
        QVERIFY(button && !button->isChecked());
        test.window->measureTools().setTool(MeasureKind::Distance);
        QVERIFY(button->isChecked());
        QVERIFY(button->toolTip().contains(QStringLiteral("Distance")));
        test.window->measureTools().setTool({});
        QVERIFY(!button->isChecked());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<ViewTest>(); });
}
#include "ViewTest.moc"
