// SPDX-License-Identifier: MIT
#include "render/scene/PointIds.h"

#include "core/Error.h"

namespace punctum::render
{

PointId PointIds::take(Slot count)
{
    constexpr std::uint64_t kBlock = std::uint64_t(1) << kBlockBits;
    const auto blocks = std::size_t((count + kBlock - 1) >> kBlockBits);
    if (blocks > kBlocks - m_owners.size())
        throw Error("A view holds up to 4,294,901,760 points, and these clouds together have more; leave one out.");
    const auto first = PointId(m_owners.size() << kBlockBits);
    m_owners.insert(m_owners.end(), blocks, std::uint32_t(m_layers.size()));
    m_layers.push_back({first, count});
    return first;
}

void PointIds::clear() noexcept
{
    m_layers.clear();
    m_owners.clear();
}

}  // namespace punctum::render
