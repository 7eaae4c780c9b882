// SPDX-License-Identifier: MIT
// punctum bench surface: how long the ground surface takes at first, and from a stroke of the brush to its picture.
#include "app/commands/Bench.h"
#include "core/Error.h"
#include "core/edit/ClassCommand.h"
#include "core/edit/History.h"
#include "core/surface/Surface.h"
#include "core/task/Progress.h"

#include <cmath>
#include <ctime>
#include <functional>
#include <memory>
#include <utility>

namespace punctum::app
{

namespace
{

constexpr double kStrokeRadius = 5.0;  ///< units of length

/// Ground points about that ground point that is the `part`-th part of all from the first one.
PointSet strokeAbout(const PointCloud& cloud, double part)
{
    const auto x = cloud.rawX(), y = cloud.rawY();
    const Attribute& classes = *cloud.findAttribute("Classification");
    PointIndex middle = PointIndex(part * double(cloud.size()));
    while (middle + 1 < cloud.size() && classes.number(middle) != 2.0) ++middle;
    const TrueLengths lengths = trueLengths(cloud);
    const double dx = lengths.stretch.x * cloud.coordinates().scale.x,
                 dy = lengths.stretch.y * cloud.coordinates().scale.y;
    PointSet stroke(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i)
        if (std::hypot((double(x[i]) - x[middle]) * dx, (double(y[i]) - y[middle]) * dy) < kStrokeRadius &&
            classes.number(i) == 2.0)
            stroke.insert(i);
    return stroke;
}

/// A view of the cloud with its surface, as the window has it, and what a stroke costs there.
class SurfaceStage
{
public:
    SurfaceStage(const DrawableCloud& drawable, std::shared_ptr<Surface> surface, Figures& figures,
                 Progress& progress)
        : m_drawable(drawable), m_surface(std::move(surface)), m_figures(figures), m_progress(progress)
    {
        render::DisplaySettings display;
        display.attribute = "Classification";
        display.surface = render::SurfaceLook::Heights;
        display.surfaceReplaces = m_surface->settings().classes;
        display.sizing = render::PointSizing::Density;
        show(renderer(), drawable, kBenchWidth, kBenchHeight, display);
        renderer().setSurface(*drawable.cloud, m_surface->view());
        m_subscription = drawable.cloud->subscribe(
            [this](const ChangeNotice& notice) { renderer().valuesChanged(*m_drawable.cloud, notice); });
    }

    /// Of all, or of some 100 units about the stroke.
    void look(bool near, const PointSet& stroke)
    {
        render::Camera camera = benchCamera(m_drawable, kBenchWidth, kBenchHeight);
        if (near) {
            glm::dvec3 middle(0.0);
            stroke.forEach([&](PointIndex i) { middle += m_drawable.cloud->world(i) / double(stroke.count()); });
            WorldBounds box;
            box.include(WorldBounds{middle - kNear, middle + kNear});
            camera.fit(box, {kBenchWidth, kBenchHeight});
        }
        renderer().setCamera(camera);
        drawAll(renderer(), false, m_progress);
    }

    /// From the begin of the edit to the first picture with the new relief, which has to be the finished one of it.
    void measure(const std::string& where, const PointSet& stroke, const std::function<void()>& edit)
    {
        const std::clock_t worked = std::clock();
        const Clock clock;
        edit();
        const double edited = clock.milliseconds();
        const std::size_t tiles = m_surface->update(&stroke, m_progress);
        const double updated = clock.milliseconds();
        renderer().setSurface(*m_drawable.cloud, m_surface->view());
        renderer().renderFrame(render::kFrameSeconds);
        const double shown = clock.milliseconds();
        const double processor = 1e3 * double(std::clock() - worked) / CLOCKS_PER_SEC;  // of all threads
        const render::Image first = renderer().image();
        drawAll(renderer(), false, m_progress);
        if (first != renderer().image()) throw Error("The first picture after a stroke did not show all of it.");
        m_figures.add(where + ".stroke_ms", shown);
        m_figures.add(where + ".processor_ms", processor);
        m_figures.add(where + ".edit_ms", edited);
        m_figures.add(where + ".update_ms", updated - edited);
        m_figures.add(where + ".picture_ms", shown - updated);
        m_figures.add(where + ".tiles_updated", double(tiles));
    }

private:
    static constexpr double kNear = 50.0;

    render::ProgressiveRenderer& renderer() { return m_headless.renderer(); }

    HeadlessRenderer m_headless{"auto"};
    const DrawableCloud& m_drawable;
    std::shared_ptr<Surface> m_surface;
    Figures& m_figures;
    Progress& m_progress;
    Subscription m_subscription;
};

void runBenchSurface(const BenchOptions& options, Progress& progress)
{
    const DrawableCloud drawable = loadDrawable(options.file, progress);
    Figures figures;
    figures.fact("points", drawable.cloud->size());
    std::shared_ptr<Surface> surface;
    for (int round = 0; round < options.rounds; ++round) {
        surface.reset();
        const Clock clock;
        surface = std::make_shared<Surface>(drawable.cloud, SurfaceSettings(), progress);
        figures.add("build_ms", clock.milliseconds());
    }
    figures.fact("ground_points", surface->groundPoints());
    figures.fact("tiles", surface->view()->tiles.size());

    SurfaceStage stage(drawable, surface, figures, progress);
    History history(drawable.cloud);
    for (const double part : {0.2, 0.4, 0.6, 0.8}) {
        const auto stroke = std::make_shared<PointSet>(strokeAbout(*drawable.cloud, part));
        figures.add("points_changed", double(stroke->count()));
        for (const bool near : {true, false}) {
            stage.look(near, *stroke);
            for (int round = 0; round < options.rounds; ++round) {
                const std::string where = near ? "near" : "all";
                stage.measure(where, *stroke, [&] {
                    history.push(makeClassCommand("brush", classAttribute(*drawable.cloud, 6), stroke, 6));
                });
                stage.measure(where, *stroke, [&] { history.undo(); });
            }
        }
    }
    figures.report(options);
}

}  // namespace

void addBenchSurface(CLI::App& bench, Action& action)
{
    CLI::App& command = addCommand(
        bench, "surface", "The surface of the ground points: made, and from a stroke of the brush to its picture");
    const auto options = std::make_shared<BenchOptions>();
    addBenchOptions(command, *options);
    command.callback([options, &action] { action = [options](Progress& p) { runBenchSurface(*options, p); }; });
}

}  // namespace punctum::app
