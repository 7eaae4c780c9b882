// SPDX-License-Identifier: MIT
#include "app/Renderer.h"

#include "core/task/Progress.h"
#include "render/resolve/EyeDome.h"

#include <algorithm>
#include <cmath>

namespace punctum::app
{

namespace
{

/// Seconds a frame may take where nobody watches: short enough to answer Ctrl+C at once.
constexpr double kFrameSeconds = 0.05;

}  // namespace

HeadlessRenderer::HeadlessRenderer(const std::string& backend)
{
    const auto kind = render::backendFromName(backend).value_or(render::BackendKind::Cpu);
    if (render::needsGl(kind)) m_context = render::EglContext::create();
    m_renderer = std::make_unique<render::ProgressiveRenderer>(render::makeBackend(kind));
}

HeadlessRenderer::~HeadlessRenderer() = default;

void addBackendOption(CLI::App& command, std::string& backend)
{
    command
        .add_option("--backend", backend,
                    "What draws: auto, cpu, gl-compute or gl-points; default auto, which is cpu here")
        ->type_name("NAME")
        ->check([](const std::string& name) {
            if (name == "auto" || render::backendFromName(name)) return std::string();
            return "There is no backend \"" + name + "\"; there are auto, cpu, gl-compute and gl-points.";
        });
}

void drawAll(render::ProgressiveRenderer& renderer, bool bruteForce, Progress& progress)
{
    if (bruteForce) {
        renderer.renderBruteForce();
        return;
    }
    constexpr std::uint64_t kParts = 1000;
    progress.begin("Drawing", kParts);
    std::uint64_t done = 0;
    for (;;) {
        progress.check();
        const render::FrameReport report = renderer.renderFrame(kFrameSeconds);
        if (report.converged) return;
        const std::uint64_t now = std::uint64_t(report.share * kParts);
        if (now > done) progress.add(now - done);
        done = std::max(done, now);
    }
}

namespace
{

constexpr std::int64_t kMostSamples = std::int64_t(1) << 26;  ///< of a picture drawn whole: 512 MiB
constexpr int kTile = 2048;                                   ///< px

/// The depth range that eye-dome lighting goes by, of a picture that is drawn in tiles: that of a small one, which
/// shows the same.
float extentOf(render::ProgressiveRenderer& renderer, int width, int height)
{
    const render::DisplaySettings shown = renderer.display();
    const double scale = double(kTile) / std::max(width, height);
    render::DisplaySettings small = shown;
    small.pointSize = std::max(1.0, shown.pointSize * scale);
    small.samples = 1;
    renderer.setPart(std::nullopt);
    renderer.setDisplay(small);
    renderer.setSize(std::max(1, int(width * scale)), std::max(1, int(height * scale)));
    renderer.renderBruteForce();
    std::vector<float> depths;
    renderer.depths(depths);
    const bool perspective = !renderer.camera().orthographic;
    for (float& depth : depths)
        depth = std::isfinite(depth) ? render::eyeDomeLevel(depth, perspective) : render::kNoLevel;
    renderer.setDisplay(shown);
    return render::eyeDomeExtent(depths);
}

}  // namespace

Picture drawPicture(render::ProgressiveRenderer& renderer, int width, int height, bool bruteForce,
                    Progress& progress)
{
    const render::DisplaySettings& display = renderer.display();
    Picture picture;
    if (std::int64_t(width) * height * display.samples <= kMostSamples) {
        renderer.setPart(std::nullopt);
        renderer.setSize(width, height);
        drawAll(renderer, bruteForce, progress);
        progress.check();
        picture.covered = renderer.coveredShare();
        picture.image = renderer.image();
        return picture;
    }
    // Tiles overlap by what lighting looks at beyond their edges.
    const float extent = display.eyeDome > 0 ? extentOf(renderer, width, height) : 0.0f;
    const int margin = extent > 0 ? 2 * display.eyeDomeReach() : 0;
    const int side = kTile - 2 * margin;
    const int columns = (width + side - 1) / side, rows = (height + side - 1) / side;
    progress.begin("Drawing", std::uint64_t(columns) * std::uint64_t(rows));
    picture.image.resize(width, height);
    std::vector<float> depths;
    renderer.setSize(kTile, kTile);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            progress.check();
            const int x = column * side, y = row * side;
            const int w = std::min(side, width - x), h = std::min(side, height - y);
            renderer.setPart(render::PicturePart{x - margin, y - margin, width, height}, extent);
            renderer.renderBruteForce();
            std::size_t covered = 0;
            renderer.depths(depths);
            const render::Image& tile = renderer.image();
            for (int r = 0; r < h; ++r) {
                const auto from = std::size_t(r + margin) * kTile + std::size_t(margin),
                           to = std::size_t(y + r) * std::size_t(width) + std::size_t(x);
                std::copy_n(tile.pixels.begin() + std::ptrdiff_t(from), w,
                            picture.image.pixels.begin() + std::ptrdiff_t(to));
                const float* const d = depths.data() + from;
                covered += std::size_t(std::count_if(d, d + w, [](float depth) { return std::isfinite(depth); }));
            }
            picture.covered += double(covered) / (double(width) * double(height));
            progress.add(1);
        }
    renderer.setPart(std::nullopt);
    return picture;
}

}  // namespace punctum::app
