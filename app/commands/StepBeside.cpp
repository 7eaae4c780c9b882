// SPDX-License-Identifier: MIT
#include "app/commands/StepBeside.h"

#include "ui/document/BackgroundPriority.h"

namespace punctum::app
{

StepBeside::StepBeside(const PointCloud& cloud, const ParsedStep& step)
{
    m_thread = std::thread([this, &cloud, &step] {
        const ui::BackgroundPriority priority;
        try {
            for (;; ++m_runs) (void)step.step->run(cloud, step.values, m_progress);
        } catch (const Cancelled&) {
            return;
        } catch (...) {
            m_error = std::current_exception();
            m_failed = true;
        }
    });
}

StepBeside::~StepBeside()
{
    m_progress.cancel();
    m_thread.join();
}

int StepBeside::runs() const
{
    if (m_failed) std::rethrow_exception(m_error);
    return m_runs;
}

}  // namespace punctum::app
