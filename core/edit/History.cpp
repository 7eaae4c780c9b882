// SPDX-License-Identifier: MIT
#include "core/edit/History.h"

#include "core/edit/Command.h"

#include <iterator>
#include <utility>

namespace punctum {

void History::push(std::unique_ptr<Command> command)
{
    if (command == nullptr) return;
    std::vector<std::unique_ptr<Command>> forgotten;  // destroyed last, outside both locks: they may be large
    const std::lock_guard changing(m_changing);
    {
        const std::lock_guard lock(m_mutex);
        m_commands.reserve(m_commands.size() + 1);  // whatever can fail fails before the points change
        forgotten.reserve(m_commands.size() - m_done);
    }
    command->apply(*m_cloud);

    const std::lock_guard lock(m_mutex);
    const auto undone = m_commands.begin() + std::ptrdiff_t(m_done);
    forgotten.assign(std::make_move_iterator(undone), std::make_move_iterator(m_commands.end()));
    m_commands.erase(undone, m_commands.end());
    if (m_saved > std::ptrdiff_t(m_done)) m_saved = -1;
    m_commands.push_back(std::move(command));
    ++m_done;
}

void History::undo()
{
    const std::lock_guard changing(m_changing);
    if (!canUndo()) return;
    // Only a change alters m_commands and m_done, and changes take turns: reading them here needs no lock.
    m_commands[m_done - 1]->apply(*m_cloud);
    const std::lock_guard lock(m_mutex);
    --m_done;
}

void History::redo()
{
    const std::lock_guard changing(m_changing);
    if (!canRedo()) return;
    m_commands[m_done]->apply(*m_cloud);
    const std::lock_guard lock(m_mutex);
    ++m_done;
}

bool History::canUndo() const
{
    const std::lock_guard lock(m_mutex);
    return m_done > 0;
}

bool History::canRedo() const
{
    const std::lock_guard lock(m_mutex);
    return m_done < m_commands.size();
}

std::string History::undoName() const
{
    const std::lock_guard lock(m_mutex);
    return m_done > 0 ? m_commands[m_done - 1]->name() : std::string();
}

std::string History::redoName() const
{
    const std::lock_guard lock(m_mutex);
    return m_done < m_commands.size() ? m_commands[m_done]->name() : std::string();
}

bool History::modified() const
{
    const std::lock_guard lock(m_mutex);
    return m_saved != std::ptrdiff_t(m_done);
}

void History::markSaved()
{
    const std::lock_guard lock(m_mutex);
    m_saved = std::ptrdiff_t(m_done);
}

std::vector<std::string> History::names() const
{
    const std::lock_guard lock(m_mutex);
    std::vector<std::string> names;
    names.reserve(m_commands.size());
    for (const auto& command : m_commands) names.push_back(command->name());
    return names;
}

std::size_t History::position() const
{
    const std::lock_guard lock(m_mutex);
    return m_done;
}

}  // namespace punctum
