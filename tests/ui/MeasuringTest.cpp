// SPDX-License-Identifier: MIT
#include "core/surface/Surface.h"
#include "core/surface/Volume.h"
#include "core/task/Progress.h"
#include "tests/ui/UiTest.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/measure/MeasureDock.h"
#include "ui/measure/MeasureTools.h"
#include "ui/measure/Measurements.h"
#include "ui/measure/VolumeFields.h"
#include "ui/select/SelectTools.h"
#include "ui/style/NumberField.h"
#include "ui/style/Theme.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QFile>
#include <QPushButton>
#include <QStyleOptionComboBox>
#include <QTreeWidget>

#include <cmath>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// Where the file says the point is.
glm::dvec3 worldOf(const PointCloud& cloud, PointIndex index)
{
    return {cloud.findAttribute("X")->number(index), cloud.findAttribute("Y")->number(index),
            cloud.findAttribute("Z")->number(index)};
}

}  // namespace

/// Measuring with the mouse, on a real file.
class MeasuringTest : public QObject
{
    Q_OBJECT

private:
    /// The file from above, drawn; null without the file.
    static Document* openFromAbove(TestWindow& test)
    {
        Document* const document = test.open(surveyFile());
        if (document == nullptr) return nullptr;
        test.window->viewport().setStandardView(QStringLiteral("top"));
        QTest::qWait(400);  // the camera flies there
        return test.settle() ? document : nullptr;
    }
    /// Keys of tools; shortcuts of actions need a window manager.
    static void key(TestWindow& test, Qt::Key key) { QTest::keyClick(&test.window->viewport(), key); }
    /// Clicks in the view, at a place told in parts of its size, and waits until the point is taken.
    static bool click(TestWindow& test, double x, double y, Qt::MouseButton button = Qt::LeftButton,
                      bool takes = true)
    {
        Viewport& view = test.window->viewport();
        bool taken = false;
        const auto connection =
            QObject::connect(&test.window->measureTools(), &MeasureTools::pointTaken, [&] { taken = true; });
        QTest::mouseClick(&view, button, {}, QPoint(int(view.width() * x), int(view.height() * y)));
        const bool good = !takes || button != Qt::LeftButton || waitFor([&] { return taken; }, 20000);
        QObject::disconnect(connection);
        return good;
    }
    static QAction* tool(TestWindow& test, MeasureKind kind)
    {
        for (QAction* action : test.window->actions())
            if (action->isCheckable() && action->toolTip().startsWith(QStringLiteral("Click")) &&
                action->data().toInt() == int(kind))
                return action;
        return nullptr;
    }

private slots:
    void measuresWhatIsClicked()
    {
        TestWindow test;
        Document* document = openFromAbove(test);
        QVERIFY(document);
        Measurements& all = test.window->measurements();
        const glm::dvec2 places[] = {{0.2, 0.55}, {0.35, 0.58}, {0.4, 0.65}, {0.25, 0.64}};
        for (const MeasureKind kind : {MeasureKind::Distance, MeasureKind::Height, MeasureKind::Angle,
                                       MeasureKind::Area, MeasureKind::Box}) {
            tool(test, kind)->trigger();
            QCOMPARE(test.window->measureTools().tool(), std::optional(kind));
            const std::size_t before = all.entries().size(), needed = pointsOf(kind);
            const std::size_t corners = needed == 0 ? 4 : needed;
            for (std::size_t k = 0; k < corners; ++k) QVERIFY(click(test, places[k].x, places[k].y));
            if (needed == 0) key(test, Qt::Key_Return);
            QCOMPARE(all.entries().size(), before + 1);
            const Measurement& m = all.entries().back().measurement;
            QCOMPARE(m.points.size(), corners);
            const Viewport& view = test.window->viewport();
            for (std::size_t k = 0; k < corners; ++k) {
                // the point is where the mouse was, and its place is the file's
                const glm::dvec3 world = worldOf(*document->cloud(), m.points[k].index);
                QVERIFY(glm::length(world - m.points[k].world) < 1e-6);
                const glm::dvec3 px = view.camera().project(world, {double(view.width()), double(view.height())});
                QVERIFY(std::hypot(px.x - view.width() * places[k].x, px.y - view.height() * places[k].y) < 8);
            }
            const auto quantities = quantitiesOf(kind, m.points, glm::dvec3(1));
            QCOMPARE(quantities.size(), m.quantities.size());
            for (std::size_t k = 0; k < quantities.size(); ++k)
                QCOMPARE(m.quantities[k].value, quantities[k].value);
            QVERIFY(test.window->measureTools().tool() == kind);  // ready for the next one
        }
        QTreeWidget& list = test.window->measureDock().list();
        QCOMPARE(list.topLevelItemCount(), 5);
        QVERIFY(list.topLevelItem(0)->text(0).contains(QStringLiteral("Distance")));
        const Measurement& first = test.window->measurements().entries().front().measurement;
        QCOMPARE(list.topLevelItem(0)->text(1), quantityText(first.quantities.front(), first.length));

        // a file for spreadsheets
        const QString csv = test.folder.filePath(QStringLiteral("all.csv"));
        all.exportTo(csv);
        QVERIFY(waitFor([&] { return QFile::exists(csv) && !test.window->workspace().busy(); }));
        QFile file(csv);
        QVERIFY(file.open(QIODevice::ReadOnly));
        QVERIFY(file.readAll().contains("5,box,survey.laz,Volume,"));
        // they go with the file
        test.window->workspace().close(*document);
        QVERIFY(all.entries().empty());
        QCOMPARE(list.topLevelItemCount(), 0);
    }

