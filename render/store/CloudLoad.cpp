// SPDX-License-Identifier: MIT
#include "render/store/CloudLoad.h"

#include "core/las/SourceFile.h"

namespace punctum::render
{

CloudLoad::CloudLoad(const std::filesystem::path& path, OrderKind order)
    : m_reader(las::Reader::open(path)),
      m_cloud(m_reader->createCloud()),
      m_store(std::make_shared<PointStore>(m_cloud, source()->sampledBounds, order))
{
}

las::ReadResult CloudLoad::read(Progress& progress) const
{
    return m_reader->read(*m_cloud, progress, [this](PointRange range) { m_store->fill(range); });
}

}  // namespace punctum::render
