// SPDX-License-Identifier: MIT
#include "render/progressive/FrameCostModel.h"
#include "render/raster/cpu/CpuResolve.h"
#include "render/resolve/Background.h"
#include "render/resolve/EyeDome.h"
#include "render/resolve/HoleFill.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

using namespace punctum;
using namespace punctum::render;

namespace
{

/// A made cloud as one layer of a scene, with the words of an attribute.
struct OneLayer {
    PointStore store;
    FrameScene scene;
    ResolveSettings settings;

    OneLayer(std::uint32_t points, const char* attribute, WordKind kind)
        : OneLayer(test::makeCloud(points), attribute)
    {
        settings.layers = {{kind, 0, 1}};
    }

private:
    OneLayer(const std::shared_ptr<PointCloud>& cloud, const char* attribute) : store(cloud, cloud->computeBounds())
    {
        store.fillAll();
        store.show(*cloud->findAttribute(attribute));
        while (store.stale()) store.refreshNext(cloud->size());
        scene.add({&store, 0, {}});
    }
};

}  // namespace

class ResolveTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void colorMapsAreComplete();
    void classesHaveNamesAndColors();
    void categoriesDiffer();
    void scalarsClampToTheRange();
    void samplesAverageByAlpha();
    void backgroundIsAGradient();
    void costModelLearns();
    void bandsAreEqualSteps();
    void eyeDomeShadesWhatLiesBehind();
    void eyeDomeDoesNotDependOnTheScale();
    void ownLogarithmsAreRight();
    void lightIsAsDefined_data();
    void lightIsAsDefined();
    void rimsAreNotBright();
    void holesAreFilledFromTheFront();
    void tonesBrightenAndStretch();
    void selectionLooksLikeNoMap();
};

void ResolveTest::colorMapsAreComplete()
{
    for (const char* name : {"viridis", "turbo", "cividis", "grey"}) {
        const ColorMap* map = findColorMap(name);
        QVERIFY2(map != nullptr, name);
        std::set<std::uint32_t> colors;
        for (const Rgba8& c : map->table) {
            QCOMPARE(unsigned(c.a), 255u);
            colors.insert(std::bit_cast<std::uint32_t>(c));
        }
        QVERIFY2(colors.size() > 200, name);
    }
    QCOMPARE(findColorMap("viridis")->table[0], (Rgba8{0x44, 0x01, 0x54, 255}));
    QCOMPARE(findColorMap("viridis")->table[255], (Rgba8{0xfd, 0xe7, 0x25, 255}));
    QCOMPARE(unsigned(findColorMap("grey")->table[77].g), 77u);
    QVERIFY(findColorMap("no such map") == nullptr);
    QCOMPARE(chosenColorMap("", "Intensity").name, std::string("grey"));
    QCOMPARE(chosenColorMap("", "Z").name, std::string("viridis"));
    QCOMPARE(chosenColorMap("turbo", "Intensity").name, std::string("turbo"));
}

void ResolveTest::classesHaveNamesAndColors()
{
    const auto& classes = asprsClasses();
    QCOMPARE(classes[2].name, std::string("Ground"));
    QCOMPARE(classes[7].name, std::string("Low Noise"));
    QCOMPARE(classes[22].name, std::string("Temporal Exclusion"));
    QCOMPARE(classes[64].name, std::string("Class 64"));
    QVERIFY(classes[6].color.r > classes[6].color.b);
}

void ResolveTest::categoriesDiffer()
{
    for (std::uint32_t id = 0; id < 1000; ++id) {
        const Rgba8 a = categoryColor(id), b = categoryColor(id + 1);
        const int distance = std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
        QVERIFY2(distance > 60, qPrintable(QString::number(id)));
    }
}

