// SPDX-License-Identifier: MIT
#include "UiTest.h"

#include "core/las/Writer.h"
#include "core/sample/Sample.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/style/Theme.h"
#include "ui/view/Viewport.h"

#include <QApplication>
#include <QDir>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QElapsedTimer>
#include <QFileInfo>
#include <QMimeData>
#include <QTimer>
#include <QUrl>
#include <QVariantAnimation>
#include <QWindow>

#include <csignal>

namespace punctum::ui::test
{

int runUiTest(int argc, char** argv, const std::function<std::unique_ptr<QObject>()>& make)
{
    if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM") && qEnvironmentVariableIsEmpty("DISPLAY"))
        qputenv("QT_QPA_PLATFORM", "offscreen");
    std::signal(SIGXFSZ, SIG_IGN);  // as the program does: a limit on files is an error of write()
    QCoreApplication::setAttribute(Qt::AA_ShareOpenGLContexts);  // as the program does
    QApplication application(argc, argv);
    applyTheme(application, Appearance::Dark);
    QTEST_SET_MAIN_SOURCE_PATH
    const auto test = make();
    return QTest::qExec(test.get(), argc, argv);
}

QString dataFile(const QString& name)
{
    const QString path = QDir::cleanPath(QStringLiteral(PUNCTUM_TEST_DATA "/") + name);
    return QFileInfo::exists(path) ? path : QString();
}

bool waitFor(const std::function<bool()>& done, int timeoutMs)
{
    return QTest::qWaitFor(done, timeoutMs);
}

TestWindow::TestWindow(ViewKind view, const QString& settings)
{
    WindowOptions options;
    options.settingsFile = settings.isEmpty() ? folder.filePath(QStringLiteral("settings.ini")) : settings;
    options.backend = render::BackendKind::Cpu;
    options.view = view;
    window = std::make_unique<MainWindow>(options);
    window->resize(1280, 800);
    window->show();
    if (!QTest::qWaitForWindowExposed(window.get())) qWarning("The window was not shown.");
}

bool TestWindow::settle(const QString& attribute, int timeoutMs)
{
    // A picture of few points may be finished while the camera still flies.
    const auto* const flight =
        window->viewport().findChild<QVariantAnimation*>(QString(), Qt::FindDirectChildrenOnly);
    const auto settled = [&] {
        const auto now = frame();
        return now && !(flight && flight->state() == QAbstractAnimation::Running) && now->report.converged &&
               now->camera == window->viewport().camera() && !window->workspace().busy() &&
               !window->workspace().opening() && (attribute.isEmpty() || now->attribute == attribute);
    };
    if (!waitFor(settled, timeoutMs)) return false;
    const Document* const active = window->workspace().active();
    if (active == nullptr) return true;
    // The render thread may not know yet that loading has ended, by which points get their final size: it tells
    // what is to be seen when it has heard all that was said before, and has drawn it.
    const auto drawn = std::make_shared<bool>(false);
    window->renderer().snapshot(active->cloud(), window.get(),
                                [drawn](const std::shared_ptr<const ViewSnapshot>&) { *drawn = true; });
    return waitFor([&] { return *drawn && settled(); }, timeoutMs);
}

Document* TestWindow::open(const QString& path)
{
    window->openFiles({path});
    if (!settle()) return nullptr;
    return window->workspace().active();
}

Document* TestWindow::openSample(std::uint64_t points)
{
    const QString path = folder.filePath(QStringLiteral("sample.las"));
    writeSample(path, points);
    return open(path);
}

void TestWindow::dropFiles(const QStringList& paths)
{
    QMimeData mime;
    QList<QUrl> urls;
    for (const QString& path : paths) urls << QUrl::fromLocalFile(path);
    mime.setUrls(urls);
    drop(mime);
}

void TestWindow::drop(const QMimeData& mime, const std::function<void()>& over)
{
    Viewport& view = window->viewport();
    const QPoint middle = view.rect().center();
    QDragEnterEvent enter(middle, Qt::CopyAction, &mime, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &enter);
    QVERIFY(enter.isAccepted());
    if (over) over();
    QDropEvent dropped(middle, Qt::CopyAction, &mime, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &dropped);
    QVERIFY(dropped.isAccepted());
}

void dragWithMouse(QWidget& from, QPoint start, QWidget& to, QPoint end)
{
    QWindow* window = from.window()->windowHandle();
    const QPoint a = from.mapTo(from.window(), start);
    const QPoint b = to.mapTo(to.window(), end);
    constexpr int kSteps = 12;
    constexpr int kPause = 20;  // ms
    // A drag of an item runs an event loop of its own inside a mouse move: what follows must be on its way by then,
    // each by a timer of its own, because a timer does not fire inside its own signal.
    bool over = false;
    QObject guard;
    for (int step = 1; step <= kSteps; ++step)
        QTimer::singleShot(step * kPause, &guard, [=] { QTest::mouseMove(window, a + (b - a) * step / kSteps); });
    QTimer::singleShot((kSteps + 2) * kPause, &guard,
                       [=] { QTest::mouseRelease(window, Qt::LeftButton, Qt::NoModifier, b); });
    QTimer::singleShot((kSteps + 4) * kPause, &guard, [&] { over = true; });
    QTest::mousePress(window, Qt::LeftButton, Qt::NoModifier, a);
    waitFor([&] { return over; }, 20000);
}

double difference(const render::Image& a, const render::Image& b)
{
    if (a.width != b.width || a.height != b.height || a.pixels.empty()) return 1.0;
    std::size_t unlike = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) unlike += a.pixels[i] == b.pixels[i] ? 0 : 1;
    return double(unlike) / double(a.pixels.size());
}

void writeSample(const QString& path, std::uint64_t points)
{
    Progress progress;
    const auto cloud = makeSample(points, 7, progress);
    las::WriteOptions options;
    options.compressed = las::isCompressedName(toPath(path));
    options.verify = false;
    las::write(*cloud, toPath(path), options, progress);
}

}  // namespace punctum::ui::test
