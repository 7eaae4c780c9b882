// SPDX-License-Identifier: MIT
#include "core/edit/ListCommand.h"

#include "core/Error.h"

#include <algorithm>
#include <mutex>
#include <shared_mutex>
#include <utility>

namespace punctum
{

namespace
{

bool shows(const Attribute& attribute, const Column* column)
{
    return std::any_of(attribute.columns.begin(), attribute.columns.end(),
                       [&](const auto& c) { return c && c.get() == column; });
}

}  // namespace

ListCommand::ListCommand(std::string name, Attribute attribute, std::string to)
    : Command(std::move(name)), m_attribute(std::move(attribute)), m_to(std::move(to))
{
    m_notice.kind = ChangeNotice::Kind::Attributes;
}

std::unique_ptr<ListCommand> ListCommand::rename(const Attribute& attribute, const std::string& to)
{
    return std::unique_ptr<ListCommand>(new ListCommand("Rename " + attribute.name + " to " + to, attribute, to));
}

std::unique_ptr<ListCommand> ListCommand::remove(const Attribute& attribute)
{
    return std::unique_ptr<ListCommand>(new ListCommand("Remove " + attribute.name, attribute, {}));
}

void ListCommand::plan(const PointCloud& cloud)
{
    m_columns = cloud.columns();
    m_attributes = cloud.attributes();
    const auto sharesColumn = [&](const Attribute& a) {
        return std::any_of(m_attribute.columns.begin(), m_attribute.columns.end(),
                           [&](const auto& column) { return column && shows(a, column.get()); });
    };
    for (const Attribute& a : cloud.attributes()) {
        if (m_to.empty() ? !sharesColumn(a) : a.name != m_attribute.name) continue;
        m_effect.removed.push_back(a);
        m_notice.attributes.push_back(a.name);
    }
    if (m_to.empty()) {
        std::erase_if(m_attributes, sharesColumn);
        std::erase_if(m_columns, [&](const auto& column) { return shows(m_attribute, column.get()); });
        return;
    }
    for (Attribute& a : m_attributes)
        if (a.name == m_attribute.name) {
            a.name = m_to;
            m_effect.added.push_back(a);
        }
    m_notice.attributes.push_back(m_to);
}

void ListCommand::apply(PointCloud& cloud) noexcept
{
    {
        const std::unique_lock lock(cloud.mutex());
        // Made once: a command is undone and redone on the same state of the cloud.
        if (!std::exchange(m_planned, true)) plan(cloud);
        cloud.exchangeLists(m_columns, m_attributes);
        m_detached.clear();
        for (const auto& column : m_columns)
            if (std::find(cloud.columns().begin(), cloud.columns().end(), column) == cloud.columns().end())
                m_detached.add(column);
    }
    cloud.notify(m_notice);
}

void checkOwn(const Attribute& attribute)
{
    if (attribute.standard)
        throw Error(attribute.name +
                    " is a field of the LAS point format; only extra bytes and computed attributes can be renamed "
                    "or removed.");
}

}  // namespace punctum
