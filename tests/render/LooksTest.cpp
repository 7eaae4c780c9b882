// SPDX-License-Identifier: MIT
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/raster/cpu/CpuBackend.h"

#include <glm/geometric.hpp>

#include <QImage>
#include <QTest>

#include <cstdlib>
#include <functional>
#include <map>

using namespace punctum;
using namespace punctum::render;

namespace
{

constexpr int kWidth = 160, kHeight = 100;

/// Where the pictures that ought to come out are kept.
const QString kBaselines = QStringLiteral(PUNCTUM_SOURCE_DIR "/tests/render/baselines/");

struct Cloud {
    const char* name;
    const char* file;
    const char* attribute;
    double worldSize;  ///< some spacings of its points
};
constexpr Cloud kClouds[] = {{"airborne", "autzen_trim.laz", "RGB", 25.0},
                             {"terrestrial", "tls_clip.laz", "Z", 0.8},
                             {"photogrammetric", "lion_takanawa.copc.laz", "RGB", 0.15}};

struct Look {
    const char* name;
    std::function<void(DisplaySettings&, const Cloud&)> set;
};
const Look kLooks[] = {
    {"plain", [](DisplaySettings&, const Cloud&) {}},
    {"round",
     [](DisplaySettings& d, const Cloud&) {
         d.samples = 4;
         d.pointSize = 5;
         d.round = true;
     }},
    {"world-size",
     [](DisplaySettings& d, const Cloud& cloud) {
         d.sizing = PointSizing::World;
         d.worldSize = cloud.worldSize;
     }},
    {"density",
     [](DisplaySettings& d, const Cloud&) {
         d.sizing = PointSizing::Density;
         d.spacings = 4;
         d.round = true;
     }},
    {"averaged", [](DisplaySettings& d, const Cloud&) { d.averaged = true; }},
    {"eye-dome",
     [](DisplaySettings& d, const Cloud&) {
         d.eyeDome = 1;
         d.pointSize = 2;
         d.samples = 4;
     }},
    {"bands",
     [](DisplaySettings& d, const Cloud&) {
         d.attribute = "Z";
         d.bands = 6;
         d.colorMap = "turbo";
     }},
    {"lit",
     [](DisplaySettings& d, const Cloud&) {
         d.attribute = "Normal";
         d.pointSize = 2;
     }},
    {"gradient",
     [](DisplaySettings& d, const Cloud&) {
         d.samples = 16;
         d.backgroundTop = {200, 210, 255, 255};
         d.backgroundBottom = {90, 60, 30, 255};
     }},
    {"transparent",
     [](DisplaySettings& d, const Cloud&) {
         d.samples = 4;
         d.backgroundTop = d.backgroundBottom = {0, 0, 0, 0};
     }},
};

/// Directions that need no neighbors: away from the middle of the cloud's floor, as of a ball.
void addNormals(PointCloud& cloud)
{
    const RawBounds bounds = cloud.computeBounds();
    const glm::dvec3 middle(glm::dvec3(bounds.min.x + bounds.max.x, bounds.min.y + bounds.max.y, 2 * bounds.min.z) /
                            2.0);
    std::span<float> values[3];
    for (int axis = 0; axis < 3; ++axis) {
        Attribute part;
        part.name = std::string("Normal") + char('X' + axis);
        part.columns[0] = cloud.addColumn(std::make_shared<Column>(part.name, ScalarType::F32, cloud.size()));
        values[axis] = part.columns[0]->values<float>();
        cloud.addAttribute(part);
    }
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        const glm::dvec3 n =
            glm::normalize(glm::dvec3(cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i] + 1) - middle);
        for (int axis = 0; axis < 3; ++axis) values[axis][i] = float(n[axis]);
    }
    addComposite(cloud, "Normal", AttributeKind::Vector, {"NormalX", "NormalY", "NormalZ"});
}

}  // namespace

/// Each look on three real clouds, beside pictures that were looked at. PUNCTUM_UPDATE_BASELINES=1 writes them
/// anew.
class LooksTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void looksAsItDid_data();
    void looksAsItDid();

private:
    std::map<QString, std::shared_ptr<PointCloud>> m_clouds;
};

