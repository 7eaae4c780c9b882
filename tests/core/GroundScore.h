// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// How well points were told apart, in per cent: total error, type I (ground that was lost), type II (objects taken
/// for ground), and Cohen's kappa, which says how much better than chance it is.
struct GroundScore {
    double total = 0, lost = 0, taken = 0, kappa = 0;
};

/// `truth`: classes, 2 is ground; `used`: which points count.
inline GroundScore groundScore(const std::vector<std::uint8_t>& truth, const std::vector<char>& isGround,
                               const std::vector<char>& used)
{
    double both = 0, lost = 0, taken = 0, neither = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (used[i] == 0) continue;
        if (truth[i] == 2)
            (isGround[i] != 0 ? both : lost) += 1;
        else
            (isGround[i] != 0 ? taken : neither) += 1;
    }
    const double n = both + lost + taken + neither, agree = (both + neither) / n;
    const double chance = ((both + lost) * (both + taken) + (taken + neither) * (lost + neither)) / (n * n);
    return {100 * (lost + taken) / n, 100 * lost / std::max(1.0, both + lost),
            100 * taken / std::max(1.0, taken + neither), 100 * (agree - chance) / (1 - chance)};
}

}  // namespace punctum
