// SPDX-License-Identifier: MIT
#include "core/above/TriangulatedGround.h"

#include "core/Error.h"
#include "core/surface/Triangulation.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace punctum
{

namespace
{

constexpr std::size_t kPieceGround = 8192;  ///< points of the ground in a piece, about, without the margin
constexpr double kPieceMargin = 8;          ///< of a piece, in spacings of its ground
constexpr double kPieceMarginGrowth = 4;
constexpr int kSureTries = 3;                   ///< then a triangle counts whose circle leaves the piece
constexpr std::size_t kMostGround = 1'000'000;  ///< of a piece with its margin; then the nearest point counts
constexpr std::size_t kDealtBuckets = 64;       ///< stretches of the cloud that are dealt out side by side
constexpr std::size_t kDealtCheck = 4096;       ///< points between two looks at the cancel flag

SurfacePoint surfacePointOf(const GroundTree::Place& p)
{
    return {p.x, p.y, p.z, 0};
}

/// The hull of places by X and Y: the lower and the upper chain, from least to greatest X.
class GroundHull
{
public:
    explicit GroundHull(std::vector<SurfacePoint> points)
    {
        std::sort(points.begin(), points.end(),
                  [](const auto& a, const auto& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
        for (const SurfacePoint& p : points) {
            add(m_lower, p, 1);
            add(m_upper, p, -1);
        }
    }
    std::vector<SurfacePoint> corners() const
    {
        std::vector<SurfacePoint> all = m_lower;
        all.insert(all.end(), m_upper.begin(), m_upper.end());
        return all;
    }
    /// On it counts as inside.
    bool holds(std::int32_t x, std::int32_t y) const
    {
        if (m_lower.empty() || x < m_lower.front().x || x > m_lower.back().x) return false;
        const SurfacePoint p{x, y, 0, 0};
        return beside(m_lower, p) >= 0 && beside(m_upper, p) <= 0;
    }
    /// To the nearest whole place.
    bool holdsPlace(double x, double y) const
    {
        const auto whole = [](double value) { return value > double(INT32_MIN) && value < double(INT32_MAX); };
        return whole(x) && whole(y) && holds(std::int32_t(x), std::int32_t(y));
    }

private:
    static void add(std::vector<SurfacePoint>& chain, const SurfacePoint& p, int turn)
    {
        while (chain.size() > 1 && Delaunay::orientation(chain[chain.size() - 2], chain.back(), p) * turn <= 0)
            chain.pop_back();
        if (chain.empty() || chain.back().x != p.x || chain.back().y != p.y) chain.push_back(p);
    }
    /// Positive when the place is left of the chain (seen along rising X), 0 when on it.
    static int beside(const std::vector<SurfacePoint>& chain, const SurfacePoint& p)
    {
        const auto after =
            std::upper_bound(chain.begin(), chain.end(), p, [](const auto& a, const auto& b) { return a.x < b.x; });
        if (after != chain.end() && after != chain.begin()) return Delaunay::orientation(*(after - 1), *after, p);
        // at the greatest X: an upright edge may end the chain
        const SurfacePoint& end = chain.back();
        const auto first =
            std::lower_bound(chain.begin(), chain.end(), p, [](const auto& a, const auto& b) { return a.x < b.x; });
        const std::int32_t low = std::min(first->y, end.y), high = std::max(first->y, end.y);
        return p.y < low ? -1 : p.y > high ? 1 : 0;
    }
    std::vector<SurfacePoint> m_lower, m_upper;
};

GroundHull hullOfGround(const GroundTree& ground, std::size_t firstNode, const Progress& progress)
{
    std::vector<std::vector<SurfacePoint>> corners(firstNode);
    tbb::parallel_for(std::size_t(0), firstNode, [&](std::size_t k) {
        if (progress.cancelled()) return;
        std::vector<SurfacePoint> own;
        for (const GroundTree::Place& p : ground.places(firstNode + k)) own.push_back(surfacePointOf(p));
        corners[k] = GroundHull(std::move(own)).corners();
    });
    progress.check();
    std::vector<SurfacePoint> all;
    for (const auto& own : corners) all.insert(all.end(), own.begin(), own.end());
    return GroundHull(std::move(all));
}

/// Points dealt out to the pieces of the ground in whose part of the plane they lie.
struct DealtPoints {
    std::vector<std::uint32_t> points;
    std::vector<std::size_t> starts;
};

DealtPoints dealOutToPieces(const PointCloud& cloud, const GroundTree& ground, std::size_t firstNode,
                            const PointSet* within, Progress& progress)
{
    const auto x = cloud.rawX(), y = cloud.rawY();
    const auto deleted = deletedPoints(cloud);
    const std::size_t n = cloud.size();
    const auto firstOf = [n](std::size_t bucket) { return std::size_t(std::uint64_t(bucket) * n / kDealtBuckets); };
    const auto forBuckets = [&](auto&& each) {
        tbb::parallel_for(std::size_t(0), kDealtBuckets, [&](std::size_t bucket) {
            const std::size_t last = firstOf(bucket + 1);
            for (std::size_t first = firstOf(bucket); first < last && !progress.cancelled(); first += kDealtCheck)
                for (std::size_t i = first; i < std::min(last, first + kDealtCheck); ++i) {
                    if ((deleted && deleted->contains(i)) || (within != nullptr && !within->contains(i))) continue;
                    each(bucket, ground.nodeAt(firstNode, x[i], y[i]) - firstNode, i);
                }
        });
        progress.check();
    };
    std::vector<std::vector<std::size_t>> at(kDealtBuckets, std::vector<std::size_t>(firstNode));
    forBuckets([&](std::size_t bucket, std::size_t piece, std::size_t) { ++at[bucket][piece]; });
    DealtPoints dealt;
    std::size_t sum = 0;
    for (std::size_t piece = 0; piece < firstNode; ++piece) {
        dealt.starts.push_back(sum);
        for (auto& counts : at) sum += std::exchange(counts[piece], sum);
    }
    dealt.starts.push_back(sum);
    dealt.points.resize(sum);
    forBuckets([&](std::size_t bucket, std::size_t piece, std::size_t i) {
        dealt.points[at[bucket][piece]++] = std::uint32_t(i);
    });
    return dealt;
}

/// A part of the ground, triangulated.
class GroundPiece
{
public:
    /// `reach`: of the margin, in units of length.
    GroundPiece(const GroundTree& ground, std::size_t node, double reach, const PlaneMetric& metric,
                const Progress& progress)
        : m_scale(ground.scale())
    {
        const GroundTree::Box own = ground.box(node), &all = ground.bounds();
        const auto outward = [](std::int32_t from, double by) {
            return std::int32_t(std::clamp(double(from) + by, double(INT32_MIN), double(INT32_MAX)));
        };
        m_box = {outward(own.minX, -reach / m_scale[0]), outward(own.minY, -reach / m_scale[1]),
                 outward(own.maxX, reach / m_scale[0]), outward(own.maxY, reach / m_scale[1])};
        m_ends = {m_box.minX > all.minX, m_box.minY > all.minY, m_box.maxX < all.maxX, m_box.maxY < all.maxY};
        std::vector<GroundTree::Place> places;
        m_fits = ground.within(m_box, kMostGround, places);
        if (!m_fits) return;
        std::sort(places.begin(), places.end());  // the order must not tell how the files were cut
        std::vector<SurfacePoint> points;
        points.reserve(places.size());
        for (const auto& p : places) points.push_back(surfacePointOf(p));
        m_net = Triangulation(points, metric, Delaunay::Keep::Lowest, &progress);
    }
    bool fits() const { return m_fits; }
    bool whole() const { return !m_ends[0] && !m_ends[1] && !m_ends[2] && !m_ends[3]; }
    /// The height of the ground in raw steps. `sure`: by a triangle of the whole ground alone, but for those at the
    /// rim, whose circle is about a place outside of the hull.
    std::optional<double> height(std::int32_t x, std::int32_t y, bool sure, const GroundHull* hull)
    {
        if (m_net.empty()) return {};
        const auto triangle = m_net.locate(double(x), double(y), m_near);
        if (!triangle) return {};
        if (sure && !sureOf(*triangle, hull)) return {};
        return m_net.heightIn(*triangle, double(x), double(y));
    }

private:
    bool sureOf(std::uint32_t triangle, const GroundHull* hull)
    {
        if (whole() || triangle == m_lastSure) return true;
        const auto& corners = m_net.triangles()[triangle];
        const SurfacePoint &a = m_net.vertices()[corners[0]], &b = m_net.vertices()[corners[1]],
                           &c = m_net.vertices()[corners[2]];
        // from corner a, in units of length
        const double bx = (double(b.x) - double(a.x)) * m_scale[0], by = (double(b.y) - double(a.y)) * m_scale[1],
                     cx = (double(c.x) - double(a.x)) * m_scale[0], cy = (double(c.y) - double(a.y)) * m_scale[1];
        const double twice = 2 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
        const double x = (cy * bb - by * cc) / twice, y = (bx * cc - cx * bb) / twice;
        const double radius = std::hypot(x, y) * (1 + 1e-9);
        const auto outside = [&](bool ends, double edge, double from, double scale, double middle) {
            return ends && (edge - from) * scale - middle < radius;
        };
        if (!std::isfinite(radius) || outside(m_ends[0], -double(m_box.minX), -double(a.x), m_scale[0], -x) ||
            outside(m_ends[1], -double(m_box.minY), -double(a.y), m_scale[1], -y) ||
            outside(m_ends[2], double(m_box.maxX), double(a.x), m_scale[0], x) ||
            outside(m_ends[3], double(m_box.maxY), double(a.y), m_scale[1], y))
            return hull != nullptr && !hull->holdsPlace(double(a.x) + x / m_scale[0], double(a.y) + y / m_scale[1]);
        m_lastSure = triangle;
        return true;
    }

    std::array<double, 3> m_scale;
    GroundTree::Box m_box;
    std::array<bool, 4> m_ends{};  ///< sides on which the ground goes on
    bool m_fits = false;
    Triangulation m_net;
    std::uint32_t m_near = 0, m_lastSure = Triangulation::kNone;
};

}  // namespace

void measureTriangulated(const PointCloud& cloud, const GroundTree& ground, const PointSet* within,
                         Progress& progress, const HeightVisitor& visit)
{
    if (cloud.size() > UINT32_MAX)
        throw Error("This step handles up to 4,294,967,295 points; split the cloud first.");
    progress.begin("Measuring heights", cloud.size());
    const std::array<double, 3>& scale = ground.scale();
    const PlaneMetric metric = PlaneMetric::of(scale[0], scale[1]);
    const std::size_t firstNode = ground.firstNodeOf(kPieceGround);
    const GroundHull hull = hullOfGround(ground, firstNode, progress);
    const DealtPoints dealt = dealOutToPieces(cloud, ground, firstNode, within, progress);
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    const auto tell = [&](std::uint32_t i, double ground_) { visit(i, (double(z[i]) - ground_) * scale[2]); };

    tbb::parallel_for(std::size_t(0), firstNode, [&](std::size_t k) {
        if (progress.cancelled()) return;
        const std::size_t node = firstNode + k;
        const std::span<const std::uint32_t> own{dealt.points.data() + dealt.starts[k],
                                                 dealt.starts[k + 1] - dealt.starts[k]};
        std::vector<GroundTree::Near> near;
        const auto byNearest = [&](std::uint32_t i) {
            ground.nearest(x[i], y[i], 1, near);
            tell(i, double(near.front().place.z));
        };
        std::vector<std::uint32_t> open, later;
        open.reserve(own.size());
        for (std::size_t at = 0; at < own.size(); ++at) {
            if (at % kDealtCheck == 0 && progress.cancelled()) return;
            if (hull.holds(x[own[at]], y[own[at]]))
                open.push_back(own[at]);
            else
                byNearest(own[at]);
        }
        progress.add(own.size() - open.size());
        const GroundTree::Box& box = ground.box(node);
        const double width = (double(box.maxX) - double(box.minX)) * scale[0],
                     depth = (double(box.maxY) - double(box.minY)) * scale[1];
        const auto count = double(ground.places(node).size());
        double reach = kPieceMargin * std::max({std::sqrt(width * depth / count), std::max(width, depth) / count,
                                                scale[0], scale[1]});
        for (int tries = 1; !open.empty(); ++tries, reach *= kPieceMarginGrowth) {
            GroundPiece piece(ground, node, reach, metric, progress);
            if (!piece.fits()) break;
            later.clear();
            for (std::size_t at = 0; at < open.size(); ++at) {
                if (at % kDealtCheck == 0 && progress.cancelled()) return;
                const std::uint32_t i = open[at];
                if (const auto height = piece.height(x[i], y[i], tries<kSureTries, tries> 1 ? &hull : nullptr))
                    tell(i, *height);
                else
                    later.push_back(i);
            }
            progress.add(open.size() - later.size());
            open.swap(later);
            if (piece.whole()) break;
        }
        for (const std::uint32_t i : open) byNearest(i);
        progress.add(open.size());
    });
    progress.check();
}

}  // namespace punctum
