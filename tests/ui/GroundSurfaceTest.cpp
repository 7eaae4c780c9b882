// SPDX-License-Identifier: MIT
// The ground surface in the window by real keys and clicks: it comes and goes, follows edits, and selects.
#include "SelectBench.h"

#include "core/surface/SurfaceHeights.h"
#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/store/PointStore.h"
#include "ui/surface/GroundSurface.h"
#include "ui/view/MessageArea.h"
#include "ui/view/ViewSettings.h"

#include <QAction>
#include <QDialog>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QTemporaryDir>

#include <mutex>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// Of any menu of the window.
QAction* actionNamed(QWidget& window, const QString& text)
{
    for (QAction* action : window.findChildren<QAction*>())
        if (QString(action->text()).remove(QLatin1Char('&')) == text) return action;
    return nullptr;
}

QMenu* menuNamed(QWidget& window, const QString& title)
{
    for (QMenu* menu : window.findChildren<QMenu*>())
        if (QString(menu->title()).remove(QLatin1Char('&')) == title) return menu;
    return nullptr;
}

/// Opens the menu and clicks the entry that begins so.
bool clickEntry(QMenu& menu, const QString& text)
{
    menu.popup(QPoint(0, 0));
    if (!QTest::qWaitForWindowExposed(&menu)) return false;
    for (QAction* action : menu.actions()) {
        if (!QString(action->text()).remove(QLatin1Char('&')).startsWith(text)) continue;
        QTest::mouseClick(&menu, Qt::LeftButton, {}, menu.actionGeometry(action).center());
        return true;
    }
    return false;
}

/// What the status bar says of the surface; empty while it is not shown.
QString stateOf(Bench& b)
{
    auto* const label = b.window->findChild<QLabel*>(QStringLiteral("groundState"));
    return label && label->isVisible() ? label->text() : QString();
}

/// The picture that the view is to show: all at once, of a surface that is made anew.
render::Image expected(Bench& b)
{
    const std::shared_ptr<const PointCloud> cloud = b.document->cloud();
    const auto store = std::make_shared<render::PointStore>(cloud, cloud->computeBounds());
    store->fillAll();
    render::ProgressiveRenderer renderer(render::makeBackend(render::BackendKind::Cpu));
    renderer.addCloud(store);
    renderer.loadingEnded(*cloud, cloud->computeBounds());
    renderer.setSize(b.view().pictureSize().width(), b.view().pictureSize().height());
    renderer.setCamera(b.view().camera());
    render::DisplaySettings display = b.window->viewSettings().display();
    display.pointSize *= b.ratio();
    renderer.setDisplay(display);
    renderer.setSelection(*cloud, b.points());
    Progress progress;
    if (b.window->ground().isOn()) {
        SurfaceSettings settings;
        settings.classes = b.window->ground().classes();
        renderer.setSurface(*cloud, Surface(cloud, settings, progress).view());
    }
    renderer.renderBruteForce();
    return renderer.image();
}

/// Share of the pixels that are not those, once the view has had time to come there. OpenGL rounds for itself.
constexpr double kRounding = 0.001;

bool showsWhatIsExpected(Bench& b)
{
    const render::Image wanted = expected(b);
    return waitFor([&] { return difference(b.frame()->image, wanted) < kRounding; }, 20'000);
}

}  // namespace

class GroundSurfaceTest : public QObject
{
    Q_OBJECT
private slots:
    void comesAndGoes();
    void followsAStroke();
    void hidesItsOwnPoints();
    void hasContours();
    void tellsThatItIsMade();
    void selectsByHeight();
    void measuresAVolume();
};

void GroundSurfaceTest::comesAndGoes()
{
    Bench b;
    QVERIFY(b.begin(Tool::None));
    GroundSurface& ground = b.window->ground();
    QVERIFY(!ground.surface(b.document));
    const auto before = b.frame();
    b.key(Qt::Key_G);
    QVERIFY(ground.isOn());
    QVERIFY(waitFor([&] { return ground.surface(b.document) && !ground.busy(); }));
    QVERIFY(b.settle());
    QVERIFY(waitFor([&] { return difference(before->image, b.frame()->image) > 0.001; }));
    QTest::keyClick(&b.view(), Qt::Key_G, Qt::ShiftModifier);  // points on top
    QVERIFY(b.settle());
    b.key(Qt::Key_G);
    QVERIFY(!ground.isOn());
    QVERIFY(b.settle());
    QVERIFY(waitFor([&] { return b.frame()->image == before->image; }));
}

