// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

/// The set of a command: as it is while it is needed, packed meanwhile where that is shorter.
class StowableSet
{
public:
    explicit StowableSet(std::shared_ptr<const PointSet> points) : m_points(std::move(points)) {}

    /// Made anew for the caller while it is stowed.
    std::shared_ptr<const PointSet> points() const
    {
        return m_points ? m_points : std::make_shared<const PointSet>(m_packed->unpacked());
    }
    /// Only while it is not stowed.
    const PointSet& operator*() const noexcept { return *m_points; }
    const PointSet* operator->() const noexcept { return m_points.get(); }
    /// Packs it, tried once until it is fetched.
    void stow();
    void fetch();
    std::size_t memory() const noexcept { return m_points ? m_points->words().size_bytes() : m_packed->bytes(); }

private:
    std::shared_ptr<const PointSet> m_points;  ///< null while it is stowed
    std::optional<PackedSet> m_packed;
    bool m_tried = false;
};

}  // namespace punctum
