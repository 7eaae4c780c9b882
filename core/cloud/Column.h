// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"
#include "core/cloud/ScalarType.h"

#include <cassert>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

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
class Column
{
public:
    /// Throws Error when the memory cannot be had.
    Column(std::string name, ScalarType type, PointIndex size, std::uint32_t components = 1)
        : m_name(std::move(name)),
          m_type(type),
          m_components(components),
          m_size(size),
          m_buffer(size * components * sizeOf(type))
    {
    }

    const std::string& name() const noexcept { return m_name; }
    ScalarType type() const noexcept { return m_type; }
    std::uint32_t components() const noexcept { return m_components; }
    PointIndex size() const noexcept { return m_size; }
    /// Bytes of one point's element, all components.
    std::size_t elementBytes() const noexcept { return m_components * sizeOf(m_type); }

    std::byte* data() noexcept { return m_buffer.data(); }
    const std::byte* data() const noexcept { return m_buffer.data(); }

    /// The values, size() x components(); T must be the C++ type of type().
    template <typename T>
    std::span<T> values() noexcept
    {
        assert(sizeof(T) == sizeOf(m_type) && std::is_floating_point_v<T> == isFloating(m_type));
        return {reinterpret_cast<T*>(m_buffer.data()), m_size * m_components};
    }
    template <typename T>
    std::span<const T> values() const noexcept
    {
        assert(sizeof(T) == sizeOf(m_type) && std::is_floating_point_v<T> == isFloating(m_type));
        return {reinterpret_cast<const T*>(m_buffer.data()), m_size * m_components};
    }

private:
    std::string m_name;
    ScalarType m_type;
    std::uint32_t m_components;
    PointIndex m_size;
    Buffer m_buffer;
};

}  // namespace punctum
