// SPDX-License-Identifier: MIT
#include "ui/view/ViewRenderer.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/gl/EglContext.h"
#include "render/store/Arrangement.h"
#include "tests/render/SyntheticCloud.h"
#include "ui/view/Still.h"

#include <QSignalSpy>
#include <QTest>

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
    void viewsBesideEachOther_data();
    void viewsBesideEachOther();
    void stillsBesideTheView();

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
    std::shared_ptr<render::PointStore> store;

    explicit View(std::optional<BackendKind> kind, const FastestBackend& fastest = {}) : renderer(kind, fastest)
    {
        const RawBounds bounds = cloud->computeBounds();
        store = std::make_shared<render::PointStore>(cloud, bounds);
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

void ViewRendererTest::viewsBesideEachOther_data()
{
    QTest::addColumn<BackendKind>("kind");
    for (const BackendKind kind : render::kBackendKinds) QTest::addRow("%s", nameOf(kind).data()) << kind;
}

// Two views of one store: whatever is told, both become what a renderer with a store of its own draws at once.
// Pictures of devices are not compared, as they may differ by single pixels.
void ViewRendererTest::viewsBesideEachOther()
{
    QFETCH(BackendKind, kind);
    if (render::needsGl(kind) && !m_haveGl) QSKIP("This machine has no OpenGL.");
    View view(kind);
    ViewRenderer other(view.renderer);
    const WorldBounds box = view.cloud->coordinates().toWorld(view.cloud->computeBounds());
    render::DisplaySettings display, cut;
    render::Camera top, side;
    top.setView("top");
    top.fit(box, {400, 300});
    side.setView("front");
    side.orthographic = true;
    side.fit(box, {300, 200});
    const auto send = [&] {
        cut = display;
        const double middle = (box.min.y + box.max.y) / 2, width = (box.max.y - box.min.y) / 5;
        cut.clip.planes = {{{0, 1, 0}, middle - width}, {{0, -1, 0}, -middle - width}};
        view.renderer.setDisplay(display);
        other.setDisplay(cut);
    };
    view.renderer.setCamera(top);
    other.setCamera(side);
    other.setSize(300, 200);
    send();
    QTRY_VERIFY(view.shows(400));
    QVERIFY(!other.frame());  // it is off
    other.setOn(true);

    std::shared_ptr<const PointSet> selected, hidden;
    bool arranged = false;
    const auto arrangementOf = [&](const render::PointStore& store) {
        Progress progress;
        return store.arrangement(view.cloud->computeBounds(), progress, -1e9);  // whatever it is worth
    };
    const auto expected = [&](const render::Camera& camera, const render::DisplaySettings& settings, int w, int h) {
        render::ProgressiveRenderer renderer(render::makeBackend(BackendKind::Cpu));
        const auto store = std::make_shared<render::PointStore>(view.cloud, view.cloud->computeBounds());
        store->fillAll();
        if (arranged) store->arrange(std::move(*arrangementOf(*store)));
        renderer.addCloud(store);
        renderer.setSize(w, h);
        renderer.setCamera(camera);
        renderer.setDisplay(settings);
        if (selected) renderer.setSelection(*view.cloud, selected);
        if (hidden) renderer.hide(*view.cloud, hidden.get());
        while (!renderer.renderFrame(1.0).converged) {
        }
        return renderer.image();
    };
    const auto both = [&](const char* what) {
        const render::Image first = expected(top, display, 400, 300), second = expected(side, cut, 300, 200);
        const auto same = [&] {
            const auto a = view.renderer.frame(), b = other.frame();
            return a && b && a->report.converged && b->report.converged && b->image == second &&
                   (kind != BackendKind::Cpu || a->image == first);
        };
        return QTest::qWaitFor(same, 20'000) ? QByteArray() : QByteArray(what);
    };
    const auto reclassify = [&](std::uint8_t from, std::uint8_t to) {
        const std::unique_lock lock(view.cloud->mutex());
        const auto points = test::reclassify(*view.cloud, from, to);
        view.renderer.valuesChanged(view.cloud, {ChangeNotice::Kind::Values, {"Classification"}, points});
    };
    QCOMPARE(both("at first"), QByteArray());
    for (const char* attribute : {"Z", "Classification", "Intensity"}) {
        display.attribute = attribute;
        send();
        QCOMPARE(both(attribute), QByteArray());
    }
    selected = std::make_shared<PointSet>(view.cloud->size());
    for (PointIndex i = 0; i < view.cloud->size(); i += 3) std::const_pointer_cast<PointSet>(selected)->insert(i);
    view.renderer.setSelection(view.cloud, selected);
    QCOMPARE(both("selection"), QByteArray());
    hidden = std::make_shared<PointSet>(view.cloud->size());
    for (PointIndex i = 0; i < view.cloud->size(); i += 5) std::const_pointer_cast<PointSet>(hidden)->insert(i);
    view.renderer.hide(view.cloud, hidden);
    QCOMPARE(both("hidden"), QByteArray());
    std::shared_ptr<render::Arrangement> made = arrangementOf(*view.store);
    QVERIFY(made);
    view.renderer.arrange(view.cloud, made);
    arranged = true;
    QCOMPARE(both("in other slots"), QByteArray());
    QVERIFY(view.store->arranged());
    hidden = nullptr;
    view.renderer.hide(view.cloud, nullptr);
    QCOMPARE(both("shown again"), QByteArray());
    display.classVisible[6] = false;
    send();
    QCOMPARE(both("class hidden"), QByteArray());
    display.attribute = "Classification";
    send();
    reclassify(2, 9);
    QCOMPARE(both("ground is water"), QByteArray());
    reclassify(9, 6);
    QCOMPARE(both("water is of the hidden class"), QByteArray());
    reclassify(6, 2);
    QCOMPARE(both("all is ground"), QByteArray());

    // off and on again it shows the same
    const auto before = other.frame();
    other.setOn(false);
    QVERIFY(!other.frame());
    bool answered = false;
    other.pick(150, 100, &other, [&](const std::optional<PickedPoint>& point) { answered = !point; });
    QTRY_VERIFY(answered);
    other.setOn(true);
    QTRY_VERIFY(other.frame() && other.frame()->report.converged && other.frame()->image == before->image);
    std::optional<PickedPoint> picked;
    other.pick(150, 100, &other, [&](const std::optional<PickedPoint>& point) { picked = point; });
    QTRY_VERIFY(picked);
    QVERIFY(std::abs(picked->world.y - (box.min.y + box.max.y) / 2) <= (box.max.y - box.min.y) / 5 + 1e-6);

    // what was chosen meanwhile is not undone for a moment: all words would be made anew
    other.setOn(false);
    display.attribute = "Z";
    send();
    QTRY_COMPARE(view.renderer.frame()->attribute, QStringLiteral("Z"));
    const auto encoder = view.store->encoder();
    other.setOn(true);
    QCOMPARE(both("chosen while it was off"), QByteArray());
    QCOMPARE(view.store->encoder(), encoder);

    // what fails beside it does not touch the first view
    QVERIFY(view.failures.isEmpty());
    const BackendKind drawsWith = view.kind();
    other.setSize(100'000, 100'000);
    QTRY_COMPARE(view.failures.size(), 1);
    QVERIFY(view.failures.front().front().toString().startsWith(QStringLiteral("The section is not drawn: ")));
    QCOMPARE(view.kind(), drawsWith);
    other.setSize(300, 200);
    QCOMPARE(both("after a failure"), QByteArray());
}

/// A still is the picture that the view would show, drawn beside it; it follows edits, and is refused where it
/// would be half of one thing and half of another.
void ViewRendererTest::stillsBesideTheView()
{
    View view(BackendKind::Cpu);
    render::DisplaySettings display;
    display.attribute = "Classification";
    view.renderer.setDisplay(display);
    const auto shows = [&] {
        return view.shows(400) && view.renderer.frame()->attribute == QStringLiteral("Classification");
    };
    QTRY_VERIFY(shows());
    const auto shown = view.renderer.frame();
    const auto still = [&](int width, int height) {
        auto made = std::make_shared<Still>(StillRequest{width, height, shown->camera, display});
        view.renderer.draw(made);
        return made;
    };
    Progress progress;
    const StillPicture same = still(400, 300)->wait(progress);
    QVERIFY(same.image == shown->image);
    QCOMPARE(same.attribute, shown->attribute);
    QCOMPARE(view.renderer.frame()->number, shown->number);  // the view has drawn nothing for it

    // Points are hidden while it is drawn: none of them is in it.
    const auto large = still(4000, 3000);
    const auto all = std::make_shared<PointSet>(view.cloud->size());
    all->invert();
    view.renderer.hide(view.cloud, all);
    const StillPicture empty = large->wait(progress);
    QCOMPARE(empty.image.width, 4000);
    const render::Rgba8 corner = empty.image.pixels.front();
    QVERIFY(std::all_of(empty.image.pixels.begin(), empty.image.pixels.begin() + 4000,
                        [&](render::Rgba8 c) { return c == corner; }));
    QVERIFY(empty.image.pixels[std::size_t(1500) * 4000 + 2000] != same.image.pixels[std::size_t(150) * 400 + 200]);
    view.renderer.hide(view.cloud, nullptr);
    QTRY_VERIFY(view.renderer.frame()->image == shown->image);

    // Two wait for their turn: one is cancelled, the other refused since the stores show another attribute now.
    const auto first = still(6000, 6000), second = still(6000, 6000);
    Progress cancelled;
    cancelled.cancel();
    QVERIFY_EXCEPTION_THROWN(first->wait(cancelled), Cancelled);
    display.attribute = "Z";
    view.renderer.setDisplay(display);
    QVERIFY_EXCEPTION_THROWN(second->wait(progress), Error);
    QTRY_COMPARE(view.renderer.frame()->attribute, QStringLiteral("Z"));
    QVERIFY(view.failures.isEmpty());
}

QTEST_GUILESS_MAIN(ViewRendererTest)
#include "ViewRendererTest.moc"
