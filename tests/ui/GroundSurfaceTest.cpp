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
#include <QMenuBar>
#include <QPushButton>
#include <QTemporaryDir>

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
