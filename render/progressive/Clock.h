// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace punctum::render
{

/// Seconds of a clock that only goes forward, by which frames are timed.
inline double now()
{
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

}  // namespace punctum::render
