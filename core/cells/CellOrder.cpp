// SPDX-License-Identifier: MIT
#include "core/cells/CellOrder.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kBucketPoints = 16'384;  ///< aimed at: what is looked at of them stays in the cache
constexpr std::size_t kMostBuckets = 16'384;
constexpr std::size_t kSorters = 64;  ///< pieces of the cloud that are sorted side by side
constexpr std::size_t kSamplePoints = 8192;
constexpr std::size_t kSampleBlocks = 2048;  ///< of a sample: then buckets are about as full as one another
constexpr std::uint32_t kNoCell = UINT32_MAX;

}  // namespace

CellOrder::CellOrder(const WorldGrid& grid, const PointSet* leftOut, Progress& progress) : m_grid(&grid)
{
    const std::size_t n = grid.points();
    progress.begin("Sorting points into cells", 2 * n);
    m_blockBits = chooseBlocks(leftOut);
    const std::size_t count = std::bit_ceil(std::clamp<std::size_t>(n / kBucketPoints, 1, kMostBuckets));
    m_bucketMask = count - 1;
    std::vector<std::uint16_t> bucketOfPoint(n);
    std::vector<std::vector<std::uint32_t>> counts(kSorters, std::vector<std::uint32_t>(count));
    const auto firstOf = [n](std::size_t range) { return std::size_t(std::uint64_t(range) * n / kSorters); };
    const auto forRanges = [&](auto&& work) {
        tbb::parallel_for(std::size_t(0), kSorters, [&](std::size_t range) {
            const std::size_t last = firstOf(range + 1);
            for (std::size_t i = firstOf(range); i < last && !progress.cancelled(); i += kCheck) {
                const std::size_t end = std::min(last, i + kCheck);
                for (std::size_t p = i; p < end; ++p)
                    if (leftOut == nullptr || !leftOut->contains(p)) work(range, p);
                progress.add(end - i);
            }
        });
        progress.check();
    };
    forRanges([&](std::size_t range, std::size_t point) {
        const std::size_t bucket = bucketOf(grid.cellOf(point));
        bucketOfPoint[point] = std::uint16_t(bucket);
        ++counts[range][bucket];
    });
    m_start.resize(count + 1);
    std::uint32_t at = 0;
    for (std::size_t bucket = 0; bucket < count; ++bucket) {
        m_start[bucket] = at;
        for (auto& of : counts) at += std::exchange(of[bucket], at);
    }
    m_start[count] = at;
    m_order.resize(at);
    forRanges([&](std::size_t range, std::size_t point) {
        m_order[counts[range][bucketOfPoint[point]]++] = std::uint32_t(point);
    });
}

/// The largest blocks of cells of which a sample of the points still meets enough.
unsigned CellOrder::chooseBlocks(const PointSet* leftOut) const
{
    const std::size_t n = m_grid->points();
    std::vector<CellKey> sample;
    const std::size_t step = std::max<std::size_t>(1, n / kSamplePoints);
    for (std::size_t p = step / 2; p < n; p += step)
        if (leftOut == nullptr || !leftOut->contains(p)) sample.push_back(m_grid->cellOf(p));
    unsigned bits = 0;
    for (std::vector<CellKey> blocks; bits < 16; ++bits) {
        blocks = sample;
        for (CellKey& key : blocks)
            for (std::uint32_t& k : key) k >>= bits + 1;
        std::sort(blocks.begin(), blocks.end());
        const auto end = std::unique(blocks.begin(), blocks.end());
        if (std::size_t(end - blocks.begin()) < std::min(kSampleBlocks, sample.size() / 4)) break;
    }
    return bits;
}

bool CellOrder::sortBucket(std::size_t bucket, Sorted& sorted, const Progress& progress) const
{
    const std::span<const std::uint32_t> own = points(bucket);
    sorted.keys.clear();
    sorted.first.clear();
    sorted.points.resize(own.size());
    sorted.cellOf.resize(own.size());
    std::size_t places = 64;
    sorted.table.assign(places, kNoCell);
    const auto placeOf = [&](const CellKey& key) {
        std::size_t at = std::size_t(mixedBits(key)) & (places - 1);
        while (sorted.table[at] != kNoCell && sorted.keys[sorted.table[at]] != key) at = (at + 1) & (places - 1);
        return at;
    };
    for (std::size_t k = 0; k < own.size(); ++k) {
        if (k % kCheck == 0 && progress.cancelled()) return false;
        const CellKey key = m_grid->cellOf(own[k]);
        std::uint32_t& place = sorted.table[placeOf(key)];
        if (place == kNoCell) {
            place = std::uint32_t(sorted.keys.size());
            sorted.keys.push_back(key);
            sorted.first.push_back(0);
        }
        sorted.cellOf[k] = place;
        ++sorted.first[place];
        if (sorted.keys.size() * 2 <= places) continue;
        places *= 4;
        sorted.table.assign(places, kNoCell);
        for (std::size_t c = 0; c < sorted.keys.size(); ++c)
            sorted.table[placeOf(sorted.keys[c])] = std::uint32_t(c);
    }
    std::uint32_t at = 0;
    for (std::uint32_t& first : sorted.first) at += std::exchange(first, at);
    sorted.first.push_back(at);
    for (std::size_t k = 0; k < own.size(); ++k) sorted.points[sorted.first[sorted.cellOf[k]]++] = own[k];
    // Each has moved to where the next one begins.
    for (std::size_t c = sorted.keys.size(); c > 0; --c) sorted.first[c] = sorted.first[c - 1];
    if (!sorted.first.empty()) sorted.first[0] = 0;
    return true;
}

}  // namespace punctum
