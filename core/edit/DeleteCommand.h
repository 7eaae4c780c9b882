// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"

#include <memory>
#include <string>

namespace punctum
{

/// Marks points as deleted, or takes the marks away: each point of the set changes sides, so that applying again
/// undoes it. Values and indices stay; saving leaves out what is marked then.
class DeleteCommand final : public Command
{
public:
    /// `points`: all of them are deleted, or none is, on the state of the cloud that it is done on.
    DeleteCommand(std::string name, std::shared_ptr<const PointSet> points);

    PointIndex changedPoints() const noexcept override { return m_count; }
    std::shared_ptr<const PointSet> points() const override { return m_points.points(); }
    void apply(PointCloud& cloud) noexcept override;
    void prepare() override;
    void stow() noexcept override;
    void spill(SpillFile& file) override { m_points.spill(file); }
    std::size_t memory() const noexcept override { return m_points.memory(); }
    std::size_t spilled() const noexcept override { return m_points.spilled(); }
    Effect effect() const override { return {{}, {}, {}, true}; }
    void cross(const Column&, std::span<std::byte>) const override {}

private:
    StowableSet m_points;
    std::shared_ptr<PointSet> m_next;  ///< room for what is deleted after apply()
    PointIndex m_count;
};

}  // namespace punctum
