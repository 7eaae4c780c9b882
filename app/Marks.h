// SPDX-License-Identifier: MIT
#pragma once

#include "app/Files.h"
#include "core/cloud/Section.h"
#include "core/cloud/Visibility.h"
#include "render/camera/Camera.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/scene/Image.h"

#include <optional>
#include <vector>

namespace CLI
{
class App;
class Option;
}  // namespace CLI

namespace punctum::app
{

/// What is to be drawn on a picture.
struct MarkOptions {
    bool legend = false, scaleBar = false, northArrow = false;
    bool ruler = false;  ///< heights and distances of a section
    double scale = 0.0;  ///< px of the picture for each px of the marks; 0: as suits the size

    bool any() const noexcept { return legend || scaleBar || northArrow || ruler; }
};

/// Adds --legend, --scale-bar, --north-arrow, --ruler (which needs `section`) and --mark-scale.
void addMarkOptions(CLI::App& command, MarkOptions& options, CLI::Option& section);

/// Draws them on the finished picture of these clouds. `visibility`: of each cloud. Needs no display. Throws Error,
/// Cancelled.
void drawMarks(render::Image& image, const MarkOptions& options, const std::vector<DrawableCloud>& clouds,
               const std::vector<Visibility>& visibility, const render::ProgressiveRenderer& renderer,
               const std::optional<Section>& section, Progress& progress);

}  // namespace punctum::app
