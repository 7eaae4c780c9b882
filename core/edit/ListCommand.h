// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"

#include <string>
#include <vector>

namespace punctum
{

/// Gives an attribute another name, or takes it out of the cloud: trades the cloud's lists of columns and
/// attributes for others, so that undoing it brings back every column in its place. Only for attributes that are no
/// fields of the standard (checkOwn()).
class ListCommand final : public Command
{
public:
    static std::unique_ptr<ListCommand> rename(const Attribute& attribute, const std::string& to);
    /// With every attribute that shows one of its columns.
    static std::unique_ptr<ListCommand> remove(const Attribute& attribute);

    /// A name is no value of a point.
    PointIndex changedPoints() const noexcept override { return m_to.empty() ? m_attribute.size() : 0; }
    void apply(PointCloud& cloud) noexcept override;
    void prepare() override { m_detached.fetch(); }
    void spill(SpillFile& file) override { m_detached.spill(file); }
    std::size_t memory() const noexcept override { return m_detached.memory(); }
    std::size_t spilled() const noexcept override { return m_detached.spilled(); }
    Effect effect() const override { return m_effect; }
    void cross(const Column&, std::span<std::byte>) const override {}

private:
    ListCommand(std::string name, Attribute attribute, std::string to);
    void plan(const PointCloud& cloud);

    DetachedColumns m_detached;
    Attribute m_attribute;
    std::string m_to;  ///< empty: it is removed
    bool m_planned = false;
    std::vector<std::shared_ptr<Column>> m_columns;  ///< of the other side
    std::vector<Attribute> m_attributes;
    Effect m_effect;
    ChangeNotice m_notice;
};

/// Refuses attributes that are fields of the LAS point format. Throws Error.
void checkOwn(const Attribute& attribute);

}  // namespace punctum
