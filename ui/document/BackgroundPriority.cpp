// SPDX-License-Identifier: MIT
#include "ui/document/BackgroundPriority.h"

#include <oneapi/tbb/task_scheduler_observer.h>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace punctum::ui
{

namespace
{

/// Enough that the window's thread always wins, little enough that jobs stay fast on a busy machine.
constexpr int kNiceness = 3;

void lowerThisThread() noexcept
{
#ifdef __linux__
    static thread_local bool lowered = false;
    if (lowered) return;
    lowered = true;
    setpriority(PRIO_PROCESS, 0, kNiceness);  // 0: on Linux the calling thread, not the process
#endif
}

}  // namespace

/// Sees the workers that enter the arena of the thread it was made in.
class BackgroundPriority::Observer final : public tbb::task_scheduler_observer
{
public:
    Observer() { observe(true); }
    ~Observer() override { observe(false); }
    void on_scheduler_entry(bool) override { lowerThisThread(); }
};

BackgroundPriority::BackgroundPriority()
{
    lowerThisThread();
    m_observer = std::make_unique<Observer>();
}

BackgroundPriority::~BackgroundPriority() = default;

}  // namespace punctum::ui
