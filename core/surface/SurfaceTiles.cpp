// SPDX-License-Identifier: MIT
#include "core/surface/SurfaceTiles.h"

#include "core/Error.h"
#include "core/surface/SurfaceNetMaker.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace punctum
{

namespace
{

constexpr double kReachMeters = 100.0;
constexpr double kReachSpacings = 25.0;

/// Bits of x at the even places.
std::uint64_t spreadBits(std::uint64_t x) noexcept
{
    x = (x | (x << 16)) & 0x0000FFFF0000FFFFu;
    x = (x | (x << 8)) & 0x00FF00FF00FF00FFu;
    x = (x | (x << 4)) & 0x0F0F0F0F0F0F0F0Fu;
    x = (x | (x << 2)) & 0x3333333333333333u;
    return (x | (x << 1)) & 0x5555555555555555u;
}

double squaredGapTo(const RawRect& rect, const RawDisc& disc, const PlaneMetric& m) noexcept
{
    const double dx = std::max({rect.minX - disc.x, 0.0, disc.x - rect.maxX}),
                 dy = std::max({rect.minY - disc.y, 0.0, disc.y - rect.maxY});
    return m.x * dx * dx + m.y * dy * dy;
}

}  // namespace

/// Whether any of the triangles about a corner counts.
bool SurfaceNet::countsAbout(std::uint32_t triangle, std::size_t corner) const noexcept
{
    const std::uint32_t vertex = triangles.triangles()[triangle][corner];
    for (const std::size_t turn : {0u, 2u}) {  // across the edge after the corner, then the one before it
        for (std::uint32_t t = triangle;;) {
            const std::array<std::uint32_t, 3>& v = triangles.triangles()[t];
            const std::size_t i = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
            t = triangles.neighbors()[t][(i + turn) % 3];
            if (t == triangle) return false;
            if (t == Triangulation::kNone) break;
            if (counts(t)) return true;
        }
    }
    return false;
}

std::optional<double> SurfaceNet::height(double x, double y, std::uint32_t& near) const noexcept
{
    const std::optional<std::uint32_t> t = triangles.locate(x, y, near);
    if (!t) return std::nullopt;
    if (counts(*t)) return triangles.heightIn(*t, x, y);
    // on the edge of one that counts, or at its corner
    for (std::size_t i = 0; i < 3; ++i) {
        const SurfacePoint& a = triangles.vertices()[triangles.triangles()[*t][i]];
        if (double(a.x) == x && double(a.y) == y)
            return countsAbout(*t, i) ? std::optional<double>(a.z) : std::nullopt;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t other = triangles.neighbors()[*t][i];
        if (other == Triangulation::kNone || !counts(other)) continue;
        const SurfacePoint &a = triangles.vertices()[triangles.triangles()[*t][i]],
                           &b = triangles.vertices()[triangles.triangles()[*t][(i + 1) % 3]];
        if ((double(b.x) - a.x) * (y - a.y) == (double(b.y) - a.y) * (x - a.x))
            return triangles.heightIn(other, x, y);
    }
    return std::nullopt;
}

double SurfaceTiles::reachOf(const TrueLengths& lengths, double spacing) noexcept
{
    return std::max(kReachMeters / (lengths.meters > 0 ? lengths.meters : 1.0), kReachSpacings * spacing);
}

SurfaceTiles::SurfaceTiles(const PointCloud& cloud, const PointSet& ground, double reach, Progress& progress)
{
    if (cloud.size() > UINT32_MAX) throw Error("A surface can be made of at most 4,294,967,295 points.");
    const TrueLengths lengths = trueLengths(cloud);
    for (std::size_t a = 0; a < 3; ++a) {
        m_columns[a] = cloud.columns()[a];
        m_axes[a] = cloud.columns()[a]->values<std::int32_t>().data();
        m_steps[a] = lengths.stretch[int(a)] * cloud.coordinates().scale[int(a)];
    }
    m_metric = PlaneMetric::of(m_steps[0], m_steps[1]);

    const RawBounds bounds = cloud.computeBounds();
    if (bounds.empty()) return;
    const std::uint64_t extent = std::uint64_t(std::max(bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y));
    const int levels = std::max(1, int(std::bit_width(extent)));

    progress.begin("Sorting ground points", 2 * ground.words().size());
    const std::vector<PointIndex> before = ground.ranks(256);
    std::vector<Keyed> keyed(before.back());
    tbb::parallel_for(std::size_t(0), before.size() - 1, [&](std::size_t block) {
        if (progress.cancelled()) return;
        std::size_t at = before[block];
        const std::size_t last = std::min(ground.words().size(), (block + 1) * 256);
        ground.forEachInWords(block * 256, last, [&](PointIndex i) {
            const std::uint64_t x = std::uint64_t(m_axes[0][i] - bounds.min.x),
                                y = std::uint64_t(m_axes[1][i] - bounds.min.y);
            keyed[at++] = {spreadBits(x) | spreadBits(y) << 1, std::uint32_t(i)};
        });
        progress.add(last - block * 256);
    });
    progress.check();
    tbb::parallel_sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
        return a.key != b.key ? a.key < b.key : a.index < b.index;
    });
    progress.check();

    const double side = std::ldexp(1.0, levels);
    // tiles hold their lower and left edge; points lie on whole numbers
    const double left = double(bounds.min.x) - 0.5, low = double(bounds.min.y) - 0.5;
    m_nodes.push_back({{left, low, left + side, low + side}, 0, 0});
    grow(0, levels, keyed);

    m_reach = reach;
    if (!(reach > 0)) {
        // spacing: in the middle one of all tiles that have a fair number of points
        std::vector<double> spacings;
        for (const Node& node : m_nodes) {
            if (node.children != 0 || m_points[node.tile].size() < 16) continue;
            const double area = (node.box.maxX - node.box.minX) * (node.box.maxY - node.box.minY);
            spacings.push_back(std::sqrt(area * m_steps[0] * m_steps[1] / double(m_points[node.tile].size())));
        }
        double spacing = 0;
        if (!spacings.empty()) {
            const auto middle = spacings.begin() + std::ptrdiff_t(spacings.size() / 2);
            std::nth_element(spacings.begin(), middle, spacings.end());
            spacing = *middle;
        }
        m_reach = reachOf(lengths, spacing);
    }
    m_rawReach = {m_reach / m_steps[0], m_reach / m_steps[1]};
    m_squaredReach = m_rawReach[0] * m_rawReach[0] * m_metric.x;
    splitWide(0);
    numberTiles();
    progress.add(ground.words().size());
}

