// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/parallel_for.h>
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

}  // namespace punctum::las
