// SPDX-License-Identifier: MIT
#include "render/raster/gl_compute/GlBufferVisibility.h"

#include "core/Error.h"
#include "resources.h"

#include <epoxy/gl.h>

namespace punctum::render
{

std::string GlBufferVisibility::accessors() const
{
    return (m_wide ? "#define CELLS64\n" : "") + std::string(resource("shaders/gl_compute/visibility.glsl"));
}

void GlBufferVisibility::makeStorage(const GlInfo& info)
{
    m_storage.clear();
    for (const Band& band : bands()) {
        const std::size_t cells =
            std::size_t(size().width) * std::size_t(size().samples) * std::size_t(band.lastRow - band.firstRow);
        if (cells > std::size_t(info.maxStorageBlock) / (m_wide ? 8 : 4))
            throw Error("A row of the picture is too long for this graphics driver. Choose the CPU backend.");
        Storage storage;
        storage.ids = GlBuffer::allocate(cells * (m_wide ? 8 : 4));
        if (!m_wide) storage.depths = GlBuffer::allocate(cells * 4);
        m_storage.push_back(std::move(storage));
    }
}

void GlBufferVisibility::clear()
{
    for (Storage& storage : m_storage) {
        storage.ids.clear(kNoPoint);
        if (!m_wide) storage.depths.clear(kNoPoint);
    }
}

void GlBufferVisibility::bindForDrawing(const Band& band) const
{
    const Storage& storage = m_storage[indexOf(band)];
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, storage.ids.id());
    if (!m_wide) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, storage.depths.id());
}

void GlBufferVisibility::bindForReading(const Band& band)
{
    bindForDrawing(band);
    glUniform2i(15, band.firstRow, size().width);
}

}  // namespace punctum::render