void SurfaceTiles::splitNode(std::uint32_t n)
{
    const RawRect box = m_nodes[n].box;
    const double x = (box.minX + box.maxX) / 2, y = (box.minY + box.maxY) / 2;
    const std::uint32_t first = std::uint32_t(m_nodes.size());
    m_nodes[n].children = first;
    // by the bits of a Morton code: x is the lower one
    m_nodes.push_back({{box.minX, box.minY, x, y}, 0, 0});
    m_nodes.push_back({{x, box.minY, box.maxX, y}, 0, 0});
    m_nodes.push_back({{box.minX, y, x, box.maxY}, 0, 0});
    m_nodes.push_back({{x, y, box.maxX, box.maxY}, 0, 0});
}

void SurfaceTiles::grow(std::uint32_t n, int level, std::span<const Keyed> points)
{
    if (points.size() <= kMostPoints || level == 0) {
        m_nodes[n].tile = std::uint32_t(m_points.size());
        std::vector<std::uint32_t>& own = m_points.emplace_back();
        own.reserve(points.size());
        for (const Keyed& p : points) own.push_back(p.index);
        return;
    }
    splitNode(n);
    const int shift = 2 * (level - 1);
    std::size_t from = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const auto end = std::partition_point(points.begin() + std::ptrdiff_t(from), points.end(),
                                              [&](const Keyed& p) { return ((p.key >> shift) & 3) <= i; });
        const std::size_t to = std::size_t(end - points.begin());
        grow(m_nodes[n].children + i, level - 1, points.subspan(from, to - from));
        from = to;
    }
}

bool SurfaceTiles::hasPointsIn(const RawRect& rect) const noexcept
{
    bool any = false;
    forTilesIn(rect, [&](std::size_t tile) { any = any || !m_points[tile].empty(); });
    return any;
}

/// Tiles that are wider than the reach, and may have surface.
void SurfaceTiles::splitWide(std::uint32_t n)
{
    if (m_nodes[n].children != 0) {
        for (std::uint32_t i = 0; i < 4; ++i) splitWide(m_nodes[n].children + i);
        return;
    }
    const RawRect box = m_nodes[n].box;
    if ((box.maxX - box.minX <= m_rawReach[0] && box.maxY - box.minY <= m_rawReach[1]) || box.maxX - box.minX <= 1)
        return;
    if (!hasPointsIn(box.grown(2 * m_rawReach[0], 2 * m_rawReach[1]))) return;
    const std::vector<std::uint32_t> points = std::move(m_points[m_nodes[n].tile]);
    m_points[m_nodes[n].tile].clear();
    const std::uint32_t tile = m_nodes[n].tile;
    splitNode(n);
    const std::uint32_t first = m_nodes[n].children;
    for (std::uint32_t i = 0; i < 4; ++i) {
        m_nodes[first + i].tile = i == 0 ? tile : std::uint32_t(m_points.size());
        if (i != 0) m_points.emplace_back();
    }
    const RawRect lower = m_nodes[first].box;
    for (const std::uint32_t p : points) {
        const std::uint32_t i = (m_axes[0][p] > lower.maxX ? 1u : 0u) + (m_axes[1][p] > lower.maxY ? 2u : 0u);
        m_points[m_nodes[first + i].tile].push_back(p);
    }
    for (std::uint32_t i = 0; i < 4; ++i) splitWide(first + i);
}

