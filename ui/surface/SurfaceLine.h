// SPDX-License-Identifier: MIT
#pragma once

#include "ui/section/SectionOverlays.h"

#include <glm/vec3.hpp>

#include <vector>

namespace punctum::ui
{

/// The ground surface as a line over a section view. GUI thread only.
class SurfaceLine final : public ViewLayer
{
    Q_OBJECT
public:
    using ViewLayer::ViewLayer;
    /// Pieces of it, in world; none: nothing is drawn.
    void setPieces(std::vector<std::vector<glm::dvec3>> pieces);
    const std::vector<std::vector<glm::dvec3>>& pieces() const noexcept { return m_pieces; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::vector<std::vector<glm::dvec3>> m_pieces;
};

}  // namespace punctum::ui
