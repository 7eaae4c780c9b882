// SPDX-License-Identifier: MIT
// GlBackendChecks: what is done to a picture as a whole, and that it stays on the device.
#include "core/task/Progress.h"
#include "render/gl/GlObjects.h"
#include "tests/render/AverageChecks.h"
#include "tests/render/GlBackendChecks.h"
#include "tests/render/GlPictures.h"

#include <epoxy/gl.h>

#include <QTest>

namespace punctum::test
{

namespace
{

/// Of what covered pixels may be more than kSteps off in a channel.
constexpr double kLightDiffers = 0.002;
/// Light is made of floats: both sides round, and the depth range may be a neighboring value's.
constexpr int kSteps = 2;

double shareBeyond(const Image& a, const Image& b, int steps, double covered)
{
    int n = 0;
    for (std::size_t k = 0; k < a.pixels.size(); ++k) {
        const Rgba8 p = a.pixels[k], q = b.pixels[k];
        n += std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b), std::abs(p.a - q.a)}) > steps;
    }
    return n / std::max(1.0, covered * kWidth * kHeight);
}

}  // namespace

void GlBackendChecks::averagesFollowChanges()
{
    const double limit = std::max(m_tolerance.converged, kAveraged);
    QCOMPARE(test::averagesFollowChanges([this] { return gl(); },
                                         [limit](const Image& a, const Image& b, double covered) {
                                             return differing(a, b) > limit * covered * double(a.pixels.size());
                                         }),
             std::string());
}

void GlBackendChecks::lightAndHolesAreThoseOfTheCpuBackend_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<bool>("averaged");
    for (const int samples : m_samples)
        for (const bool orthographic : {false, true})
            for (const bool averaged : {false, true})
                if (samples == 1 || (!orthographic && !averaged))
                    QTest::addRow("%d samples%s%s", samples, orthographic ? ", orthographic" : "",
                                  averaged ? ", averaged" : "")
                        << samples << orthographic << averaged;
}

