// SPDX-License-Identifier: MIT
#pragma once

#include "render/backends/Backends.h"
#include "tests/render/RenderedView.h"

#include <QString>

#include <algorithm>
#include <memory>
#include <vector>

namespace punctum::test
{

using namespace punctum::render;

/// What the checks of the OpenGL backends draw and compare.
inline constexpr int kWidth = 400, kHeight = 260;
/// Of mean colors, as Tolerance::cpu.
inline constexpr double kAveraged = 0.003;

inline Camera cameraFor(const PointCloud& cloud)
{
    return cameraFor(cloud, kWidth, kHeight);
}

struct View : RenderedView {
    View(std::unique_ptr<RasterBackend> backend, const std::vector<std::shared_ptr<PointStore>>& stores,
         const Camera& camera, const DisplaySettings& display)
        : RenderedView(std::move(backend), stores, camera, display, kWidth, kHeight)
    {
    }
    int converge(double budget = 0.02) { return RenderedView::converge(budget); }
};

inline std::unique_ptr<RasterBackend> cpu()
{
    return makeBackend(BackendKind::Cpu);
}

/// Pixels that differ as a share of those that show a point.
inline double share(const Image& a, const Image& b, double covered)
{
    return differing(a, b) / std::max(1.0, covered * kWidth * kHeight);
}

/// share() of a picture from what all points give on another view, which is drawn for it.
inline double share(const Image& image, View& reference)
{
    const Image expected = reference.bruteForce();
    return share(image, expected, reference.renderer.coveredShare());
}

/// One picture of all points by the processor and by another backend.
struct BesideCpu {
    View reference, view;
    Image expected, image;
    double covered;

    BesideCpu(std::unique_ptr<RasterBackend> backend, const std::vector<std::shared_ptr<PointStore>>& stores,
              const Camera& camera, const DisplaySettings& display)
        : reference(cpu(), stores, camera, display),
          view(std::move(backend), stores, camera, display),
          expected(reference.bruteForce()),
          image(view.bruteForce()),
          covered(reference.renderer.coveredShare())
    {
    }
    double different() const { return share(image, expected, covered); }
};

inline QString percent(double value)
{
    return QString::number(100 * value, 'f', 3) + " %";
}

}  // namespace punctum::test
