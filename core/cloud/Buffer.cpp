// SPDX-License-Identifier: MIT
#include "core/cloud/Buffer.h"

#include "core/Error.h"
#include "core/Text.h"

#include <sys/mman.h>

#include <limits>
#include <string>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kReadableTail = 128;
constexpr std::size_t kPage = 4096;
constexpr std::size_t kHugePage = std::size_t(2) << 20;

}  // namespace

Buffer::Buffer(std::size_t bytes) : m_size(bytes)
{
    if (bytes == 0) return;
    if (bytes > std::numeric_limits<std::size_t>::max() / 2) throw Error("There is not enough memory for this.");
    m_mapped = (bytes + kReadableTail + kPage - 1) / kPage * kPage;
    void* p = ::mmap(nullptr, m_mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (p == MAP_FAILED) throw Error("There is not enough memory: " + sizeText(bytes) + " more are needed.");
    // Fewer page faults and TLB misses: measured on filling columns, not needed for correctness.
    if (m_mapped >= kHugePage) (void)::madvise(p, m_mapped, MADV_HUGEPAGE);
    m_data = static_cast<std::byte*>(p);
}

Buffer::~Buffer()
{
    if (m_data != nullptr) ::munmap(m_data, m_mapped);
}

Buffer::Buffer(Buffer&& other) noexcept
    : m_data(std::exchange(other.m_data, nullptr)),
      m_size(std::exchange(other.m_size, 0)),
      m_mapped(std::exchange(other.m_mapped, 0))
{
}

Buffer& Buffer::operator=(Buffer&& other) noexcept
{
    std::swap(m_data, other.m_data);
    std::swap(m_size, other.m_size);
    std::swap(m_mapped, other.m_mapped);
    return *this;
}

}  // namespace punctum
