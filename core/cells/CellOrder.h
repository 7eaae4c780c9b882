// SPDX-License-Identifier: MIT
#pragma once

#include "core/cells/WorldGrid.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

/// Points of a cloud sorted into some thousand buckets, such that all points of a cell of the grid are in one of
/// them, and near cells mostly, too. The same on any number of threads. 4 bytes a point, while it is made 8.
class CellOrder
{
public:
    /// `leftOut`: points that are none; null: all are some. Throws Cancelled.
    CellOrder(const WorldGrid& grid, const PointSet* leftOut, Progress& progress);

    const WorldGrid& grid() const noexcept { return *m_grid; }
    std::size_t buckets() const noexcept { return m_start.size() - 1; }
    /// How many points it has.
    std::size_t size() const noexcept { return m_order.size(); }
    /// Rising, or by cells after sortByCells().
    std::span<const std::uint32_t> points(std::size_t bucket) const noexcept
    {
        return {m_order.data() + m_start[bucket], m_start[bucket + 1] - m_start[bucket]};
    }
    /// Which bucket a cell's points are in.
    std::size_t bucketOf(const CellKey& key) const noexcept
    {
        const std::array<std::uint32_t, 3> block{key[0] >> m_blockBits, key[1] >> m_blockBits,
                                                 key[2] >> m_blockBits};
        return std::size_t(mixedBits(block) >> 32) & m_bucketMask;
    }
    /// Calls f(bucket, key, points) for each cell that has points, which are in rising order; once a cell, from
    /// several threads at once, but for cells of one bucket in a row, always in the same order. Counts points in
    /// `progress`. Throws Cancelled.
    template <typename F>
    void forEachCell(const std::string& stage, Progress& progress, F&& f) const
    {
        forSortedBuckets(stage, progress, [&](std::size_t b, const Sorted& sorted) {
            return tellCells(b, sorted, std::span<const std::uint32_t>(sorted.points), progress, f);
        });
    }
    /// The same, and from then on the points of each bucket lie by cells: f may keep the points it is told, which
    /// stay where they are, and change their order. No memory beside that of the buckets in work.
    template <typename F>
    void sortByCells(const std::string& stage, Progress& progress, F&& f)
    {
        forSortedBuckets(stage, progress, [&](std::size_t b, const Sorted& sorted) {
            const std::span<std::uint32_t> own(m_order.data() + m_start[b], m_start[b + 1] - m_start[b]);
            std::copy(sorted.points.begin(), sorted.points.end(), own.begin());
            return tellCells(b, sorted, own, progress, f);
        });
    }

private:
    static constexpr std::size_t kCheck = 1 << 14;  ///< points between two looks at the cancel flag
    /// The points of a bucket by cells.
    struct Sorted {
        std::vector<CellKey> keys;         ///< in the order of their first points
        std::vector<std::uint32_t> first;  ///< of a cell, in `points`; one more at the end
        std::vector<std::uint32_t> points;
        std::vector<std::uint32_t> cellOf;  ///< work space
        std::vector<std::uint32_t> table;
    };
    /// False when cancelled meanwhile.
    bool sortBucket(std::size_t bucket, Sorted& sorted, const Progress& progress) const;
    /// Calls work(bucket, sorted) for each bucket, in parallel, until one gives false.
    template <typename Work>
    void forSortedBuckets(const std::string& stage, Progress& progress, const Work& work) const
    {
        progress.begin(stage, size());
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, buckets(), 1),
            [&](const auto& range) {
                Sorted sorted;
                for (std::size_t b = range.begin(); b != range.end() && !progress.cancelled(); ++b)
                    if (!sortBucket(b, sorted, progress) || !work(b, sorted)) return;
            },
            tbb::simple_partitioner());
        progress.check();
    }
    /// Calls f(bucket, key, points) for the cells of a sorted bucket; false when cancelled meanwhile.
    template <typename Index, typename F>
    static bool tellCells(std::size_t bucket, const Sorted& sorted, std::span<Index> points, Progress& progress,
                          F&& f)
    {
        std::size_t told = 0, looked = 0;
        for (std::size_t c = 0; c < sorted.keys.size(); ++c) {
            f(bucket, sorted.keys[c], points.subspan(sorted.first[c], sorted.first[c + 1] - sorted.first[c]));
            looked = sorted.first[c + 1];
            if (looked - told < kCheck) continue;
            progress.add(looked - told);
            told = looked;
            if (progress.cancelled()) return false;
        }
        progress.add(looked - told);
        return true;
    }
    unsigned chooseBlocks(const PointSet* leftOut) const;

    const WorldGrid* m_grid;
    unsigned m_blockBits = 0;
    std::size_t m_bucketMask = 0;
    std::vector<std::uint32_t> m_start;
    std::vector<std::uint32_t> m_order;
};

/// Cells with what somebody keeps of each, found by their keys. 16 bytes and the value for each place.
template <typename Value>
class CellTable
{
public:
    struct Entry {
        CellKey key{};
        Value value{};
    };
    /// Room for so many cells at most.
    explicit CellTable(std::size_t cells)
    {
        std::size_t places = 16;
        while (places < cells + cells / 2 + 1) places *= 2;
        m_entries.resize(places);
        m_used.assign(places, 0);
    }
    Value& operator[](const CellKey& key)
    {
        std::size_t at = std::size_t(mixedBits(key)) & (m_entries.size() - 1);
        while (m_used[at] && m_entries[at].key != key) at = (at + 1) & (m_entries.size() - 1);
        m_used[at] = 1;
        m_entries[at].key = key;
        return m_entries[at].value;
    }
    /// Null where there is none.
    const Value* find(const CellKey& key) const noexcept
    {
        std::size_t at = std::size_t(mixedBits(key)) & (m_entries.size() - 1);
        while (m_used[at]) {
            if (m_entries[at].key == key) return &m_entries[at].value;
            at = (at + 1) & (m_entries.size() - 1);
        }
        return nullptr;
    }

private:
    std::vector<Entry> m_entries;
    std::vector<std::uint8_t> m_used;
};

}  // namespace punctum
