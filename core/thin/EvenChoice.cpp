// SPDX-License-Identifier: MIT
#include "core/cells/WorldGrid.h"
#include "core/neighbors/KdOrder.h"
#include "core/task/Progress.h"
#include "core/thin/Choices.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace punctum
{

namespace
{

constexpr std::size_t kRowPiece = 8192;  ///< points that are put into a row at once
constexpr unsigned kRowBits = 16;        ///< of a place in a piece, along each axis

/// Every third bit of the result is one of `value` (Morton order).
std::uint64_t spreadBits(std::uint64_t value)
{
    std::uint64_t bits = 0;
    for (unsigned b = 0; b < kRowBits; ++b) bits |= ((value >> b) & 1) << (3 * b);
    return bits;
}

/// The points of a node, near ones after each other.
void putIntoRow(const KdOrder& order, std::size_t node, const PointSet* leftOut, std::vector<std::uint32_t>& row)
{
    const KdOrder::Box& box = order.box(node);
    double widest = 0;
    for (std::size_t a = 0; a < 3; ++a)
        widest = std::max(widest, (double(box.max[a]) - double(box.min[a])) * order.scale()[a]);
    const double factor = widest > 0 ? double((1u << kRowBits) - 1) / widest : 0;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
    for (const std::uint32_t p : order.points(node)) {
        if (leftOut != nullptr && leftOut->contains(p)) continue;
        const KdOrder::Raw r = order.raw(p);
        std::uint64_t code = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double at = double(std::int64_t(r[a]) - box.min[a]) * order.scale()[a] * factor;
            code |= spreadBits(std::uint64_t(at)) << a;
        }
        sorted.emplace_back(code, p);
    }
    std::sort(sorted.begin(), sorted.end());
    row.clear();
    for (const auto& [code, p] : sorted) row.push_back(p);
}

}  // namespace

std::shared_ptr<PointSet> chooseByNumber(const PointCloud& cloud, PointIndex count, const PointSet* leftOut,
                                         Progress& progress)
{
    auto kept = std::make_shared<PointSet>(cloud.size());
    const auto order = KdOrder::of(cloud, progress);
    const std::vector<std::size_t> pieces = order->tiles(kRowPiece);
    std::vector<std::uint64_t> before(pieces.size() + 1);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        const auto points = order->points(pieces[k]);
        before[k + 1] =
            before[k] + (leftOut == nullptr
                             ? points.size()
                             : std::size_t(std::count_if(points.begin(), points.end(),
                                                         [&](std::uint32_t p) { return !leftOut->contains(p); })));
        if (k % 16 == 0) progress.check();
    }
    const std::uint64_t all = before.back();
    count = std::min<PointIndex>(count, all);
    progress.begin("Choosing points", order->size());
    tbb::parallel_for(std::size_t(0), pieces.size(), [&](std::size_t k) {
        if (progress.cancelled() || before[k] == before[k + 1] || count == 0) return;
        std::vector<std::uint32_t> row;
        putIntoRow(*order, pieces[k], leftOut, row);
        // Pieces of the row whose chosen place is among these points; neither product exceeds 64 bits.
        for (std::uint64_t j = before[k] * count / all; j < count; ++j) {
            const std::uint64_t first = j * all / count, last = (j + 1) * all / count;
            if (first >= before[k + 1]) break;
            const std::uint64_t place = first + mixedBits(j + 1) % (last - first);
            if (place >= before[k] && place < before[k + 1]) kept->insertShared(row[place - before[k]]);
        }
        progress.add(order->points(pieces[k]).size());
    });
    progress.check();
    return kept;
}

}  // namespace punctum