void ResolveTest::scalarsClampToTheRange()
{
    ResolveSettings settings;
    settings.colorMap = findColorMap("grey")->table;
    const LayerColors layer{WordKind::Scalar, 10.0f, 20.0f};
    const auto gray = [&](float v) {
        return unsigned(colorOf(std::bit_cast<std::uint32_t>(v), layer, settings).r);
    };
    QCOMPARE(gray(-5), 0u);
    QCOMPARE(gray(10), 0u);
    QCOMPARE(gray(15), 128u);
    QCOMPARE(gray(20), 255u);
    QCOMPARE(gray(1e30f), 255u);
    QCOMPARE(gray(std::numeric_limits<float>::quiet_NaN()), unsigned(settings.noValue.r));
    const LayerColors flat{WordKind::Scalar, 5.0f, 5.0f};
    QCOMPARE(unsigned(colorOf(std::bit_cast<std::uint32_t>(5.0f), flat, settings).r), 128u);
}

void ResolveTest::samplesAverageByAlpha()
{
    OneLayer layer(1, "Classification", WordKind::Class);
    const FrameScene& scene = layer.scene;
    ResolveSettings& settings = layer.settings;
    settings.palette.fill({200, 100, 0, 255});
    settings.backgroundTop = settings.backgroundBottom = {0, 0, 100, 255};
    const std::vector<std::uint64_t> cells{~0ull, 0, ~0ull, ~0ull};  // one sample of four sees the point
    Image image;
    resolveCells(cells, {}, {1, 1, 4}, scene, settings, image);
    QCOMPARE(image.at(0, 0), (Rgba8{50, 25, 75, 255}));
    settings.backgroundTop = settings.backgroundBottom = {0, 0, 0, 0};
    resolveCells(cells, {}, {1, 1, 4}, scene, settings, image);
    QCOMPARE(image.at(0, 0), (Rgba8{200, 100, 0, 64}));
}

void ResolveTest::backgroundIsAGradient()
{
    ResolveSettings settings;
    settings.backgroundTop = {0, 0, 0, 255};
    settings.backgroundBottom = {200, 100, 50, 255};
    Image image;
    resolveCells(std::vector<std::uint64_t>(15, ~0ull), {}, {3, 5, 1}, {}, settings, image);
    QCOMPARE(image.at(0, 0), (Rgba8{0, 0, 0, 255}));
    QCOMPARE(image.at(2, 2), (Rgba8{100, 50, 25, 255}));
    QCOMPARE(image.at(1, 4), (Rgba8{200, 100, 50, 255}));
}