void SurfaceTiles::numberTiles()
{
    // along the Morton curve, so that neighbors in number are neighbors
    std::vector<std::vector<std::uint32_t>> points;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
        Node& node = m_nodes[stack.back()];
        stack.pop_back();
        if (node.children != 0) {
            for (std::uint32_t i = 4; i-- > 0;) stack.push_back(node.children + i);
            continue;
        }
        points.push_back(std::move(m_points[node.tile]));
        std::sort(points.back().begin(), points.back().end());
        node.tile = std::uint32_t(m_boxes.size());
        m_boxes.push_back(node.box);
    }
    m_points = std::move(points);
    m_notes.resize(m_boxes.size());
}

std::size_t SurfaceTiles::pointCount() const noexcept
{
    std::size_t n = 0;
    for (const auto& points : m_points) n += points.size();
    return n;
}

std::optional<std::size_t> SurfaceTiles::tileAt(double x, double y) const noexcept
{
    if (m_nodes.empty() || !m_nodes[0].box.holds(x, y)) return std::nullopt;
    const Node* node = &m_nodes[0];
    while (node->children != 0) {
        const RawRect& lower = m_nodes[node->children].box;
        node = &m_nodes[node->children + (x > lower.maxX ? 1u : 0u) + (y > lower.maxY ? 2u : 0u)];
    }
    return node->tile;
}

SurfaceNet SurfaceTiles::net(std::size_t tile, double beyond) const
{
    return SurfaceNetMaker(*this, tile, beyond).take(nullptr);
}

SurfaceNet SurfaceTiles::noteNet(std::size_t tile, double beyond)
{
    return SurfaceNetMaker(*this, tile, beyond).take(&m_notes[tile]);
}

std::vector<std::size_t> SurfaceTiles::change(const PointSet& changed, const PointSet& ground)
{
    // in each tile, those that changed, and the rectangle about them
    std::vector<std::pair<std::size_t, std::uint32_t>> moved;
    changed.forEach([&](PointIndex i) {
        if (const auto tile = tileAt(m_axes[0][i], m_axes[1][i])) moved.push_back({*tile, std::uint32_t(i)});
    });
    std::sort(moved.begin(), moved.end());
    std::vector<RawRect> rects;
    for (std::size_t first = 0, last = 0; first < moved.size(); first = last) {
        const std::size_t tile = moved[first].first;
        std::vector<std::uint32_t>& old = m_points[tile];
        std::vector<std::uint32_t> now;
        RawRect rect{INFINITY, INFINITY, -INFINITY, -INFINITY};
        bool any = false;
        std::size_t at = 0;
        for (; last < moved.size() && moved[last].first == tile; ++last) {
            const std::uint32_t i = moved[last].second;
            while (at < old.size() && old[at] < i) now.push_back(old[at++]);
            const bool was = at < old.size() && old[at] == i, is = ground.contains(i);
            if (was) ++at;
            if (is) now.push_back(i);
            if (was == is) continue;
            any = true;
            const double x = m_axes[0][i], y = m_axes[1][i];
            rect = {std::min(rect.minX, x), std::min(rect.minY, y), std::max(rect.maxX, x), std::max(rect.maxY, y)};
        }
        if (!any) continue;
        now.insert(now.end(), old.begin() + std::ptrdiff_t(at), old.end());
        old = std::move(now);
        rects.push_back(rect);
    }

    std::vector<std::size_t> touched;
    const auto concerns = [&](const Notes& notes, const RawRect& rect) {
        if (notes.whole.meets(rect)) return true;
        if (!notes.far.meets(rect)) return false;
        for (const RawDisc& disc : notes.discs)
            if (squaredGapTo(rect, disc, m_metric) <= disc.squaredRadius) return true;
        return notes.needsHull && !isInHull(notes.hull, rect);
    };
    for (std::size_t t = 0; t < m_notes.size(); ++t)
        if (std::any_of(rects.begin(), rects.end(),
                        [&](const RawRect& rect) { return concerns(m_notes[t], rect); }))
            touched.push_back(t);
    return touched;
}

}  // namespace punctum
