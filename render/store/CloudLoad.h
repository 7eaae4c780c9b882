// SPDX-License-Identifier: MIT
#pragma once

#include "core/session/Session.h"
#include "render/store/PointStore.h"

#include <memory>

namespace punctum::render
{

/// A session on its way into what is drawn of it: the store is made by the constructor, filled by read(). Cloud and
/// store may be shown in between.
///
/// Any thread, one at a time; session and store live as long as somebody holds them.
class CloudLoad
{
public:
    /// Of a session that was opened and not read.
    explicit CloudLoad(std::shared_ptr<Session> session, OrderKind order = OrderKind::Stratified);

    const std::shared_ptr<Session>& session() const noexcept { return m_session; }
    const std::shared_ptr<PointStore>& store() const noexcept { return m_store; }

    /// Reads all points into the cloud, and into the store while they are in the processor's cache. Throws Error,
    /// Cancelled.
    las::ReadResult read(Progress& progress) const;

private:
    std::shared_ptr<Session> m_session;
    std::shared_ptr<PointStore> m_store;
};

}  // namespace punctum::render
