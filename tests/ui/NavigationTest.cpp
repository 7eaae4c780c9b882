// SPDX-License-Identifier: MIT
// Where the view can go: orthographic and back, the axes in the corner, coordinates, saved views. By real events.
#include "UiTest.h"

#include "core/Error.h"
#include "render/camera/CameraFile.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/menu/Menus.h"
#include "ui/navigate/AxesMark.h"
#include "ui/navigate/Coordinates.h"
#include "ui/navigate/GoToDialog.h"
#include "ui/navigate/Places.h"
#include "ui/navigate/SavedViews.h"
#include "ui/navigate/SavedViewsDialog.h"
#include "ui/section/Sections.h"
#include "ui/settings/WindowSettings.h"
#include "ui/style/NumberField.h"
#include "ui/view/Framing.h"
#include "ui/view/MessageArea.h"
#include "ui/view/Overlays.h"
#include "ui/view/PivotMark.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QClipboard>
#include <QDialogButtonBox>
#include <QInputDialog>
#include <QMenu>
#include <QPushButton>
#include <QSettings>
#include <QTreeWidget>
#include <QWheelEvent>

#include <glm/geometric.hpp>

#include <cmath>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

using Part = AxesMark::Part;

/// A window that shows a made survey.
struct Bench : TestWindow {
    Document* document = nullptr;

    explicit Bench(const QString& settings = {}) : TestWindow(ViewKind::Automatic, settings) {}
    bool begin(std::uint64_t points = 30'000)
    {
        document = openSample(points);
        view().messages().clear();
        return document != nullptr;
    }
    Viewport& view() { return window->viewport(); }
    const render::Camera& camera() { return view().camera(); }
    AxesMark& axes() { return window->places().axes(); }
    glm::dvec2 size()
    {
        const QSize px = view().pictureSize();
        return {px.width(), px.height()};
    }
    QAction* action(const char* name) { return window->findChild<QAction*>(QLatin1String(name)); }
    /// An action's key, which works without a window manager only so.
    bool trigger(const char* name)
    {
        QAction* const found = action(name);
        if (!found || !found->isEnabled()) return false;
        found->trigger();
        return settle();
    }
    bool click(Part part)
    {
        const auto place = axes().placeOf(part);
        if (!place) return false;
        QTest::mouseClick(&axes(), Qt::LeftButton, {}, place->toPoint());
        return settle();
    }
    void wheel(QPointF at, int angle)
    {
        QWheelEvent event(at, view().mapToGlobal(at), {}, {0, angle}, Qt::NoButton, Qt::NoModifier,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&view(), &event);
    }
    std::optional<PickedPoint> pick(QPoint at)
    {
        std::optional<PickedPoint> found;
        bool answered = false;
        view().renderer().pick(at.x(), at.y(), window.get(), [&](const std::optional<PickedPoint>& point) {
            found = point;
            answered = true;
        });
        waitFor([&] { return answered; }, 10'000);
        return found;
    }
    QStringList said() { return view().messages().sentences(); }
    /// What the box looks like, as a share of the picture.
    double seen() { return camera().seenSize(document->bounds(), size()) / std::max(size().x, size().y); }
};

/// Along the view direction, from the eye.
double depthOf(const render::Camera& camera, const glm::dvec3& world)
{
    return glm::dot((world - camera.eye) * camera.stretch, camera.forward());
}

SavedViews::View savedView(const QString& file, const QString& name)
{
    return {file, name, QStringLiteral("{\"eye\": [1, 2, 3]}")};
}

}  // namespace

class NavigationTest : public QObject
{
    Q_OBJECT
private slots:
    /// What lies at the pivot's depth stays where it is and as large as it is, and so does the scale bar.
    void projectionChangesInPlace()
    {
        Bench b;
        QVERIFY(b.begin());
        const render::Camera before = b.camera();
        QVERIFY(!before.orthographic && !b.action("orthographic")->isChecked());
        const auto* const bar = b.view().findChild<CompassOverlay*>();
        const ScaleBar scale = bar->content();
        const glm::dvec3 beside = before.unproject(b.size() * 0.25, b.size());
        QVERIFY(b.trigger("orthographic"));
        QVERIFY(b.camera().orthographic && b.action("orthographic")->isChecked());
        QVERIFY(bar->content() == scale);
        for (const glm::dvec3& place : {before.pivot, beside})
            QVERIFY(glm::length(before.project(place, b.size()) - b.camera().project(place, b.size())) < 1e-6);
        QVERIFY(b.trigger("orthographic"));
        QVERIFY(b.camera() == before);
        // The key is documented, and free.
        int times = 0;
        for (const auto& shortcut : b.window->menus().shortcuts()) times += shortcut.keys == QStringLiteral("V");
        QCOMPARE(times, 1);
    }

