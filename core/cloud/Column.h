// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"
#include "core/cloud/ScalarType.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace punctum
{

/// Index of a point in its cloud: its position in the file, never changed by an edit.
using PointIndex = std::uint64_t;

/// Points `first` up to but not including `last`.
struct PointRange {
    PointIndex first = 0;
    PointIndex last = 0;

    constexpr PointIndex size() const noexcept { return last - first; }
    constexpr bool empty() const noexcept { return last <= first; }
    friend bool operator==(const PointRange&, const PointRange&) = default;
};

/// One field of the point record, for every point: an array in the file's own type.
///
/// Bit-packed bytes stay bytes; undocumented extra bytes are one column of `components` bytes a point.
/// Shape: size() x components() of type(), contiguous, point after point. Not synchronized: see
/// PointCloud::mutex().
///
/// In a cloud of many files some may lack a field: their points are said to be `absent` and hold 0 until an edit
/// gives them a value.
class Column
{
public:
    /// Throws Error when the memory cannot be had.
    Column(std::string name, ScalarType type, PointIndex size, std::uint32_t components = 1)
        : m_name(std::move(name)),
          m_type(type),
          m_components(components),
          m_size(size),
          m_buffer(size * components * sizeOf(type), BufferUse::Points),
          m_data(m_buffer.data())
    {
    }
    /// The points `range` of another column, under a name of its own: the same memory, which it keeps alive.
    Column(std::string name, std::shared_ptr<Column> whole, PointRange range)
        : m_name(std::move(name)),
          m_type(whole->type()),
          m_components(whole->components()),
          m_size(range.size()),
          m_whole(std::move(whole)),
          m_data(m_whole->data() + range.first * m_whole->elementBytes())
    {
    }
    Column(Column&&) noexcept = default;
    Column& operator=(Column&&) noexcept = default;
    ~Column() = default;
    Column(const Column&) = delete;
    Column& operator=(const Column&) = delete;

    const std::string& name() const noexcept { return m_name; }
    ScalarType type() const noexcept { return m_type; }
    std::uint32_t components() const noexcept { return m_components; }
    PointIndex size() const noexcept { return m_size; }
    /// Bytes of one point's element, all components.
    std::size_t elementBytes() const noexcept { return m_components * sizeOf(m_type); }

    std::byte* data() noexcept { return m_data; }
    const std::byte* data() const noexcept { return m_data; }
    /// Its memory is a file already (Residency).
    bool inFile() const noexcept { return m_whole ? m_whole->inFile() : m_buffer.inFile(); }

    /// Points of files that lack the field, as ranges in rising order; set before other threads see the column.
    const std::vector<PointRange>& absent() const noexcept { return m_absent; }
    void setAbsent(std::vector<PointRange> ranges) { m_absent = std::move(ranges); }
    /// Whether the point is of a file that lacks the field.
    bool isAbsent(PointIndex i) const noexcept
    {
        const auto after = std::upper_bound(m_absent.begin(), m_absent.end(), i,
                                            [](PointIndex p, const PointRange& r) { return p < r.last; });
        return after != m_absent.end() && after->first <= i;
    }

    /// The values, size() x components(); T must be the C++ type of type().
    template <typename T>
    std::span<T> values() noexcept
    {
        assert(sizeof(T) == sizeOf(m_type) && std::is_floating_point_v<T> == isFloating(m_type));
        return {reinterpret_cast<T*>(m_data), m_size * m_components};
    }
    template <typename T>
    std::span<const T> values() const noexcept
    {
        assert(sizeof(T) == sizeOf(m_type) && std::is_floating_point_v<T> == isFloating(m_type));
        return {reinterpret_cast<const T*>(m_data), m_size * m_components};
    }

private:
    std::string m_name;
    ScalarType m_type;
    std::uint32_t m_components;
    PointIndex m_size;
    Buffer m_buffer;                  ///< empty where the memory is another column's
    std::shared_ptr<Column> m_whole;  ///< that one
    std::byte* m_data;
    std::vector<PointRange> m_absent;
};

}  // namespace punctum
