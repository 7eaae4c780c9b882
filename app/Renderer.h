// SPDX-License-Identifier: MIT
#pragma once

#include "render/gl/EglContext.h"
#include "render/progressive/ProgressiveRenderer.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace punctum
{
class Progress;
}

namespace punctum::render
{
class EglContext;
}

namespace punctum::app
{

/// A renderer with no window, and the OpenGL context it may need. One thread: the one that makes it.
class HeadlessRenderer
{
public:
    /// `backend`: "auto" (cpu: the same picture on every machine), "cpu", "gl-compute" or "gl-points". Throws
    /// Error.
    explicit HeadlessRenderer(const std::string& backend);
    ~HeadlessRenderer();
    HeadlessRenderer(const HeadlessRenderer&) = delete;
    HeadlessRenderer& operator=(const HeadlessRenderer&) = delete;

    render::ProgressiveRenderer& renderer() noexcept { return *m_renderer; }

private:
    render::EglContext m_context;  ///< empty for cpu; outlives the renderer, whose objects live in it
    std::unique_ptr<render::ProgressiveRenderer> m_renderer;
};

/// Adds --backend, which takes the names above.
void addBackendOption(CLI::App& command, std::string& backend);

/// A picture of every point and what was found on the way.
struct Picture {
    render::Image image;
    double covered = 0;  ///< share of the pixels that have a point
};
/// Draws a picture of this size, large ones tile by tile, so that memory holds little more than the picture.
/// Display and camera have been set. `bruteForce`: in one pass. Throws Error, Cancelled.
Picture drawPicture(render::ProgressiveRenderer& renderer, int width, int height, bool bruteForce,
                    Progress& progress);

/// Draws until the picture shows every point, progressively or in one pass. Throws Error, Cancelled.
void drawAll(render::ProgressiveRenderer& renderer, bool bruteForce, Progress& progress);

}  // namespace punctum::app
