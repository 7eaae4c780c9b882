// SPDX-License-Identifier: MIT
#include "tests/ui/UiTest.h"

#include "core/task/Progress.h"
#include "ui/document/Workspace.h"
#include "ui/view/SharedContext.h"
#include "ui/view/Still.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/ViewSurface.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainWindow.h"

#include <QOpenGLWidget>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>

#include <optional>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;
using render::BackendKind;

/// Pictures that OpenGL draws are shown where they are, in a window with OpenGL.
class ViewTextureTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void initTestCase();
    void picturesAreShownFromTheDevice_data();
    void picturesAreShownFromTheDevice();
    void withoutSharingPicturesAreCopied();

private:
    /// What the OpenGL widget shows.
    static QImage shown(TestWindow& window);
    /// The finished picture, as a screenshot has it: drawn by the processor.
    static QImage captured(TestWindow& window);
    /// Whether they differ in a hundredth of the pixels at most, as pictures of different backends do.
    static bool alike(const QImage& a, const QImage& b);

    QTemporaryDir m_folder;
    QString m_file;
    QString m_missing;  ///< why there are no shared pictures here; empty: there are
};

void ViewTextureTest::initTestCase()
{
    m_file = m_folder.filePath("cloud.las");
    writeSample(m_file, 60'000);
    if (!openGlWidgetsWork(true))
        m_missing = "This platform shows no OpenGL in windows.";
    else
        SharedContext::create(m_missing);
}

QImage ViewTextureTest::shown(TestWindow& window)
{
    auto* const widget = window.window->viewport().findChild<QOpenGLWidget*>();
    return widget ? widget->grabFramebuffer().convertToFormat(QImage::Format_RGBA8888) : QImage();
}

QImage ViewTextureTest::captured(TestWindow& window)
{
    Viewport& view = window.window->viewport();
    const QSize size = view.pictureSize();
    const auto still = std::make_shared<Still>(
        StillRequest{size.width(), size.height(), view.camera(), view.displayFor(view.pixelRatio())});
    window.window->renderer().draw(still);
    std::shared_ptr<const render::Image> image;
    window.window->workspace().startJob(QStringLiteral("Picture"), [&image, still](Progress& progress) {
        image = std::make_shared<render::Image>(still->wait(progress).image);
    });
    if (!waitFor([&] { return !window.window->workspace().busy(); }) || !image) return {};
    return QImage(reinterpret_cast<const uchar*>(image->pixels.data()), image->width, image->height,
                  image->width * 4, QImage::Format_RGBA8888)
        .copy();
}

bool ViewTextureTest::alike(const QImage& a, const QImage& b)
{
    if (a.size() != b.size()) return false;
    int off = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) off += std::abs(qGreen(a.pixel(x, y)) - qGreen(b.pixel(x, y))) > 3;
    return off < a.width() * a.height() / 100;
}

void ViewTextureTest::picturesAreShownFromTheDevice_data()
{
    QTest::addColumn<BackendKind>("kind");
    QTest::newRow("gl-compute") << BackendKind::GlCompute;
    QTest::newRow("gl-points") << BackendKind::GlPoints;
}

// Frames are textures; what the widget shows is the picture that a screenshot has, in motion and still, after the
// size and after the backend changed; and a click finds the same point as with the processor.
void ViewTextureTest::picturesAreShownFromTheDevice()
{
    QFETCH(BackendKind, kind);
    if (!m_missing.isEmpty()) QSKIP(qPrintable(m_missing));
    TestWindow window(ViewKind::OpenGl);
    QVERIFY(window.window->viewport().usesOpenGl());
    window.window->viewSettings().setEyeDome(1.0);
    QVERIFY(window.open(m_file));
    QVERIFY(window.settle());
    QVERIFY(!window.frame()->texture);  // the processor draws
    const auto pickedAt = [&](int x, int y) {
        std::optional<PickedPoint> point;
        bool answered = false;
        window.window->renderer().pick(x, y, window.window.get(), [&](const std::optional<PickedPoint>& found) {
            point = found;
            answered = true;
        });
        return waitFor([&] { return answered; }) && point ? std::optional(point->index) : std::nullopt;
    };
    const QSize size = window.window->viewport().pictureSize();
    std::vector<std::optional<PointIndex>> expected;
    for (int k = 1; k < 6; ++k) expected.push_back(pickedAt(size.width() * k / 6, size.height() / 2));
    const QImage byProcessor = captured(window);

    window.window->renderer().setBackend(kind);
    QVERIFY(waitFor([&] { return window.frame() && window.frame()->texture; }));
    QVERIFY(window.settle());
    QVERIFY(window.frame()->image.pixels.empty());
    QCOMPARE(QSize(window.frame()->texture->width(), window.frame()->texture->height()), size);
    int same = 0;
    for (int k = 1; k < 6; ++k)
        same += pickedAt(size.width() * k / 6, size.height() / 2) == expected[std::size_t(k - 1)];
    QVERIFY(same >= 4);  // one may be a neighbor, by the last bit of a float
    const QImage picture = captured(window);
    QCOMPARE(picture.size(), byProcessor.size());
    QVERIFY(picture == byProcessor);
    QVERIFY(waitFor([&] { return alike(shown(window), picture); }));

    // in motion, and at another size
    for (int k = 0; k < 4; ++k) {
        render::Camera camera = window.window->viewport().camera();
        camera.orbit(0.05, 0.01);
        window.window->viewport().setCamera(camera);
        const auto before = window.frame()->number;
        QVERIFY(waitFor([&] { return window.frame()->number > before; }));
        QVERIFY(window.frame()->texture);
    }
    window.window->resize(1000, 640);
    QVERIFY(waitFor([&] {
        return window.frame()->texture &&
               window.frame()->texture->width() == window.window->viewport().pictureSize().width();
    }));
    QVERIFY(window.settle());
    const QImage smaller = captured(window);
    QVERIFY(waitFor([&] { return alike(shown(window), smaller); }));
    window.window->renderer().setBackend(BackendKind::Cpu);
    QVERIFY(waitFor([&] { return !window.frame()->texture; }));
    QVERIFY(window.settle());
}

// A view that cannot share says so where it says what draws, and shows what it draws all the same.
void ViewTextureTest::withoutSharingPicturesAreCopied()
{
    ViewRenderer renderer(BackendKind::GlCompute, {}, nullptr, nullptr, "Nothing is shared.");
    QSignalSpy changes(&renderer, &ViewRenderer::backendChanged);
    renderer.setSize(64, 48);
    QTRY_VERIFY(!changes.isEmpty());
    if (changes.last().at(0).value<BackendKind>() == BackendKind::Cpu) QSKIP("This machine has no OpenGL.");
    QVERIFY(changes.last().at(1).toString().contains("Nothing is shared."));
    QTRY_VERIFY(renderer.frame() && renderer.frame()->image.width == 64);
    QVERIFY(!renderer.frame()->texture);
}

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<ViewTextureTest>(); });
}
#include "ViewTextureTest.moc"
