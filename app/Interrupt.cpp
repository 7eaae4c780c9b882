// SPDX-License-Identifier: MIT
#include "app/Interrupt.h"

#include "core/task/Progress.h"

#include <atomic>
#include <csignal>

namespace punctum::app
{

namespace
{

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// A signal handler gets nothing but a number: what it cancels must be in a place it knows.
std::atomic<Progress*> interrupted{nullptr};
static_assert(std::atomic<Progress*>::is_always_lock_free);

extern "C" void cancelWork(int)
{
    if (Progress* progress = interrupted.load()) progress->cancel();
}

}  // namespace

Interrupt::Interrupt(Progress& progress)
{
    interrupted.store(&progress);
    struct sigaction action = {};
    action.sa_handler = cancelWork;
    action.sa_flags = int(SA_RESETHAND);  // the second time, the signal does what it does by default
    for (const int signal : kSignals) sigaction(signal, &action, nullptr);
}

Interrupt::~Interrupt()
{
    for (const int signal : kSignals) std::signal(signal, SIG_DFL);
    interrupted.store(nullptr);
}

}  // namespace punctum::app
