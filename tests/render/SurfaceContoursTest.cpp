// SPDX-License-Identifier: MIT
// Contours in the picture of the ground surface, against rays that are cut with a plane.
#include "core/task/Progress.h"
#include "render/surface/SurfaceContours.h"
#include "render/surface/SurfaceRaster.h"
#include "tests/render/RenderedView.h"

#include <glm/geometric.hpp>

#include <QTest>

#include <algorithm>
#include <cmath>

using namespace punctum;
using namespace punctum::render;
using namespace punctum::test;

namespace
{

constexpr int kWidth = 320, kHeight = 200;
constexpr double kSide = 200.0;  // of makeCloud(), m

/// z = height + eastward x + northward y.
struct Plane {
    double height = 0, eastward = 0, northward = 0;
    double at(double x, double y) const { return height + eastward * x + northward * y; }
};

std::shared_ptr<PointCloud> cloudOf(const Plane& plane)
{
    const auto cloud = makeCloud(20000);
    const auto axis = [&](const char* name) {
        return cloud->findAttribute(name)->columns[0]->values<std::int32_t>();
    };
    const auto x = axis("X"), y = axis("Y"), z = axis("Z");
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        z[i] = std::int32_t(std::lround(1000 * plane.at(x[i] / 1000.0, y[i] / 1000.0)));
        classes[i] = 2;
    }
    return cloud;
}

struct View {
    Camera camera;
    SurfaceRaster raster;
    double focal = 0;

    View(const Plane& plane, const SurfaceContours& contours, bool orthographic, double pitch, double distance)
    {
        const auto cloud = cloudOf(plane);
        const auto store = filledStore(cloud);
        Progress progress;
        camera = cameraFor(*cloud, kWidth, kHeight);
        camera.orthographic = orthographic;
        camera.pitch = pitch;
        camera.pivot = {kSide / 2, kSide / 2, plane.at(kSide / 2, kSide / 2)};
        camera.eye = camera.pivot - camera.forward() * distance;
        focal = kHeight / 2.0 / std::tan(camera.fovY / 2);
        const SurfaceLayer layer{Surface(cloud, {}, progress).view(),
                                 makeProjection(camera, *store, TargetSize{kWidth, kHeight, 1}),
                                 store->frame(),
                                 LayerClip{},
                                 orthographic ? focal / camera.pivotDepth() : focal,
                                 cloud->coordinates().scale.z,
                                 cloud->coordinates().offset.z};
        raster.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, SurfaceRaster::kFineCell,
                    SurfaceLook::Gray, contours);
    }
    /// Where the ray of a place in the picture meets the plane.
    glm::dvec3 place(const Plane& plane, double px, double py) const
    {
        glm::dvec3 origin = camera.eye;
        const glm::dvec3 right = camera.right() * ((px - kWidth / 2.0) / focal),
                         down = camera.up() * ((py - kHeight / 2.0) / focal);
        glm::dvec3 ray = camera.forward() + right - down;
        if (camera.orthographic) {
            origin += (right - down) * camera.pivotDepth();
            ray = camera.forward();
        }
        const glm::dvec3 normal(-plane.eastward, -plane.northward, 1);
        const double t = (plane.height - glm::dot(normal, origin)) / glm::dot(normal, ray);
        return t > 0 ? origin + ray * t : glm::dvec3(NAN);
    }
    int ink(int x, int y) const { return raster.ink()[std::size_t(y) * kWidth + std::size_t(x)]; }
    int inked() const
    {
        return int(std::count_if(raster.ink().begin(), raster.ink().end(), [](std::uint8_t i) { return i != 0; }));
    }
};

}  // namespace

class SurfaceContoursTest : public QObject
{
    Q_OBJECT

private slots:
    void liesWhereHeightsAreWhole_data();
    void liesWhereHeightsAreWhole();
    void noneOnLevelGround();
    void noneWhereTheyWouldTouch();
    void onlyIndexContoursWhereOthersAreTooClose();
    void intervalsSuitTheRange();
};

void SurfaceContoursTest::liesWhereHeightsAreWhole_data()
{
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<double>("pitch");
    QTest::addColumn<double>("distance");
    for (const bool orthographic : {false, true})
        for (const double pitch : {-1.57, -0.7, -0.35})
            for (const double distance : {40.0, 150.0})
                QTest::addRow("%s, at %g, from %g m", orthographic ? "orthographic" : "perspective", pitch,
                              distance)
                    << orthographic << pitch << distance;
}

