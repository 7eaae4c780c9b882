// SPDX-License-Identifier: MIT
// What the panels do under a real hand: clicks that change something and say so, a focus that is seen, room for the
// view in a small window.
#include "SelectBench.h"

#include "core/las/Writer.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/ClassesModel.h"
#include "ui/process/ProcessingDock.h"
#include "ui/select/EditDock.h"

#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QStatusBar>
#include <QTableView>

#include <glm/geometric.hpp>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

QPushButton* buttonOf(QWidget& panel, const QString& text)
{
    for (QPushButton* button : panel.findChildren<QPushButton*>())
        if (button->text() == text) return button;
    return nullptr;
}

/// Which points of `among` have one of `others` (other than themselves) within the distance: a plain loop.
std::shared_ptr<PointSet> near(const Document& document, const std::function<bool(PointIndex)>& among,
                               const PointSet& others, double distance)
{
    const PointCloud& cloud = *document.cloud();
    const glm::dvec3 stretch = document.viewStretch(document.bounds());
    std::vector<glm::dvec3> places;
    others.forEach([&](PointIndex i) { places.push_back(cloud.world(i) * stretch); });
    auto found = std::make_shared<PointSet>(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        if (!among(i)) continue;
        const glm::dvec3 p = cloud.world(i) * stretch;
        const bool any = std::any_of(places.begin(), places.end(), [&](const glm::dvec3& q) {
            const glm::dvec3 d = q - p;
            return glm::dot(d, d) <= distance * distance;
        });
        if (any) found->insert(i);
    }
    return found;
}

/// Points that are in one of both sets and not in the other.
PointIndex unlikeness(const PointSet& a, const PointSet& b)
{
    PointIndex n = 0;
    a.forEach([&](PointIndex i) { n += b.contains(i) ? 0 : 1; });
    b.forEach([&](PointIndex i) { n += a.contains(i) ? 0 : 1; });
    return n;
}

/// The first field or button of a panel that does not wholly fit into it.
QString cutOff(QDockWidget& panel)
{
    for (const QWidget* widget : panel.findChildren<QWidget*>()) {
        const bool control =
            qobject_cast<const QAbstractButton*>(widget) || qobject_cast<const QComboBox*>(widget) ||
            qobject_cast<const QAbstractSpinBox*>(widget) || qobject_cast<const QLineEdit*>(widget);
        if (!control || !widget->isVisible() || qobject_cast<const QAbstractSpinBox*>(widget->parentWidget()))
            continue;
        const int end = widget->mapTo(&panel, QPoint(widget->width(), 0)).x();
        if (end > panel.width() || widget->width() < std::min(widget->minimumSizeHint().width(), 60) ||
            widget->height() < widget->minimumSizeHint().height() - 2 ||
            (widget->parentWidget()->layout() && !widget->parentWidget()->rect().contains(widget->geometry())))
            return QStringLiteral("%1: \"%2\" is %3 x %4 and ends at %5 of %6")
                .arg(panel.windowTitle(), widget->accessibleName() + widget->toolTip())
                .arg(widget->width())
                .arg(widget->height())
                .arg(end)
                .arg(panel.width());
    }
    return {};
}

}  // namespace

class PanelsTest : public QObject
{
    Q_OBJECT
private slots:
    void growAndShrinkAreClicked()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        EditDock& panel = b.window->editDock();
        panel.show();
        panel.raise();
        QVERIFY(QTest::qWaitFor([&] { return panel.isVisible(); }));
        b.drag(b.at(0.45, 0.45), b.at(0.5, 0.5));
        QVERIFY(b.done());
        const auto distance = panel.findChild<QDoubleSpinBox*>();
        QVERIFY(distance && waitFor([&] { return b.document->spacing() > 0; }));
        const double reach = distance->value();
        const auto click = [&](const QString& text) {
            QPushButton* const button = buttonOf(panel, text);
            if (!button || !button->isEnabled() || !button->isVisible()) return false;
            QTest::mouseClick(button, Qt::LeftButton);
            return b.done();
        };
        const auto before = std::make_shared<const PointSet>(*b.points());
        const auto others = [&](const PointSet& set) { return [&set](PointIndex i) { return !set.contains(i); }; };
        const auto joining = near(*b.document, others(*before), *before, reach);
        QVERIFY2(joining->count() > 10, qPrintable(QString::number(joining->count())));
        QVERIFY(click(QStringLiteral("Grow")));
        const auto grown = std::make_shared<const PointSet>(*b.points());
        PointSet expected = *before;
        expected.insert(*joining);
        QCOMPARE(unlikeness(*grown, expected), PointIndex(0));
        QCOMPARE(panel.resultText(),
                 QStringLiteral("Grown by %1 within %2.").arg(pointsText(joining->count()), distance->text()));

