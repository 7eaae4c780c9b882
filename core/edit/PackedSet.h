// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"
#include "core/edit/SpillFile.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace punctum
{

/// A set of points in as little room as runs need: for each run how many points are left out before it, and how
/// many follow one another, as variable-length integers. Immutable.
class PackedSet
{
public:
    PackedSet() = default;
    explicit PackedSet(const PointSet& points);

    PointIndex size() const noexcept { return m_size; }  ///< of the cloud
    std::size_t bytes() const noexcept { return m_runs.size(); }
    PointSet unpacked() const;

    const std::vector<std::uint8_t>& runs() const noexcept { return m_runs; }
    /// Nothing when they make no set of a cloud of this size.
    static std::optional<PackedSet> fromRuns(std::vector<std::uint8_t> runs, PointIndex size);

    /// As printable text without blanks (base64, RFC 4648), and back; nothing when it is no set of a cloud of this
    /// size.
    std::string text() const;
    static std::optional<PackedSet> fromText(std::string_view text, PointIndex size);

private:
    template <typename F>
    bool forRuns(F f) const;

    PointIndex m_size = 0;
    std::vector<std::uint8_t> m_runs;
};

/// The set of a command: as it is while it is needed, meanwhile packed where that is shorter, or in a file.
class StowableSet
{
public:
    explicit StowableSet(std::shared_ptr<const PointSet> points) : m_size(points->size()), m_kept(std::move(points))
    {
    }

    /// Made anew for the caller while it is stowed. Throws Error when it cannot be read back.
    std::shared_ptr<const PointSet> points() const;
    /// Only while it is not stowed.
    const PointSet& operator*() const noexcept { return **std::get_if<Plain>(&m_kept); }
    const PointSet* operator->() const noexcept { return std::get_if<Plain>(&m_kept)->get(); }
    /// Packs it, tried once until it is fetched.
    void stow();
    /// What stow() made of it goes to the file. Throws Error; nothing has changed then. So does fetch().
    void spill(SpillFile& file);
    void fetch();
    std::size_t memory() const noexcept;
    std::size_t spilled() const noexcept;

private:
    using Plain = std::shared_ptr<const PointSet>;
    struct Spilled {
        SpillFile::Piece piece;
        bool packed;
        PointIndex count;
    };

    PointIndex m_size;
    std::variant<Plain, PackedSet, Spilled> m_kept;
    bool m_tried = false;
};

}  // namespace punctum
