// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
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

}  // namespace punctum