/// Every pixel that a contour passes by less than half a px has ink, more of it on each fifth one, and none that is
/// further from it than a line is wide.
void SurfaceContoursTest::liesWhereHeightsAreWhole()
{
    QFETCH(bool, orthographic);
    QFETCH(double, pitch);
    QFETCH(double, distance);
    const Plane plane{412.3, 0.16, 0.11};
    const SurfaceContours contours{distance / 40.0, 1.2};
    const View view(plane, contours, orthographic, pitch, distance);
    int on = 0, off = 0, index = 0, wrong = 0;
    for (int y = 1; y + 1 < kHeight; ++y)
        for (int x = 1; x + 1 < kWidth; ++x) {
            const auto level = [&](double px, double py) {
                return view.place(plane, px, py).z / contours.interval;
            };
            const double px = x + 0.5, py = y + 0.5, here = level(px, py);
            const glm::dvec3 place = view.place(plane, px, py);
            if (!(place.x > 5 && place.x < kSide - 5 && place.y > 5 && place.y < kSide - 5)) continue;
            const double slope =
                std::hypot(level(px + 0.5, py) - level(px - 0.5, py), level(px, py + 0.5) - level(px, py - 0.5));
            if (1 / slope < 7) continue;  // they fade
            const double away = std::abs(here - std::round(here)) / slope;
            const bool fifth = std::fmod(std::round(here), 5.0) == 0;
            const int ink = view.ink(x, y);
            if (away < 0.5) {
                ++on;
                index += int(fifth);
                wrong += int(fifth ? ink < 150 : ink < 60 || ink > 150);
            } else if (away > 1.6) {
                ++off;
                wrong += int(ink != 0);
            }
        }
    const QString counts = QStringLiteral("%1 on, %2 of them index, %3 off, %4 wrong");
    const QString said = counts.arg(on).arg(index).arg(off).arg(wrong);
    QVERIFY2(on > 500 && index > 30 && off > 2000, qPrintable(said));
    QVERIFY2(wrong == 0, qPrintable(said));
}

/// Neither on the height of a contour nor beside it, though all of the ground is of one height.
void SurfaceContoursTest::noneOnLevelGround()
{
    for (const double height : {0.0, 12.0, 12.4})
        for (const bool orthographic : {false, true}) {
            const View view({height}, {1.0, 1.2}, orthographic, -0.9, 150);
            const auto seen = std::count_if(view.raster.depths().begin(), view.raster.depths().end(),
                                            [](float depth) { return !std::isinf(depth); });
            QVERIFY(seen > 10000);
            QCOMPARE(view.inked(), 0);
        }
}

void SurfaceContoursTest::noneWhereTheyWouldTouch()
{
    const Plane plane{412.3, 0.16, 0.11};
    QVERIFY(View(plane, {2.0, 1.2}, true, -1.57, 150).inked() > 1000);
    QCOMPARE(View(plane, {0.01, 1.2}, true, -1.57, 150).inked(), 0);
    QCOMPARE(View(plane, {}, true, -1.57, 150).raster.ink().size(), std::size_t(0));
}

void SurfaceContoursTest::onlyIndexContoursWhereOthersAreTooClose()
{
    const Plane plane{412.3, 0.2, 0.0};
    // 0.5 m a px; five contours in 10 px
    const double interval = 0.2, px = 0.5;
    const double distance = px * kHeight / 2 / std::tan(Camera().fovY / 2);
    const View view(plane, {interval, 1.2}, true, -1.5707, distance);
    int dark = 0, wrong = 0;
    for (int y = 20; y < kHeight - 20; ++y)
        for (int x = 60; x < kWidth - 60; ++x) {
            const double level = view.place(plane, x + 0.5, y + 0.5).z / interval / 5;
            const double away = std::abs(level - std::round(level)) * 10;  // px
            dark += int(view.ink(x, y) > 150);
            wrong += int(away > 1.7 && view.ink(x, y) != 0);
        }
    QVERIFY2(dark > 1000 && wrong == 0, qPrintable(QStringLiteral("%1 dark, %2 wrong").arg(dark).arg(wrong)));
}

void SurfaceContoursTest::intervalsSuitTheRange()
{
    QCOMPARE(suitableInterval(0), 0.0);
    QCOMPARE(suitableInterval(NAN), 0.0);
    QCOMPARE(suitableInterval(20), 1.0);
    QCOMPARE(suitableInterval(45), 2.0);
    QCOMPARE(suitableInterval(110), 5.0);
    QCOMPARE(suitableInterval(190), 10.0);
    QCOMPARE(suitableInterval(4), 0.2);
    for (double range = 0.013; range < 9000; range *= 1.17) {
        const double lines = range / suitableInterval(range);
        QVERIFY2(lines > 12 && lines < 33, qPrintable(QString("%1: %2").arg(range).arg(lines)));
    }
}

QTEST_APPLESS_MAIN(SurfaceContoursTest)
#include "SurfaceContoursTest.moc"
