// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace punctum::las
{

/// Something of a cloud that a point format or version which was asked for cannot hold.
struct Loss {
    std::string what;          ///< "a class above 31"
    std::string becomes;       ///< what is written instead, as the end of a sentence: "becomes class 1"
    std::uint64_t points = 0;  ///< that have it; 0: it is nothing of points

    /// "34 points have a class above 31"
    std::string text() const;
};

}  // namespace punctum::las
