// SPDX-License-Identifier: MIT
#include "render/store/CloudLoad.h"

#include <utility>

namespace punctum::render
{

CloudLoad::CloudLoad(std::shared_ptr<Session> session, OrderKind order)
    : m_session(std::move(session)),
      m_store(std::make_shared<PointStore>(m_session->cloud(), m_session->survey().sampledBounds(), order))
{
}

las::ReadResult CloudLoad::read(Progress& progress) const
{
    las::ReadResult result = m_session->read(
        progress, [this](PointRange range) { m_store->fill(range); },
        [this](PointRange range) { m_store->fillAhead(range); });
    for (const PointRange& range : result.missing) m_store->withdraw(range);  // some were read before all was known
    return result;
}

}  // namespace punctum::render
