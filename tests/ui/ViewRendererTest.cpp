// SPDX-License-Identifier: MIT
#include "ui/ViewRenderer.h"

#include "core/Error.h"
#include "render/gl/EglContext.h"
#include "tests/render/SyntheticCloud.h"

#include <QSignalSpy>
#include <QtTest>

using namespace punctum;
using namespace punctum::ui;
using render::BackendKind;

/// The render thread without a window: which backend draws, and what happens when one fails.
class ViewRendererTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void initTestCase();
    void theFastestIsMeasuredOnce();
    void backendsChangeWhileDrawing();
    void theCpuGoesOnWhenOpenGlFails();

private:
    bool m_haveGl = false;
};

namespace
{

/// A renderer that shows a cloud, and what it has said.
struct View {
    ViewRenderer renderer;
    QSignalSpy failures{&renderer, &ViewRenderer::failed};
    QSignalSpy changes{&renderer, &ViewRenderer::backendChanged};
    QSignalSpy measured{&renderer, &ViewRenderer::backendsMeasured};
    std::shared_ptr<PointCloud> cloud = test::makeCloud(100'000);

    explicit View(std::optional<BackendKind> kind, const FastestBackend& fastest = {}) : renderer(kind, fastest)
    {
        const RawBounds bounds = cloud->computeBounds();
        const auto store = std::make_shared<render::PointStore>(cloud, bounds);
        store->fillAll();
        renderer.addCloud(store);
        renderer.loadingEnded(cloud, bounds);
        resize(400, 300);
    }
    void resize(int width, int height)
    {
        render::Camera camera;
        camera.fit(cloud->coordinates().toWorld(cloud->computeBounds()), {width, height});
        renderer.setSize(width, height);
        renderer.setCamera(camera);
    }
    /// Whether a finished picture of this width has come.
    bool shows(int width) const
    {
        const auto frame = renderer.frame();
        return frame && frame->image.width == width && frame->report.converged;
    }
    BackendKind kind() const
    {
        return changes.isEmpty() ? BackendKind::Cpu : changes.last().at(0).value<BackendKind>();
    }
};

}  // namespace

void ViewRendererTest::initTestCase()
{
    try {
        render::EglContext::create();
        m_haveGl = true;
    } catch (const Error& e) {
        qInfo("%s", e.what());
    }
}

void ViewRendererTest::theFastestIsMeasuredOnce()
{
    View view(std::nullopt);
    QTRY_VERIFY(view.shows(400));
    QVERIFY(view.measured.isEmpty());  // not before the picture
    QTRY_VERIFY_WITH_TIMEOUT(!view.measured.isEmpty(), 60'000);
    const auto fastest = view.measured.first().at(0).value<FastestBackend>();
    QVERIFY(fastest.device);
    QCOMPARE(m_haveGl, !fastest.device->empty());
    QTRY_COMPARE(view.kind(), fastest.kind);
    QTRY_VERIFY(view.shows(400));
    QVERIFY(view.failures.isEmpty());
}

void ViewRendererTest::backendsChangeWhileDrawing()
{
    if (!m_haveGl) QSKIP("This machine has no OpenGL.");
    View view(BackendKind::Cpu);
    for (const auto kind :
         {BackendKind::GlCompute, BackendKind::GlPoints, BackendKind::GlCompute, BackendKind::Cpu}) {
        view.renderer.setBackend(kind);
        QTRY_COMPARE(view.kind(), kind);
        view.resize(view.kind() == BackendKind::Cpu ? 300 : 350 + int(kind), 200);
        QTRY_VERIFY(view.shows(view.kind() == BackendKind::Cpu ? 300 : 350 + int(kind)));
    }
    QVERIFY(view.failures.isEmpty());
}

// A picture that is wider than what OpenGL can draw.
void ViewRendererTest::theCpuGoesOnWhenOpenGlFails()
{
    if (!m_haveGl) QSKIP("This machine has no OpenGL.");
    for (const auto kind : {BackendKind::GlCompute, BackendKind::GlPoints}) {
        View view(kind);
        QTRY_VERIFY(view.shows(400));
        QCOMPARE(view.kind(), kind);
        view.resize(100'000, 8);
        QTRY_COMPARE(view.kind(), BackendKind::Cpu);
        QTRY_VERIFY(view.shows(100'000));
        QCOMPARE(view.failures.size(), 1);
        const QString sentence = view.failures.first().first().toString();
        QVERIFY2(sentence.contains("CPU") && sentence.endsWith('.'), qPrintable(sentence));
    }
}

QTEST_GUILESS_MAIN(ViewRendererTest)
#include "ViewRendererTest.moc"
