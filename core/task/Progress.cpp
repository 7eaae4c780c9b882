// SPDX-License-Identifier: MIT
#include "core/task/Progress.h"

#include <algorithm>

namespace punctum
{

void Progress::begin(const std::string& stage, std::uint64_t total)
{
    if (m_wholes.load() != 0) return;
    const std::lock_guard lock(m_mutex);
    m_stage = stage;
    m_done.store(0, std::memory_order_relaxed);
    m_total.store(total, std::memory_order_relaxed);
}

double Progress::fraction() const noexcept
{
    const std::uint64_t total = m_total.load(std::memory_order_relaxed);
    if (total == 0) return 0.0;
    return std::min(1.0, double(m_done.load(std::memory_order_relaxed)) / double(total));
}

std::string Progress::stage() const
{
    const std::lock_guard lock(m_mutex);
    return m_stage;
}

}  // namespace punctum