void GroundSurfaceTest::followsAStroke()
{
    Bench b;
    QVERIFY(b.begin(Tool::None));
    GroundSurface& ground = b.window->ground();
    ground.setTinted(false);  // the range of tints stays as it was while somebody edits
    b.key(Qt::Key_G);
    QVERIFY(waitFor([&] { return ground.surface(b.document) && !ground.busy(); }));
    QVERIFY(b.settle());
    QVERIFY(showsWhatIsExpected(b));
    const auto before = b.frame();
    const std::uint64_t version = ground.surface(b.document)->view()->version;
    const std::size_t points = ground.surface(b.document)->groundPoints();
    b.key(Qt::Key_B);
    b.drag(b.at(0.3, 0.5), b.at(0.7, 0.5));
    QVERIFY(b.done());
    QVERIFY(b.selection().count() > 0);
    QVERIFY(b.runEdit([&] { b.key(Qt::Key_1); }));  // no ground any longer
    QVERIFY(waitFor([&] { return ground.surface(b.document)->view()->version > version && !ground.busy(); }));
    QVERIFY(ground.surface(b.document)->groundPoints() < points);
    QVERIFY(b.settle());
    QVERIFY(showsWhatIsExpected(b));
    b.selection().clear();
    QVERIFY(b.done());
    QVERIFY(showsWhatIsExpected(b));
    QVERIFY(difference(before->image, b.frame()->image) > 2 * kRounding);
    // undone, all is as it was
    b.window->workspace().undo(*b.document);
    QVERIFY(b.done());
    QVERIFY(waitFor([&] { return ground.surface(b.document)->groundPoints() == points && !ground.busy(); }));
    QVERIFY(b.settle());
    QVERIFY(waitFor([&] { return difference(before->image, b.frame()->image) == 0.0; }));
}

void GroundSurfaceTest::hidesItsOwnPoints()
{
    const QTemporaryDir folder;
    const QString settings = folder.filePath(QStringLiteral("settings.ini"));
    {
        Bench b(settings);
        QVERIFY(b.begin(Tool::None));
        GroundSurface& ground = b.window->ground();
        b.key(Qt::Key_G);
        QVERIFY(waitFor([&] { return ground.surface(b.document) && !ground.busy(); }));
        QVERIFY(b.settle());
        QVERIFY(showsWhatIsExpected(b));
        const auto hidden = b.frame();
        QAction* const choice = actionNamed(*b.window, QStringLiteral("Hide Its Own Points"));
        QVERIFY(choice && choice->isChecked());
        choice->trigger();
        QVERIFY(b.settle());
        QVERIFY(showsWhatIsExpected(b));
        QVERIFY(difference(hidden->image, b.frame()->image) > 0.01);
        b.window->close();
    }
    Bench again(settings);
    QAction* const choice = actionNamed(*again.window, QStringLiteral("Hide Its Own Points"));
    QVERIFY(choice && !choice->isChecked());
    choice->trigger();
    QVERIFY(again.window->viewSettings().groundReplaced());
}

void GroundSurfaceTest::hasContours()
{
    const QTemporaryDir folder;
    const QString settings = folder.filePath(QStringLiteral("settings.ini"));
    {
        Bench b(settings);
        QVERIFY(b.begin(Tool::None));
        GroundSurface& ground = b.window->ground();
        QMenu* const menu = menuNamed(*b.window, QStringLiteral("Contours"));
        QVERIFY(menu);
        // contours bring the surface
        QVERIFY(clickEntry(*menu, QStringLiteral("Automatic")));
        QVERIFY(ground.isOn());
        QVERIFY(waitFor([&] { return ground.surface(b.document) && !ground.busy(); }));
        QVERIFY(b.settle());
        const auto view = ground.surface(b.document)->view();
        const double range = (view->high - view->low) * b.document->cloud()->coordinates().scale.z;
        const double suitable = render::suitableInterval(range);
        QVERIFY(suitable > 0);
        QCOMPARE(b.window->viewSettings().display().contours.interval, suitable);
        QVERIFY2(stateOf(b).startsWith(QStringLiteral("Contours every ")), qPrintable(stateOf(b)));
        QVERIFY(showsWhatIsExpected(b));
        const auto automatic = b.frame();

        QVERIFY(clickEntry(*menu, QStringLiteral("None")));
        QVERIFY(ground.isOn());
        QVERIFY(stateOf(b).isEmpty());
        QVERIFY(b.settle());
        QVERIFY(showsWhatIsExpected(b));
        QVERIFY(waitFor([&] { return difference(automatic->image, b.frame()->image) > kRounding; }));

        QVERIFY(clickEntry(*menu, QStringLiteral("5")));
        QCOMPARE(b.window->viewSettings().display().contours.interval, 5.0);
        QVERIFY2(stateOf(b).startsWith(QStringLiteral("Contours every 5")), qPrintable(stateOf(b)));
        QVERIFY(b.settle());
        QVERIFY(showsWhatIsExpected(b));
        b.key(Qt::Key_G);
        QVERIFY(stateOf(b).isEmpty());
        b.window->close();
    }
    Bench again(settings);
    QCOMPARE(again.window->viewSettings().display().contours.interval, 5.0);
    QMenu* const menu = menuNamed(*again.window, QStringLiteral("Contours"));
    const auto checked = [&] {
        QStringList texts;
        for (const QAction* action : menu->actions())
            if (action->isChecked()) texts << action->text();
        return texts.join(QLatin1Char(' '));
    };
    QVERIFY2(checked().startsWith(QLatin1Char('5')), qPrintable(checked()));
}

