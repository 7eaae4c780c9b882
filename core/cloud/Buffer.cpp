// SPDX-License-Identifier: MIT
#include "core/cloud/Buffer.h"

#include "core/Error.h"
#include "core/cloud/Residency.h"

#include <limits>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kReadableTail = 128;
constexpr std::size_t kPage = 4096;

}  // namespace

Buffer::Buffer(std::size_t bytes, BufferUse use) : m_size(bytes)
{
    if (bytes == 0) return;
    if (bytes > std::numeric_limits<std::size_t>::max() / 2) throw Error("There is not enough memory for this.");
    m_place = Residency::instance().take((bytes + kReadableTail + kPage - 1) / kPage * kPage, use);
}

Buffer::~Buffer()
{
    if (m_place.at != nullptr) Residency::instance().giveBack(m_place);
}

Buffer::Buffer(Buffer&& other) noexcept
    : m_place(std::exchange(other.m_place, {})), m_size(std::exchange(other.m_size, 0))
{
}

Buffer& Buffer::operator=(Buffer&& other) noexcept
{
    std::swap(m_place, other.m_place);
    std::swap(m_size, other.m_size);
    return *this;
}

}  // namespace punctum
