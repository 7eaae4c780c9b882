// SPDX-License-Identifier: MIT
#include "core/select/Selecting.h"

#include "core/cloud/BlockBoxes.h"
#include "core/cloud/LinearSide.h"
#include "core/cloud/Slabs.h"
#include "core/neighbors/Neighbors.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

namespace punctum
{

namespace
{

constexpr double kRounding = 1e-12;       ///< of a few operations in double, as a share of their terms
constexpr std::size_t kProjected = 1024;  ///< points projected at a time: fills the first cache, and is vectorized

/// Projects blocks of points, and looks up their px.
class RegionTest
{
public:
    RegionTest(const Region& region, const PointCloud& cloud)
        : m_region(region),
          m_box(region.mask.box()),
          m_x(cloud.rawX().data()),
          m_y(cloud.rawY().data()),
          m_z(cloud.rawZ().data())
    {
        const PictureProjection& p = region.projection;
        const auto row = [](const glm::dvec4& r) { return LinearSide(glm::dvec3(r), r.w); };
        const LinearSide x = row(p.rowX), y = row(p.rowY), depth = row(p.rowD), nothing(glm::dvec3(0.0), 0.0);
        const double nearest = std::max(p.nearDepth, region.nearest);
        if (std::isfinite(nearest)) m_sides.push_back(LinearSide(depth).add(-nearest));
        if (std::isfinite(region.furthest))
            m_sides.push_back(LinearSide(nothing).add(depth, -1.0).add(region.furthest));
        // x_px >= at, times the depth: of places before the eye alone
        if (p.perspective && !(nearest > 0.0)) return;
        const auto edge = [&](const LinearSide& along, double sign, double at) {
            LinearSide side = LinearSide(nothing).add(along, sign);
            m_sides.push_back(p.perspective ? side.add(depth, -sign * at) : side.add(-sign * at));
        };
        edge(x, 1.0, m_box.left);
        edge(x, -1.0, m_box.right);
        edge(y, 1.0, m_box.top);
        edge(y, -1.0, m_box.bottom);
    }

    bool empty() const noexcept { return m_box.empty(); }

    /// Whether no point of a box of raw coordinates can be inside.
    bool misses(const RawBounds& box) const
    {
        const glm::dvec3 low = glm::dvec3(box.min) - m_region.projection.base,
                         high = glm::dvec3(box.max) - m_region.projection.base;
        return std::any_of(m_sides.begin(), m_sides.end(), [&](const LinearSide& side) {
            return side.of(low, high, kRounding) == LinearSide::Box::Outside;
        });
    }

    /// 1 for the points inside; of kProjected values those behind points.size() are 0.
    void test(PointRange points, std::uint8_t* flags) const
    {
        alignas(64) std::array<double, kProjected> px, py, depth;
        const PictureProjection& p = m_region.projection;
        const auto n = std::size_t(points.size());
        const std::int32_t *const x = m_x + points.first, *const y = m_y + points.first,
                                  *const z = m_z + points.first;
        const glm::dvec3 base = p.base;
        const glm::dvec4 rx = p.rowX, ry = p.rowY, rd = p.rowD;
        for (std::size_t k = 0; k < n; ++k) {
            const double a = x[k] - base.x, b = y[k] - base.y, c = z[k] - base.z;
            px[k] = rx.x * a + rx.y * b + rx.z * c + rx.w;
            py[k] = ry.x * a + ry.y * b + ry.z * c + ry.w;
            depth[k] = rd.x * a + rd.y * b + rd.z * c + rd.w;
        }
        if (p.perspective)
            for (std::size_t k = 0; k < n; ++k) {
                px[k] /= depth[k];
                py[k] /= depth[k];
            }
        const double left = m_box.left, right = m_box.right, top = m_box.top, bottom = m_box.bottom;
        const double nearest = std::max(p.nearDepth, m_region.nearest), furthest = m_region.furthest;
        for (std::size_t k = 0; k < n; ++k)
            flags[k] = std::uint8_t(std::uint8_t(px[k] >= left) & std::uint8_t(px[k] < right) &
                                    std::uint8_t(py[k] >= top) & std::uint8_t(py[k] < bottom) &
                                    std::uint8_t(depth[k] >= nearest) & std::uint8_t(depth[k] <= furthest));
        const std::uint8_t* const mask = m_region.mask.px().data();
        const auto width = std::size_t(m_region.mask.width());
        for (std::size_t k = 0; k < n; ++k)
            if (flags[k]) flags[k] = mask[std::size_t(py[k]) * width + std::size_t(px[k])];
        std::fill(flags + n, flags + kProjected, std::uint8_t(0));
    }

private:
    const Region& m_region;
    ScreenMask::Box m_box;
    const std::int32_t *m_x, *m_y, *m_z;
    std::vector<LinearSide> m_sides;  ///< what is outside of one of them is not in the region; of raw - base
};

/// Looks at the classes of the points of one word after another.
class TouchTest
{
public:
    TouchTest(const PointCloud& cloud, const Touchable& touchable) : m_touchable(touchable)
    {
        const bool all = std::all_of(touchable.classes.begin(), touchable.classes.end(), [](bool b) { return b; });
        const Attribute* const found = all ? nullptr : cloud.findAttribute("Classification");
        if (found == nullptr || found->columns[0]->components() != 1) return;
        m_classes = *found;
    }

