// SPDX-License-Identifier: MIT
// punctum bench order: the prime and the stratified order of drawing beside each other.
#include "app/Picture.h"
#include "app/commands/Bench.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/camera/Projection.h"
#include "render/color/ColorMap.h"

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace punctum::app
{

namespace
{

using render::OrderKind;
using render::Slot;

constexpr std::array<int, 7> kPercents{1, 2, 5, 10, 20, 40, 70};
constexpr double kLowest = 0.02;  ///< percentiles that the color map spans

struct BenchOrderOptions : BenchOptions {
    PictureSize size;
};

/// How far a picture is from the finished one.
struct Distance {
    double missing = 0;  ///< share of the pixels with a point that have none yet
    double color = 0;    ///< mean difference of a channel over the same pixels, 0 to 255
};

/// Pictures of one store by the CPU backend.
class Drawing
{
public:
    Drawing(const render::PointStore& store, const render::Camera& camera, render::TargetSize size)
        : m_store(store), m_backend(render::makeBackend(render::BackendKind::Cpu))
    {
        m_backend->setTarget(size);
        m_scene.add({&store, 0, render::makeProjection(camera, store, size)});
        m_scene.classVisible.fill(true);
        m_scene.allClassesVisible = true;
        const auto encoder = store.encoder();
        m_settings.layers.push_back({encoder->kind(), 0, 1});
        if (encoder->kind() == render::WordKind::Scalar) {
            std::vector<double> values;
            for (PointIndex i = 0; i < store.cloud().size(); i += store.cloud().size() / 5000 + 1)
                values.push_back(encoder->attribute().number(i) - encoder->bias());
            m_settings.layers[0].low = float(percentile(values, kLowest));
            m_settings.layers[0].high = float(percentile(values, 1 - kLowest));
        }
        m_settings.colorMap = render::suitableColorMap(encoder->attribute().name).table;
        for (std::size_t k = 0; k < m_settings.palette.size(); ++k)
            m_settings.palette[k] = render::asprsClasses()[k].color;
        m_settings.backgroundTop = m_settings.backgroundBottom = {0, 0, 0, 0};
    }
    void clear() { m_backend->clear(); }
    /// From slot `from` on, round the end.
    void draw(Slot from, Slot count)
    {
        const Slot slotCount = m_store.slotCount();
        from %= slotCount;
        const Slot first = std::min<Slot>(count, slotCount - from);
        m_backend->draw(m_scene, 0, {from, from + first});
        if (first < count) m_backend->draw(m_scene, 0, {0, count - first});
        m_backend->finish();
    }
    render::Image picture()
    {
        render::Image image;
        m_backend->resolve(m_scene, m_settings, image);
        return image;
    }

private:
    const render::PointStore& m_store;
    std::unique_ptr<render::RasterBackend> m_backend;
    render::FrameScene m_scene;
    render::ResolveSettings m_settings;
};

Distance distanceOf(const render::Image& image, const render::Image& finished)
{
    std::uint64_t covered = 0;
    std::uint64_t missing = 0;
    std::uint64_t difference = 0;
    for (std::size_t k = 0; k < finished.pixels.size(); ++k) {
        const render::Rgba8 a = image.pixels[k];
        const render::Rgba8 b = finished.pixels[k];
        if (b.a == 0) continue;
        ++covered;
        missing += a.a == 0;
        difference += std::uint64_t(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b));
    }
    const double pixels = std::max(1.0, double(covered));
    return {double(missing) / pixels, double(difference) / 3 / pixels};
}

void measure(OrderKind order, const std::string& name, const std::shared_ptr<PointCloud>& cloud,
             const RawBounds& bounds, const BenchOrderOptions& options, Figures& figures, Progress& progress)
{
    const auto points = double(cloud->size());
    const auto figure = [&](const std::string& what, double value) { figures.add(name + "." + what, value); };
    for (int round = 0; round < options.rounds; ++round) {
        progress.check();
        // The first filling of a store touches new memory; what the order costs is seen in the second.
        const auto store = std::make_shared<render::PointStore>(cloud, bounds, order);
        store->fillAll();
        Clock clock;
        store->fillAll();
        figure("fill_mpts_per_s", points / clock.seconds() * 1e-6);

        render::Camera camera;
        camera.setView("iso");
        camera.fit(cloud->coordinates().toWorld(bounds), {options.size.width, options.size.height});
        Drawing drawing(*store, camera, {options.size.width, options.size.height, 1});
        const Slot slotCount = store->slotCount();
        drawing.draw(0, slotCount);
        drawing.clear();
        clock.restart();
        drawing.draw(0, slotCount);
        figure("draw_mpts_per_s", points / clock.seconds() * 1e-6);
        const render::Image finished = drawing.picture();

        // Each round begins at another place of the order, as a view does that was turned.
        const Slot window = store->order().windowSize();
        const Slot from = Slot(std::uint64_t(round) * slotCount / std::uint64_t(options.rounds) / window * window);
        drawing.clear();
        Slot drawn = 0;
        for (const int percent : kPercents) {
            progress.check();
            const auto wanted = std::uint64_t(slotCount) * std::uint64_t(percent) / 100;
            const Slot upTo = Slot(std::min<std::uint64_t>(slotCount, (wanted + window - 1) / window * window));
            if (upTo > drawn) drawing.draw((from + drawn) % slotCount, upTo - drawn);
            drawn = std::max(drawn, upTo);
            const Distance error = distanceOf(drawing.picture(), finished);
            figure("missing_at_" + std::to_string(percent) + "_percent", error.missing);
            figure("color_error_at_" + std::to_string(percent) + "_percent", error.color);
        }
    }
}

void runBenchOrder(const BenchOrderOptions& options, Progress& progress)
{
    const auto reader = las::Reader::open(options.file);
    const std::shared_ptr<PointCloud> cloud = reader->createCloud();
    const las::ReadResult result = reader->read(*cloud, progress);
    Figures figures;
    figures.fact("points", cloud->size());
    figures.fact("size", sizeText(options.size));
    measure(OrderKind::Stratified, "stratified", cloud, result.bounds, options, figures, progress);
    measure(OrderKind::Prime, "prime", cloud, result.bounds, options, figures, progress);
    figures.report(options);
}

}  // namespace

void addBenchOrder(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(
        bench, "order",
        "Orders of drawing, stratified and prime: filling the store, drawing all points, and how far the "
        "picture is from the finished one when a share of the points is drawn");
    const auto options = std::make_shared<BenchOrderOptions>();
    addBenchOptions(command, *options);
    addSize(command, options->size);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchOrder(*options, p); }; });
}

}  // namespace punctum::app
