// SPDX-License-Identifier: MIT
#pragma once

#include "core/Identity.h"
#include "core/cloud/PointCloud.h"
#include "core/edit/DetachedColumns.h"
#include "core/edit/PackedSet.h"
#include "core/edit/Recipe.h"
#include "core/edit/SpillFile.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

/// One change to a cloud that can be undone and redone.
///
/// A command is made (by a processing step or a tool) holding the new values; apply() swaps them with the cloud's,
/// so that applying again undoes it. Memory: the changed values and a bit a point, or the columns that the
/// cloud does not have.
class Command
{
public:
    explicit Command(std::string name);
    virtual ~Command() = default;
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    /// Shown in menus and lists: "Reclassify to 6 Building".
    const std::string& name() const noexcept { return m_name; }
    /// What a journal knows it by.
    const Identity& identity() const noexcept { return m_identity; }
    /// What it was made from, where that is known: makeCommand() sets it, a journal keeps it. Needed until the
    /// command has been done for the first time; its set is dropped then.
    const std::optional<Recipe>& recipe() const noexcept { return m_recipe; }
    void setRecipe(Recipe recipe) { m_recipe = std::move(recipe); }
    void dropRecipe() noexcept { m_recipe.reset(); }
    /// One sentence on what was found, beside how many points change: "214 trees."; empty: nothing more to say.
    const std::string& finding() const noexcept { return m_finding; }
    void setFinding(std::string sentence) { m_finding = std::move(sentence); }
    /// Points whose values differ.
    virtual PointIndex changedPoints() const noexcept = 0;
    /// Which they are; null where that is all points, or not known. Throws Error when it cannot be read back.
    virtual std::shared_ptr<const PointSet> points() const { return nullptr; }
    /// Does it if undone, undoes it if done: takes cloud.mutex() alone for the time of the swap, then notifies.
    /// Parallel; never throws; call it from a job, not the GUI thread.
    virtual void apply(PointCloud& cloud) noexcept = 0;
    /// Makes ready for apply(): reads back what is spilled, and takes apart what stow() put together. May throw;
    /// nothing has changed then.
    virtual void prepare() = 0;
    /// Puts together what is kept until the next apply(), in as little memory as it takes.
    virtual void stow() noexcept {}
    /// Moves what stow() put together to the file, as much of it as can be there. Throws Error when the file takes
    /// no more; all is kept then, where it is.
    virtual void spill(SpillFile& file) = 0;
    /// Bytes that it keeps in memory, about, and in the file.
    virtual std::size_t memory() const noexcept = 0;
    virtual std::size_t spilled() const noexcept = 0;

    /// What there is to be seen of it in the cloud, done or undone.
    struct Effect {
        std::vector<std::shared_ptr<Column>> columns;  ///< whose values it swaps
        std::vector<Attribute> added, removed;         ///< by doing it
        bool deletes = false;                          ///< its points are deleted, or restored
    };
    /// The same for as long as the command is neither done nor undone.
    virtual Effect effect() const = 0;
    /// `values`: the column's elements as they are on this side of the command; they become those of the other
    /// side. Nothing for columns that it does not swap. Throws Error when it cannot be read back.
    virtual void cross(const Column& column, std::span<std::byte> values) const = 0;
    /// Before it is done for the first time: attributes that it puts in, filled, under the names that they get.
    /// They share its columns.
    virtual std::vector<Attribute> brings() const { return {}; }

private:
    std::string m_name;
    Identity m_identity;
    std::optional<Recipe> m_recipe;
    std::string m_finding;
};

/// New values of one column for a set of points.
///
/// Where the attribute is a bit field, only its bits are swapped: the other fields of the byte keep what other
/// commands gave them.
class ValueCommand final : public Command
{
public:
    /// `values`: raw elements (column.elementBytes() each) of the points in `points`, in rising index order.
    /// `attribute`: the attribute that is being changed, named in the change notice; its first column is meant.
    ValueCommand(std::string name, const Attribute& attribute, std::shared_ptr<const PointSet> points,
                 std::vector<std::byte> values);

    PointIndex changedPoints() const noexcept override { return m_count; }
    std::shared_ptr<const PointSet> points() const override { return m_points.points(); }
    void apply(PointCloud& cloud) noexcept override;
    void prepare() override;
    void stow() noexcept override;
    void spill(SpillFile& file) override;
    std::size_t memory() const noexcept override;
    std::size_t spilled() const noexcept override { return m_points.spilled() + m_values.spilled(); }
    Effect effect() const override { return {{m_column}, {}, {}}; }
    void cross(const Column& column, std::span<std::byte> values) const override;

private:
    ChangeNotice m_notice;  ///< made early, so that apply() has nothing to allocate
    std::shared_ptr<Column> m_column;
    StowableSet m_points;
    std::vector<PointIndex> m_ranks;  ///< of the blocks of words that threads swap; none while it is stowed
    PointIndex m_count = 0;
    std::uint64_t m_mask = ~std::uint64_t(0);  ///< bits of an element that belong to the attribute
    /// While `m_packed`: a count of 4 bytes and an element for each run of equal ones.
    StowedBytes m_values;
    bool m_packed = false;
    bool m_stowed = false;  ///< it was tried

    std::vector<std::byte> values() const;
};

/// Adds attributes with columns that are already filled (normals); undoing takes them out again.
///
/// An attribute of the cloud that has the same name is replaced, and comes back when undone. Where the types agree
/// the columns trade contents in their places, so that a column of the file's record keeps its place in the record.
/// Replacing an attribute of the file's record by one of another type is not supported: the record would not fit.
class AttributesCommand final : public Command
{
public:
    /// Columns that several of the attributes show (NormalX and Normal) are shared between them.
    AttributesCommand(std::string name, std::vector<Attribute> attributes);

    PointIndex changedPoints() const noexcept override { return m_changedPoints; }
    void apply(PointCloud& cloud) noexcept override;
    void prepare() override { m_detached.fetch(); }
    void spill(SpillFile& file) override { m_detached.spill(file); }
    std::size_t memory() const noexcept override { return m_detached.memory(); }
    std::size_t spilled() const noexcept override { return m_detached.spilled(); }
    Effect effect() const override;
    void cross(const Column& column, std::span<std::byte> values) const override;
    std::vector<Attribute> brings() const override { return m_attributes; }

private:
    /// Two columns of one shape that swap contents.
    struct Trade {
        std::shared_ptr<Column> theirs;  ///< in the cloud
        std::shared_ptr<Column> ours;
        friend bool operator==(const Trade&, const Trade&) = default;
    };

    void plan(const PointCloud& cloud);
    bool planTrade(const PointCloud& cloud, const Attribute& theirs, const Attribute& ours);
    void keepDetached(const PointCloud& cloud);

    DetachedColumns m_detached;           ///< once planned: what the cloud does not have
    std::vector<Attribute> m_attributes;  ///< what was asked for; empty once planned
    PointIndex m_changedPoints = 0;
    bool m_planned = false;
    bool m_done = false;
    std::vector<Trade> m_trades;
    std::vector<Attribute> m_added;
    std::vector<Attribute> m_displaced;  ///< taken out of the cloud, because their types do not agree
    ChangeNotice m_values;
    ChangeNotice m_list;
};

}  // namespace punctum
