// SPDX-License-Identifier: MIT
#include "core/cloud/SetWords.h"

#include "core/Error.h"
#include "core/Text.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

namespace punctum
{

namespace
{

constexpr std::size_t kSetPage = 4096;
constexpr std::size_t kPageWords = kSetPage / sizeof(std::uint64_t);
/// Smaller sets come from the heap: a mapping of their own costs more than it saves.
constexpr std::size_t kLeastMapped = std::size_t(64) << 10;
/// Of ones, mapped again and again: few mappings for large sets, and little memory for the first one.
constexpr std::size_t kOnesBytes = std::size_t(1) << 20;

constexpr std::size_t mappedBytes(std::size_t words)
{
    return (words * sizeof(std::uint64_t) + kSetPage - 1) / kSetPage * kSetPage;
}

/// A file without a name, in memory, of nothing but ones; -1 where it cannot be had.
class SharedOnes
{
public:
    SharedOnes() : m_file(::memfd_create("punctum-ones", MFD_CLOEXEC))
    {
        if (m_file < 0) return;
        const std::vector<unsigned char> ones(kOnesBytes, 0xFF);
        std::size_t at = 0;
        while (at < ones.size()) {
            const ::ssize_t n = ::write(m_file, ones.data() + at, ones.size() - at);
            if (n <= 0) break;
            at += std::size_t(n);
        }
        if (at < ones.size()) {
            ::close(m_file);
            m_file = -1;
        }
    }
    ~SharedOnes()
    {
        if (m_file >= 0) ::close(m_file);
    }
    SharedOnes(const SharedOnes&) = delete;
    SharedOnes& operator=(const SharedOnes&) = delete;

    /// Lays them over a mapping, of which each page stays shared until it is written to; false where that failed.
    bool over(std::byte* at, std::size_t bytes) const
    {
        for (std::size_t done = 0; m_file >= 0 && done < bytes; done += kOnesBytes)
            if (::mmap(at + done, std::min(kOnesBytes, bytes - done), PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_FIXED | MAP_NORESERVE, m_file, 0) == MAP_FAILED)
                return false;
        return m_file >= 0;
    }

private:
    int m_file = -1;
};

[[noreturn]] void throwNoRoom(std::size_t words)
{
    throw Error("There is not enough memory: " + sizeText(words * sizeof(std::uint64_t)) + " more are needed.");
}

}  // namespace

bool SetWords::mapped() const noexcept
{
    return m_size * sizeof(std::uint64_t) >= kLeastMapped;
}

SetWords::SetWords(std::size_t words, Fill fill) : m_size(words)
{
    if (words == 0) return;
    if (!mapped()) {
        m_data = static_cast<std::uint64_t*>(std::calloc(words, sizeof(std::uint64_t)));
        if (m_data == nullptr) throwNoRoom(words);
        if (fill == Fill::Ones) std::fill_n(m_data, words, ~std::uint64_t(0));
        return;
    }
    void* const pages = ::mmap(nullptr, mappedBytes(words), PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) throwNoRoom(words);
    m_data = static_cast<std::uint64_t*>(pages);
    if (fill == Fill::Zeros) return;
    static const SharedOnes ones;
    if (!ones.over(static_cast<std::byte*>(pages), mappedBytes(words)))
        std::fill_n(m_data, words, ~std::uint64_t(0));
}

SetWords::~SetWords()
{
    if (m_data == nullptr) return;
    if (mapped())
        ::munmap(m_data, mappedBytes(m_size));
    else
        std::free(m_data);
}

SetWords::SetWords(const SetWords& other) : SetWords(other.m_size, Fill::Zeros)
{
    for (std::size_t at = 0; at < m_size; at += kPageWords) {
        const std::size_t n = std::min(kPageWords, m_size - at);
        std::uint64_t any = 0;
        for (std::size_t w = at; w < at + n; ++w) any |= other.m_data[w];
        if (any != 0) std::memcpy(m_data + at, other.m_data + at, n * sizeof(std::uint64_t));
    }
}

SetWords& SetWords::operator=(const SetWords& other)
{
    if (this != &other) *this = SetWords(other);
    return *this;
}

SetWords::SetWords(SetWords&& other) noexcept
    : m_data(std::exchange(other.m_data, nullptr)), m_size(std::exchange(other.m_size, 0))
{
}

SetWords& SetWords::operator=(SetWords&& other) noexcept
{
    std::swap(m_data, other.m_data);
    std::swap(m_size, other.m_size);
    return *this;
}

}  // namespace punctum
