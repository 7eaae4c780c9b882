// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace punctum
{

/// What an array is for, which decides who comes first where memoryBudget() does not hold all.
enum class BufferUse {
    Working,  ///< for a while, or small: memory, and not counted
    Points,   ///< a column of a cloud: memory while half of the budget holds it
    Drawing,  ///< what is drawn, looked at in each frame: memory up to seven eighths of the budget
};

/// Memory, or a mapped file, that Residency gives and takes back.
struct BufferPlace {
    std::byte* at = nullptr;
    std::size_t bytes = 0;  ///< whole pages
    BufferUse use = BufferUse::Working;
    bool inFile = false;
};

/// Zero-filled memory for large arrays, in huge pages where the system gives them.
///
/// Pages are taken only when first touched, so that a large column costs nothing until it is filled. Where memory
/// is short, arrays of points and of what is drawn lie in files (Residency), and are used alike.
/// Move-only; an empty Buffer owns nothing. Page aligned, and readable for 128 bytes past its end, so that
/// SIMD code may load whole vectors at the end of an array.
class Buffer
{
public:
    Buffer() noexcept = default;
    /// Throws Error when the memory cannot be had.
    explicit Buffer(std::size_t bytes, BufferUse use = BufferUse::Working);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;

    std::byte* data() noexcept { return m_place.at; }
    const std::byte* data() const noexcept { return m_place.at; }
    std::size_t size() const noexcept { return m_size; }
    /// Its pages belong to a file: nothing else may be mapped in their place.
    bool inFile() const noexcept { return m_place.inFile; }

private:
    BufferPlace m_place;
    std::size_t m_size = 0;
};

}  // namespace punctum
