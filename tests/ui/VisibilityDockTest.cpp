// SPDX-License-Identifier: MIT
// Filter, clip box and cuts in the window, by keys and mouse, against what core says is hidden.
#include "UiTest.h"

#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/VisibilityDock.h"
#include "ui/document/Workspace.h"
#include "ui/select/EditDock.h"
#include "ui/select/SelectTools.h"
#include "ui/select/Selection.h"
#include "ui/style/NumberField.h"
#include "ui/view/ClipFrame.h"
#include "ui/view/ShownCount.h"
#include "ui/view/ShownPill.h"
#include "ui/view/Still.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QCheckBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QStatusBar>
#include <QWindow>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// A window that shows a real file and the dock.
struct DockBench : TestWindow {
    Document* document = nullptr;

    bool begin(const QString& file)
    {
        document = open(file);
        dock().show();
        dock().raise();
        return document && settle();
    }
    VisibilityDock& dock() { return window->visibilityDock(); }
    PointIndex hidden()
    {
        Progress progress;
        const auto points = hiddenPoints(*document->cloud(), window->viewFilter().visibility(*document), progress);
        return points ? points->count() : 0;
    }
};

}  // namespace

class VisibilityDockTest : public QObject
{
    Q_OBJECT

    template <class Widget>
    static Widget* find(QWidget& dock, const QString& name)
    {
        for (Widget* widget : dock.findChildren<Widget*>())
            if (widget->accessibleName() == name || widget->property("text").toString() == name) return widget;
        return nullptr;
    }
    static QString stateOf(VisibilityDock& dock)
    {
        for (const QLabel* label : dock.findChildren<QLabel*>())
            if (label->text().contains(QStringLiteral("hidden")) ||
                label->text().startsWith(QStringLiteral("Column")))
                return label->text();
        return {};
    }

private slots:
    void hidesAndShows()
    {
        const QString file = surveyFile();
        DockBench test;
        QVERIFY(test.begin(file));
        const Document* const document = test.document;
        VisibilityDock& dock = test.dock();
        const render::Image all = test.frame()->image;

        // a filter, a wrong one, and none
        auto* filter = find<QLineEdit>(dock, QStringLiteral("Filter"));
        QVERIFY(filter);
        filter->setFocus();
        QTest::keyClicks(filter, QStringLiteral("Intensity > 100 and ReturnNumber == 1"));
        QTest::keyClick(filter, Qt::Key_Return);
        QVERIFY(waitFor([&] { return stateOf(dock).contains(QStringLiteral("110,000")); }));
        PointIndex expected = 0;
        const Attribute &intensity = *document->findAttribute(QStringLiteral("Intensity")),
                        &number = *document->findAttribute(QStringLiteral("ReturnNumber"));
        for (PointIndex i = 0; i < document->points(); ++i)
            expected += !(intensity.number(i) > 100 && number.number(i) == 1);
        QCOMPARE(test.hidden(), expected);
        QVERIFY2(stateOf(dock).startsWith(QLocale(QLocale::English).toString(expected)), qPrintable(stateOf(dock)));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        filter->selectAll();
        QTest::keyClicks(filter, QStringLiteral("Intensty > 100"));
        QTest::keyClick(filter, Qt::Key_Return);
        QVERIFY(waitFor([&] { return stateOf(dock).startsWith(QStringLiteral("Column 1")); }));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));
        filter->clear();
        QVERIFY(waitFor([&] { return stateOf(dock).isEmpty(); }));

        // the box
        auto* box = dock.findChild<QCheckBox*>();
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QVERIFY(box->isChecked() && test.window->viewSettings().display().clip.box);
        QVERIFY(test.settle());
        QVERIFY(waitFor(
            [&] { return difference(all, test.frame()->image) == 0.0; }));  // the file's own box hides nothing
        auto* least = find<QLineEdit>(dock, QStringLiteral("Least X"));
        QVERIFY(least);
        least->setFocus();
        least->selectAll();
        QTest::keyClicks(least, QStringLiteral("636600"));
        QTest::keyClick(least, Qt::Key_Return);
        QVERIFY(test.settle());
        expected = 0;
        for (PointIndex i = 0; i < document->points(); ++i) expected += document->cloud()->world(i).x < 636600;
        QCOMPARE(test.hidden(), expected);
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));

        // cuts
        auto* cut = find<QPushButton>(dock, QStringLiteral("Cut Here"));
        auto* uncut = find<QPushButton>(dock, QStringLiteral("Remove Cuts"));
        QVERIFY(cut && uncut && !uncut->isEnabled());
        QTest::mouseClick(cut, Qt::LeftButton);
        QVERIFY(test.settle());
        const PointIndex hidden = test.hidden();
        QVERIFY(hidden > document->points() / 5 && hidden < document->points() * 4 / 5);
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        QTest::mouseClick(uncut, Qt::LeftButton);
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));
    }

    /// A box of a small thing holds all of it, whatever the decimals of its fields; and what is no number changes
    /// nothing.
    void boxOfASmallFile()
    {
        DockBench test;
        const QString file = test.folder.filePath(QStringLiteral("small.las"));
        writeSurvey(file, 3000);
        {
            // steps of 1e-7: a coin, as a survey is
            QFile bytes(file);
            QVERIFY(bytes.open(QIODevice::ReadWrite));
            for (int axis = 0; axis < 3; ++axis) {
                const double scale = 1e-7;
                bytes.seek(131 + 8 * axis);
                bytes.write(reinterpret_cast<const char*>(&scale), sizeof scale);
            }
        }
        QVERIFY(test.begin(file));
        VisibilityDock& dock = test.dock();
        auto* box = dock.findChild<QCheckBox*>();
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QTest::mouseClick(find<QPushButton>(dock, QStringLiteral("Box of the File")), Qt::LeftButton);
        QVERIFY(test.window->viewSettings().display().clip.box && test.settle());
        QCOMPARE(test.hidden(), PointIndex(0));
        auto* least = find<NumberField>(dock, QStringLiteral("Least X"));
        auto* most = find<NumberField>(dock, QStringLiteral("Most X"));
        QVERIFY(least && most);
        QCOMPARE(least->text(), QStringLiteral("6.3600176"));
        // typed, it is what was typed
        const Clip before = test.window->viewSettings().display().clip;
        const auto type = [](QLineEdit* field, const QString& text) {
            field->setFocus();
            field->selectAll();
            QTest::keyClicks(field, text);
            QTest::keyClick(field, Qt::Key_Return);
        };
        type(least, QStringLiteral("6,3"));
        QVERIFY(least->property("wrong").toBool() && test.window->viewSettings().display().clip == before);
        type(least, QStringLiteral("6.366"));
        QVERIFY(!least->property("wrong").toBool());
        QCOMPARE(test.window->viewSettings().display().clip.box->min.x, 6.366);
        QCOMPARE(test.window->viewSettings().display().clip.box->max.x, before.box->max.x);
        type(most, QStringLiteral("6.365"));
        QVERIFY(most->property("wrong").toBool());
        QCOMPARE(test.window->viewSettings().display().clip.box->max.x, before.box->max.x);
    }

    /// The view says that points are hidden, and what hides them; what hides them ends with the files it was chosen
    /// for.
    void hiddenPointsAreTold()
    {
        DockBench test;
        QVERIFY(test.begin(surveyFile()));
        MainWindow& window = *test.window;
        const auto says = [&](const QString& text) {
            return waitFor([&] { return window.shownPill().text() == text && window.shownCount().state().known; });
        };
        const auto status = [&](const QString& text) {
            return waitFor([&] {
                for (const QLabel* label : window.statusBar()->findChildren<QLabel*>())
                    if (label->text() == text) return true;
                return false;
            });
        };
        QVERIFY(says({}) && status(QStringLiteral("All points drawn")));
        QVERIFY(waitFor([&] { return test.document->classCounts().has_value(); }));
        const quint64 ground = (*test.document->classCounts())[2];
        window.viewSettings().setClassVisible(2, false);
        window.viewSettings().setClassVisible(17, false);  // there is none of it
        QVERIFY(says(QStringLiteral("%1 of 110,000 shown: 1 class").arg(countText(110000 - ground))));
        QVERIFY(status(QStringLiteral("All %1 shown points drawn").arg(countText(110000 - ground))));
        window.viewFilter().setText(QStringLiteral("Intensity > 100"));
        Clip clip;
        clip.box = test.document->bounds();
        clip.box->max.x -= 500;
        window.viewSettings().setClip(clip);
        QVERIFY(waitFor(
            [&] { return window.shownCount().state().known && window.shownCount().state().reasons.size() == 3; }));
        QVERIFY(says(
            QStringLiteral("%1 of 110,000 shown: filter, box, 1 class").arg(countText(110000 - test.hidden()))));
        clip.box->max = clip.box->min - glm::dvec3(5);
        clip.box->min -= glm::dvec3(10);
        window.viewSettings().setClip(clip);
        QVERIFY(status(QStringLiteral("No point is shown")));
        window.viewSettings().setClassLocked(1, true);

        // a second file, opened while all that is in force, is hidden as well, and that is said
        const QString other = test.folder.filePath(QStringLiteral("other.las"));
        writeSurvey(other, 5000, 2000.0);
        Document* second = test.open(other);
        QVERIFY(second && second != test.document);
        QVERIFY(says(QStringLiteral("0 of 115,000 shown: filter, box, 1 class")));
        // what was chosen for the first one goes with it
        window.workspace().close(*test.document);
        QVERIFY(says({}) && test.settle());
        QVERIFY(window.viewFilter().text().isEmpty() && !window.viewSettings().display().clip.any());
        QVERIFY(!window.viewSettings().classLocked(1));
        for (bool visible : window.viewSettings().display().classVisible) QVERIFY(visible);

        // the button shows all
        window.viewSettings().setClassVisible(1, false);
        window.viewFilter().setText(QStringLiteral("Intensity > 200"));
        QVERIFY(waitFor([&] { return window.shownCount().state().reasons.size() == 2; }));
        QTest::mouseClick(&window.shownPill().showAllButton(), Qt::LeftButton);
        QVERIFY(says({}) && window.viewFilter().text().isEmpty());

        // deleted points are said, and are not to be shown
        window.selection().selectClass(2, SelectMode::Replace);
        QVERIFY(waitFor([&] { return window.selection().count() > 0 && !window.selection().busy(); }));
        const PointIndex some = window.selection().count();
        window.editDock().deleteSelected();
        QVERIFY(says(QStringLiteral("%1 of 5,000 shown: %2 deleted").arg(countText(5000 - some), countText(some))));
        QVERIFY(!window.shownPill().showAllButton().isVisible());
    }

    void boxIsDragged()
    {
        const QString file = surveyFile();
        DockBench test;
        QVERIFY(test.begin(file));
        const Document* const document = test.document;
        VisibilityDock& dock = test.dock();
        Viewport& view = test.window->viewport();
        const ClipFrame& frame = view.clipFrame();
        auto* least = find<QLineEdit>(dock, QStringLiteral("Least X"));
        auto* most = find<QLineEdit>(dock, QStringLiteral("Most X"));
        auto* box = dock.findChild<QCheckBox*>();
        QVERIFY(least && most && !frame.handle(ClipFrame::kMiddle));
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QVERIFY(test.settle());
        const auto now = [&] { return *test.window->viewSettings().display().clip.box; };
        const WorldBounds whole = now();
        const double width = whole.max.x - whole.min.x;

        QWindow* const window = test.window->windowHandle();
        const auto inWindow = [&](QPointF at) { return view.mapTo(test.window.get(), at.toPoint()); };
        const auto place = [&](const glm::dvec3& world) {
            const glm::dvec3 px = view.camera().project(world, {double(view.width()), double(view.height())});
            return QPointF(px.x, px.y);
        };
        const glm::dvec3 middle = whole.min + (whole.max - whole.min) * 0.5;
        constexpr std::size_t kMostX = 1;
        // From the handle by as much as the face has to move on the screen to get to the middle.
        const QPointF from = *frame.handle(kMostX);
        const QPointF by = place(middle) - place({whole.max.x, middle.y, middle.z});
        QTest::mousePress(window, Qt::LeftButton, Qt::NoModifier, inWindow(from));
        QTest::mouseMove(window, inWindow(from + by / 2));
        const double half = now().max.x;
        QVERIFY(half < whole.max.x - width / 8 && half > middle.x);
        QCOMPARE(most->text(), shownCoordinate(document->cloud()->coordinates(), 0, half));
        QVERIFY(waitFor([&] { return test.hidden() > 0 && test.frame()->report.share == 1.0; }));
        QTest::mouseMove(window, inWindow(from + by));
        QVERIFY(std::abs(now().max.x - middle.x) < width / 100);
        QCOMPARE(now().min, whole.min);
        QCOMPARE(now().max.y, whole.max.y);
        QTest::mouseRelease(window, Qt::LeftButton, Qt::NoModifier, inWindow(from + by));
        QTest::mouseMove(window, inWindow(from));  // nothing is held any more
        const WorldBounds dragged = now();
        QVERIFY(std::abs(dragged.max.x - middle.x) < width / 100);
        PointIndex expected = 0;
        for (PointIndex i = 0; i < document->points(); ++i)
            expected += document->cloud()->world(i).x > dragged.max.x;
        QCOMPARE(test.hidden(), expected);
        // What the settings of now come to, and no older picture.
        const auto picture = [&] {
            const QSize size = view.pictureSize();
            const auto still = std::make_shared<Still>(
                StillRequest{size.width(), size.height(), view.camera(), view.displayFor(view.pixelRatio())});
            test.window->renderer().draw(still);
            std::shared_ptr<const render::Image> image;
            test.window->workspace().startJob(QStringLiteral("Picture"), [&, still](Progress& progress) {
                image = std::make_shared<render::Image>(still->wait(progress).image);
            });
            return waitFor([&] { return !test.window->workspace().busy(); }) ? image : nullptr;
        };
        const auto cut = picture();
        QVERIFY(cut);

        // Escape takes back what is being dragged; the camera has not moved meanwhile.
        const render::Camera camera = view.camera();
        const QPointF center = *frame.handle(ClipFrame::kMiddle);
        QTest::mousePress(window, Qt::LeftButton, Qt::NoModifier, inWindow(center));
        QTest::mouseMove(window, inWindow(center + QPointF(60, 25)));
        QVERIFY(std::abs(now().min.x - dragged.min.x) > width / 100);
        QVERIFY(std::abs((now().max.x - now().min.x) - (dragged.max.x - dragged.min.x)) < width * 1e-9);
        QTest::keyClick(window, Qt::Key_Escape);
        QCOMPARE(now().min, dragged.min);
        QCOMPARE(now().max, dragged.max);
        QTest::mouseMove(window, inWindow(center + QPointF(90, 25)));
        QTest::mouseRelease(window, Qt::LeftButton, Qt::NoModifier, inWindow(center + QPointF(90, 25)));
        QCOMPARE(now().max, dragged.max);
        QVERIFY(camera == view.camera());
        const auto same = picture();
        QVERIFY(same && *same == *cut);

        // A face stops at the one that faces it; keys move it as well.
        const QPointF again = *frame.handle(kMostX);
        QTest::mousePress(window, Qt::LeftButton, Qt::NoModifier, inWindow(again));
        QTest::mouseMove(window, inWindow(again + 3 * by));
        QCOMPARE(now().max.x, now().min.x);
        QTest::mouseMove(window, inWindow(again));
        QTest::mouseRelease(window, Qt::LeftButton, Qt::NoModifier, inWindow(again));
        QVERIFY(std::abs(now().max.x - dragged.max.x) < width / 1000);
        least->setFocus();
        QTest::keyClick(least, Qt::Key_Up);
        QVERIFY(std::abs(now().min.x - (whole.min.x + (dragged.max.x - whole.min.x) / 100)) < width / 1000);
        QCOMPARE(least->text(), shownCoordinate(document->cloud()->coordinates(), 0, now().min.x));

        // A tool has the mouse for itself.
        test.window->selectTools().setTool(SelectTools::Tool::Lasso);
        QVERIFY(!frame.handle(kMostX));
        test.window->selectTools().setTool(SelectTools::Tool::None);
        QVERIFY(frame.handle(kMostX));
        // Seen from above, only what moves sideways has a handle.
        QTest::mouseClick(find<QPushButton>(dock, QStringLiteral("Box of the File")), Qt::LeftButton);
        QCOMPARE(now().max.x, whole.max.x);
        view.setStandardView(QStringLiteral("top"));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return view.camera().pitch < -1.57; }));
        QVERIFY(frame.handle(0) && frame.handle(3) && !frame.handle(4) && !frame.handle(5));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<VisibilityDockTest>(); });
}

#include "VisibilityDockTest.moc"
