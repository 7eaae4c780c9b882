// SPDX-License-Identifier: MIT
// Selecting and editing by real mouse and key events, against plain loops over all points of a real file.
#include "SelectBench.h"

#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/expression/Condition.h"
#include "core/las/Diff.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributeActions.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/ClassesModel.h"
#include "ui/docks/HistoryDock.h"
#include "ui/document/Workspace.h"
#include "ui/measure/MeasureDock.h"
#include "ui/measure/Measurements.h"
#include "ui/select/EditDock.h"
#include "ui/select/SelectBar.h"
#include "ui/select/SelectTools.h"
#include "ui/select/Selection.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QAbstractItemView>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QInputDialog>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QPushButton>
#include <QTreeWidget>
#include <QWheelEvent>

#include <cmath>
#include <numeric>
#include <vector>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

QStringList attributeNamesOf(const Document& document)
{
    QStringList names;
    for (const Attribute& a : document.attributes()) names << toQString(a.name);
    return names;
}

}  // namespace

class SelectionTest : public QObject
{
    Q_OBJECT
private slots:
    void rectangleAndModes()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        b.key(Qt::Key_R);  // the tool's own key
        QCOMPARE(b.window->selectTools().tool(), Tool::Rectangle);
        const auto before = b.frame();
        const auto in = [&](QPoint from, QPoint to) {
            return [=, r = b.ratio()](glm::dvec2 p) {
                return p.x >= std::min(from.x(), to.x()) * r && p.x < std::max(from.x(), to.x()) * r &&
                       p.y >= std::min(from.y(), to.y()) * r && p.y < std::max(from.y(), to.y()) * r;
            };
        };
        const QPoint a1 = b.at(0.3, 0.3), a2 = b.at(0.55, 0.6), b1 = b.at(0.7, 0.4), b2 = b.at(0.45, 0.75);
        const auto first = in(a1, a2), second = in(b1, b2);
        b.drag(a1, a2);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), first));
        QCOMPARE(b.selection().count(), b.points()->count());
        QVERIFY(b.window->selectBar().countText().contains(QLatin1String("selected")));
        QVERIFY(waitFor([&] { return difference(before->image, b.frame()->image) > 0.005; }));  // the tint

        b.drag(b1, b2, Qt::ShiftModifier);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), [&](glm::dvec2 p) { return first(p) || second(p); }));
        b.drag(a1, a2, Qt::ControlModifier);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), [&](glm::dvec2 p) { return second(p) && !first(p); }));
        b.selection().setMode(SelectMode::Intersect);
        const QPoint c1 = b.at(0.5, 0.5), c2 = b.at(0.65, 0.7);
        b.drag(c1, c2);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), [&](glm::dvec2 p) { return second(p) && !first(p) && in(c1, c2)(p); }));
        const PointIndex some = b.selection().count();
        b.window->selection().invert();
        QVERIFY(b.done());
        QCOMPARE(b.selection().count(), b.document->points() - some);
        b.selection().clear();
        QVERIFY(b.settle());
        QVERIFY(waitFor([&] { return b.frame()->image == before->image; }));
    }

    void polygonByClicks()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Polygon));
        const std::vector<QPoint> clicks{b.at(0.3, 0.3), b.at(0.6, 0.25), b.at(0.7, 0.6), b.at(0.5, 0.5),
                                         b.at(0.35, 0.7)};
        std::vector<glm::dvec2> corners;
        for (const QPoint& p : clicks) corners.push_back({p.x() * b.ratio(), p.y() * b.ratio()});
        const auto in = [&](glm::dvec2 p) { return insidePolygon(corners, p); };
        for (const QPoint& p : clicks) b.click(p);
        QCOMPARE(b.window->selectTools().corners(), clicks.size());
        b.click(b.at(0.9, 0.9));
        b.key(Qt::Key_Backspace);  // that one was wrong
        QCOMPARE(b.window->selectTools().corners(), clicks.size());
        b.key(Qt::Key_Return);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), in));
        const auto byEnter = b.points();

        b.selection().clear();
        for (const QPoint& p : clicks) b.click(p);
        QTest::mouseClick(&b.view(), Qt::RightButton, {}, b.at(0.4, 0.4));
        QVERIFY(b.done());
        QVERIFY(b.points() && *b.points() == *byEnter);
        QCOMPARE(b.window->selectTools().corners(), std::size_t(0));

        // Escape gives up the shape, then the tool
        b.click(b.at(0.1, 0.1));
        b.click(b.at(0.9, 0.1));
        b.key(Qt::Key_Escape);
        QVERIFY(b.done());
        QVERIFY(b.points() && *b.points() == *byEnter);
        QCOMPARE(b.window->selectTools().tool(), Tool::Polygon);
        b.key(Qt::Key_Escape);
        QCOMPARE(b.window->selectTools().tool(), Tool::None);
    }

    void lassoAndBrush()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Lasso));
        std::vector<glm::dvec2> corners;
        for (int k = 0; k < 24; ++k) {
            const double angle = k * 0.2618;
            const QPoint p = b.at(0.5 + 0.17 * std::cos(angle), 0.5 + 0.2 * std::sin(angle) * std::cos(angle / 3));
            corners.push_back({p.x() * b.ratio(), p.y() * b.ratio()});
            k == 0 ? b.press(p) : b.move(p);
            if (k == 23) b.release(p);
        }
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), [&](glm::dvec2 p) { return insidePolygon(corners, p); }));

        b.window->selectTools().setTool(Tool::Brush);
        const double small = b.window->selectTools().brushRadius();
        b.wheel(b.at(0.4, 0.5), 3);
        const double radius = b.window->selectTools().brushRadius() * b.ratio();
        QVERIFY(radius > small * b.ratio() * 1.3);
        const QPoint from = b.at(0.4, 0.4), to = b.at(0.6, 0.55);
        b.drag(from, to);
        QVERIFY(b.done());
        // moves go by whole px: the way is what the mouse told
        std::vector<glm::dvec2> way{{double(from.x()), double(from.y())}};
        for (int k = 1; k <= 4; ++k) {
            const QPoint p = from + (to - from) * k / 4;
            way.push_back({double(p.x()), double(p.y())});
        }
        SAME(b.unlike(b.points().get(), [&](glm::dvec2 p) {
            for (std::size_t k = 0; k + 1 < way.size(); ++k) {
                const glm::dvec2 a = way[k] * b.ratio(), step = way[k + 1] * b.ratio() - a, q = p - a;
                const double length = step.x * step.x + step.y * step.y;
                const double t = std::clamp((q.x * step.x + q.y * step.y) / length, 0.0, 1.0);
                if (std::hypot(q.x - t * step.x, q.y - t * step.y) <= radius) return true;
            }
            return false;
        }));
    }

    void spaceMovesTheCamera()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        QVERIFY(b.dragCamera(b.at(0.4, 0.4), b.at(0.6, 0.5)));
        QVERIFY(b.done());
        QVERIFY(!b.points());
        const render::Camera moved = b.view().camera();
        b.drag(b.at(0.4, 0.4), b.at(0.6, 0.5));
        QVERIFY(b.done());
        QVERIFY(b.points());
        QVERIFY(b.view().camera() == moved);
    }

    void hiddenAndLockedClassesAreLeftAlone()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
        const QPoint from = b.at(0.2, 0.2), to = b.at(0.8, 0.8);
        const auto in = [=, r = b.ratio()](glm::dvec2 p) {
            return p.x >= from.x() * r && p.x < to.x() * r && p.y >= from.y() * r && p.y < to.y() * r;
        };
        b.window->viewSettings().setClassLocked(2, true);
        b.drag(from, to);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), in, [&](PointIndex i) { return classes.number(i) != 2; }));
        b.window->viewSettings().setClassLocked(2, false);
        b.window->viewSettings().setClassVisible(1, false);
        QVERIFY(b.settle());
        b.drag(from, to);
        QVERIFY(b.done());
        SAME(b.unlike(b.points().get(), in, [&](PointIndex i) { return classes.number(i) != 1; }));
        b.selection().selectAll();
        QVERIFY(b.done());
        b.points()->forEach([&](PointIndex i) { QVERIFY(classes.number(i) != 1); });
    }

    void visibleSurfaceAndHiddenCount()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        render::Camera front = b.view().camera();
        QVERIFY(front.setView("front"));  // trees before trees
        const QSize size = b.view().pictureSize();
        front.fit(b.document->bounds(), {size.width(), size.height()});
        b.view().setCamera(front);
        QVERIFY(b.settle());
        b.drag(b.at(0.1, 0.3), b.at(0.9, 0.7));
        QVERIFY(b.done());
        const auto through = b.points();
        const PointIndex hidden = b.selection().hiddenCount();
        QVERIFY(hidden > 1000);
        b.selection().setDepth(Selection::Depth::Visible);
        b.drag(b.at(0.1, 0.3), b.at(0.9, 0.7));
        QVERIFY(b.done());
        QCOMPARE(b.selection().hiddenCount(), PointIndex(0));
        QCOMPARE(b.selection().count(), through->count() - hidden);
        QCOMPARE(countWithout(*b.points(), *through), PointIndex(0));

        b.selection().setDepth(Selection::Depth::Slab);
        b.selection().setSlabThickness(40.0);
        b.drag(b.at(0.1, 0.3), b.at(0.9, 0.7));
        QVERIFY(b.done());
        const render::Camera camera = b.view().camera();
        const double middle = camera.project(camera.pivot, {size.width(), size.height()}).z;
        QVERIFY(b.points() && b.points()->count() > 100 && b.points()->count() < through->count());
        int unlike = 0;
        through->forEach([&](PointIndex i) {
            const double depth =
                camera.project(b.document->cloud()->world(i), {size.width(), size.height()}).z - middle;
            const bool edge = std::abs(std::abs(depth) - 20.0) < 0.01;
            unlike += !edge && b.points()->contains(i) != (std::abs(depth) <= 20.0) ? 1 : 0;
        });
        QCOMPARE(unlike, 0);
    }

    void keysSetClassesAndUndoBringsThemBack_data()
    {
        QTest::addColumn<QByteArray>("settings");
        QTest::addColumn<QString>("kept");
        QTest::newRow("from memory") << QByteArray() << QStringLiteral(" in memory");
        QTest::newRow("from the disk") << QByteArray("[edit]\nundoMemory=0\n")
                                       << QStringLiteral("bytes on the disk");
    }

    void keysSetClassesAndUndoBringsThemBack()
    {
        QFETCH(QByteArray, settings);
        QFETCH(QString, kept);
        const QTemporaryDir folder;
        QFile file(folder.filePath(QStringLiteral("s.ini")));
        QVERIFY(file.open(QIODevice::WriteOnly) && file.write(settings) == settings.size());
        file.close();
        Bench b(file.fileName());
        QVERIFY(b.begin(Tool::Rectangle));
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
        std::vector<int> before(b.document->points());
        for (PointIndex i = 0; i < before.size(); ++i) before[i] = int(classes.number(i));
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done());
        const auto points = b.points();
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
        for (PointIndex i = 0; i < before.size(); ++i)
            QCOMPARE(int(classes.number(i)), points->contains(i) ? 6 : before[i]);
        QVERIFY(b.window->isWindowModified());
        QCOMPARE(b.document->history().undoName(), std::string("Set Classification = 6"));
        QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return b.document->history().position() == 0; }) && b.done());
        for (PointIndex i = 0; i < before.size(); ++i) QCOMPARE(int(classes.number(i)), before[i]);
        // the history can be walked
        QListWidget& list = b.window->historyDock().list();
        b.window->historyDock().show();
        b.window->historyDock().raise();
        QCOMPARE(list.count(), 2);
        QCOMPARE(list.item(1)->data(HistoryDock::kCountRole).toString(), countText(points->count()));
        QVERIFY2(list.toolTip().contains(kept), qPrintable(list.toolTip()));
        QTest::mouseClick(list.viewport(), Qt::LeftButton, {}, list.visualItemRect(list.item(1)).center());
        QVERIFY(waitFor([&] { return b.document->history().position() == 1; }) && b.done());
        points->forEach([&](PointIndex i) { QCOMPARE(int(classes.number(i)), 6); });
        QTest::mouseClick(list.viewport(), Qt::LeftButton, {}, list.visualItemRect(list.item(0)).center());
        QVERIFY(waitFor([&] { return b.document->history().position() == 0; }) && b.done());
        for (PointIndex i = 0; i < before.size(); ++i) QCOMPARE(int(classes.number(i)), before[i]);
        // from one class to another
        QVERIFY(b.runEdit([&] { b.window->editDock().setClass(9, 2); }));
        for (PointIndex i = 0; i < before.size(); ++i)
            QCOMPARE(int(classes.number(i)), points->contains(i) && before[i] == 2 ? 9 : before[i]);
    }

    /// Selections and edits are undone in the order in which they were done.
    void selectionsAreUndoneInOrder()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        const auto undo = [&] {
            QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
            return b.done();
        };
        const auto redo = [&] {
            QTest::keyClick(&b.view(), Qt::Key_Y, Qt::ControlModifier);
            return b.done();
        };
        const auto edits = [&] { return b.document->history().position(); };
        b.drag(b.at(0.3, 0.3), b.at(0.5, 0.5));
        QVERIFY(b.done() && b.points());
        const PointSet first = *b.points();
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
        b.drag(b.at(0.5, 0.5), b.at(0.7, 0.7), Qt::ShiftModifier);
        QVERIFY(b.done());
        const PointSet second = *b.points();
        QVERIFY(second.count() > first.count());
        b.click(b.at(0.02, 0.98));  // a stray click takes all of it away
        QVERIFY(b.done() && !b.points());

        QVERIFY(undo() && b.points() && *b.points() == second);
        QCOMPARE(edits(), std::size_t(1));
        QVERIFY(undo() && b.points() && *b.points() == first);
        QCOMPARE(edits(), std::size_t(1));
        QVERIFY(b.window->menu().undo->text().contains(QStringLiteral("Classification = 6")));
        QVERIFY(undo() && waitFor([&] { return edits() == 0; }) && b.done());
        QVERIFY(b.points() && *b.points() == first);
        QVERIFY(undo() && !b.points());
        QVERIFY(!b.window->menu().undo->isEnabled());
        QVERIFY(redo() && b.points() && *b.points() == first);
        QVERIFY(redo() && waitFor([&] { return edits() == 1; }) && b.done());
        QVERIFY(redo() && b.points() && *b.points() == second);
        QVERIFY(redo() && !b.points());
        QVERIFY(!b.window->menu().redo->isEnabled());
    }

    /// Keys without Ctrl act where the view has the keys: in a list they are the list's.
    void keysAreWhereTheFocusIs()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done() && b.points());
        const auto deleted = [&] { return b.document->deletedPoints(); };
        const auto position = [&] { return b.document->history().position(); };
        const auto point = [&](PointIndex i) { return MeasuredPoint{i, b.document->cloud()->world(i)}; };
        b.window->measurements().add(*b.document, MeasureKind::Distance, {point(0), point(1)});
        QTreeWidget& list = b.window->measureDock().list();
        QVERIFY(waitFor([&] { return list.topLevelItemCount() == 1; }));
        list.setFocus();
        list.setCurrentItem(list.topLevelItem(0));
        QTest::keyClick(&list, Qt::Key_6);
        QTest::keyClick(&list, Qt::Key_B);
        QTest::keyClick(&list, Qt::Key_Delete);
        QVERIFY(b.done());
        QCOMPARE(list.topLevelItemCount(), 0);
        QCOMPARE(deleted(), PointIndex(0));
        QCOMPARE(position(), std::size_t(0));
        QVERIFY(b.window->selectTools().tool() == Tool::Rectangle);
        // without one that is chosen nothing is removed
        QVERIFY(!b.window->measureDock().removeButton().isEnabled());
        // a click gives the list the keys
        auto* const classes = b.window->classesDock().findChild<QAbstractItemView*>();
        QVERIFY(classes);
        QTest::mouseClick(classes->viewport(), Qt::LeftButton, {},
                          classes->visualRect(classes->model()->index(0, ClassesModel::Name)).center());
        QCOMPARE(b.window->focusWidget(), static_cast<QWidget*>(classes));
        QTest::keyClick(classes, Qt::Key_6);
        QTest::keyClick(classes, Qt::Key_Delete);
        QVERIFY(b.done());
        QCOMPARE(position(), std::size_t(0));
        // and the mouse over the view gives it to the view, but not where somebody types
        QLineEdit* const field = b.window->findChild<QLineEdit*>();
        QVERIFY(field);
        const auto cross = [&] {
            QTest::mouseMove(classes->viewport(), QPoint(5, 5));
            QTest::mouseMove(&b.view(), b.view().rect().center());
        };
        field->setFocus();
        cross();
        QCOMPARE(b.window->focusWidget(), static_cast<QWidget*>(field));
        classes->setFocus();
        cross();
        QVERIFY(waitFor([&] { return b.view().hasFocus(); }));
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
        QTest::keyClick(&b.view(), Qt::Key_Delete);
        QVERIFY(waitFor([&] { return deleted() > 0; }));
    }

    void deletedPointsAreGoneUntilRestored()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath(QStringLiteral("a.laz")),
                      settings = folder.filePath(QStringLiteral("s.ini"));
        QVERIFY(QFile::copy(surveyFile(), file));
        const auto press = [](Bench& b, Qt::Key key, Qt::KeyboardModifiers modifiers) {
            const History& history = b.document->history();
            const std::size_t before = history.position();
            QTest::keyClick(&b.view(), key, modifiers);
            return waitFor([&] { return history.position() != before; }) && b.done();
        };
        Bench b(settings);
        QVERIFY(b.begin(Tool::Rectangle, file));
        const PointIndex all = b.document->points();
        const auto before = b.frame();
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done());
        b.selection().setMode(SelectMode::Add);
        b.selection().selectByRule(QStringLiteral("Z > 450"));
        QVERIFY(b.done());
        b.selection().setMode(SelectMode::Replace);
        const auto points = b.points();
        QVERIFY(press(b, Qt::Key_Delete, {}));
        QVERIFY(!b.points());
        QCOMPARE(b.document->deletedPoints(), points->count());
        // ranges and what Fit shows are those of the others
        const auto figures = [&](const char* name) { return (*b.document->figures(QLatin1String(name)))[0]; };
        for (const char* name : {"X", "Y", "Z", "Intensity"}) {
            double low = 1e300, high = -1e300;
            for (PointIndex i = 0; i < all; ++i) {
                const double v = b.document->findAttribute(QLatin1String(name))->number(i);
                if (points->contains(i)) continue;
                low = std::min(low, v);
                high = std::max(high, v);
            }
            QCOMPARE(figures(name).count, all - points->count());
            QCOMPARE(toDouble(figures(name).min), low);
            QCOMPARE(toDouble(figures(name).max), high);
        }
        QVERIFY(b.document->bounds().max.z <= 450.0);
        QVERIFY(waitFor([&] { return difference(before->image, b.frame()->image) > 0.01; }));
        const auto& counts = *b.document->classCounts();
        QCOMPARE(std::accumulate(counts.begin(), counts.end(), std::uint64_t(0)), all - points->count());
        b.selection().selectAll();
        QVERIFY(b.done());
        QCOMPARE(b.selection().count(), all - points->count());
        b.selection().clear();
        for (int step = 0; step < 2; ++step) {  // these selections are undone first
            QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
            QVERIFY(b.done() && b.document->deletedPoints() == points->count());
        }
        QVERIFY(press(b, Qt::Key_Z, Qt::ControlModifier));
        QCOMPARE(b.document->deletedPoints(), PointIndex(0));
        QVERIFY(b.document->bounds().max.z > 500.0);
        QVERIFY(waitFor([&] { return b.frame()->image == before->image; }));
        QVERIFY(press(b, Qt::Key_Y, Qt::ControlModifier));
        QVERIFY2(waitFor([&] { return b.document->unsavedChanges().contains(QLatin1String("left out")); }),
                 qPrintable(b.document->unsavedChanges()));

        // saved: the file lacks them, the window still has them
        b.window->save();
        QVERIFY(waitFor([&] { return !b.window->isWindowModified(); }) && b.done());
        QVERIFY(b.document->lastSave()->sentence.contains(QLatin1String("left out")));
        Progress progress;
        QCOMPARE(las::load(file.toStdString(), progress)->size(), all - points->count());
        // a crash after further edits: the journal is of the file that was saved
        b.selection().selectAll();
        QVERIFY(b.done());
        QVERIFY(press(b, Qt::Key_6, {}));
        const QDir journals(folder.filePath(QStringLiteral("journals")));
        const QStringList found = journals.entryList({QStringLiteral("*.journal")}, QDir::Files);
        QCOMPARE(found.size(), 1);
        const JournalContents journal = readJournal(journals.filePath(found.front()).toStdString());
        QCOMPARE(journal.key.points, all - points->count());
        {
            const auto reopened = las::load(file.toStdString(), progress);
            History history(reopened);
            QCOMPARE(replay(journal, *reopened, history, progress).stopped, std::string());
            const Attribute& classes = *reopened->findAttribute("Classification");
            for (PointIndex i = 0; i < reopened->size(); ++i) QCOMPARE(classes.number(i), 6.0);
        }
        QVERIFY(press(b, Qt::Key_Z, Qt::ControlModifier));
        QVERIFY(press(b, Qt::Key_Delete, Qt::ShiftModifier));
        QCOMPARE(b.document->deletedPoints(), PointIndex(0));
        b.window->save();
        QVERIFY(waitFor([&] { return !b.window->isWindowModified(); }) && b.done());
        const las::Difference same = las::diffFiles(surveyFile().toStdString(), file.toStdString(), {}, progress);
        QVERIFY2(same.differing == 0 && same.pointsB == all,
                 qPrintable(QString::fromStdString(las::summary(same))));
    }

    void attributesAreAddedRenamedAndRemoved()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        AttributesDock& dock = b.window->attributesDock();
        const auto choose = [&](const QString& attribute, const QString& text) {
            const std::unique_ptr<QMenu> menu(dock.actions().makeMenu(dock.model().indexOf(attribute)));
            for (QAction* action : menu->actions()) {
                if (!action->text().remove(QLatin1Char('&')).startsWith(text)) continue;
                if (!action->isEnabled()) return false;
                action->trigger();
                return true;
            }
            return false;
        };
        const auto names = [&] { return attributeNamesOf(*b.document); };
        const QStringList before = names();
        QVERIFY(!choose(QStringLiteral("Intensity"), QStringLiteral("Rename")));
        QVERIFY(!choose(QStringLiteral("Intensity"), QStringLiteral("Remove")));

        QVERIFY(choose({}, QStringLiteral("Add")));
        auto* dialog = dock.findChild<QDialog*>();
        QVERIFY(dialog && waitFor([&] { return dialog->isVisible(); }));
        const auto edits = dialog->findChildren<QLineEdit*>();
        QCOMPARE(edits.size(), 2);
        QTest::keyClicks(edits[0], QStringLiteral("Above 400"));
        edits[1]->clear();
        QTest::keyClicks(edits[1], QStringLiteral("Z - 400"));
        QVERIFY(b.runEdit([&] { QTest::keyClick(edits[1], Qt::Key_Return); }));
        QVERIFY(names().contains(QStringLiteral("Above 400")));
        const Attribute added = *b.document->findAttribute(QStringLiteral("Above 400"));
        QVERIFY(std::abs(added.number(7) - (b.document->cloud()->world(7).z - 400)) < 1e-3);

        emit dock.attributeChosen(QStringLiteral("Above 400"));
        QVERIFY(b.settle(QStringLiteral("Above 400")));
        QVERIFY(waitFor([&] { return dock.model().shown() == QLatin1String("Above 400"); }));
        QVERIFY(choose(QStringLiteral("Above 400"), QStringLiteral("Rename")));
        auto* input = dock.findChild<QInputDialog*>();
        QVERIFY(input && waitFor([&] { return input->isVisible(); }));
        input->setTextValue(QStringLiteral("Height"));
        QVERIFY(b.runEdit([&] { QTest::keyClick(input, Qt::Key_Return); }));
        QVERIFY(names().contains(QStringLiteral("Height")) && !names().contains(QStringLiteral("Above 400")));
        QVERIFY(waitFor([&] { return b.frame()->attribute == QLatin1String("Height"); }));  // it is still shown
        QVERIFY(b.runEdit([&] { choose(QStringLiteral("Height"), QStringLiteral("Remove")); }));
        QCOMPARE(names(), before);
        QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return names().contains(QStringLiteral("Height")); }));
    }

    void classesAreSelectedByTheirMenu()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        ClassesDock& dock = b.window->classesDock();
        QVERIFY(waitFor([&] { return dock.model().rowCount() >= 2; }));
        const auto& counts = *b.document->classCounts();
        const auto codeOf = [&](int row) {
            return dock.model().index(row, 0).data(ClassesModel::CodeRole).toUInt();
        };
        const auto choose = [&](int row, int action) {
            const std::unique_ptr<QMenu> menu(dock.makeMenu(dock.model().index(row, 0)));
            menu->actions().at(action)->trigger();
            return b.done();
        };
        QVERIFY(choose(0, 0));
        QCOMPARE(b.selection().count(), counts[codeOf(0)]);
        QVERIFY(choose(1, 1));
        QCOMPARE(b.selection().count(), counts[codeOf(0)] + counts[codeOf(1)]);
        QVERIFY(choose(0, 2));
        QCOMPARE(b.selection().count(), counts[codeOf(1)]);
    }

    void withheldIsAFlagAndSelectedPointsGoToAnotherFile()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done());
        const auto points = b.points();
        const Attribute withheld = *b.document->findAttribute(QStringLiteral("Withheld"));
        QVERIFY(b.runEdit([&] { b.window->editDock().setWithheld(true); }));
        for (PointIndex i = 0; i < b.document->points(); ++i)
            QCOMPARE(withheld.number(i), points->contains(i) ? 1.0 : 0.0);
        QVERIFY(b.runEdit([&] { b.window->editDock().setWithheld(false); }));
        for (PointIndex i = 0; i < b.document->points(); ++i) QCOMPARE(withheld.number(i), 0.0);

        const QString part = b.folder.filePath(QStringLiteral("part.laz"));
        b.window->workspace().extract(*b.document, points, part);
        QVERIFY(b.done());
        Document* const other = b.open(part);
        QVERIFY(other && other != b.document);
        QCOMPARE(other->points(), points->count());
        PointIndex k = 0;
        points->forEach([&](PointIndex i) {
            QVERIFY(other->cloud()->world(k) == b.document->cloud()->world(i));
            ++k;
        });
        // the open file itself is not replaced by a part of it
        const qint64 size = QFileInfo(part).size();
        auto first = std::make_shared<PointSet>(other->points());
        first->insert(0);
        b.window->workspace().extract(*other, first, part);
        QVERIFY(b.done());
        QCOMPARE(QFileInfo(part).size(), size);
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<SelectionTest>(); });
}
#include "SelectionTest.moc"
