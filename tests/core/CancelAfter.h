// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Progress.h"

#include <chrono>
#include <thread>

namespace punctum
{

/// What came of work that another thread cancelled.
struct CancelOutcome {
    bool cancelled = false;  ///< it threw Cancelled; else it was done
    double ms = 0;           ///< from the cancel to the work's end; below 0 where it ended first
};

/// Runs work(progress), and cancels it so many milliseconds after it began.
template <typename Work>
CancelOutcome cancelAfter(int wait, Work&& work)
{
    Progress progress;
    std::chrono::steady_clock::time_point asked;
    std::thread canceller([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(wait));
        asked = std::chrono::steady_clock::now();
        progress.cancel();
    });
    CancelOutcome outcome;
    try {
        work(progress);
    } catch (const Cancelled&) {
        outcome.cancelled = true;
    }
    const auto ended = std::chrono::steady_clock::now();
    canceller.join();
    outcome.ms = std::chrono::duration<double, std::milli>(ended - asked).count();
    return outcome;
}

}  // namespace punctum