        PointSet outside(b.document->points());
        for (PointIndex i = 0; i < b.document->points(); ++i)
            if (!grown->contains(i)) outside.insert(i);
        // Those that leave are near the edge: only what lies outside near it can make them leave.
        const auto edge = near(*b.document, others(*grown), *grown, reach);
        const auto leaving = near(
            *b.document, [&](PointIndex i) { return grown->contains(i); }, *edge, reach);
        QVERIFY(leaving->count() > 10);
        QVERIFY(click(QStringLiteral("Shrink")));
        expected = *grown;
        expected.remove(*leaving);
        QCOMPARE(unlikeness(*b.points(), expected), PointIndex(0));
        QCOMPARE(panel.resultText(), QStringLiteral("Shrunk by %1 that have others within %2.")
                                         .arg(pointsText(leaving->count()), distance->text()));
    }

    /// Who clicks twice wants it to run.
    void doubleClickOnRunDoesNotCancel()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        ProcessingDock& panel = b.window->processingDock();
        panel.show();
        panel.raise();
        panel.chooseStep(QStringLiteral("normals"));
        QPushButton* const run = buttonOf(panel, QStringLiteral("Run"));
        QVERIFY(run && waitFor([&] { return run->isVisible() && run->isEnabled(); }));
        const QSignalSpy ended(&b.window->workspace(), &Workspace::stepEnded);
        QTest::mouseClick(run, Qt::LeftButton);
        QTest::mouseDClick(run, Qt::LeftButton);
        QTest::mouseRelease(run, Qt::LeftButton);
        QVERIFY2(panel.running(), qPrintable(panel.resultText()));
        QCOMPARE(run->text(), QStringLiteral("Cancel"));
        QVERIFY(waitFor([&] { return !ended.isEmpty(); }) && b.done());
        QCOMPARE(ended.size(), 1);
        QVERIFY(b.document->findAttribute(QStringLiteral("Normal")));
        QCOMPARE(b.document->history().position(), std::size_t(1));
    }

    /// Whatever takes the keys looks other than it does without them.
    void focusIsSeen()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        QVERIFY(waitFor([&] { return b.document->classCounts().has_value(); }));
        QStringList unseen;
        int seen = 0;
        const auto look = [&](QWidget* widget, const QDockWidget* panel) {
            if (!widget->isVisible() || !widget->isEnabled() || !(widget->focusPolicy() & Qt::TabFocus)) return;
            b.window->viewport().setFocus();
            QTest::qWait(1);
            const QImage without = widget->grab().toImage();
            widget->setFocus(Qt::TabFocusReason);
            QTest::qWait(1);
            if (!widget->hasFocus()) return;  // given on
            // the cursor of a text may be just off
            const QImage with = widget->grab().toImage();
            ++seen;
            if (with == without)
                unseen << QStringLiteral("%1 \"%2\" of %3")
                              .arg(QLatin1String(widget->metaObject()->className()),
                                   widget->accessibleName() + widget->toolTip(), panel->windowTitle());
        };
        const QList<QDockWidget*> panels = b.window->findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly);
        for (QDockWidget* panel : panels) {
            panel->show();
            panel->raise();
            QVERIFY(waitFor([&] { return panel->isVisible(); }));
            QTest::qWait(1);
            for (QWidget* widget : panel->findChildren<QWidget*>())
                if (qobject_cast<QAbstractButton*>(widget) || qobject_cast<QAbstractItemView*>(widget) ||
                    qobject_cast<QComboBox*>(widget) || qobject_cast<QAbstractSpinBox*>(widget) ||
                    qobject_cast<QLineEdit*>(widget))
                    look(widget, panel);
        }
        QVERIFY2(seen > 25, qPrintable(QString::number(seen)));
        QVERIFY2(unseen.isEmpty(), qPrintable(unseen.join(QLatin1Char('\n'))));
    }

    /// The mouse rests over a point while its class is changed by a key.
    void statusBarHasTheNewClass()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        const auto told = [&](const QString& text) {
            for (const QLabel* label : b.window->statusBar()->findChildren<QLabel*>())
                if (label->text().contains(text)) return true;
            return false;
        };
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done());
        b.window->selectTools().setTool(Tool::None);
        const auto hover = [&](QPoint p) {
            QMouseEvent event(QEvent::MouseMove, QPointF(p), b.view().mapToGlobal(QPointF(p)), Qt::NoButton,
                              Qt::NoButton, Qt::NoModifier);
            QApplication::sendEvent(&b.view(), &event);
            return waitFor([&] { return told(QStringLiteral("x ")); }, 300);
        };
        bool over = false;
        for (int k = 0; k < 60 && !over; ++k) over = hover(b.at(0.4 + 0.002 * k, 0.45));
        QVERIFY(over);
        QVERIFY(!told(QStringLiteral("9 Water")));
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_9); }));
        QVERIFY(waitFor([&] { return told(QStringLiteral("9 Water")); }, 10'000));
        QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return !told(QStringLiteral("9 Water")) && told(QStringLiteral("x ")); }, 10'000));
    }

    /// A slab is as thick as the points are dense, in the unit of the file, until somebody chooses a thickness.
    void slabSuitsTheFile()
    {
        Bench b;
        QVERIFY(b.begin(Tool::Rectangle));
        QVERIFY(waitFor([&] { return b.document->spacing() > 0; }) && b.done());
        const double first = b.selection().slabThickness(), spacing = b.document->spacing();
        QVERIFY2(first > 5 * spacing && first < 20 * spacing,
                 qPrintable(QStringLiteral("%1 of %2").arg(first).arg(spacing)));
        b.selection().setDepth(Selection::Depth::Slab);
        QDoubleSpinBox* field = nullptr;
        for (QDoubleSpinBox* each : b.window->findChildren<QDoubleSpinBox*>())
            if (each->accessibleName() == QStringLiteral("Thickness of the slab")) field = each;
        QVERIFY(field && waitFor([&] { return field->isVisible(); }, 5'000));
        QCOMPARE(field->value(), first);
        const QString unit = b.document->lengthUnit();
        QCOMPARE(field->suffix(), QLatin1Char(' ') + (unit.isEmpty() ? QStringLiteral("units") : unit));
        // a small thing, whose points are a hundredth of a unit apart
        const QString small = b.folder.filePath(QStringLiteral("small.las"));
        {
            Progress progress;
            const CoordinateScale steps{glm::dvec3(1e-4), glm::dvec3(0.0)};
            const auto source = las::makeSource(0, {}, steps, {}, 2500);
            PointCloud cloud(2500, steps);
            las::makeColumns(cloud, source->layout);
            cloud.setSource(source);
            for (std::size_t i = 0; i < 2500; ++i) {
                cloud.columns()[0]->values<std::int32_t>()[i] = std::int32_t(i % 50 * 100);
                cloud.columns()[1]->values<std::int32_t>()[i] = std::int32_t(i / 50 * 100);
            }
            las::write(cloud, toPath(small), {}, progress);
        }
        const Document* const other = b.open(small);
        QVERIFY(other && other != b.document);
        QVERIFY(waitFor([&] { return other->spacing() > 0; }) && b.done());
        QVERIFY2(b.selection().slabThickness() > 0.03 && b.selection().slabThickness() < 0.3,
                 qPrintable(QString::number(b.selection().slabThickness())));
        QCOMPARE(field->value(), b.selection().slabThickness());
        QCOMPARE(field->suffix(), QStringLiteral(" units"));
        // typed, it stays
        field->setFocus();
        field->selectAll();
        QTest::keyClicks(field, QStringLiteral("0.25"));
        QTest::keyClick(field, Qt::Key_Return);
        QCOMPARE(b.selection().slabThickness(), 0.25);
    }

    /// All panels are there, and the view has most of a small window.
    void viewHasRoomInASmallWindow()
    {
        Bench b;
        QVERIFY(b.begin(Tool::None));
        b.window->resize(1024, 700);
        QVERIFY(waitFor([&] { return b.window->width() == 1024; }));
        // of themselves, as the window becomes smaller
        QVERIFY2(waitFor([&] { return b.view().width() >= 560; }, 5'000),
                 qPrintable(QString::number(b.view().width())));
        QList<QDockWidget*> left, right;
        for (QDockWidget* panel : b.window->findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly))
            (b.window->dockWidgetArea(panel) == Qt::LeftDockWidgetArea ? left : right) << panel;
        QVERIFY(left.size() > 1 && right.size() > 4);
        for (QDockWidget* panel : left + right) {
            panel->show();
            panel->raise();
            QVERIFY(waitFor([&] { return panel->isVisible(); }));
            b.window->resizeDocks({left.front(), right.contains(panel) ? panel : right.front()}, {1, 1},
                                  Qt::Horizontal);
            QTest::qWait(20);
            QVERIFY2(b.view().width() >= 560, qPrintable(QStringLiteral("%1: %2 px, left %3 %4, right %5 %6")
                                                             .arg(panel->windowTitle())
                                                             .arg(b.view().width())
                                                             .arg(left.front()->width())
                                                             .arg(left.front()->minimumSizeHint().width())
                                                             .arg(right.front()->width())
                                                             .arg(right.front()->minimumSizeHint().width())));
            // rows fold once the panel has its width
            QVERIFY2(waitFor([&] { return cutOff(*panel).isEmpty(); }, 2'000), qPrintable(cutOff(*panel)));
            if (panel != &b.window->processingDock()) continue;
            for (const Step* step : allSteps()) {
                b.window->processingDock().chooseStep(toQString(step->name()));
                // rows find their places once the fields are there
                QVERIFY2(waitFor([&] { return cutOff(*panel).isEmpty(); }, 2'000), qPrintable(cutOff(*panel)));
            }
        }
        QCOMPARE(b.window->width(), 1024);
        // what classes are called can be read
        const auto* const classes = b.window->classesDock().findChild<QTableView*>();
        QVERIFY(classes);
        QVERIFY2(classes->columnWidth(ClassesModel::Name) >= 56,
                 qPrintable(QString::number(classes->columnWidth(ClassesModel::Name))));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<PanelsTest>(); });
}
#include "PanelsTest.moc"
