// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace punctum
{

/// Zero-filled memory for large arrays, in huge pages where the system gives them.
///
/// Pages are taken only when first touched, so that a large column costs nothing until it is filled.
/// Move-only; an empty Buffer owns nothing. Page aligned, and readable for 128 bytes past its end, so that
/// SIMD code may load whole vectors at the end of an array.
class Buffer
{
public:
    Buffer() noexcept = default;
    /// Throws Error when the memory cannot be had.
    explicit Buffer(std::size_t bytes);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;

    std::byte* data() noexcept { return m_data; }
    const std::byte* data() const noexcept { return m_data; }
    std::size_t size() const noexcept { return m_size; }

private:
    std::byte* m_data = nullptr;
    std::size_t m_size = 0;
    std::size_t m_mapped = 0;
};

}  // namespace punctum
