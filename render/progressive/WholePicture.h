// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/ProgressiveRenderer.h"

#include <vector>

namespace punctum::render
{

/// A picture of every point, of whatever size, drawn step by step: large ones tile by tile, so that memory holds
/// little more than the picture.
///
///     WholePicture whole(renderer, 8000, 5000);
///     while (!whole.draw(0.05)) progress.check();
///     const Image image = whole.takeImage();
///
/// Display and camera of the renderer have been set; its size and part are changed, and left as they come out.
/// Thread: the renderer's. Throws what the renderer throws.
class WholePicture
{
public:
    /// `bruteForce`: each tile in one pass, which takes as long as it takes.
    WholePicture(ProgressiveRenderer& renderer, int width, int height, bool bruteForce = false);

    /// Goes on for about so many seconds. True: the picture is finished.
    bool draw(double seconds);
    /// Of the picture, 0 to 1.
    double share() const noexcept;
    /// Share of the pixels that have a point, once it is finished.
    double covered() const noexcept { return m_covered; }
    /// The finished picture, once.
    Image takeImage() { return std::move(m_image); }

private:
    bool tiled() const noexcept { return m_columns * m_rows > 1; }
    /// Of what each tile is taken for, px.
    int side() const noexcept;
    void beginTile();
    void keepTile();
    void beginExtent();
    void keepExtent();
    FrameReport drawPart(double seconds);

    ProgressiveRenderer* m_renderer;
    int m_width, m_height;
    bool m_bruteForce;
    int m_columns = 1, m_rows = 1, m_tile = 0;
    int m_margin = 0;  ///< px: tiles overlap by what lighting looks at beyond their edges
    bool m_begun = false;
    bool m_extentWanted = false;  ///< of depths, which lighting goes by, from a small picture that shows the same
    float m_extent = 0;
    DisplaySettings m_shown;
    double m_partShare = 0;
    double m_covered = 0;
    Image m_image;
    std::vector<float> m_depths;  ///< of a tile's pixels
};

}  // namespace punctum::render
