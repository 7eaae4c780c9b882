// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum {

/// One change to a cloud that can be undone and redone.
///
/// A command is made (by a processing step or a tool) holding the new values; apply() swaps them with the cloud's,
/// so that applying again undoes it. Memory: the changed values and a bit a point, or the added columns.
class Command {
public:
    Command(std::string name) : m_name(std::move(name)) {}
    virtual ~Command() = default;
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    /// Shown in menus and lists: "Reclassify to 6 Building".
    const std::string& name() const noexcept { return m_name; }
    /// Points whose values differ.
    virtual PointIndex changedPoints() const noexcept = 0;
    /// Does it if undone, undoes it if done: takes cloud.mutex() alone for the time of the swap, then notifies.
    /// Parallel; never throws; call it from a job, not the GUI thread.
    virtual void apply(PointCloud& cloud) noexcept = 0;

private:
    std::string m_name;
};

/// New values of one column for a set of points.
class ValueCommand final : public Command {
public:
    /// `values`: raw elements (column.elementBytes() each) of the points in `points`, in rising index order.
    /// `attribute`: the attribute that is being changed, named in the change notice.
    ValueCommand(std::string name, const Attribute& attribute, std::shared_ptr<const PointSet> points,
                 std::vector<std::byte> values);

    PointIndex changedPoints() const noexcept override { return m_count; }
    void apply(PointCloud& cloud) noexcept override;

private:
    std::string m_attribute;
    std::shared_ptr<Column> m_column;
    std::shared_ptr<const PointSet> m_points;
    std::vector<PointIndex> m_rankOfBlock;  ///< members before each block of words: lets threads share the swap
    PointIndex m_count = 0;
    std::vector<std::byte> m_values;
};

/// Adds attributes with columns that are already filled (normals); undoing takes them out again.
/// An attribute of the cloud that has the same name is replaced, and comes back when undone.
class AttributesCommand final : public Command {
public:
    AttributesCommand(std::string name, std::vector<Attribute> attributes);

    PointIndex changedPoints() const noexcept override;
    void apply(PointCloud& cloud) noexcept override;

private:
    std::vector<std::string> m_names;    ///< of all attributes the command is about
    std::vector<Attribute> m_attributes; ///< those not in the cloud at present
};

}  // namespace punctum