    /// The members of a word that may be touched. Hold cloud.mutex() shared.
    std::uint64_t operator()(std::size_t word, std::uint64_t bits) const
    {
        if (m_touchable.hidden) bits &= ~m_touchable.hidden->words()[word];
        if (bits == 0 || !m_classes.columns[0]) return bits;
        std::array<std::uint8_t, 64> codes;
        const PointRange points{PointIndex(word) * 64, std::min(PointIndex(word) * 64 + 64, m_classes.size())};
        m_classes.gatherBits(points, codes.data());
        std::uint64_t kept = 0;
        for (std::uint64_t left = bits; left != 0; left &= left - 1) {
            const auto k = unsigned(std::countr_zero(left));
            if (m_touchable.classes[codes[k]]) kept |= std::uint64_t(1) << k;
        }
        return kept;
    }

private:
    const Touchable& m_touchable;
    Attribute m_classes;
};

/// Sets and counts are looked at in parallel, piece by piece.
constexpr std::size_t kPieceWords = 1 << 14;

template <typename F>
void forPieces(std::size_t words, F f)
{
    tbb::parallel_for(std::size_t(0), (words + kPieceWords - 1) / kPieceWords, [&](std::size_t piece) {
        const std::size_t first = piece * kPieceWords;
        f(first, std::min(words, first + kPieceWords));
    });
}

/// Members of the set, one piece of `words` after another, in parallel: visit(point) from worker threads. Checks
/// for cancel between points, as one may have many neighbors.
template <typename Visit>
void forMembers(const PointSet& points, Progress& progress, Visit visit)
{
    constexpr std::size_t kMemberWords = 64;
    const std::size_t words = points.words().size();
    tbb::parallel_for(std::size_t(0), (words + kMemberWords - 1) / kMemberWords, [&](std::size_t piece) {
        const std::size_t first = piece * kMemberWords, last = std::min(words, first + kMemberWords);
        points.forEachInWords(first, last, [&](PointIndex i) {
            if (!progress.cancelled()) visit(i);
        });
        progress.add(pointsOfWords(points.size(), first, last).size());
    });
    progress.check();
}

/// Calls each(point, near) for every member, with the points within the distance, from worker threads. Few members
/// search for themselves; many are searched for leaf by leaf.
template <typename Each>
void forNear(const PointSet& members, const KdOrder& order, double distance, const std::string& stage,
             Progress& progress, Each each)
{
    constexpr PointIndex kManyPoints = 64;  // a member in so many
    if (members.count() > members.size() / kManyPoints) {
        const auto visit = [&](const Neighborhood& n) { each(n.point, n.points); };
        forEachWithin(order, distance, stage, progress, visit, &members);
        return;
    }
    progress.begin(stage, members.size());
    forMembers(members, progress, [&](PointIndex i) {
        thread_local std::vector<KdOrder::Found> found;
        thread_local std::vector<std::uint32_t> near;
        if (!order.within(std::uint32_t(i), distance, found, progress)) return;
        near.clear();
        for (const KdOrder::Found& f : found) near.push_back(f.point);
        each(std::uint32_t(i), std::span<const std::uint32_t>(near));
    });
}

/// Members of `from` -> the points within the distance that are not in `known` yet, which they join.
PointSet step(const PointSet& from, PointSet& known, const KdOrder& order, double distance,
              const std::string& stage, Progress& progress)
{
    PointSet found(from.size());
    forNear(from, order, distance, stage, progress, [&](std::uint32_t, std::span<const std::uint32_t> near) {
        for (const std::uint32_t p : near)
            if (!known.contains(p)) found.insertShared(p);
    });
    combine(known, found, SelectMode::Add);
    return found;
}

}  // namespace

PointSet pointsIn(const Region& region, const PointCloud& cloud, const Touchable& touchable, Progress& progress)
{
    PointSet points(cloud.size());
    const RegionTest inside(region, cloud);
    progress.begin("Selecting", cloud.size());
    if (inside.empty()) return points;
    const auto boxes = cloud.boxes();
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        constexpr std::size_t kBlockWords = kProjected / 64;
        const TouchTest touch(cloud, touchable);
        alignas(64) std::array<std::uint8_t, kProjected> flags;
        forStretches(firstWord, lastWord, [&](std::size_t stretch, std::size_t first, std::size_t last) {
            if (inside.misses((*boxes)[stretch])) return;
            for (std::size_t w = first; w < last; w += kBlockWords) {
                const std::size_t end = std::min(last, w + kBlockWords);
                inside.test({PointIndex(w) * 64, std::min(cloud.size(), PointIndex(end) * 64)}, flags.data());
                for (std::size_t k = w; k < end; ++k)
                    if (const std::uint64_t bits = packFlags(flags.data() + (k - w) * 64); bits != 0)
                        points.words()[k] = touch(k, bits);
            }
        });
    });
    return points;
}

