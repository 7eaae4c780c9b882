// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

/// The places of a set's members among themselves. A byte for each eight points of the cloud.
class PointRanks
{
public:
    /// The set is not copied, and must stay as it is.
    explicit PointRanks(const PointSet& set) : m_words(set.words()), m_before(set.ranks(1)) {}
    std::size_t count() const noexcept { return std::size_t(m_before.back()); }
    /// How many members come before this point.
    std::uint32_t operator()(PointIndex point) const noexcept
    {
        const std::uint64_t below = m_words[std::size_t(point / 64)] & ((std::uint64_t(1) << (point % 64)) - 1);
        return std::uint32_t(m_before[std::size_t(point / 64)]) + std::uint32_t(std::popcount(below));
    }

private:
    std::span<const std::uint64_t> m_words;
    std::vector<PointIndex> m_before;
};

}  // namespace punctum