    void measuresVolumes()
    {
        TestWindow test;
        Document* document = openFromAbove(test);
        QVERIFY(document);
        Measurements& all = test.window->measurements();
        MeasureDock& dock = test.window->measureDock();
        VolumeFields& fields = dock.volumeFields();
        QVERIFY(!fields.isVisible());
        tool(test, MeasureKind::Volume)->trigger();
        QVERIFY(fields.isVisible());
        QVERIFY(test.settle());
        const glm::dvec2 places[] = {{0.3, 0.4}, {0.6, 0.42}, {0.62, 0.6}, {0.28, 0.58}};
        for (const glm::dvec2 at : places) QVERIFY(click(test, at.x, at.y));
        QVERIFY(!test.window->measureTools().overlay().unfinishedText().isEmpty());
        // a click on the first corner closes it
        click(test, places[0].x, places[0].y, Qt::LeftButton, false);
        QCOMPARE(all.entries().size(), std::size_t(1));
        QCOMPARE(all.entries()[0].measurement.points.size(), std::size_t(4));
        const auto measured = [&] { return waitFor([&] { return all.entries().back().job == 0; }); };
        QVERIFY(measured());
        const Measurement& m = all.entries()[0].measurement;
        const auto value = [&](const char* name) {
            for (const Quantity& q : m.quantities)
                if (q.name == name) return q.value;
            return double(NAN);
        };
        // the surface of all ground points of the survey, asked by somebody else
        Progress progress;
        const Surface surface(document->cloud(), {}, progress);
        VolumeQuestion question;
        question.within.emplace_back();
        for (const MeasuredPoint& p : m.points) question.within[0].emplace_back(p.world);
        const auto expected = [&](VolumeBase base) {
            question.base = base;
            return surface.withTiles(
                [&](const SurfaceTiles& tiles) { return volumeOf(*document->cloud(), tiles, question, progress); });
        };
        const auto agrees = [&](VolumeBase base) {
            const Volume volume = expected(base);
            return std::abs(value("Net volume") - volume.net()) < 1e-3 * volume.area &&
                   std::abs(value("Cut") - volume.cut) < 1e-3 * volume.area && value("Standard deviation") > 0;
        };
        QVERIFY(agrees(VolumeBase::Outline));
        const QTreeWidgetItem& row = *dock.list().topLevelItem(0);
        QCOMPARE(row.text(1), quantityText(m.quantities.front(), m.length));
        QVERIFY(row.text(1).endsWith(toQString(unitText(Quantity::Unit::Volume, m.length))));
        // in the narrowest panel choices and figures are read in full
        test.window->resizeDocks({&dock}, {kLeastPanelWidth}, Qt::Horizontal);
        QVERIFY(waitFor([&] { return dock.width() < kLeastPanelWidth + 30; }));
        for (QComboBox* box : {&fields.base(), &fields.points()}) {
            QStyleOptionComboBox option;
            option.initFrom(box);
            option.editable = false;
            const int room = box->style()
                                 ->subControlRect(QStyle::CC_ComboBox, &option, QStyle::SC_ComboBoxEditField, box)
                                 .width();
            for (int k = 0; k < box->count(); ++k)
                QVERIFY2(box->fontMetrics().horizontalAdvance(box->itemText(k)) <= room,
                         qPrintable(box->itemText(k)));
        }
        QTreeWidget& list = dock.list();
        const auto fits = [&] {
            return list.columnWidth(0) + list.columnWidth(1) <= list.viewport()->width() &&
                   list.fontMetrics().horizontalAdvance(row.text(1)) <= list.columnWidth(1);
        };
        QVERIFY2(waitFor(fits, 5000), qPrintable(QStringLiteral("%1 and %2 px of %3")
                                                     .arg(list.columnWidth(0))
                                                     .arg(list.columnWidth(1))
                                                     .arg(list.viewport()->width())));
        // other bases, by keys: it is measured again
        fields.base().setFocus();
        QTest::keyClick(&fields.base(), Qt::Key_Down);
        QVERIFY(measured());
        QVERIFY(agrees(VolumeBase::Lowest));
        QTest::keyClick(&fields.base(), Qt::Key_Down);
        QVERIFY(measured());
        QVERIFY(agrees(VolumeBase::Plane));
        QTest::keyClick(&fields.base(), Qt::Key_Down);
        QVERIFY(fields.height().isVisible());
        question.height = expected(VolumeBase::Lowest).height + 2;
        fields.height().clear();
        QTest::keyClicks(&fields.height(), QString::number(question.height, 'f', 6));
        QTest::keyClick(&fields.height(), Qt::Key_Return);
        QVERIFY(measured());
        QVERIFY(agrees(VolumeBase::Height));
        QVERIFY(value("Fill") > 0);

        dock.copyButton().click();
        const QString copied = QApplication::clipboard()->text();
        QVERIFY(copied.contains(QStringLiteral("Net volume\t")));
        QVERIFY(copied.contains(QStringLiteral("Surface of\tclass 2")));
        const QString csv = test.folder.filePath(QStringLiteral("all.csv"));
        all.exportTo(csv);
        QVERIFY(waitFor([&] { return QFile::exists(csv) && !test.window->workspace().busy(); }));
        QFile file(csv);
        QVERIFY(file.open(QIODevice::ReadOnly));
        const QByteArray text = file.readAll();
        QVERIFY(text.contains("1,volume,survey.laz,Net volume,"));
        QVERIFY(text.contains("1,volume,survey.laz,Base,height,"));

        // Enter closes one, a double click too; the same base is asked for
        fields.setWish({});
        all.setVolumeWish(0, {});
        for (const bool twice : {false, true}) {
            const std::size_t before = all.entries().size();
            for (const glm::dvec2 at : {places[0], places[1]}) QVERIFY(click(test, at.x, at.y));
            Viewport& view = test.window->viewport();
            const QPoint last(int(view.width() * places[3].x), int(view.height() * places[3].y));
            QTest::mouseClick(&view, Qt::LeftButton, {}, last);
            if (twice)
                QTest::mouseDClick(&view, Qt::LeftButton, {}, last);
            else
                key(test, Qt::Key_Return);
            QVERIFY(waitFor([&] { return all.entries().size() == before + 1; }));
            QCOMPARE(all.entries().back().measurement.points.size(), std::size_t(3));
            QVERIFY(measured());
        }
        QCOMPARE(all.entries()[1].measurement.quantities.front().value,
                 all.entries()[2].measurement.quantities.front().value);
        // a job that is stopped leaves the outline, one whose file is closed nothing
        VolumeWish shown;
        shown.points = VolumeWish::Points::Shown;
        all.setVolumeWish(all.entries().back().id, shown);
        test.window->workspace().cancel(all.entries().back().job);
        QVERIFY(measured());
        QCOMPARE(all.entries().back().measurement.facts.front().first, std::string("Not measured"));
        QCOMPARE(all.entries().back().measurement.quantities.front().name, std::string("Area"));
        shown.base = VolumeBase::Plane;
        all.setVolumeWish(all.entries().back().id, shown);
        QVERIFY(measured());
        QCOMPARE(all.entries().back().measurement.facts[1].second, std::string("points shown"));
        all.setVolumeWish(all.entries().back().id, {});
        test.window->workspace().close(*document);
        QVERIFY(all.entries().empty());
        QVERIFY(waitFor([&] { return !test.window->workspace().busy(); }));
    }

