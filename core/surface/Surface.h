// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"
#include "core/surface/TileNeighbors.h"

#include <array>
#include <atomic>
#include <bitset>
#include <memory>
#include <shared_mutex>
#include <vector>

namespace punctum
{

/// Heights of the surface at the nodes of a tile's grid, for drawing. Immutable.
struct SurfaceTile {
    static constexpr int kCells = 32;        ///< along each side
    static constexpr int kRow = kCells + 3;  ///< nodes along each side, with one beyond each edge

    RawRect box;
    double base = 0;            ///< raw Z that heights are told from, so that floats are exact enough
    float least = 0, most = 0;  ///< of the heights; least > most: there is no surface
    std::array<float, std::size_t(kRow) * kRow> heights{};  ///< NaN: no surface there

    /// Of node (i, j), from -1 to kCells + 1; nodes 0 and kCells are on the edges.
    float height(int i, int j) const noexcept { return heights[std::size_t(j + 1) * kRow + std::size_t(i + 1)]; }
    bool empty() const noexcept { return least > most; }
};

/// All tiles of a surface at one moment. Immutable, so that it can be drawn while the next one is made.
struct SurfaceView {
    std::vector<std::shared_ptr<const SurfaceTile>> tiles;
    std::shared_ptr<const TileNeighbors> neighbors;
    std::array<double, 3> steps{1, 1, 1};  ///< units of true length of a raw step along each axis
    std::uint64_t version = 0;             ///< another one after each change
    /// Range of most of the heights (raw Z), without the outermost hundredths.
    double low = 0, high = 0;
};

/// Which points make the surface.
struct SurfaceSettings {
    std::bitset<256> classes{4};  ///< 2, ground
    double reach = 0;             ///< SurfaceTiles
    friend bool operator==(const SurfaceSettings&, const SurfaceSettings&) = default;
};

/// The ground surface of a cloud, kept up with edits: made once, after which each change of classes, or of which
/// points are deleted, costs the tiles about the changed points alone.
///
/// Any thread: view() and the questions at any time, while another thread is in update(). Those who call update()
/// wait for each other. All take cloud.mutex() shared for a while. Owns a share of the cloud.
class Surface
{
public:
    /// The second of the two stages that making all of it has, and the longer one.
    static constexpr const char* kTilesStage = "Making the surface";

    /// In parallel. Throws Cancelled, and Error (no classes, more than 2^32 points).
    Surface(std::shared_ptr<const PointCloud> cloud, const SurfaceSettings& settings, Progress& progress);

    /// Looks at the points of a change again (null: all of them). Returns how many tiles are others now. Throws
    /// Cancelled where there is much to do; the surface is then as before, but for what is known of it no longer:
    /// call it again with null.
    std::size_t update(const PointSet* changed, Progress& progress);
    /// Whether a change can be one of the surface.
    bool isConcerned(const ChangeNotice& notice) const;

    std::shared_ptr<const SurfaceView> view() const noexcept { return m_view.load(); }
    const PointCloud& cloud() const noexcept { return *m_cloud; }
    const SurfaceSettings& settings() const noexcept { return m_settings; }
    std::size_t groundPoints() const;

    /// Calls f(tiles) with the tiles of the moment, which do not change meanwhile.
    template <typename F>
    auto withTiles(F&& f) const
    {
        const std::shared_lock lock(m_mutex);
        return f(static_cast<const SurfaceTiles&>(*m_tiles));
    }

private:
    PointSet groundOf(const PointSet* among, Progress& progress) const;
    void makeAll(Progress& progress);
    std::shared_ptr<const SurfaceTile> makeTile(std::size_t tile);
    void show(std::vector<std::shared_ptr<const SurfaceTile>> tiles,
              std::shared_ptr<const TileNeighbors> neighbors);

    std::shared_ptr<const PointCloud> m_cloud;
    SurfaceSettings m_settings;
    mutable std::shared_mutex m_mutex;  ///< guards the tiles
    std::unique_ptr<SurfaceTiles> m_tiles;
    std::atomic<std::shared_ptr<const SurfaceView>> m_view;
};

}  // namespace punctum
