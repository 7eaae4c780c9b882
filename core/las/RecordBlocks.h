// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/PointFormat.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum::las
{

/// Takes records of one layout apart into columns. Made once for a layout; any number of threads may use it.
///
/// Fields that fill the four-byte lanes of sixteen bytes of the record are taken together: sixteen bytes of four
/// records at a time are transposed, which needs a third of the loads and stores of copying field by field.
class Deinterleaver
{
public:
    explicit Deinterleaver(const RecordLayout& layout);

    /// Copies the fields of `count` records to columns: columns[k] is where field k of the first of these points
    /// goes, or null to leave it out. Works on pieces that stay in the first-level cache.
    void operator()(const std::byte* records, std::size_t count, std::span<std::byte* const> columns) const;

private:
    /// A field of 1, 2, 4 or 8 bytes in a group: where it begins, and which column it goes to.
    struct Part {
        std::uint8_t lane;   ///< of four bytes, 0-3; a field of 8 bytes has the next one too
        std::uint8_t shift;  ///< bits
        std::uint8_t bytes;
        std::size_t column;
    };
    /// Sixteen bytes of the record, from `offset` on.
    struct Group {
        std::size_t offset;
        std::vector<Part> parts;
    };
    struct Field {
        std::size_t offset, bytes;
    };
    static void gather(const Group& group, const std::byte* records, std::size_t stride, std::size_t first,
                       std::span<std::byte* const> columns);

    std::size_t m_stride;
    std::vector<Field> m_fields;       ///< all, by column
    std::vector<Group> m_groups;       ///< of two parts or more
    std::vector<std::size_t> m_alone;  ///< columns of the other fields
};

/// The reverse, for `count` points: columns[k] is where field k of the first point is, or null for zeros.
void interleave(const RecordLayout& layout, std::span<const std::byte* const> columns, std::size_t count,
                std::byte* records);

/// 0 ... count-1 in an order that visits everywhere early: each run of the order is spread over the whole.
std::vector<std::uint32_t> spreadOrder(std::uint32_t count);

}  // namespace punctum::las
