// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace punctum
{

/// The words of a PointSet, all 0 or all ones at first: memory that costs nothing until it is written to, by pages
/// of 32,768 points. Those of ones are pages that all sets share until then, those of zeros the system's.
///
/// A value: a copy takes memory only for pages that are not all 0.
class SetWords
{
public:
    enum class Fill { Zeros, Ones };

    SetWords() noexcept = default;
    /// Throws Error when the memory cannot be had.
    SetWords(std::size_t words, Fill fill);
    ~SetWords();
    SetWords(const SetWords& other);
    SetWords& operator=(const SetWords& other);
    SetWords(SetWords&& other) noexcept;
    SetWords& operator=(SetWords&& other) noexcept;

    std::uint64_t* data() noexcept { return m_data; }
    const std::uint64_t* data() const noexcept { return m_data; }
    std::size_t size() const noexcept { return m_size; }

private:
    bool mapped() const noexcept;

    std::uint64_t* m_data = nullptr;
    std::size_t m_size = 0;
};

}  // namespace punctum