void ResolveTest::costModelLearns()
{
    FrameCostModel model;
    QVERIFY(!model.known());
    QCOMPARE(model.affordable(0.01), FrameCostModel::kFirstRun);
    model.observe(1'000'000, 0.010);
    QVERIFY(std::abs(double(model.affordable(0.005)) - 500'000) < 2);
    QVERIFY(std::abs(model.cost(200'000) - 0.002) < 1e-9);
    for (int k = 0; k < 30; ++k) model.observe(1'000'000, 0.020);
    QVERIFY(std::abs(double(model.affordable(0.020)) - 1'000'000) < 1000);
    QCOMPARE(model.affordable(-1), std::uint64_t(1));
    model.observe(0, 1.0);
    model.observe(100, 0.0);
    QVERIFY(std::abs(double(model.affordable(0.020)) - 1'000'000) < 1000);
}

void ResolveTest::bandsAreEqualSteps()
{
    const ColorTable& map = findColorMap("turbo")->table;
    QVERIFY(banded(map, 0) == map);
    for (const int bands : {2, 3, 7, 64}) {
        const ColorTable steps = banded(map, bands);
        std::vector<int> lengths{1};
        for (std::size_t k = 1; k < steps.size(); ++k) {
            if (steps[k] == steps[k - 1])
                ++lengths.back();
            else
                lengths.push_back(1);
        }
        QCOMPARE(int(lengths.size()), bands);
        for (const int length : lengths) QVERIFY(std::abs(length - 256 / bands) <= 1);
    }
}

namespace
{

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// A low step down the middle of a slope, with a hole in it, all gray.
std::vector<float> steps(int width, int height, float near, float scale)
{
    std::vector<float> depths;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            depths.push_back(near + scale * (float(y) * 0.1f + (x < width / 2 ? 0.0f : 2.0f)));
    depths[std::size_t(5 * width + 5)] = kNothing;
    return depths;
}

Image greyImage(int width, int height)
{
    Image image;
    image.resize(width, height);
    std::fill(image.pixels.begin(), image.pixels.end(), Rgba8{200, 200, 200, 255});
    return image;
}

}  // namespace

namespace
{

std::uint64_t cellOf(float depth, PointId id)
{
    return depth == kNothing ? ~0ull : std::uint64_t(std::bit_cast<std::uint32_t>(depth)) << 32 | id;
}

/// Light on a picture of one sample a pixel.
void shadeEyeDome(std::span<const float> depths, bool perspective, float strength, int reach, Image& image)
{
    std::vector<std::uint64_t> cells;
    for (const float depth : depths) cells.push_back(cellOf(depth, 0));
    const EyeDomeShades shades(cells, {image.width, image.height, 1}, {strength, perspective, reach});
    std::vector<float> row;
    for (int y = 0; y < image.height && !shades.empty(); ++y) {
        shades.shadesOf(y, row);
        for (int x = 0; x < image.width; ++x)
            if (cells[std::size_t(y * image.width + x)] != ~0ull)
                image.at(x, y) = dimmed(image.at(x, y), row[std::size_t(x)]);
    }
}

}  // namespace

void ResolveTest::eyeDomeShadesWhatLiesBehind()
{
    constexpr int kWidth = 60, kHeight = 40;
    const Image before = greyImage(kWidth, kHeight);
    const std::vector<float> depths = steps(kWidth, kHeight, 100, 1);
    Image image = before;
    shadeEyeDome(depths, false, 1, 1, image);
    QCOMPARE(image.at(5, 5), before.at(5, 5));  // the hole
    const auto gray = [&](int x) { return int(image.at(x, 20).r); };
    QVERIFY2(gray(kWidth / 2) < gray(kWidth / 2 - 1) - 20, "the far side of the step is the dark one");
    QVERIFY(gray(kWidth / 2 - 1) > 150);
    QCOMPARE(gray(kWidth / 2 + 10), gray(kWidth - 10));  // a slope is shaded evenly
    Image strong = before;
    shadeEyeDome(depths, false, 3, 1, strong);
    QVERIFY(strong.at(kWidth / 2, 20).r < image.at(kWidth / 2, 20).r);
    // no strength, or all at one depth: nothing
    image = before;
    shadeEyeDome(depths, false, 0, 1, image);
    QVERIFY(image == before);
    shadeEyeDome(std::vector<float>(std::size_t(kWidth * kHeight), 7.0f), true, 1, 1, image);
    QVERIFY(image == before);
    shadeEyeDome(std::vector<float>(std::size_t(kWidth * kHeight), kNothing), true, 1, 1, image);
    QVERIFY(image == before);
}

/// A room and a mountain of the same shape look the same, in both kinds of view.
void ResolveTest::eyeDomeDoesNotDependOnTheScale()
{
    Image room = greyImage(60, 40), mountain = room;
    shadeEyeDome(steps(60, 40, 1, 0.125f), false, 1, 1, room);
    shadeEyeDome(steps(60, 40, 4096, 512), false, 1, 1, mountain);
    for (std::size_t k = 0; k < room.pixels.size(); ++k)
        QVERIFY(std::abs(room.pixels[k].r - mountain.pixels[k].r) <= 1);
    room = mountain = greyImage(60, 40);
    shadeEyeDome(steps(60, 40, 4, 0.5f), true, 1, 1, room);
    shadeEyeDome(steps(60, 40, 4096, 512), true, 1, 1, mountain);
    for (std::size_t k = 0; k < room.pixels.size(); ++k)
        QVERIFY(std::abs(room.pixels[k].r - mountain.pixels[k].r) <= 1);
}

// The steps that processor and devices share, beside what the processor's own functions say.
void ResolveTest::ownLogarithmsAreRight()
{
    for (double x = 1e-6; x < 1e9; x *= 1.0037)
        QVERIFY(std::abs(double(log2Of(float(x))) - std::log2(double(float(x)))) <=
                2e-7 * std::max(1.0, std::abs(std::log2(x))));
    for (float x = 0; x > -40; x -= 0.00731f)
        QVERIFY(std::abs(double(exp2Of(x)) / std::exp2(double(x)) - 1) < 4e-6);
    QVERIFY(exp2Of(-1e30f) < 1e-30f);
}

void ResolveTest::lightIsAsDefined_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<bool>("perspective");
    for (const int samples : kSampleCounts)
        for (const bool perspective : {false, true})
            QTest::addRow("%d samples%s", samples, perspective ? ", perspective" : "") << samples << perspective;
}

// Every sample of every pixel, one after the other and by the definition: the picture is the same bit for bit.
void ResolveTest::lightIsAsDefined()
{
    QFETCH(int, samples);
    QFETCH(bool, perspective);
    constexpr int kWidth = 67, kHeight = 41;
    OneLayer layer(5000, "RGB", WordKind::Color);
    const FrameScene& scene = layer.scene;
    ResolveSettings& settings = layer.settings;
    settings.backgroundTop = {10, 20, 30, 0};
    settings.backgroundBottom = {200, 0, 0, 255};
    settings.eyeDome = {1.3f, perspective, 2};
    const auto cells = [&] {
        std::vector<std::uint64_t> all;
        for (int k = 0; k < kWidth * kHeight * samples; ++k) {
            const int x = k / samples % kWidth, y = k / samples / kWidth;
            const std::uint64_t h = test::hash(std::uint64_t(k));
            const float depth =
                50 + float(y) * 0.3f + (x + int(h % 2) < kWidth / 2 ? 0 : 20) + float(h % 100) * 0.01f;
            all.push_back(h % 7 == 0 ? ~0ull : cellOf(depth, PointId(h % 5000)));
        }
        return all;
    }();
    Image image;
    resolveCells(cells, {}, {kWidth, kHeight, samples}, scene, settings, image);

    const auto levelAt = [&](int x, int y, int s) {
        const std::uint64_t cell = cells[std::size_t((y * kWidth + x) * samples + s)];
        if (cell == ~0ull) return kNothing;
        return eyeDomeLevel(std::bit_cast<float>(std::uint32_t(cell >> 32)), perspective);
    };
    std::vector<float> some;
    const std::size_t step = std::max<std::size_t>(1, cells.size() / 4096);
    for (std::size_t k = 0; k < cells.size(); k += step) {
        const int pixel = int(k) / samples;
        const float level = levelAt(pixel % kWidth, pixel / kWidth, int(k) % samples);
        if (level != kNothing) some.push_back(level);
    }
    std::sort(some.begin(), some.end());
    const float extent =
        some[std::size_t(0.98f * float(some.size() - 1))] - some[std::size_t(0.02f * float(some.size() - 1))];
    const float scale = eyeDomeScale(1.3f, extent);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            std::uint32_t sum[4] = {};
            for (int s = 0; s < samples; ++s) {
                const float level = levelAt(x, y, s);
                Rgba8 color = backgroundOf(y, kHeight, settings);
                if (level != kNothing) {
                    const auto id = PointId(cells[std::size_t((y * kWidth + x) * samples + s)]);
                    float behind = 0;
                    for (const int reach : {2, 4})
                        for (const auto& [dx, dy] : std::vector<std::pair<int, int>>{
                                 {-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
                            const int nx = x + dx * reach, ny = y + dy * reach;
                            if (nx < 0 || ny < 0 || nx >= kWidth || ny >= kHeight) continue;
                            const float other = levelAt(nx, ny, s);
                            if (other < level) behind += std::min(level - other, extent);
                        }
                    color = dimmed(colorOf(layer.store.words()[id], settings.layers[0], settings),
                                   0.15f + 0.85f * exp2Of(-behind * scale));
                }
                for (int c = 0; c < 3; ++c)
                    sum[c] += std::uint32_t(c == 0   ? color.r
                                            : c == 1 ? color.g
                                                     : color.b) *
                              (samples > 1 ? color.a : 1u);
                sum[3] += color.a;
            }
            const auto n = std::uint32_t(samples), a = sum[3];
            Rgba8 expected{std::uint8_t(sum[0]), std::uint8_t(sum[1]), std::uint8_t(sum[2]), std::uint8_t(a)};
            if (samples > 1)
                expected = a == 0 ? Rgba8{0, 0, 0, 0}
                                  : Rgba8{std::uint8_t((sum[0] + a / 2) / a), std::uint8_t((sum[1] + a / 2) / a),
                                          std::uint8_t((sum[2] + a / 2) / a), std::uint8_t((a + n / 2) / n)};
            QCOMPARE(image.at(x, y), expected);
        }
}

// A wall before a floor, its edge through the middle of pixels: these are between wall and dark floor, not as
// bright as the wall.
void ResolveTest::rimsAreNotBright()
{
    constexpr int kSide = 40;
    OneLayer layer(10, "Classification", WordKind::Class);
    const FrameScene& scene = layer.scene;
    ResolveSettings& settings = layer.settings;
    settings.palette.fill({200, 200, 200, 255});
    settings.eyeDome = {1.0f, false, 1};
    for (const int samples : {4, 8, 16}) {
        std::vector<std::uint64_t> cells;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                for (int s = 0; s < samples; ++s)
                    cells.push_back(cellOf(x < 20 || (x == 20 && s < samples / 2) ? 10.0f : 30.0f, 0));
        Image image;
        resolveCells(cells, {}, {kSide, kSide, samples}, scene, settings, image);
        const int wall = image.at(18, 20).r, rim = image.at(20, 20).r, beside = image.at(21, 20).r;
        QCOMPARE(wall, 200);
        QVERIFY(beside < 150);
        QVERIFY2(rim < 180 && rim > beside, qPrintable(QString("%1 %2 %3").arg(wall).arg(rim).arg(beside)));
    }
}

// A near square with holes before a far floor: holes up to 4 px close with the square's color, a wide one and the
// outside do not, and the floor that shows through goes with the nothing.
void ResolveTest::holesAreFilledFromTheFront()
{
    constexpr int kWide = 60;
    constexpr float kNone = std::numeric_limits<float>::infinity();
    Image image;
    image.resize(kWide, kWide);
    std::vector<float> depths(kWide * kWide, kNone);
    const Rgba8 front{200, 100, 50, 255}, floor{0, 0, 255, 255}, nothing{1, 2, 3, 255};
    const auto put = [&](int x0, int y0, int x1, int y1, float depth, Rgba8 color) {
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) {
                image.at(x, y) = color;
                depths[std::size_t(y * kWide + x)] = depth;
            }
    };
    put(0, 0, kWide, kWide, kNone, nothing);
    put(0, 30, kWide, kWide, 50, floor);
    put(10, 10, 50, 50, 10, front);
    const Image whole = image;
    put(15, 15, 16, 16, kNone, nothing);
    put(20, 15, 22, 17, kNone, nothing);
    put(15, 40, 16, 44, 50, floor);  // a slit
    put(30, 20, 42, 32, kNone, nothing);
    const std::size_t filled = fillHoles(depths, image);
    QVERIFY(filled >= 9);
    QCOMPARE(image.at(15, 15), front);
    QCOMPARE(image.at(21, 16), front);
    QCOMPARE(image.at(15, 42), front);
    QCOMPARE(depths[15 * kWide + 15], 10.0f);
    QCOMPARE(image.at(36, 26), nothing);
    int outside = 0;
    for (int y = 0; y < kWide; ++y)
        for (int x = 0; x < kWide; ++x)
            if (x < 10 || y < 10 || x >= 50 || y >= 50) outside += !(image.at(x, y) == whole.at(x, y));
    QCOMPARE(outside, 0);
    Image small;
    small.resize(2, 2);
    std::vector<float> few(4, kNone);
    QCOMPARE(fillHoles(few, small), std::size_t(0));
}

void ResolveTest::tonesBrightenAndStretch()
{
    const ColorTable plain = toneTable({});
    for (std::size_t k = 0; k < 256; ++k) QCOMPARE(std::size_t(plain[k].r), k);
    const ColorTable bright = toneTable({.brightness = 0.2}), strong = toneTable({.contrast = 0.5}),
                     bent = toneTable({.gamma = 2.2}), gray = toneTable({.contrast = -1.0}),
                     extreme = toneTable({.contrast = 1.0});
    QCOMPARE(int(bright[100].g), 151);
    QCOMPARE(int(bright[250].g), 255);
    QVERIFY(strong[64].r < 40 && strong[192].r > 215 && std::abs(int(strong[128].r) - 128) <= 1);
    QVERIFY(bent[30].b > 80 && bent[0].b == 0 && bent[255].b == 255);
    QVERIFY(gray[0].r == gray[255].r && gray[0].r == 128);
    QVERIFY(extreme[120].r == 0 && extreme[136].r == 255);
    // Colors of a file alone are toned.
    ResolveSettings settings;
    settings.tone = bright;
    settings.colorMap = findColorMap("grey")->table;
    QCOMPARE(colorOf(0xFF000000u | 10 << 16 | 250 << 8 | 100, {WordKind::Color, 0, 1}, settings),
             (Rgba8{151, 255, 61, 255}));
    QCOMPARE(int(colorOf(std::bit_cast<std::uint32_t>(0.5f), {WordKind::Scalar, 0, 1}, settings).r), 128);
}

namespace
{

/// How unlike two colors look: the distance in CIELAB (D65), in which 2 is a difference that can just be seen.
double unlike(Rgba8 a, Rgba8 b)
{
    const auto lab = [](Rgba8 c) {
        const auto linear = [](int v) {
            const double s = v / 255.0;
            return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
        };
        const double r = linear(c.r), g = linear(c.g), bl = linear(c.b);
        const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
        const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * bl) / 0.95047),
                     y = f(0.2126 * r + 0.7152 * g + 0.0722 * bl),
                     z = f((0.0193 * r + 0.1192 * g + 0.9505 * bl) / 1.08883);
        return glm::dvec3(116 * y - 16, 500 * (x - y), 200 * (y - z));
    };
    return glm::length(lab(a) - lab(b));
}

}  // namespace

// A selected point, whatever color it has, is far from every color of the map it is drawn with, and of the classes.
void ResolveTest::selectionLooksLikeNoMap()
{
    const auto check = [](const auto& colors, const std::string& name) {
        for (const Rgba8 own : colors) {
            const auto mixed = [&](int a, int b) { return std::uint8_t((a + 3 * b) / 4); };
            const Rgba8 selected{mixed(own.r, kSelectedColor.r), mixed(own.g, kSelectedColor.g),
                                 mixed(own.b, kSelectedColor.b), 255};
            for (const Rgba8 other : colors)
                QVERIFY2(unlike(selected, other) > 15, qPrintable(QString::fromStdString(name)));
        }
    };
    for (const ColorMap& map : colorMaps()) check(map.table, map.name);
    std::vector<Rgba8> classes;
    for (std::size_t code = 0; code < 23; ++code) classes.push_back(asprsClasses()[code].color);
    check(classes, "classes");
}

QTEST_APPLESS_MAIN(ResolveTest)
#include "ResolveTest.moc"
