// SPDX-License-Identifier: MIT
#include "core/edit/DeleteCommand.h"

#include <algorithm>
#include <mutex>
#include <new>
#include <shared_mutex>
#include <utility>

namespace punctum
{

DeleteCommand::DeleteCommand(std::string name, std::shared_ptr<const PointSet> points)
    : Command(std::move(name)), m_points(std::move(points)), m_count(m_points->count())
{
    prepare();
}

std::shared_ptr<const PointSet> DeleteCommand::points() const
{
    return m_points ? m_points : std::make_shared<const PointSet>(m_packed->unpacked());
}

void DeleteCommand::prepare()
{
    auto next = m_next ? std::move(m_next) : std::make_shared<PointSet>(points()->size());
    m_points = points();
    m_packed.reset();
    m_next = std::move(next);
}

void DeleteCommand::apply(PointCloud& cloud) noexcept
{
    std::shared_ptr<const PointSet> before;  // freed without the lock
    {
        const std::unique_lock lock(cloud.mutex());
        before = cloud.deleted();
        const std::span<std::uint64_t> next = m_next->words();
        const std::span<const std::uint64_t> ours = std::as_const(*m_points).words();
        bool any = false;
        for (std::size_t w = 0; w < next.size(); ++w) {
            next[w] = (before ? before->words()[w] : 0) ^ ours[w];
            any = any || next[w] != 0;
        }
        cloud.setDeleted(any ? std::move(m_next) : nullptr);
        m_next.reset();
    }
    cloud.notify({ChangeNotice::Kind::Deleted, {}, m_points});
}

void DeleteCommand::stow() noexcept
{
    if (!m_points) return;
    try {
        PackedSet packed(*m_points);
        if (packed.bytes() >= m_points->words().size_bytes()) return;
        m_packed = std::move(packed);
        m_points.reset();
    } catch (const std::bad_alloc&) {
        // then it stays as it is, which is as good
    }
}

std::size_t DeleteCommand::memory() const noexcept
{
    return m_points ? m_points->words().size_bytes() : m_packed->bytes();
}

}  // namespace punctum
