// SPDX-License-Identifier: MIT
// GlBackendChecks: how points look.
#include "tests/render/GlBackendChecks.h"
#include "tests/render/GlPictures.h"

#include <QTest>

namespace punctum::test
{

void GlBackendChecks::stylesAgreeWithTheCpuBackend_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<int>("samples");
    QTest::addColumn<int>("sizing");
    QTest::addColumn<bool>("round");
    QTest::addColumn<bool>("averaged");
    constexpr const char* kNames[] = {"px", "world", "density"};
    for (const char* file : {"synthetic", "tls_clip.laz"})
        for (const int samples : {1, 4})
            for (const auto sizing : {PointSizing::Pixels, PointSizing::World, PointSizing::Density})
                for (const bool round : {false, true})
                    for (const bool averaged : {false, true})
                        if (std::string_view(file) == "synthetic"
                                ? sizing != PointSizing::Pixels || round || averaged
                                : sizing == PointSizing::Density && round && averaged)
                            QTest::addRow("%s, %d samples, by %s%s%s", file, samples, kNames[int(sizing)],
                                          round ? ", round" : "", averaged ? ", averaged" : "")
                                << file << samples << int(sizing) << round << averaged;
}

// The same reasons as above. Of mean colors the sums are the same integers; but many points come into a sample, and
// one at its rim or at the limit of 1 % that falls to the other side may change the mean by a step.
void GlBackendChecks::stylesAgreeWithTheCpuBackend()
{
    QFETCH(QString, file);
    QFETCH(int, samples);
    QFETCH(int, sizing);
    QFETCH(bool, round);
    QFETCH(bool, averaged);
    const auto cloud = cloudNamed(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there."));
    const auto store = filledStore(cloud);
    DisplaySettings display;
    display.attribute = "Z";
    display.samples = samples;
    display.sizing = PointSizing(sizing);
    display.pointSize = round ? 4.0 : 1.0;
    const WorldBounds box = cloud->coordinates().toWorld(cloud->computeBounds());
    display.worldSize = (box.max.x - box.min.x) / 100;
    display.spacings = 1.5;
    display.round = round;
    display.averaged = averaged;
    BesideCpu both(gl(), {store}, cameraFor(*cloud), display);
    QVERIFY(both.covered > 0.05);
    qInfo("%s of the covered pixels differ", qPrintable(percent(both.different())));
    QVERIFY(both.different() <= (averaged ? std::max(m_tolerance.cpu, kAveraged) : m_tolerance.cpu));
    both.view.converge();
    QVERIFY(share(both.view.renderer.image(), both.image, both.covered) <= m_tolerance.converged);
}

// Mean colors are there once all is drawn, are those of the attribute shown, and leave with the style.
void GlBackendChecks::averagesFollowColors()
{
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud), other = filledStore(makeCloud(50'000));
    DisplaySettings display;
    display.attribute = "Z";
    display.averaged = true;
    Camera camera = cameraFor(*cloud);
    for (const int samples : {1, 4}) {
        display.samples = samples;
        // several pieces of both kinds of memory
        View view(gl({.chunkSlots = PointStore::kBlockSlots, .bandSamples = kWidth * 40u}), {store, other}, camera,
                  display);
        View reference(cpu(), {store, other}, camera, display);
        view.converge();
        const double covered = (reference.bruteForce(), reference.renderer.coveredShare());
        QVERIFY(share(view.renderer.image(), reference.renderer.image(), covered) <=
                std::max(m_tolerance.cpu, kAveraged));
        for (const auto& change : std::vector<std::function<void(DisplaySettings&)>>{
                 [](DisplaySettings& d) { d.attribute = "Classification"; },
                 [](DisplaySettings& d) { d.averaged = false; }, [](DisplaySettings& d) { d.averaged = true; },
                 [](DisplaySettings& d) {
                     d.palette[2] = {1, 2, 250, 255};
                 }}) {
            DisplaySettings changed = view.renderer.display();
            change(changed);
            view.renderer.setDisplay(changed);
            reference.renderer.setDisplay(changed);
            view.converge();
            reference.converge();
            QVERIFY(share(view.renderer.image(), reference.renderer.image(), covered) <=
                    std::max(m_tolerance.cpu, kAveraged));
        }
        camera.orbit(0.2, 0.0);
        view.renderer.setCamera(camera);
        reference.renderer.setCamera(camera);
        view.converge();
        reference.converge();
        QVERIFY(share(view.renderer.image(), reference.renderer.image(), covered) <=
                std::max(m_tolerance.cpu, kAveraged));
    }
}

}  // namespace punctum::test
