// SPDX-License-Identifier: MIT
#include "render/raster/gl_compute/GlBufferVisibility.h"

#include "core/Error.h"
#include "resources.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>

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
        const std::size_t cells = cellsOf(band);
        if (cells > std::size_t(info.maxStorageBlock) / (m_wide ? 8 : 4))
            throw Error("A row of the picture is too long for this graphics driver. Choose the CPU backend.");
        Storage storage;
        storage.ids = GlBuffer::allocate(cells * (m_wide ? 8 : 4));
        if (!m_wide) storage.depths = GlBuffer::allocate(cells * 4);
        m_storage.push_back(std::move(storage));
    }
}

void GlBufferVisibility::emptyCells()
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

void GlBufferVisibility::emptySums()
{
    for (const Band& band : bands()) {
        Storage& storage = m_storage[indexOf(band)];
        for (GlBuffer* const sums : {&storage.redGreen, &storage.blueCount}) {
            sums->reserve(cellsOf(band) * 8);
            sums->clear();
        }
        storage.means.reserve(cellsOf(band) * 4);
    }
}

void GlBufferVisibility::bindForAdding(const Band& band) const
{
    bindForDrawing(band);
    const Storage& storage = m_storage[indexOf(band)];
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, storage.redGreen.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, storage.blueCount.id());
}

void GlBufferVisibility::makeMeans()
{
    if (!m_means)
        m_means = GlProgram::compute("means.comp", {kShaderHead, resource("shaders/gl_compute/means.comp.glsl")});
    m_means.use();
    for (const Band& band : bands()) {
        const Storage& storage = m_storage[indexOf(band)];
        glUniform1ui(at::kCells, GLuint(cellsOf(band)));
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, storage.redGreen.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, storage.blueCount.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, storage.means.id());
        constexpr GLuint kGroup = 256, kRow = 1024;  // groups in a row
        const GLuint groups = GLuint((cellsOf(band) + kGroup - 1) / kGroup);
        glDispatchCompute(std::min(groups, kRow), (groups + kRow - 1) / kRow, 1);
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void GlBufferVisibility::bindForReading(const Band& band)
{
    bindForDrawing(band);
    if (hasSums()) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, m_storage[indexOf(band)].means.id());
    glUniform2i(at::kStored, band.firstRow, size().width);
}

}  // namespace punctum::render
