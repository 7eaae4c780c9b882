// SPDX-License-Identifier: MIT
#include "core/neighbors/KdOrder.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>

namespace punctum
{

namespace
{

constexpr std::size_t kLeafPoints = 32;        ///< at most, where places differ; at least half of it
constexpr std::size_t kBucketPoints = 4096;    ///< about: sorted into leaves by one thread, in its cache
constexpr std::size_t kMostBuckets = 32'768;   ///< a bucket's number fits into 16 bits, with one left for none
constexpr std::size_t kSamplesPerBucket = 64;  ///< medians are then good to some hundredths
constexpr std::size_t kRanges = 64;            ///< pieces of the cloud that are sorted side by side
constexpr std::size_t kCheck = 1 << 14;        ///< points between two looks at the cancel flag
constexpr std::size_t kSideBySide = 8;
constexpr std::size_t kLargeBucket = 1 << 20;     ///< looked at before it is copied: most of it may be in one place
constexpr std::uint64_t kShareKept = 32;          ///< of memoryBudget(), which a cloud's order may keep
constexpr std::uint64_t kLargeOrder = 256 << 20;  ///< bytes

std::size_t longestOf(const std::array<double, 3>& extents)
{
    return std::size_t(std::max_element(extents.begin(), extents.end()) - extents.begin());
}

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
    if (asBefore && order->bytes() <= memoryBudget() / kShareKept) {
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

void KdOrder::dropLarge(const PointCloud& cloud) const noexcept
{
    if (bytes() > kLargeOrder) drop(cloud);
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
    m_leaves = std::bit_ceil(std::max<std::size_t>((count + kLeafPoints - 1) / kLeafPoints, 1));
    m_buckets = std::min(std::bit_ceil(std::clamp<std::size_t>(count / kBucketPoints, 1, kMostBuckets)), m_leaves);
    m_splits.resize(m_buckets);

    std::vector<std::uint32_t> sample = sampled(n, only);
    split(1, sample.data(), sample.data() + sample.size(), progress);
    progress.check();
    std::vector<std::uint32_t>().swap(sample);
    sortBuckets(sortIntoBuckets(deleted.get(), only, progress), progress);
    std::vector<Split>().swap(m_splits);
}

std::uint64_t KdOrder::bytes() const noexcept
{
    return m_order.size() * sizeof(m_order[0]) + m_leafStart.size() * sizeof(m_leafStart[0]) +
           m_boxes.size() * sizeof(Box);
}

std::array<double, 3> KdOrder::extents(const Box& box) const noexcept
{
    std::array<double, 3> lengths{};
    for (std::size_t a = 0; a < 3; ++a) lengths[a] = (double(box.max[a]) - double(box.min[a])) * m_scale[a];
    return lengths;
}

std::vector<std::uint32_t> KdOrder::sampled(std::size_t n, const PointSet* only) const
{
    const std::size_t count = only == nullptr ? n : only->count();
    std::vector<std::uint32_t> sample(std::min(count, m_buckets * kSamplesPerBucket));
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

void KdOrder::split(std::size_t node, std::uint32_t* first, std::uint32_t* last, const Progress& progress)
{
    if (node >= m_buckets || last - first < 2 || progress.cancelled()) return;
    Box box;
    for (const std::uint32_t* p = first; p != last; ++p) {
        const Raw r = raw(*p);
        box.include({r, r});
    }
    const std::array<double, 3> extent = extents(box);
    const std::size_t axis = longestOf(extent);
    if (!(extent[axis] > 0)) return;  // all in one place: everything goes left
    std::uint32_t* middle = first + (last - first) / 2;
    const std::int32_t* values = m_axes[axis];
    std::nth_element(first, middle, last, [=](std::uint32_t a, std::uint32_t b) { return values[a] < values[b]; });
    std::int32_t value = values[*middle];
    const auto below = [&](std::uint32_t p) { return values[p] < value; };
    if (value == box.min[axis]) {
        ++value;  // half of them at the lowest value: those go left, so that both sides have some
        middle = std::partition(middle, last, below);
    } else {
        middle = std::partition(first, middle, below);
    }
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

std::vector<std::uint32_t> KdOrder::sortIntoBuckets(const PointSet* leftOut, const PointSet* only,
                                                    Progress& progress)
{
    constexpr std::uint16_t kNoBucket = UINT16_MAX;
    const std::size_t n = m_columns[0]->size();
    std::vector<std::uint16_t> bucketOf(n);
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
    std::vector<std::vector<std::uint32_t>> counts(kRanges, std::vector<std::uint32_t>(m_buckets));
    forRanges([&](std::size_t range, std::size_t first, std::size_t last) {
        // Each step down waits for the one before, so several points go down side by side.
        const auto down = [&](std::size_t node, std::size_t i) {
            const Split s = m_splits[node];
            return 2 * node + std::size_t(m_axes[s.axis][i] >= s.value);
        };
        const auto put = [&](std::size_t node, std::size_t i) {
            const bool out =
                (leftOut != nullptr && leftOut->contains(i)) || (only != nullptr && !only->contains(i));
            bucketOf[i] = out ? kNoBucket : std::uint16_t(node - m_buckets);
            if (!out) ++counts[range][node - m_buckets];
        };
        for (std::size_t i = first; i < last; i += kSideBySide) {
            std::array<std::size_t, kSideBySide> nodes;
            nodes.fill(1);
            const std::size_t together = std::min(kSideBySide, last - i);
            if (together == kSideBySide)
                for (std::size_t reached = 1; reached < m_buckets; reached *= 2)
                    for (std::size_t k = 0; k < kSideBySide; ++k) nodes[k] = down(nodes[k], i + k);
            else
                for (std::size_t reached = 1; reached < m_buckets; reached *= 2)
                    for (std::size_t k = 0; k < together; ++k) nodes[k] = down(nodes[k], i + k);
            for (std::size_t k = 0; k < together; ++k) put(nodes[k], i + k);
        }
    });
    std::vector<std::uint32_t> starts(m_buckets + 1);
    std::uint32_t at = 0;
    for (std::size_t bucket = 0; bucket < m_buckets; ++bucket) {
        starts[bucket] = at;
        for (auto& count : counts) at += std::exchange(count[bucket], at);
    }
    starts[m_buckets] = at;
    m_order.resize(at);
    forRanges([&](std::size_t range, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (bucketOf[i] != kNoBucket) m_order[counts[range][bucketOf[i]]++] = std::uint32_t(i);
    });
    return starts;
}

/// Cuts a bucket's points at their medians until they are leaves.
class KdOrder::BucketSorter
{
public:
    explicit BucketSorter(KdOrder& order) : m_order(order) {}

    void sort(std::size_t bucket, std::uint32_t begin, std::uint32_t end)
    {
        m_begin = begin;
        const std::size_t node = m_order.m_buckets + bucket;
        const std::span<std::uint32_t> points(m_order.m_order.data() + begin, end - begin);
        Box box;
        if (points.size() > kLargeBucket) {
            for (const std::uint32_t p : points) box.include({m_order.raw(p), m_order.raw(p)});
            if (box.min == box.max) return leaveAsItIs(node, box, end);
        }
        m_items.resize(points.size());
        for (std::size_t k = 0; k < points.size(); ++k) m_items[k] = {m_order.raw(points[k]), points[k]};
        cut(node, 0, points.size());
    }

private:
    struct Item {
        Raw raw;
        std::uint32_t point;
    };

    void leaveAsItIs(std::size_t node, const Box& box, std::uint32_t end)
    {
        for (; !m_order.isLeaf(node); node *= 2) {
            m_order.m_boxes[node] = box;
            emptyBelow(2 * node + 1, end);
        }
        m_order.m_boxes[node] = box;
        m_order.m_leafStart[node - m_order.m_leaves] = m_begin;
    }
    void emptyBelow(std::size_t node, std::uint32_t at)
    {
        m_order.m_boxes[node] = Box();
        if (m_order.isLeaf(node)) {
            m_order.m_leafStart[node - m_order.m_leaves] = at;
            return;
        }
        emptyBelow(2 * node, at);
        emptyBelow(2 * node + 1, at);
    }
    void cut(std::size_t node, std::size_t first, std::size_t last)
    {
        Item* const begin = m_items.data() + first;
        Item* const end = m_items.data() + last;
        const Box box = boxOf(begin, end);
        m_order.m_boxes[node] = box;
        if (m_order.isLeaf(node)) {
            const auto before = [](const Item& a, const Item& b) { return a.point < b.point; };
            if (!std::is_sorted(begin, end, before)) std::sort(begin, end, before);
            m_order.m_leafStart[node - m_order.m_leaves] = m_begin + std::uint32_t(first);
            for (std::size_t k = first; k < last; ++k) m_order.m_order[m_begin + k] = m_items[k].point;
            return;
        }
        std::size_t middle = last;
        if (last - first > 1) {
            const std::array<double, 3> extent = m_order.extents(box);
            const std::size_t axis = longestOf(extent);
            if (extent[axis] > 0) {
                middle = first + std::size_t((axis == 0   ? cutAlong<0>(begin, end, box)
                                              : axis == 1 ? cutAlong<1>(begin, end, box)
                                                          : cutAlong<2>(begin, end, box)) -
                                             begin);
            }
        }
        cut(2 * node, first, middle);
        cut(2 * node + 1, middle, last);
    }
    /// Three axes at once, and a fourth that means nothing.
    static Box boxOf(const Item* begin, const Item* end)
    {
        using Four = std::int32_t __attribute__((vector_size(16)));
        static_assert(sizeof(Item) == sizeof(Four));
        Four low = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX},
             high = {INT32_MIN, INT32_MIN, INT32_MIN, INT32_MIN};
        for (const Item* item = begin; item != end; ++item) {
            Four v;
            std::memcpy(&v, item, sizeof(v));
            low = v < low ? v : low;
            high = v > high ? v : high;
        }
        return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    }
    template <std::size_t axis>
    static Item* cutAlong(Item* begin, Item* end, const Box& box)
    {
        Item* const middle = begin + (end - begin) / 2;
        std::nth_element(begin, middle, end,
                         [](const Item& a, const Item& b) { return a.raw[axis] < b.raw[axis]; });
        std::int32_t value = middle->raw[axis];
        const auto below = [&](const Item& item) { return item.raw[axis] < value; };
        if (value != box.min[axis]) return std::partition(begin, middle, below);
        ++value;  // as in split()
        return std::partition(middle, end, below);
    }

    KdOrder& m_order;
    std::uint32_t m_begin = 0;
    std::vector<Item> m_items;
};

void KdOrder::sortBuckets(const std::vector<std::uint32_t>& starts, Progress& progress)
{
    m_boxes.resize(2 * m_leaves);
    m_leafStart.resize(m_leaves + 1);
    m_leafStart[m_leaves] = starts.back();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_buckets, 4), [&](const auto& range) {
        BucketSorter sorter(*this);
        for (std::size_t b = range.begin(); b != range.end() && !progress.cancelled(); ++b) {
            sorter.sort(b, starts[b], starts[b + 1]);
            progress.add(starts[b + 1] - starts[b]);
        }
    });
    progress.check();
    for (std::size_t node = m_buckets - 1; node > 0; --node) {
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