void LooksTest::looksAsItDid_data()
{
    QTest::addColumn<int>("cloud");
    QTest::addColumn<int>("look");
    QTest::addColumn<bool>("baselineKernel");
    for (int cloud = 0; cloud < int(std::size(kClouds)); ++cloud)
        for (int look = 0; look < int(std::size(kLooks)); ++look)
            for (const bool baseline : {false, true})
                QTest::addRow("%s, %s%s", kClouds[cloud].name, kLooks[look].name, baseline ? ", without AVX2" : "")
                    << cloud << look << baseline;
}

// The CPU's pictures are exact but for the last bits of projections, which the AVX2 and the SSE2 kernels and other
// compilers round differently. Then a point on the rim of a sample falls to its neighbor, or of two points of the
// same depth the other one wins; all of the sample's color is another one. Between the two kernels at most 0.2 % of
// the pixels of the survey and of the scan differ, but 1.2 % of those of the photogrammetric cloud, whose
// coordinates lie on a grid of 1 cm, so that many points are equally deep. So a single pixel may differ by
// anything, 2 % of the pixels by more than 16 of 255, and the mean of all channels by 0.8 (0.63 seen).
void LooksTest::looksAsItDid()
{
    QFETCH(int, cloud);
    QFETCH(int, look);
    QFETCH(bool, baselineKernel);
    const Cloud& which = kClouds[cloud];
    const QString file = QStringLiteral(PUNCTUM_TEST_DATA "/") + which.file;
    if (!QFile::exists(file)) QSKIP(qPrintable(QString("%1 is not here.").arg(which.file)));
    std::shared_ptr<PointCloud>& points = m_clouds[which.file];
    if (!points) {
        Progress progress;
        const auto reader = las::Reader::open(file.toStdString());
        points = reader->createCloud();
        reader->read(*points, progress);
        addNormals(*points);
    }
    const RawBounds bounds = points->computeBounds();
    const auto store = std::make_shared<PointStore>(points, bounds);
    store->fillAll();
    DisplaySettings display;
    display.attribute = which.attribute;
    kLooks[look].set(display, which);
    Camera camera;
    camera.setView("iso");
    camera.fit(points->coordinates().toWorld(bounds), {kWidth, kHeight});
    camera.zoomTowards(camera.pivot, 0.7);
    ProgressiveRenderer renderer(
        std::make_unique<CpuBackend>(baselineKernel ? punctum::render::baselineKernel() : chooseKernel()));
    renderer.addCloud(store);
    renderer.loadingEnded(*points, bounds);
    renderer.setSize(kWidth, kHeight);
    renderer.setCamera(camera);
    renderer.setDisplay(display);
    while (!renderer.renderFrame(0.05).converged) {
    }
    const Image& image = renderer.image();
    const QImage picture(reinterpret_cast<const uchar*>(image.pixels.data()), kWidth, kHeight, kWidth * 4,
                         QImage::Format_RGBA8888);

    const QString name = QString("%1-%2.png").arg(which.name, kLooks[look].name);
    if (qEnvironmentVariableIsSet("PUNCTUM_UPDATE_BASELINES")) {
        // Without alpha where there is none: smaller.
        QVERIFY(
            picture.convertToFormat(display.backgroundTop.a == 0 ? QImage::Format_RGBA8888 : QImage::Format_RGB888)
                .save(kBaselines + name, "PNG", 0));
        return;
    }
    const QImage expected = QImage(kBaselines + name).convertToFormat(QImage::Format_RGBA8888);
    QVERIFY2(expected.size() == picture.size(), qPrintable("There is no baseline " + name));
    double sum = 0;
    int far = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const uchar *const a = picture.constScanLine(y) + 4 * x, *const b = expected.constScanLine(y) + 4 * x;
            int most = 0;
            for (int c = 0; c < 4; ++c) {
                const int d = std::abs(int(a[c]) - int(b[c]));
                sum += d;
                most = std::max(most, d);
            }
            far += most > 16;
        }
    const double mean = sum / (4.0 * kWidth * kHeight);
    const bool alike = mean <= 0.8 && far <= kWidth * kHeight / 50;
    if (!alike) picture.save(name);
    QVERIFY2(alike, qPrintable(QString("the mean differs by %1, %2 pixels by more than 16; what came out is in %3")
                                   .arg(mean)
                                   .arg(far)
                                   .arg(QFileInfo(name).absoluteFilePath())));
}

QTEST_APPLESS_MAIN(LooksTest)
#include "LooksTest.moc"
