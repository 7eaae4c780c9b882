// SPDX-License-Identifier: MIT
#include "app/Renderer.h"

#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/progressive/WholePicture.h"

#include <algorithm>

namespace punctum::app
{

namespace
{

/// Seconds a frame may take where nobody watches: short enough to answer Ctrl+C at once.
constexpr double kFrameSeconds = 0.05;
constexpr std::uint64_t kParts = 1000;  ///< of a picture, as progress is told

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

Picture drawPicture(render::ProgressiveRenderer& renderer, int width, int height, bool bruteForce,
                    Progress& progress)
{
    render::WholePicture whole(renderer, width, height, bruteForce);
    progress.begin("Drawing", kParts);
    std::uint64_t done = 0;
    while (!whole.draw(kFrameSeconds)) {
        progress.check();
        const auto now = std::uint64_t(whole.share() * kParts);
        if (now > done) progress.add(now - done);
        done = std::max(done, now);
    }
    progress.check();
    return {whole.takeImage(), whole.covered()};
}

}  // namespace punctum::app
