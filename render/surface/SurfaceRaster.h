// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Surface.h"
#include "render/scene/Image.h"
#include "render/scene/LayerClip.h"
#include "render/scene/LayerProjection.h"
#include "render/scene/ResolveSettings.h"
#include "render/scene/TargetSize.h"
#include "render/store/LocalFrame.h"
#include "render/surface/SurfaceContours.h"
#include "render/surface/SurfaceLook.h"

#include <memory>
#include <span>
#include <vector>

namespace punctum::render
{

/// The surface of one cloud, as the camera sees it.
struct SurfaceLayer {
    std::shared_ptr<const SurfaceView> view;
    LayerProjection projection;  ///< that of the cloud's points
    LocalFrame frame;
    LayerClip clip;
    /// px that a unit of length covers: in perspective at depth 1, in parallel anywhere.
    double pixelsPerUnit = 1;
    /// What contours go by: Z = raw Z * zScale + zOffset.
    double zScale = 1, zOffset = 0;
};

/// The ground surface as a picture with depths, drawn by the processor for every backend, and put together with the
/// picture of the points. The same picture in the same view, whatever came before: where only some tiles have
/// changed since the last one, the rectangle of the picture that they reach is drawn again, to the same pixels.
///
/// Each tile is drawn by the nodes of its grid, or every second, fourth and so on of them, so that a cell is about
/// `cellPx` px at most. Contours are found per pixel from the heights that were drawn. One thread calls; inside,
/// bands of rows are drawn in parallel.
class SurfaceRaster
{
public:
    /// Pixels of a picture; the last row and column are not part of it.
    struct Rectangle {
        int firstColumn = 0, lastColumn = 0, firstRow = 0, lastRow = 0;

        bool empty() const noexcept { return firstColumn >= lastColumn || firstRow >= lastRow; }
        void include(const Rectangle& other) noexcept;
        Rectangle cutTo(const Rectangle& other) const noexcept;
    };

    /// Of a still picture, and while the camera moves.
    static constexpr double kFineCell = 2.0, kCoarseCell = 6.0;  // px

    void draw(std::span<const SurfaceLayer> layers, const TargetSize& size, double cellPx, SurfaceLook look,
              const SurfaceContours& contours = {});
    /// What the points' picture shows.
    struct Points {
        std::span<const float> depths;           ///< VisibilityBuffer::depths()
        std::span<const std::uint8_t> replaced;  ///< 1: the nearest one gives way to the surface; empty: none does
        bool onTop = false;                      ///< those behind the surface are seen through it
    };
    /// Puts the points' picture, which was made before a transparent background, in front of or behind it.
    /// `settings`: with the background that lies behind all.
    void compose(Image& picture, const Points& points, const ResolveSettings& settings) const;

    std::span<const float> depths() const noexcept { return m_depths; }  ///< infinity: no surface
    std::span<const Rgba8> colors() const noexcept { return m_colors; }  ///< without contours
    /// How much contours darken each pixel; empty: there are none.
    std::span<const std::uint8_t> ink() const noexcept { return m_ink; }
    /// What the last draw() has drawn anew.
    const Rectangle& drawn() const noexcept { return m_drawn; }

private:
    struct Node {
        double x = 0, y = 0;  ///< px
        float w = 0;          ///< 1 / depth in perspective, depth in parallel; NaN: nothing
        float r = 0, g = 0, b = 0;
        float level = 0;  ///< LevelPicture
    };
    struct Placed {
        std::size_t layer = 0, tile = 0;
        int step = 1;                ///< 0: it is out of sight
        Rectangle pixels;            ///< none of it is elsewhere
        bool keepsToOthers = false;  ///< a neighbor has larger cells (TileEdges)
    };

    /// A tile whose nodes are of these heights.
    Placed place(const SurfaceLayer& layer, const SurfaceTile& tile, double least, double most,
                 double cellPx) const;
    void placeAll(std::span<const SurfaceLayer> layers, double cellPx);
    /// Whether the picture is that of the last draw(), but for tiles that were replaced.
    bool isSameView(std::span<const SurfaceLayer> layers, const TargetSize& size, double cellPx, SurfaceLook look,
                    const SurfaceContours& contours) const noexcept;
    Rectangle changedPixels(std::span<const SurfaceLayer> layers, const std::vector<Placed>& before,
                            const std::vector<std::vector<double>>& cellsBefore) const;
    void drawTile(std::span<const SurfaceLayer> layers, const Placed& placed, const Rectangle& within,
                  SurfaceLook look, std::vector<Node>& nodes);
    void drawTriangle(const Node& a, const Node& b, const Node& c, bool perspective, const Rectangle& within);
    /// Of a raw Z.
    float levelOf(const SurfaceLayer& layer, double z) const noexcept;
    void drawInk();
    Rgba8 seen(std::size_t pixel) const noexcept;

    int m_width = 0, m_height = 0;
    std::vector<SurfaceLayer> m_layers;  ///< as they were drawn last
    double m_cellPx = 0;
    SurfaceLook m_look = SurfaceLook::None;
    SurfaceContours m_contours;
    double m_levelZero = 0;  ///< from where levels are told, in intervals
    Rectangle m_drawn;
    std::vector<Rgba8> m_colors;
    std::vector<float> m_depths;
    std::vector<float> m_levels;               ///< LevelPicture; empty: no contours
    std::vector<std::uint8_t> m_ink;           ///< drawContours()
    std::vector<Placed> m_placed;              ///< the tiles in sight
    std::vector<std::vector<double>> m_cells;  ///< of each layer, for TileEdges
    double m_nearestSlack = 0;                 ///< of depths, for a depth of 1 (perspective) or for all
    bool m_perspective = true;
};

}  // namespace punctum::render