    /// Seen in parallel, too, the wheel keeps what is under the mouse, the pivot comes to it, and turning goes
    /// about it.
    void zoomGoesToWhatIsUnderTheMouse()
    {
        Bench b;
        QVERIFY(b.begin());
        QVERIFY(b.trigger("orthographic"));
        const QPoint at(b.view().width() / 2 + 150, b.view().height() / 2 + 40);
        const auto point = b.pick(at);
        QVERIFY(point);
        const glm::dvec3 under = b.camera().unproject(b.view().toPicture(at), b.size());
        for (int turn = 0; turn < 8; ++turn) {
            const render::Camera before = b.camera();
            b.wheel(at, 240);
            QVERIFY(waitFor([&] { return !(b.camera() == before); }, 5'000));
        }
        QVERIFY(b.settle());
        const glm::dvec3 now = b.camera().project(under, b.size());
        QVERIFY(glm::length(glm::dvec2(now) - b.view().toPicture(at)) < 1e-3);
        QVERIFY(b.camera().unitsPerPixel(b.size().y) > 0);
        // As deep as the point, however far away that was from the pivot.
        QVERIFY(std::abs(depthOf(b.camera(), point->world) - b.camera().pivotDepth()) <
                20 * b.camera().unitsPerPixel(b.size().y));
        const glm::dvec3 middle = b.camera().project(b.camera().pivot, b.size());
        QVERIFY(glm::length(glm::dvec2(middle) - b.size() / 2.0) < 1e-3);

        // Out again as far as it goes, and in again: never stuck.
        for (int turn = 0; turn < 60; ++turn) b.wheel(at, -600);
        QVERIFY(b.settle());
        QVERIFY(b.seen() < 0.2);
        const double far = b.camera().pivotDepth();
        b.wheel(at, 360);
        QVERIFY(waitFor([&] { return b.camera().pivotDepth() < far; }, 5'000));
    }

    /// A point that is clicked becomes the pivot at the same scale; panning follows the mouse at any depth.
    void centeringAndPanningKeepTheScale()
    {
        Bench b;
        QVERIFY(b.begin());
        QVERIFY(b.trigger("orthographic"));
        const double scale = b.camera().unitsPerPixel(b.size().y);
        const QPoint at(b.view().width() / 2 - 120, b.view().height() / 2 + 60);
        const auto point = b.pick(at);
        QVERIFY(point);
        QTest::mouseDClick(&b.view(), Qt::LeftButton, {}, at);
        QVERIFY(waitFor([&] { return b.camera().pivot == point->world; }, 5'000));
        QVERIFY(b.settle());
        QVERIFY(std::abs(b.camera().unitsPerPixel(b.size().y) - scale) < 1e-9 * scale);
        const glm::dvec3 high = b.document->bounds().max;
        const glm::dvec3 before = b.camera().project(high, b.size());
        QTest::mousePress(&b.view(), Qt::RightButton, {}, at);
        QMouseEvent move(QEvent::MouseMove, at + QPointF(50, -30), b.view().mapToGlobal(at + QPointF(50, -30)),
                         Qt::NoButton, Qt::RightButton, Qt::NoModifier);
        QApplication::sendEvent(&b.view(), &move);
        QTest::mouseRelease(&b.view(), Qt::RightButton, {}, at + QPoint(50, -30));
        QVERIFY(b.settle());
        const glm::dvec3 after = b.camera().project(high, b.size());
        QVERIFY(std::abs(after.x - before.x - 50 * b.view().pixelRatio()) < 1e-3);
        QVERIFY(std::abs(after.y - before.y + 30 * b.view().pixelRatio()) < 1e-3);
    }

    void standardViewsArePlans()
    {
        Bench b;
        QVERIFY(b.begin());
        for (const char* name : {"top", "front", "left", "back", "right", "bottom"}) {
            if (b.camera().orthographic) QVERIFY(b.trigger("orthographic"));
            b.view().setStandardView(QLatin1String(name));
            QVERIFY(b.settle());
            QVERIFY2(b.camera().orthographic, name);
            QVERIFY2(b.seen() > 0.5 && b.seen() <= 1.0, name);
        }
        // Back by the key; the isometric view leaves it as it is.
        QVERIFY(b.trigger("orthographic"));
        b.view().setStandardView(QStringLiteral("iso"));
        QVERIFY(b.settle() && !b.camera().orthographic);
        QVERIFY(b.trigger("orthographic"));
        b.view().setStandardView(QStringLiteral("iso"));
        QVERIFY(b.settle() && b.camera().orthographic);
        // Fit shows all of it in parallel, from afar and from near.
        for (const double factor : {0.01, 30.0}) {
            render::Camera camera = b.camera();
            camera.zoomTowards(camera.pivot, factor);
            b.view().setCamera(camera);
            QVERIFY(b.settle());
            b.window->framing().fitAll();
            QVERIFY(waitFor([&] { return b.seen() > 0.7 && b.seen() <= 1.0; }, 10'000));
            QVERIFY(b.settle() && b.camera().orthographic);
        }
    }

    void axesAreClicked()
    {
        Bench b;
        QVERIFY(b.begin());
        QVERIFY(b.axes().isVisible());
        const double scale = b.camera().unitsPerPixel(b.size().y);
        const glm::dvec3 pivot = b.camera().pivot;
        const struct {
            Part part;
            glm::dvec3 look;
        } ends[] = {{Part::Top, {0, 0, -1}}, {Part::Right, {-1, 0, 0}}, {Part::Bottom, {0, 0, 1}},
                    {Part::Left, {1, 0, 0}}, {Part::Top, {0, 0, -1}},   {Part::Front, {0, 1, 0}},
                    {Part::Top, {0, 0, -1}}, {Part::Back, {0, -1, 0}}};
        for (const auto& end : ends) {
            QVERIFY(b.click(end.part));
            QVERIFY(glm::length(b.camera().forward() - end.look) < 1e-9);
            QVERIFY(b.camera().orthographic);
            // the place and the scale are those of before
            QVERIFY(glm::length(b.camera().pivot - pivot) < 1e-6);
            QVERIFY(std::abs(b.camera().unitsPerPixel(b.size().y) - scale) < 1e-6 * scale);
            // the axis along the line of sight is under the middle
            QVERIFY(!b.axes().placeOf(end.part));
        }
        QVERIFY(b.click(Part::Middle));
        QVERIFY(!b.camera().orthographic && !b.action("orthographic")->isChecked());
        QVERIFY(b.click(Part::Middle));
        QVERIFY(b.camera().orthographic);

        // East is on the right, seen from the top, and north above.
        QVERIFY(b.click(Part::Top));
        const QPointF middle = *b.axes().placeOf(Part::Middle);
        QVERIFY(b.axes().placeOf(Part::Right)->x() > middle.x() + 20);
        QVERIFY(b.axes().placeOf(Part::Back)->y() < middle.y() - 20);

        // Hovering shows; beside the ends the mouse is the view's.
        QTest::mouseMove(&b.axes(), b.axes().placeOf(Part::Right)->toPoint());
        QVERIFY(waitFor([&] { return b.axes().hovered() == Part::Right; }, 5'000));
        const QPoint beside = (middle + QPointF(22, 22)).toPoint();
        QTest::mouseMove(&b.axes(), beside);
        QVERIFY(waitFor([&] { return !b.axes().hovered(); }, 5'000));
        const render::Camera before = b.camera();
        dragWithMouse(b.axes(), beside, b.axes(), beside + QPoint(-40, 30));
        QVERIFY(b.settle());
        QVERIFY(b.camera().yaw != before.yaw && b.camera().pivot == before.pivot);
    }

    /// They hide nothing, and go by the menu, for good.
    void axesGiveWay()
    {
        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("settings.ini"));
        {
            Bench b(settings);
            QVERIFY(b.begin());
            for (const QSize size : {QSize(1600, 1000), QSize(1024, 700), QSize(800, 500)}) {
                b.window->resize(size);
                QVERIFY(b.settle());
                b.view().messages().add(MessageKind::Info,
                                        QStringLiteral("A sentence that is said over the view."));
                QCoreApplication::processEvents();
                if (!b.axes().isVisible()) continue;
                const QRect axes = b.axes().geometry();
                QVERIFY(b.view().rect().contains(axes));
                for (const QWidget* panel : b.view().findChildren<OverlayPanel*>())
                    QVERIFY(!panel->isVisible() || !panel->geometry().intersects(axes));
                QVERIFY(!b.view().messages().geometry().intersects(axes));
                b.view().messages().clear();
            }
            QVERIFY(!b.window->sections().viewport().findChild<AxesMark*>());
            b.window->resize(1280, 800);
            QVERIFY(b.settle() && b.axes().isVisible());
            b.action("axes")->trigger();
            QVERIFY(!b.axes().isVisible());
            QVERIFY(b.settle());
        }
        Bench again(settings);
        QVERIFY(again.begin());
        QVERIFY(!again.axes().isVisible() && !again.action("axes")->isChecked());
        again.action("axes")->trigger();
        QVERIFY(again.axes().isVisible());
    }

    void coordinatesAreRead_data()
    {
        QTest::addColumn<QString>("text");
        QTest::addColumn<QString>("locale");
        QTest::addColumn<QStringList>("numbers");
        const QString us = QStringLiteral("en_US"), de = QStringLiteral("de_DE");
        const auto row = [](const char* name, const QString& locale, const char* text, const QStringList& numbers) {
            QTest::newRow(name) << QString::fromUtf8(text) << locale << numbers;
        };
        const QStringList pair{QStringLiteral("637012.24"), QStringLiteral("851050.5")};
        const QStringList triple = pair + QStringList{QStringLiteral("-3")};
        row("semicolon", us, "637012.24;851050.5", pair);
        row("comma and blank", us, "637012.24, 851050.5", pair);
        row("comma alone", us, "637012.24,851050.5", pair);
        row("blank", us, "637012.24 851050.5", pair);
        row("tab", us, "637012.24\t851050.5\t-3", triple);
        row("lines", us, "637012.24\n851050.5\n", pair);
        row("brackets", us, "(637012.24, 851050.5, -3)", triple);
        row("groups", us, "637,012.24, 851,050.5", pair);
        row("German", de, "637012,24; 851050,5", pair);
        row("German, blank", de, "637.012,24 851.050,5", pair);
        row("German, of a program", de, "637012.24, 851050.5, -3", triple);
        row("one number", us, "637,012", {});
        row("one number in groups", us, "637 012", {});
        row("four numbers", us, "1.5, 2.5, 3.5, 4.5", {});
        row("words", us, "north, south", {});
        row("nothing", us, "", {});
        row("too large", us, "1e999, 2", {});
    }
    void coordinatesAreRead()
    {
        QFETCH(QString, text);
        QFETCH(QString, locale);
        QFETCH(QStringList, numbers);
        QStringList read;
        for (const NumberRead& number : readCoordinates(text, QLocale(locale))) read << number.plain;
        QCOMPARE(read, numbers);
    }

    void goesToACoordinate()
    {
        Bench b;
        QVERIFY(b.begin());
        QVERIFY(b.trigger("orthographic"));
        const double scale = b.camera().unitsPerPixel(b.size().y), height = b.camera().pivot.z;
        const WorldBounds all = b.document->bounds();
        const auto ask = [&]() -> GoToDialog* {
            b.action("goToCoordinate")->trigger();
            auto* const dialog = b.window->findChild<GoToDialog*>();
            return dialog && dialog->isVisible() ? dialog : nullptr;
        };
        const auto gone = [&] { return waitFor([&] { return !b.window->findChild<GoToDialog*>(); }, 5'000); };

        // Typed. The fields begin with where the view is.
        GoToDialog* dialog = ask();
        QVERIFY(dialog);
        QVERIFY(std::abs(*dialog->field(0).number() - b.camera().pivot.x) < 0.01);
        const double x = std::round(all.min.x + 10), y = std::round(all.min.y + 20), z = std::ceil(all.min.z) + 0.5;
        for (const auto& [axis, text] :
             {std::pair(0, QString::number(x, 'f', 0)), {1, QString::number(y, 'f', 0)}}) {
            dialog->field(axis).setFocus();
            dialog->field(axis).selectAll();
            QTest::keyClicks(&dialog->field(axis), text);
        }
        QTest::keyClick(&dialog->field(1), Qt::Key_Return);
        QVERIFY(gone() && b.settle());
        QVERIFY(b.camera().pivot == glm::dvec3(x, y, height));
        QVERIFY(std::abs(b.camera().unitsPerPixel(b.size().y) - scale) < 1e-9 * scale);
        const glm::dvec3 px = b.camera().project({x, y, height}, b.size());
        QVERIFY(glm::length(glm::dvec2(px) - b.size() / 2.0) < 1e-3);
        const auto* const mark = b.view().findChild<PivotMark*>();
        QVERIFY(mark->isVisible());
        QVERIFY(b.said().isEmpty());
        QVERIFY(waitFor([&] { return !mark->isVisible(); }, 10'000));

        // Pasted: three numbers into the first field.
        dialog = ask();
        QVERIFY(dialog);
        QApplication::clipboard()->setText(
            QStringLiteral("%1; %2; %3").arg(x + 5.25, 0, 'f', 2).arg(y + 1, 0, 'f', 2).arg(z, 0, 'f', 1));
        dialog->field(0).setFocus();
        dialog->field(0).selectAll();
        QTest::keyClick(&dialog->field(0), Qt::Key_V, Qt::ControlModifier);
        QCOMPARE(dialog->field(2).number().value_or(0), z);
        QCOMPARE(dialog->field(1).number().value_or(0), y + 1);
        dialog->go();
        QVERIFY(gone() && b.settle());
        QVERIFY(b.camera().pivot == glm::dvec3(x + 5.25, y + 1, z));
        QVERIFY(b.said().isEmpty());

        // What is no number is said, and nothing moves.
        const render::Camera before = b.camera();
        dialog = ask();
        QVERIFY(dialog);
        dialog->field(1).selectAll();
        QTest::keyClicks(&dialog->field(1), QStringLiteral("12x"));
        dialog->go();
        QVERIFY2(dialog->isVisible() && dialog->problem().startsWith(QStringLiteral("Y: ")),
                 qPrintable(dialog->problem()));
        dialog->field(1).selectAll();
        QTest::keyClicks(&dialog->field(1), QStringLiteral("1e200"));
        dialog->go();
        QVERIFY(dialog->isVisible() && !dialog->problem().isEmpty());
        QVERIFY(b.camera() == before);

        // Outside: there, all the same, with a sentence.
        dialog->field(1).selectAll();
        QTest::keyClicks(&dialog->field(1), QString::number(all.max.y + 5000, 'f', 1));
        dialog->go();
        QVERIFY(gone() && b.settle());
        QVERIFY(std::abs(b.camera().pivot.y - all.max.y - 5000) < 0.1);
        QCOMPARE(b.said().size(), 1);
        QVERIFY2(b.said().front().contains(QStringLiteral("outside")) &&
                     b.said().front().contains(QStringLiteral("5,000")),
                 qPrintable(b.said().front()));
    }

    void viewsAreSaved()
    {
        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("settings.ini"));
        const QString file = folder.filePath(QStringLiteral("file.las"));
        writeSample(file, 20'000);
        render::Camera first, second;
        {
            Bench b(settings);
            QVERIFY(b.open(file));
            b.view().messages().clear();
            b.view().setStandardView(QStringLiteral("top"));
            QVERIFY(b.settle());
            first = b.camera();
            // By the dialog, under the name that it proposes.
            b.action("saveView")->trigger();
            auto* const name = b.window->findChild<QInputDialog*>(QStringLiteral("viewName"));
            QVERIFY(name && name->isVisible());
            QCOMPARE(name->textValue(), QStringLiteral("View 1"));
            name->accept();
            QTest::keyClick(&b.view(), Qt::Key_Left);
            QVERIFY(b.trigger("orthographic"));
            second = b.camera();
            b.window->places().save(QStringLiteral("Gable"));
            QCOMPARE(b.window->places().views().size(), std::size_t(2));
            QVERIFY(b.trigger("savedView1"));
            QVERIFY(waitFor([&] { return b.camera().pitch == first.pitch && b.camera().orthographic; }, 5'000));
            // The camera that the command line can use.
            b.action("copyCamera")->trigger();
            const std::string text = QApplication::clipboard()->text().toStdString();
            const render::Camera read = render::readCamera(text, b.camera(), {}, b.size());
            QVERIFY(glm::length(read.eye - first.eye) < 1e-6 && read.orthographic);
            const QString written = folder.filePath(QStringLiteral("camera.json"));
            b.window->places().writeCamera(written);
            QVERIFY(b.settle());
            QVERIFY(glm::length(render::readCameraFile(toPath(written), b.camera(), {}, b.size()).eye - first.eye) <
                    1e-6);
            // A view that is not there is said.
            QVERIFY(b.trigger("savedView5"));
            QVERIFY2(b.said().size() == 1, qPrintable(b.said().join(QLatin1Char('|'))));
        }
        {
            Bench b(settings);
            QVERIFY(b.open(file));
            QVERIFY(b.trigger("savedView2"));
            QVERIFY(!b.camera().orthographic && std::abs(b.camera().yaw - second.yaw) < 1e-9);
            QVERIFY(glm::length(b.camera().eye - second.eye) < 1e-6);
            b.action("arrangeViews")->trigger();
            auto* const dialog = b.window->findChild<SavedViewsDialog*>();
            QVERIFY(dialog && dialog->list().topLevelItemCount() == 2);
            // a name that is taken is not
            dialog->list().setCurrentItem(dialog->list().topLevelItem(1));
            dialog->list().topLevelItem(1)->setText(0, QStringLiteral("View 1"));
            QVERIFY(!dialog->problem().isEmpty());
            QCOMPARE(dialog->list().topLevelItem(1)->text(0), QStringLiteral("Gable"));
            dialog->list().topLevelItem(1)->setText(0, QStringLiteral("West gable"));
            QVERIFY(
                waitFor([&] { return b.window->places().views()[1].name == QStringLiteral("West gable"); }, 5'000));
            bool asked = false;
            b.window->workspace().askQuestion = [&](const Question&, const std::function<void(bool)>& answer) {
                asked = true;
                answer(true);
            };
            dialog->list().setCurrentItem(dialog->list().topLevelItem(0));
            QTest::mouseClick(&dialog->removeButton(), Qt::LeftButton);
            QVERIFY(asked);
            QVERIFY(waitFor([&] { return dialog->list().topLevelItemCount() == 1; }, 5'000));
            QCOMPARE(dialog->list().topLevelItem(0)->text(0), QStringLiteral("West gable"));
            dialog->close();
            QVERIFY(b.settle());
        }
        // Another file has none of them.
        Bench b(settings);
        QVERIFY(b.begin());
        QVERIFY(b.window->places().views().empty());
        QVERIFY(b.open(file));
        QCOMPARE(b.window->places().views().size(), std::size_t(1));
    }

    /// Broken settings cost what is broken, and no more.
    void brokenSettingsAreLeftOut()
    {
        const QString good = QStringLiteral(R"({"file":"/a.las","views":[{"name":"n","camera":"{}"}]})");
        for (const QString& text :
             {QString(), QStringLiteral("["), QStringLiteral("[1, null, {}]"), QStringLiteral("{\"file\": 3}"),
              QStringLiteral(
                  R"([{"file":"/a.las","views":7},{"file":"/a.las","views":[{"name":5},{"camera":"x"}]}])")}) {
            QVERIFY(SavedViews::fromText(text).of({QStringLiteral("/a.las")}).empty());
        }
        const SavedViews some = SavedViews::fromText(QStringLiteral("[3,%1,%1,[]]").arg(good));
        QCOMPARE(some.of({QStringLiteral("/a.las")}).size(), std::size_t(1));
        QCOMPARE(SavedViews::fromText(some.text()).text(), some.text());

        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("settings.ini")),
                      file = folder.filePath(QStringLiteral("file.las"));
        writeSample(file, 5'000);
        SavedViews views;
        QVERIFY(views.add({file, QStringLiteral("broken"), QStringLiteral("{\"eye\": 1}")}));
        QSettings(settings, QSettings::IniFormat).setValue(QStringLiteral("view/saved"), views.text());
        Bench b(settings);
        QVERIFY(b.open(file));
        b.view().messages().clear();
        const render::Camera before = b.camera();
        QVERIFY(b.trigger("savedView1"));
        QVERIFY(b.camera() == before);
        QCOMPARE(b.said().size(), 1);
        QVERIFY2(b.said().front().contains(QStringLiteral("eye")), qPrintable(b.said().front()));
    }

    /// Jobs that write settings end in any order, or are not begun before the window is closed.
    void settingsAreWrittenLast()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath(QStringLiteral("settings.ini"));
        const auto kept = [&] { return WindowSettings(file).savedViews(); };
        std::vector<std::function<void()>> jobs;
        {
            WindowSettings settings(file, [&](std::function<void()> write) { jobs.push_back(std::move(write)); });
            settings.setSavedViews(QStringLiteral("first"));
            settings.setSavedViews(QStringLiteral("second"));
            QCOMPARE(jobs.size(), std::size_t(2));
            QVERIFY(kept().isEmpty());
            jobs[1]();
            QCOMPARE(kept(), QStringLiteral("second"));
            jobs[0]();
            QCOMPARE(kept(), QStringLiteral("second"));
            settings.setSavedViews(QStringLiteral("third"));
        }
        QCOMPARE(kept(), QStringLiteral("third"));
        jobs[2]();
        QCOMPARE(kept(), QStringLiteral("third"));
    }

    void savedViewsAreBounded()
    {
        SavedViews views;
        const QString file = QStringLiteral("/f.las");
        for (std::size_t k = 0; k < SavedViews::kMostOfFile; ++k)
            QVERIFY(views.add(savedView(file, QStringLiteral("same"))));
        QVERIFY(!views.add(savedView(file, QStringLiteral("one more"))));
        QCOMPARE(views.of({file})[2].name, QStringLiteral("same (3)"));
        for (std::size_t k = 0; k < SavedViews::kMostFiles + 3; ++k)
            QVERIFY(views.add(savedView(QStringLiteral("/%1.las").arg(k), QStringLiteral("v"))));
        QVERIFY(views.of({file}).empty());  // the oldest
        QCOMPARE(views.of({QStringLiteral("/5.las")}).size(), std::size_t(1));
        QVERIFY(views.text().size() < 200'000);
        const SavedViews::View view = savedView(QStringLiteral("/5.las"), QStringLiteral("v"));
        QVERIFY(!views.rename(view, QStringLiteral("  ")));
        QVERIFY(views.rename(view, QStringLiteral(" roof ")));
        QVERIFY(!views.remove(view));
        QVERIFY(views.remove(views.of({QStringLiteral("/5.las")}).front()));
        QVERIFY(views.of({QStringLiteral("/5.las")}).empty());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<NavigationTest>(); });
}
#include "NavigationTest.moc"
