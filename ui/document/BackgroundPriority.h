// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

namespace punctum::ui
{

/// While it lives, the thread it was made in, and the TBB workers that help it, run at a slightly lower priority,
/// so that a job that keeps every core busy never makes the window wait for its turn.
///
/// Linux: niceness of single threads. It is not raised again when this ends (that takes rights which a program
/// does not have): make it in threads that do background work and nothing else.
class BackgroundPriority
{
public:
    BackgroundPriority();
    ~BackgroundPriority();
    BackgroundPriority(const BackgroundPriority&) = delete;
    BackgroundPriority& operator=(const BackgroundPriority&) = delete;

private:
    class Observer;
    std::unique_ptr<Observer> m_observer;
};

}  // namespace punctum::ui
