// SPDX-License-Identifier: MIT
#include "core/edit/CommandGroup.h"

namespace punctum
{

std::shared_ptr<const PointSet> CommandGroup::points() const
{
    for (const auto& part : m_parts)
        if (auto points = part->points()) return points;
    return nullptr;
}

void CommandGroup::apply(PointCloud& cloud) noexcept
{
    if (m_done)
        for (auto part = m_parts.rbegin(); part != m_parts.rend(); ++part) (*part)->apply(cloud);
    else
        for (const auto& part : m_parts) part->apply(cloud);
    m_done = !m_done;
}

void CommandGroup::prepare()
{
    for (const auto& part : m_parts) part->prepare();
}

void CommandGroup::stow() noexcept
{
    for (const auto& part : m_parts) part->stow();
}

void CommandGroup::spill(SpillFile& file)
{
    for (const auto& part : m_parts) part->spill(file);
}

std::size_t CommandGroup::memory() const noexcept
{
    std::size_t bytes = 0;
    for (const auto& part : m_parts) bytes += part->memory();
    return bytes;
}

std::size_t CommandGroup::spilled() const noexcept
{
    std::size_t bytes = 0;
    for (const auto& part : m_parts) bytes += part->spilled();
    return bytes;
}

Command::Effect CommandGroup::effect() const
{
    Effect all;
    for (const auto& part : m_parts) {
        const Effect one = part->effect();
        all.columns.insert(all.columns.end(), one.columns.begin(), one.columns.end());
        all.added.insert(all.added.end(), one.added.begin(), one.added.end());
        all.removed.insert(all.removed.end(), one.removed.begin(), one.removed.end());
        all.deletes = all.deletes || one.deletes;
    }
    return all;
}

std::vector<Attribute> CommandGroup::brings() const
{
    std::vector<Attribute> all;
    for (const auto& part : m_parts)
        for (Attribute& attribute : part->brings()) all.push_back(std::move(attribute));
    return all;
}

void CommandGroup::cross(const Column& column, std::span<std::byte> values) const
{
    for (const auto& part : m_parts) part->cross(column, values);
}

}  // namespace punctum
