// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// Calls f(cells) for the connected parts (by eight neighbors) of the marked cells of a grid, in the order of their
/// first cells.
template <typename F>
void forEachPart(std::vector<std::uint8_t> marked, int width, int height, const F& f)
{
    std::vector<std::uint32_t> part;
    for (std::size_t k = 0; k < marked.size(); ++k) {
        if (marked[k] == 0) continue;
        part.assign(1, std::uint32_t(k));
        marked[k] = 0;
        for (std::size_t done = 0; done < part.size(); ++done) {
            const int x = int(part[done]) % width, y = int(part[done]) / width;
            for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
                for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                    const std::size_t next = std::size_t(v) * std::size_t(width) + std::size_t(u);
                    if (marked[next] == 0) continue;
                    marked[next] = 0;
                    part.push_back(std::uint32_t(next));
                }
        }
        f(part);
    }
}

}  // namespace punctum
