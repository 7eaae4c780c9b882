// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

namespace punctum::las
{

/// Runs work(scratch, k) for k = 0 ... count-1 on all cores, each worker taking the next k when it is free, so that
/// the order of k is (nearly) the order of time. `scratch` is the worker's own. The first exception ends it.
template <typename Scratch = std::vector<std::byte>, typename Work>
void forEachInOrder(std::size_t count, const Work& work)
{
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stop{false};
    const auto cores = std::size_t(std::max(1, tbb::this_task_arena::max_concurrency()));
    tbb::parallel_for(
        std::size_t(0), std::min(cores, count),
        [&](std::size_t) {
            Scratch scratch;
            while (!stop.load(std::memory_order_relaxed)) {
                const std::size_t k = next.fetch_add(1, std::memory_order_relaxed);
                if (k >= count) return;
                try {
                    work(scratch, k);
                } catch (...) {
                    stop = true;  // the others end soon, not after all the rest
                    throw;
                }
            }
        },
        tbb::simple_partitioner());
}

/// One T of all points in the ranges: add(t, range) is called in parallel on parts of them, the results are put
/// together with t.include(other). Throws Cancelled.
template <typename T, typename Add>
T reducePoints(const std::vector<PointRange>& ranges, Progress& progress, const Add& add)
{
    constexpr PointIndex kPiece = 1 << 16;
    struct Piece {  // where one begins: in a long range, or with the first of many short ones
        std::size_t range = 0;
        PointIndex first = 0;
    };
    std::vector<Piece> pieces;
    PointIndex left = 0;
    for (std::size_t k = 0; k < ranges.size(); ++k)
        for (PointIndex first = ranges[k].first; first < ranges[k].last;) {
            if (left == 0) {
                pieces.push_back({k, first});
                left = kPiece;
            }
            const PointIndex count = std::min(left, ranges[k].last - first);
            first += count;
            left -= count;
        }
    const auto addPiece = [&](T& t, Piece at) {
        for (PointIndex rest = kPiece; rest > 0;) {
            const PointIndex count = std::min(rest, ranges[at.range].last - at.first);
            if (count > 0) add(t, PointRange{at.first, at.first + count});
            rest -= count;
            if (++at.range == ranges.size()) return;
            at.first = ranges[at.range].first;
        }
    };
    const T all = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, pieces.size()), T{},
        [&](const tbb::blocked_range<std::size_t>& r, T t) {
            for (std::size_t k = r.begin(); k != r.end() && !progress.cancelled(); ++k) addPiece(t, pieces[k]);
            return t;
        },
        [](T a, const T& b) {
            a.include(b);
            return a;
        });
    progress.check();
    return all;
}

}  // namespace punctum::las
