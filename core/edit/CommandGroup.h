// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// Several commands as one: done in order, undone in the opposite one. No two may swap values of one column.
class CommandGroup final : public Command
{
public:
    /// Those of them that change some points change the same ones, `changed` in number.
    CommandGroup(std::string name, std::vector<std::unique_ptr<Command>> parts, PointIndex changed)
        : Command(std::move(name)), m_parts(std::move(parts)), m_changed(changed)
    {
    }

    PointIndex changedPoints() const noexcept override { return m_changed; }
    std::shared_ptr<const PointSet> points() const override;
    void apply(PointCloud& cloud) noexcept override;
    void prepare() override;
    void stow() noexcept override;
    void spill(SpillFile& file) override;
    std::size_t memory() const noexcept override;
    std::size_t spilled() const noexcept override;
    Effect effect() const override;
    void cross(const Column& column, std::span<std::byte> values) const override;
    std::vector<Attribute> brings() const override;

private:
    std::vector<std::unique_ptr<Command>> m_parts;
    PointIndex m_changed;
    bool m_done = false;
};

}  // namespace punctum
