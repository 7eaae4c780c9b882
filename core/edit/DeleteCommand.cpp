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

void DeleteCommand::prepare()
{
    m_points.fetch();
    if (!m_next) m_next = std::make_shared<PointSet>(m_points->size());
}

void DeleteCommand::apply(PointCloud& cloud) noexcept
{
    std::shared_ptr<const PointSet> before;  // freed without the lock
    {
        const std::unique_lock lock(cloud.mutex());
        before = cloud.deleted();
        const std::span<std::uint64_t> next = m_next->words();
        const std::span<const std::uint64_t> ours = m_points->words();
        bool any = false;
        for (std::size_t w = 0; w < next.size(); ++w) {
            const std::uint64_t bits = (before ? std::as_const(*before).words()[w] : 0) ^ ours[w];
            if (bits == 0) continue;  // next is empty: what it need not have takes no memory
            next[w] = bits;
            any = true;
        }
        cloud.setDeleted(any ? std::move(m_next) : nullptr);
        m_next.reset();
    }
    cloud.notify({ChangeNotice::Kind::Deleted, {}, m_points.points()});
}

void DeleteCommand::stow() noexcept
{
    try {
        m_points.stow();
    } catch (const std::bad_alloc&) {
        // then it stays as it is, which is as good
    }
}

}  // namespace punctum