/// While the surface is made the status bar tells so, and where that is cancelled, nothing says that it is shown.
void GroundSurfaceTest::tellsThatItIsMade()
{
    Bench b;
    QVERIFY(b.begin(Tool::None));
    GroundSurface& ground = b.window->ground();
    QAction* const show = actionNamed(*b.window, QStringLiteral("Show Ground Surface"));
    QVERIFY(show && !show->isChecked() && stateOf(b).isEmpty());
    const auto cancel = [&] {
        for (const JobInfo& job : b.window->workspace().jobs().running())
            if (job.title == "Ground surface") b.window->workspace().cancel(job.id);
    };
    {
        // it cannot be made while this is held
        const std::unique_lock lock(b.document->cloud()->mutex());
        b.key(Qt::Key_G);
        QVERIFY(show->isChecked());
        QCOMPARE(stateOf(b), QStringLiteral("Making the ground surface: 0 %"));
        cancel();
    }
    QVERIFY(waitFor([&] { return !ground.busy(); }));
    QVERIFY(!ground.surface(b.document));
    QVERIFY(!ground.isOn() && !show->isChecked());
    QVERIFY(stateOf(b).isEmpty());
    QVERIFY(b.window->viewSettings().display().surface == render::SurfaceLook::None);

    b.key(Qt::Key_G);
    QVERIFY(waitFor([&] { return ground.surface(b.document) && !ground.busy(); }));
    QVERIFY(ground.isOn() && show->isChecked());
    QVERIFY(stateOf(b).isEmpty());
}

void GroundSurfaceTest::selectsByHeight()
{
    Bench b;
    QVERIFY(b.begin(Tool::None));
    QAction* const action = actionNamed(*b.window, QStringLiteral("Select by Height above It..."));
    QVERIFY(action && action->isEnabled());
    action->trigger();
    auto* const dialog = b.window->findChild<QDialog*>(QStringLiteral("selectBySurface"));
    QVERIFY(dialog);
    QVERIFY(QTest::qWaitForWindowExposed(dialog));
    const auto buttonNamed = [&](const QString& text) -> QPushButton* {
        for (QPushButton* button : dialog->findChildren<QPushButton*>())
            if (QString(button->text()).remove(QLatin1Char('&')) == text) return button;
        return nullptr;
    };
    auto* const field = dialog->findChild<QDoubleSpinBox*>();
    QVERIFY(field);
    field->setValue(2.5);
    QTest::mouseClick(buttonNamed(QStringLiteral("Above")), Qt::LeftButton);
    QVERIFY(b.done());

    Progress progress;
    const Surface surface(b.document->cloud(), {}, progress);
    PointSet all(b.document->points());
    all.invert();
    const auto expected = [&](double low, double high) {
        return surface.withTiles([&](const SurfaceTiles& tiles) {
            return pointsBetween(tiles, *b.document->cloud(), all, low, high, progress).count();
        });
    };
    QVERIFY(b.selection().count() > 100);
    QCOMPARE(b.selection().count(), expected(2.5000001, 1e9));
    QTest::mouseClick(buttonNamed(QStringLiteral("Near")), Qt::LeftButton);
    QVERIFY(b.done());
    QCOMPARE(b.selection().count(), expected(-2.5, 2.5));
    const PointIndex close = b.selection().count();
    QTest::mouseClick(buttonNamed(QStringLiteral("Below")), Qt::LeftButton);
    QVERIFY(b.done());
    QVERIFY(b.selection().count() < close);
    dialog->close();
}

void GroundSurfaceTest::measuresAVolume()
{
    Bench b;
    QVERIFY(b.begin(Tool::None));
    QString told;
    connect(&b.window->workspace(), &Workspace::message, this,
            [&told](MessageKind, const QString& text) { told = text; });
    b.window->ground().measureVolume(400.0);
    QVERIFY(waitFor([&] { return !told.isEmpty(); }));
    QVERIFY2(told.contains(QStringLiteral("cut")) && told.contains(QStringLiteral("fill 0")), qPrintable(told));
}

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<GroundSurfaceTest>(); });
}
#include "GroundSurfaceTest.moc"