// A part of the points, so that there are holes, then all; lit, each in several pieces of memory.
void GlBackendChecks::lightAndHolesAreThoseOfTheCpuBackend()
{
    QFETCH(int, samples);
    QFETCH(bool, orthographic);
    QFETCH(bool, averaged);
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.attribute = "Classification";
    display.samples = samples;
    display.averaged = averaged;
    for (const double eyeDome : {0.0, 1.0}) {
        display.eyeDome = eyeDome;
        display.pointSize = 2.0;
        display.fillHoles = true;
        DisplaySettings open = display;
        open.fillHoles = false;
        const GlLimits limits{.chunkSlots = PointStore::kBlockSlots, .bandSamples = 65 * kWidth};
        View view(gl(limits), {store}, camera, display), reference(cpu(), {store}, camera, display);
        View holes(cpu(), {store}, camera, open);
        for (View* const v : {&view, &reference, &holes}) {
            v->renderer.setPointsAFrame(30'000);
            QVERIFY(!v->renderer.renderFrame(1.0).converged);
        }
        const double covered = reference.renderer.coveredShare();
        QVERIFY(covered > 0.05);
        const Image expected = reference.renderer.image();
        const int closed = differing(holes.renderer.image(), expected);
        QVERIFY2(closed > 100, qPrintable(QString::number(closed)));
        const double off = shareBeyond(view.renderer.image(), expected, kSteps, covered);
        qInfo("strength %g: %d px closed, %s of the covered pixels differ by more than %d of 255", eyeDome, closed,
              qPrintable(percent(off)), kSteps);
        QVERIFY(off <= std::max(m_tolerance.cpu, averaged ? kAveraged : kLightDiffers));
        view.converge();
        reference.converge();
        QVERIFY(shareBeyond(view.renderer.image(), reference.renderer.image(), kSteps,
                            reference.renderer.coveredShare()) <=
                std::max(m_tolerance.cpu, averaged ? kAveraged : kLightDiffers));
    }
}

void GlBackendChecks::surfaceIsThatOfTheCpuBackend_data()
{
    QTest::addColumn<int>("samples");
    for (const int samples : m_samples) QTest::addRow("%d samples", samples) << samples;
}

// The relief alone is the same to the px; with points, those of the ground give way to it, but for selected ones.
void GlBackendChecks::surfaceIsThatOfTheCpuBackend()
{
    QFETCH(int, samples);
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    Progress progress;
    const auto surface = Surface(cloud, {}, progress).view();
    DisplaySettings display;
    display.attribute = "Classification";
    display.samples = samples;
    display.pointSize = 3.0;
    display.surface = SurfaceLook::Heights;
    display.surfaceReplaces[2] = true;
    const auto selected = std::make_shared<PointSet>(cloud->size());
    for (PointIndex i = 0; i < cloud->size() / 4; ++i) selected->insert(i);
    const auto draw = [&](std::unique_ptr<RasterBackend> backend, const DisplaySettings& look, bool select,
                          double* covered = nullptr) {
        View view(std::move(backend), {store}, cameraFor(*cloud), look);
        view.renderer.setSurface(*cloud, surface);
        view.renderer.setSelection(*cloud, select ? selected : nullptr);
        Image image = view.bruteForce();
        if (covered != nullptr) *covered = view.renderer.coveredShare();
        return image;
    };
    DisplaySettings alone = display;
    alone.classVisible.fill(false);
    QCOMPARE(differing(draw(gl(), alone, false), draw(cpu(), alone, false)), 0);
    Image last;
    for (const bool select : {false, true}) {
        double covered = 0;
        const Image expected = draw(cpu(), display, select, &covered), image = draw(gl(), display, select);
        const double off = shareBeyond(image, expected, kSteps, covered);
        QVERIFY2(off <= std::max(m_tolerance.cpu, kLightDiffers), qPrintable(percent(off)));
        QVERIFY(!select || differing(image, last) > 1000);
        last = image;
    }
}

void GlBackendChecks::picturesStayOnTheDevice_data()
{
    QTest::addColumn<int>("samples");
    for (const int samples : m_samples) QTest::addRow("%d samples", samples) << samples;
}

// Frames in motion, with holes closed and light: nothing of the size of a picture comes back. Asked for, the
// picture is the one that would have come, and so is its copy in a texture.
void GlBackendChecks::picturesStayOnTheDevice()
{
    QFETCH(int, samples);
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud);
    DisplaySettings display;
    display.samples = samples;
    display.eyeDome = 1;
    display.fillHoles = true;
    View view(gl(), {store}, camera, display), other(gl(), {store}, camera, display);
    view.renderer.keepOnDevice(true);
    for (View* const v : {&view, &other}) v->renderer.setPointsAFrame(50'000);
    for (int frame = 0; frame < 5; ++frame) {
        camera.orbit(0.02, 0.0);
        for (View* const v : {&view, &other}) v->renderer.setCamera(camera);
        const FrameReport kept = view.renderer.renderFrame(1.0);
        const FrameReport brought = other.renderer.renderFrame(1.0);
        QVERIFY(view.renderer.onDevice() && !other.renderer.onDevice());
        QVERIFY2(kept.bytesDown <= 64, qPrintable(QString::number(kept.bytesDown)));
        QVERIFY(brought.bytesDown >= std::uint64_t(4 * kWidth * kHeight) &&
                brought.bytesDown <= std::uint64_t(4 * kWidth * kHeight) + 64);
        QVERIFY(kept.passes.reproject > 0 && kept.passes.fill > 0 && kept.passes.resolve > 0);
    }
    GlTexture texture = GlTexture::create();
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, kWidth, kHeight);
    QVERIFY(view.renderer.copyPicture(texture.id()));
    QVERIFY(!other.renderer.copyPicture(texture.id()));
    Image copied;
    copied.resize(kWidth, kHeight);
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, copied.pixels.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    QCOMPARE(differing(view.renderer.image(), copied), 0);
    QVERIFY(share(other.renderer.image(), copied, other.renderer.coveredShare()) <= m_tolerance.converged);
}

}  // namespace punctum::test