void keepTouchable(PointSet& points, const PointCloud& cloud, const Touchable& touchable, Progress& progress)
{
    progress.begin("Selecting", cloud.size());
    const std::span<const std::uint64_t> words = std::as_const(points).words();
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const TouchTest touch(cloud, touchable);
        for (std::size_t w = firstWord; w < lastWord; ++w)
            if (const std::uint64_t bits = words[w]; bits != 0)
                if (const std::uint64_t kept = touch(w, bits); kept != bits) points.words()[w] = kept;
    });
}

void combine(PointSet& selection, const PointSet& found, SelectMode mode)
{
    const auto sure = [](const PointSet& set) { return set.surelyNone() || set.surelyAll(); };
    switch (mode) {
        case SelectMode::Replace:
            selection = found;
            return;
        case SelectMode::Add:
            if (sure(selection) || sure(found)) return selection.insert(found);
            break;
        case SelectMode::Subtract:
            if (sure(selection) || sure(found)) return selection.remove(found);
            break;
        case SelectMode::Intersect:
            if (sure(selection) || sure(found)) return selection.intersect(found);
    }
    const auto ours = selection.words();
    const auto theirs = found.words();
    constexpr std::size_t kBlock = 512;  // of words: those that stay as they are are not written to
    const auto none = [](std::span<const std::uint64_t> words) {
        return std::accumulate(words.begin(), words.end(), std::uint64_t(0), std::bit_or<>()) == 0;
    };
    forPieces(ours.size(), [&](std::size_t pieceFirst, std::size_t pieceLast) {
        for (std::size_t first = pieceFirst; first < pieceLast; first += kBlock) {
            const std::size_t last = std::min(pieceLast, first + kBlock);
            if (mode == SelectMode::Intersect) {
                if (none(ours.subspan(first, last - first))) continue;
                for (std::size_t w = first; w < last; ++w) ours[w] &= theirs[w];
                continue;
            }
            if (none(theirs.subspan(first, last - first))) continue;
            if (mode == SelectMode::Add)
                for (std::size_t w = first; w < last; ++w) ours[w] |= theirs[w];
            else
                for (std::size_t w = first; w < last; ++w) ours[w] &= ~theirs[w];
        }
    });
}

PointIndex countWithout(const PointSet& a, const PointSet& b)
{
    PointIndex n = 0;
    for (std::size_t w = 0; w < a.words().size(); ++w) n += PointIndex(std::popcount(a.words()[w] & ~b.words()[w]));
    return n;
}

PointSet grown(const PointSet& points, const KdOrder& order, double distance, Progress& progress)
{
    PointSet all = points;
    step(points, all, order, distance, "Growing the selection", progress);
    return all;
}

PointSet shrunk(const PointSet& points, const KdOrder& order, double distance, Progress& progress)
{
    PointSet edge(points.size());
    forNear(points, order, distance, "Shrinking the selection", progress,
            [&](std::uint32_t i, std::span<const std::uint32_t> near) {
                if (std::any_of(near.begin(), near.end(), [&](std::uint32_t p) { return !points.contains(p); }))
                    edge.insertShared(i);
            });
    PointSet left = points;
    combine(left, edge, SelectMode::Subtract);
    return left;
}

PointSet connected(const PointSet& points, const KdOrder& order, double distance, Progress& progress)
{
    PointSet all = points, edge = points;
    for (PointIndex found = 1; found != 0; found = edge.count())
        edge = step(edge, all, order, distance, "Following connected points", progress);
    return all;
}

}  // namespace punctum
