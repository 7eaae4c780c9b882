// SPDX-License-Identifier: MIT
#pragma once

#include "core/steps/Steps.h"
#include "core/task/Progress.h"

#include <atomic>
#include <exception>
#include <thread>

namespace punctum::app
{

/// A processing step that runs again and again, its commands thrown away, as long as this lives: as the window's
/// jobs do it, in a thread of its own and at their priority. The cloud, the step and its values must outlive it.
class StepBeside
{
public:
    StepBeside(const PointCloud& cloud, const ParsedStep& step);
    ~StepBeside();
    StepBeside(const StepBeside&) = delete;
    StepBeside& operator=(const StepBeside&) = delete;

    /// Times that it has come to an end. Throws what the step threw.
    int runs() const;

private:
    Progress m_progress;
    std::atomic<int> m_runs = 0;
    std::atomic<bool> m_failed = false;
    std::exception_ptr m_error;  ///< complete once m_failed
    std::thread m_thread;
};

}  // namespace punctum::app
