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
    const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
    progress.begin("Drawing", std::uint64_t(columns) * std::uint64_t(rows));
    picture.image.resize(width, height);
    std::vector<float> depths, part;  // lighting looks at all of the picture
    if (display.eyeDome > 0) depths.resize(picture.image.pixels.size());
    renderer.setSize(kTile, kTile);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            progress.check();
            const int x = column * kTile, y = row * kTile;
            const int w = std::min(kTile, width - x), h = std::min(kTile, height - y);
            renderer.setPart(render::PicturePart{x, y, width, height});
            renderer.renderBruteForce();
            std::size_t covered = 0;
            renderer.depths(part);
            for (int r = 0; r < h; ++r) {
                const auto from = std::size_t(r) * kTile,
                           to = std::size_t(y + r) * std::size_t(width) + std::size_t(x);
                std::copy_n(renderer.image().pixels.begin() + std::ptrdiff_t(from), w,
                            picture.image.pixels.begin() + std::ptrdiff_t(to));
                const float* const d = part.data() + from;
                covered += std::size_t(std::count_if(d, d + w, [](float depth) { return std::isfinite(depth); }));
                if (!depths.empty()) std::copy_n(d, w, depths.data() + to);
            }
            picture.covered += double(covered) / (double(width) * double(height));
            progress.add(1);
        }
    renderer.setPart(std::nullopt);
    if (!depths.empty())
        render::shadeEyeDome(depths, !renderer.camera().orthographic, float(display.eyeDome), display.leastPixels(),
                             picture.image);
    return picture;
}

}  // namespace punctum::app