    void inspectsAPoint()
    {
        TestWindow test;
        Document* document = openFromAbove(test);
        QVERIFY(document);
        tool(test, MeasureKind::Point)->trigger();
        QCOMPARE(test.window->measureTools().tool(), std::optional(MeasureKind::Point));
        QVERIFY(click(test, 0.3, 0.6));
        Measurements& all = test.window->measurements();
        QCOMPARE(all.entries().size(), std::size_t(1));
        QVERIFY(waitFor([&] { return !all.entries().front().nearest.empty(); }));
        const Measurements::Entry& entry = all.entries().front();
        const PointIndex index = entry.measurement.points.front().index;
        // every attribute, exactly
        std::size_t checked = 0;
        for (const Attribute& a : document->cloud()->attributes()) {
            if (a.components != 1 || a.kind == AttributeKind::Class) continue;
            const auto found = std::find_if(entry.attributes.begin(), entry.attributes.end(),
                                            [&](const auto& row) { return row.first.toStdString() == a.name; });
            QVERIFY2(found != entry.attributes.end(), a.name.c_str());
            QCOMPARE(found->second, shownValue(a, a.value(index)));
            ++checked;
        }
        QVERIFY(checked > 12);
        // the nearest of all points
        double least = INFINITY;
        const glm::dvec3 here = worldOf(*document->cloud(), index);
        for (PointIndex i = 0; i < document->points(); ++i)
            if (i != index) least = std::min(least, glm::distance(worldOf(*document->cloud(), i), here));
        QVERIFY(std::abs(entry.nearest.front().distance - least) < 1e-6);

        test.window->measureDock().copyButton().click();
        const QString copied = QApplication::clipboard()->text();
        QVERIFY(copied.contains(QStringLiteral("Intensity\t")));
        QVERIFY(copied.contains(QStringLiteral("Index\t%1").arg(index)));
        QTest::mouseClick(&test.window->measureDock().removeButton(), Qt::LeftButton);
        QVERIFY(all.entries().empty());
    }

