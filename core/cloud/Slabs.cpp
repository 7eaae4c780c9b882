// SPDX-License-Identifier: MIT
#include "core/cloud/Slabs.h"

#include "core/cloud/PointCloud.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <algorithm>

namespace punctum
{

namespace
{

constexpr std::size_t kSlabTasks = 32;  ///< 2 M points

}  // namespace

void forEachSlab(const PointCloud& cloud, Progress& progress,
                 const std::function<void(std::size_t firstWord, std::size_t lastWord)>& task)
{
    const auto words = std::size_t((cloud.size() + 63) / 64);
    constexpr std::size_t kSlabWords = kSlabTasks * kTaskWords;
    for (std::size_t slab = 0; slab < words; slab += kSlabWords) {
        progress.check();
        const std::size_t slabEnd = std::min(words, slab + kSlabWords);
        // One lock a slab, by this thread alone: readers that overlap would keep a waiting edit out for good.
        const std::shared_lock lock(cloud.mutex());
        forPiecesLocked(lock, slabEnd - slab, kTaskWords, [&](std::size_t first, std::size_t last) {
            if (!progress.cancelled()) task(slab + first, slab + last);
        });
        progress.add(std::min<PointIndex>(PointIndex(slabEnd) * 64, cloud.size()) - PointIndex(slab) * 64);
    }
    progress.check();
}

}  // namespace punctum
