// SPDX-License-Identifier: MIT
#include "core/surface/Surface.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

constexpr std::size_t kGroundBlock = 256;  ///< words of a set that one task looks at: 16,384 points

}  // namespace

Surface::Surface(std::shared_ptr<const PointCloud> cloud, const SurfaceSettings& settings, Progress& progress)
    : m_cloud(std::move(cloud)), m_settings(settings)
{
    makeAll(progress);
}

bool Surface::isConcerned(const ChangeNotice& notice) const
{
    if (notice.kind == ChangeNotice::Kind::Deleted) return true;
    return std::find(notice.attributes.begin(), notice.attributes.end(), "Classification") !=
           notice.attributes.end();
}

/// Those of the points (null: of all) that are ground now.
PointSet Surface::groundOf(const PointSet* among, Progress& progress) const
{
    const std::shared_lock lock(m_cloud->mutex());
    const Attribute* const classes = m_cloud->findAttribute("Classification");
    if (!classes) throw Error("A surface needs points with classes, and these have none.");
    const PointSet* const deleted = m_cloud->deleted().get();
    PointSet ground(m_cloud->size());
    const std::size_t words = ground.words().size();
    tbb::parallel_for(std::size_t(0), (words + kGroundBlock - 1) / kGroundBlock, [&](std::size_t block) {
        if (progress.cancelled()) return;
        const std::size_t first = block * kGroundBlock, last = std::min(words, first + kGroundBlock);
        if (among &&
            std::all_of(among->words().begin() + std::ptrdiff_t(first),
                        among->words().begin() + std::ptrdiff_t(last), [](std::uint64_t w) { return w == 0; }))
            return;
        std::array<std::uint8_t, kGroundBlock * 64> codes;
        const PointRange range{first * 64, std::min<PointIndex>(last * 64, m_cloud->size())};
        classes->gatherBits(range, codes.data());
        for (PointIndex i = range.first; i < range.last; ++i)
            if (m_settings.classes[codes[i - range.first]]) ground.insert(i);
        for (std::size_t w = first; w < last; ++w) {
            if (among) ground.words()[w] &= among->words()[w];
            if (deleted) ground.words()[w] &= ~deleted->words()[w];
        }
    });
    progress.check();
    return ground;
}

void Surface::makeAll(Progress& progress)
{
    const PointSet ground = groundOf(nullptr, progress);
    auto tiles = std::make_unique<SurfaceTiles>(*m_cloud, ground, m_settings.reach, progress);
    std::unique_lock lock(m_mutex);
    std::swap(m_tiles, tiles);
    const std::size_t count = m_tiles->size();
    std::vector<std::shared_ptr<const SurfaceTile>> made(count);
    progress.begin(kTilesStage, count);
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t t) {
        if (progress.cancelled()) return;
        made[t] = makeTile(t);
        progress.add(1);
    });
    if (progress.cancelled()) {
        std::swap(m_tiles, tiles);
        throw Cancelled();
    }
    auto neighbors = std::make_shared<const TileNeighbors>(*m_tiles);
    lock.unlock();
    show(std::move(made), std::move(neighbors));
}

std::shared_ptr<const SurfaceTile> Surface::makeTile(std::size_t t)
{
    constexpr int kRow = SurfaceTile::kRow;
    auto tile = std::make_shared<SurfaceTile>();
    tile->box = m_tiles->box(t);
    tile->least = INFINITY;
    tile->most = -INFINITY;
    const double cell = (tile->box.maxX - tile->box.minX) / SurfaceTile::kCells;
    const SurfaceNet net = m_tiles->noteNet(t, 1.0 / SurfaceTile::kCells);
    if (!net.triangles.empty()) tile->base = net.triangles.vertices()[0].z;
    std::uint32_t near = 0;
    for (int j = 0; j < kRow; ++j)
        for (int k = 0; k < kRow; ++k) {
            const int i = j % 2 == 0 ? k : kRow - 1 - k;  // to and fro, so that the next place is near
            const std::optional<double> z =
                net.height(tile->box.minX + (i - 1) * cell, tile->box.minY + (j - 1) * cell, near);
            float& height = tile->heights[std::size_t(j) * kRow + std::size_t(i)];
            height = z ? float(*z - tile->base) : NAN;
            if (!z) continue;
            tile->least = std::min(tile->least, height);
            tile->most = std::max(tile->most, height);
        }
    return tile;
}

void Surface::show(std::vector<std::shared_ptr<const SurfaceTile>> tiles,
                   std::shared_ptr<const TileNeighbors> neighbors)
{
    const std::shared_ptr<const SurfaceView> old = m_view.load();
    auto view = std::make_shared<SurfaceView>();
    view->tiles = std::move(tiles);
    view->neighbors = std::move(neighbors);
    view->steps = withTiles([](const SurfaceTiles& made) { return made.steps(); });
    view->version = old ? old->version + 1 : 1;
    if (old && old->tiles.size() == view->tiles.size()) {  // colors stay while somebody edits
        view->low = old->low;
        view->high = old->high;
    } else {
        std::vector<double> middles;
        for (const auto& tile : view->tiles)
            for (int i = 0; i < SurfaceTile::kCells && !tile->empty(); i += 8)
                for (int j = 0; j < SurfaceTile::kCells; j += 8)
                    if (const float z = tile->height(i, j); !std::isnan(z))
                        middles.push_back(tile->base + double(z));
        if (!middles.empty()) {
            const auto at = [&](double share) {
                const auto k = middles.begin() + std::ptrdiff_t(share * double(middles.size() - 1));
                std::nth_element(middles.begin(), k, middles.end());
                return *k;
            };
            view->low = at(0.01);
            view->high = at(0.99);
        }
    }
    m_view.store(std::move(view));
}

std::size_t Surface::groundPoints() const
{
    return withTiles([](const SurfaceTiles& tiles) { return tiles.pointCount(); });
}

std::size_t Surface::update(const PointSet* changed, Progress& progress)
{
    if (changed && changed->count() > m_cloud->size() / 8) changed = nullptr;  // sorting anew is quicker then
    if (!changed) {
        makeAll(progress);
        return view()->tiles.size();
    }
    const PointSet ground = groundOf(changed, progress);
    std::vector<std::size_t> touched;
    const auto before = view();
    std::vector<std::shared_ptr<const SurfaceTile>> tiles = before->tiles;
    {
        const std::unique_lock lock(m_mutex);
        touched = m_tiles->change(*changed, ground);
        tbb::parallel_for(std::size_t(0), touched.size(), [&](std::size_t k) {
            if (!progress.cancelled()) tiles[touched[k]] = makeTile(touched[k]);
        });
    }
    progress.check();
    if (!touched.empty()) show(std::move(tiles), before->neighbors);
    return touched.size();
}

}  // namespace punctum
