// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Reader.h"
#include "render/store/PointStore.h"

#include <filesystem>
#include <memory>

namespace punctum::render
{

/// A file on its way into a cloud and the store that is drawn of it: opened by the constructor, filled by read().
/// Cloud and store may be shown in between.
///
/// Any thread, one at a time; the cloud and the store live as long as somebody holds them.
class CloudLoad
{
public:
    /// Reads what las::Reader::open() does, and no points. Throws Error.
    explicit CloudLoad(const std::filesystem::path& path, OrderKind order = OrderKind::Stratified);

    const std::shared_ptr<const las::SourceFile>& source() const noexcept { return m_reader->source(); }
    const std::shared_ptr<PointCloud>& cloud() const noexcept { return m_cloud; }
    const std::shared_ptr<PointStore>& store() const noexcept { return m_store; }

    /// Reads all points into the cloud, and into the store while they are in the processor's cache. Throws Error,
    /// Cancelled.
    las::ReadResult read(Progress& progress) const;

private:
    std::unique_ptr<las::Reader> m_reader;
    std::shared_ptr<PointCloud> m_cloud;
    std::shared_ptr<PointStore> m_store;
};

}  // namespace punctum::render
