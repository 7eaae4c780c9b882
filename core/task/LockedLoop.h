// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace punctum
{

/// Runs work() in a thread that holds a lock, and gives its result. While the thread waits for its helpers it picks
/// up nothing else: that might want the lock, and would wait for itself. `lock` is the proof that it is held.
template <typename Lock, typename Work>
decltype(auto) runLocked([[maybe_unused]] const Lock& lock, Work&& work)
{
    assert(lock.owns_lock());
    return tbb::this_task_arena::isolate(std::forward<Work>(work));
}

/// Calls task(first, last) for the numbers from 0 to `count`, in parallel, in pieces that begin at multiples of
/// `piece` and have at most so many; the calling thread holds `lock` for all of them.
template <typename Lock, typename Task>
void forPiecesLocked(const Lock& lock, std::size_t count, std::size_t piece, const Task& task)
{
    runLocked(lock, [&] {
        tbb::parallel_for(std::size_t(0), (count + piece - 1) / piece, [&](std::size_t k) {
            const std::size_t first = k * piece;
            task(first, std::min(count, first + piece));
        });
    });
}

}  // namespace punctum
