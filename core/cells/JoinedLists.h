// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace punctum
{

/// Lists of buckets as one, in their order. The memory of each is given back as it is taken over.
template <typename T>
std::vector<T> joinedLists(std::vector<std::vector<T>> lists)
{
    std::size_t count = 0;
    for (const std::vector<T>& list : lists) count += list.size();
    std::vector<T> all;
    all.reserve(count);
    for (std::vector<T>& list : lists) {
        all.insert(all.end(), list.begin(), list.end());
        list = {};
    }
    return all;
}

}  // namespace punctum
