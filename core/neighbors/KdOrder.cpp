// SPDX-License-Identifier: MIT
#include "core/neighbors/KdOrder.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

namespace punctum
{

namespace
{

constexpr std::size_t kLeafPoints = 192;         ///< aimed at; measured best between searching and sorting
constexpr std::size_t kSamplesPerLeaf = 16;      ///< medians are then good to a few leaves in a hundred
constexpr std::size_t kMostSamples = 2'000'000;  ///< one nth_element of them stays under 50 ms
constexpr std::size_t kRanges = 64;              ///< pieces of the cloud that are sorted side by side
constexpr std::size_t kCheck = 1 << 14;          ///< points between two looks at the cancel flag

}  // namespace

void KdOrder::Box::include(const Box& other) noexcept
{
    for (std::size_t a = 0; a < 3; ++a) {
        min[a] = std::min(min[a], other.min[a]);
        max[a] = std::max(max[a], other.max[a]);
    }
}

std::shared_ptr<const KdOrder> KdOrder::of(const PointCloud& cloud, Progress& progress)
{
    PointCloud::PlaceOrder& kept = cloud.placeOrder();
    const auto same = [](const std::shared_ptr<const PointSet>& a, const std::shared_ptr<const PointSet>& b) {
        return a == b || (a && b && *a == *b);
    };
    std::shared_ptr<const PointSet> deleted;
    for (;;) {
        progress.check();
        deleted = deletedPoints(cloud);
        {
            const std::lock_guard lock(kept.mutex);
            if (kept.order && same(kept.without, deleted)) return kept.order;
            if (!kept.making) {
                kept.making = true;
                kept.order.reset();  // two of them need not fit into memory
                break;
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::shared_ptr<const KdOrder> order;
    try {
        order = std::make_shared<const KdOrder>(cloud, progress);
    } catch (...) {
        const std::lock_guard lock(kept.mutex);
        kept.making = false;
        throw;
    }
    const bool asBefore = same(deleted, deletedPoints(cloud));
    const std::lock_guard lock(kept.mutex);
    kept.making = false;
    if (asBefore) {
        kept.order = order;
        kept.without = deleted;
    }
    return order;
}

void KdOrder::drop(const PointCloud& cloud) noexcept
{
    PointCloud::PlaceOrder& kept = cloud.placeOrder();
    const std::lock_guard lock(kept.mutex);
    kept.order.reset();
    kept.without.reset();
}

KdOrder::KdOrder(const PointCloud& cloud, Progress& progress, const PointSet* only)
{
    if (cloud.size() > UINT32_MAX)
        throw Error("This step handles up to 4,294,967,295 points; split the cloud first.");
    m_lengths = trueLengths(cloud);
    std::shared_ptr<const PointSet> deleted;
    {
        const std::shared_lock lock(cloud.mutex());
        for (std::size_t a = 0; a < 3; ++a) m_columns[a] = cloud.columns()[a];
        deleted = cloud.deleted();
    }
    for (std::size_t a = 0; a < 3; ++a) {
        m_axes[a] = m_columns[a]->values<std::int32_t>().data();
        m_scale[a] = std::fabs(cloud.coordinates().scale[int(a)]) * m_lengths.stretch[int(a)];
    }
    const std::size_t n = cloud.size(), count = only == nullptr ? n : only->count();
    progress.begin("Sorting points by place", 3 * n);
    m_leaves = std::bit_ceil(std::clamp<std::size_t>(count / kLeafPoints, 1, kMostSamples / kSamplesPerLeaf));
    m_splits.resize(m_leaves);

    std::vector<std::uint32_t> sample = sampled(n, only);
    chooseSplits(sample, progress);
    sortIntoLeaves(deleted.get(), only, progress);
    computeBoxes(progress);
}

std::vector<std::uint32_t> KdOrder::sampled(std::size_t n, const PointSet* only) const
{
    const std::size_t count = only == nullptr ? n : only->count();
    std::vector<std::uint32_t> sample(std::min(count, m_leaves * kSamplesPerLeaf));
    // One of each run of points, not always the same one: scan lines repeat, and must not beat with the sample.
    const auto place = [&](std::size_t k) {
        const std::uint64_t first = std::uint64_t(k) * count / sample.size(),
                            last = (std::uint64_t(k) + 1) * count / sample.size();
        const std::uint64_t h = (std::uint64_t(k) + 1) * 0x9E3779B97F4A7C15u;
        return std::uint32_t(first + (h >> 32) % (last - first));
    };
    if (only == nullptr) {
        for (std::size_t k = 0; k < sample.size(); ++k) sample[k] = place(k);
        return sample;
    }
    std::size_t k = 0, member = 0;
    only->forEach([&](PointIndex point) {
        if (k < sample.size() && member++ == place(k)) sample[k++] = std::uint32_t(point);
    });
    return sample;
}

void KdOrder::chooseSplits(std::vector<std::uint32_t>& sample, const Progress& progress)
{
    split(1, sample.data(), sample.data() + sample.size(), progress);
    progress.check();
}

void KdOrder::split(std::size_t node, std::uint32_t* first, std::uint32_t* last, const Progress& progress)
{
    if (isLeaf(node) || last - first < 2 || progress.cancelled()) return;
    Box box;
    for (const std::uint32_t* p = first; p != last; ++p) {
        const Raw r = raw(*p);
        box.include({r, r});
    }
    std::size_t axis = 0;
    double longest = -1;
    for (std::size_t a = 0; a < 3; ++a) {
        const double extent = (double(box.max[a]) - double(box.min[a])) * m_scale[a];
        if (extent > longest) {
            longest = extent;
            axis = a;
        }
    }
    if (!(longest > 0)) return;  // all in one place: everything goes left
    std::uint32_t* middle = first + (last - first) / 2;
    const std::int32_t* values = m_axes[axis];
    std::nth_element(first, middle, last, [=](std::uint32_t a, std::uint32_t b) { return values[a] < values[b]; });
    std::int32_t value = values[*middle];
    if (value == box.min[axis])
        ++value;  // half of them at the lowest value: those go left, so that both sides have some
    middle = std::partition(first, last, [=](std::uint32_t p) { return values[p] < value; });
    m_splits[node] = {value, std::uint8_t(axis)};
    const auto left = [=, this, &progress] { split(2 * node, first, middle, progress); };
    const auto right = [=, this, &progress] { split(2 * node + 1, middle, last, progress); };
    if (last - first > 20'000) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}

void KdOrder::sortIntoLeaves(const PointSet* leftOut, const PointSet* only, Progress& progress)
{
    constexpr std::uint32_t kNoLeaf = UINT32_MAX;
    const std::size_t n = m_columns[0]->size();
    std::vector<std::uint32_t> leafOf(n);
    const auto firstOf = [n](std::size_t range) { return std::size_t(std::uint64_t(range) * n / kRanges); };
    const auto forRanges = [&](auto&& work) {
        tbb::parallel_for(std::size_t(0), kRanges, [&](std::size_t range) {
            const std::size_t last = firstOf(range + 1);
            for (std::size_t i = firstOf(range); i < last && !progress.cancelled(); i += kCheck) {
                const std::size_t end = std::min(last, i + kCheck);
                work(range, i, end);
                progress.add(end - i);
            }
        });
        progress.check();
    };
    std::vector<std::vector<std::uint32_t>> counts(kRanges, std::vector<std::uint32_t>(m_leaves));
    forRanges([&](std::size_t range, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if ((leftOut != nullptr && leftOut->contains(i)) || (only != nullptr && !only->contains(i))) {
                leafOf[i] = kNoLeaf;
                continue;
            }
            std::size_t node = 1;
            while (node < m_leaves) {
                const Split s = m_splits[node];
                node = 2 * node + std::size_t(m_axes[s.axis][i] >= s.value);
            }
            leafOf[i] = std::uint32_t(node - m_leaves);
            ++counts[range][node - m_leaves];
        }
    });
    m_leafStart.resize(m_leaves + 1);
    std::uint32_t at = 0;
    for (std::size_t leaf = 0; leaf < m_leaves; ++leaf) {
        m_leafStart[leaf] = at;
        for (auto& count : counts) at += std::exchange(count[leaf], at);
    }
    m_leafStart[m_leaves] = at;
    m_order.resize(at);
    forRanges([&](std::size_t range, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (leafOf[i] != kNoLeaf) m_order[counts[range][leafOf[i]]++] = std::uint32_t(i);
    });
}

void KdOrder::computeBoxes(Progress& progress)
{
    m_boxes.resize(2 * m_leaves);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_leaves, 64), [&](const auto& range) {
        if (progress.cancelled()) return;
        for (std::size_t leaf = range.begin(); leaf != range.end(); ++leaf) {
            Box box;
            for (std::uint32_t k = m_leafStart[leaf]; k < m_leafStart[leaf + 1]; ++k) {
                const Raw r = raw(m_order[k]);
                box.include({r, r});
            }
            m_boxes[m_leaves + leaf] = box;
        }
        progress.add(m_leafStart[range.end()] - m_leafStart[range.begin()]);
    });
    progress.check();
    for (std::size_t node = m_leaves - 1; node > 0; --node) {
        m_boxes[node] = m_boxes[2 * node];
        m_boxes[node].include(m_boxes[2 * node + 1]);
    }
}

std::span<const std::uint32_t> KdOrder::points(std::size_t node) const noexcept
{
    std::size_t first = node, last = node;
    while (first < m_leaves) {
        first = 2 * first;
        last = 2 * last + 1;
    }
    const std::uint32_t begin = m_leafStart[first - m_leaves], end = m_leafStart[last - m_leaves + 1];
    return {m_order.data() + begin, end - begin};
}

std::vector<std::size_t> KdOrder::tiles(std::size_t most) const
{
    std::vector<std::size_t> found, open{1};
    while (!open.empty()) {
        const std::size_t node = open.back();
        open.pop_back();
        const std::size_t count = points(node).size();
        if (count == 0) continue;
        if (count <= most || isLeaf(node)) {
            found.push_back(node);
        } else {
            open.push_back(2 * node + 1);
            open.push_back(2 * node);
        }
    }
    return found;
}

double KdOrder::squaredDistance(const Place& from, const Box& box) const noexcept
{
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const double below = double(box.min[a]) - from[a], above = from[a] - double(box.max[a]);
        const double d = std::max({0.0, below, above}) * m_scale[a];
        sum += d * d;
    }
    return sum;
}

void KdOrder::nearest(const Place& from, std::size_t k, std::vector<Found>& found) const
{
    found.clear();
    k = std::min(k, size());
    if (k == 0) return;
    struct Open {
        std::size_t node;
        double squared;
    };
    std::array<Open, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {1, 0.0};
    // `found` is a heap with the furthest on top; its place in the order of ties is the point's index.
    while (depth != 0) {
        const Open open = stack[--depth];
        const bool full = found.size() == k;
        // At distance 0 nothing can be nearer: clouds with many points in one place end here.
        if (full && (open.squared > found.front().squared || found.front().squared == 0.0)) continue;
        if (!isLeaf(open.node)) {
            const std::size_t left = 2 * open.node, right = left + 1;
            const Open a{left, m_boxes[left].empty() ? INFINITY : squaredDistance(from, m_boxes[left])};
            const Open b{right, m_boxes[right].empty() ? INFINITY : squaredDistance(from, m_boxes[right])};
            stack[depth++] = a.squared > b.squared ? a : b;
            stack[depth++] = a.squared > b.squared ? b : a;
            continue;
        }
        for (const std::uint32_t p : points(open.node)) {
            const Found candidate{squaredDistance(from, p), p};
            if (found.size() < k) {
                found.push_back(candidate);
                std::push_heap(found.begin(), found.end());
            } else if (candidate < found.front()) {
                std::pop_heap(found.begin(), found.end());
                found.back() = candidate;
                std::push_heap(found.begin(), found.end());
            } else if (found.front().squared == 0.0) {
                break;
            }
        }
    }
    std::sort_heap(found.begin(), found.end());
}

bool KdOrder::within(const Place& from, double radius, std::vector<Found>& found, const Progress& progress) const
{
    found.clear();
    const double limit = radius * radius;
    std::array<std::size_t, 64> stack{1};
    for (std::size_t depth = 1; depth != 0;) {
        const std::size_t node = stack[--depth];
        if (m_boxes[node].empty() || squaredDistance(from, m_boxes[node]) > limit) continue;
        if (!isLeaf(node)) {
            stack[depth++] = 2 * node + 1;
            stack[depth++] = 2 * node;
            continue;
        }
        if (progress.cancelled()) return false;
        for (const std::uint32_t p : points(node))
            if (const double d = squaredDistance(from, p); d <= limit) found.push_back({d, p});
    }
    return true;
}

}  // namespace punctum