    void keysTakeBack()
    {
        TestWindow test;
        QVERIFY(openFromAbove(test));
        MeasureTools& tools = test.window->measureTools();
        tool(test, MeasureKind::Area)->trigger();
        QVERIFY(click(test, 0.2, 0.55));
        QVERIFY(click(test, 0.3, 0.55));
        key(test, Qt::Key_Backspace);
        QCOMPARE(tools.pointsTaken(), std::size_t(1));
        // a drag moves the camera and takes nothing
        const render::Camera before = test.window->viewport().camera();
        Viewport& view = test.window->viewport();
        dragWithMouse(view, view.rect().center(), view, view.rect().center() + QPoint(40, 20));
        QVERIFY(!(view.camera() == before));
        QVERIFY(test.settle());
        QCOMPARE(tools.pointsTaken(), std::size_t(1));
        // a tool that selects takes the mouse away, and gives it back
        test.window->selectTools().setTool(SelectTools::Tool::Lasso);
        QVERIFY(!tools.tool());
        tool(test, MeasureKind::Area)->trigger();
        QVERIFY(test.window->selectTools().tool() == SelectTools::Tool::None);
        QVERIFY(click(test, 0.2, 0.55));
        // too few corners are no area
        key(test, Qt::Key_Return);
        QVERIFY(test.window->measurements().entries().empty());
        QVERIFY(click(test, 0.3, 0.6));
        key(test, Qt::Key_Escape);
        QCOMPARE(tools.pointsTaken(), std::size_t(0));
        QVERIFY(tools.tool());
        key(test, Qt::Key_Escape);
        QVERIFY(!tools.tool());
        QVERIFY(!tool(test, MeasureKind::Area)->isChecked());
        // three corners and the right button are one
        tool(test, MeasureKind::Area)->trigger();
        for (const glm::dvec2 at : {glm::dvec2(0.25, 0.58), glm::dvec2(0.35, 0.58), glm::dvec2(0.3, 0.64)})
            QVERIFY(click(test, at.x, at.y));
        QVERIFY(!tools.overlay().unfinishedText().isEmpty());
        click(test, 0.5, 0.5, Qt::RightButton);
        QCOMPARE(test.window->measurements().entries().size(), std::size_t(1));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<MeasuringTest>(); });
}

#include "MeasuringTest.moc"
