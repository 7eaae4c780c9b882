// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlTextureVisibility.h"

#include "core/Error.h"
#include "resources.h"

#include <epoxy/gl.h>

namespace punctum::render
{

std::string GlTextureVisibility::accessors() const
{
    return std::string(resource("shaders/gl_points/visibility.glsl"));
}

GLenum GlTextureVisibility::target() const noexcept
{
    return size().samples == 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_MULTISAMPLE;
}

GlTexture GlTextureVisibility::storage(GLenum format) const
{
    GlTexture texture = GlTexture::create();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(target(), texture.id());
    if (size().samples == 1) {
        glTexStorage2D(target(), 1, format, size().width, size().height);
        glTexParameteri(target(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(target(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    } else {
        glTexStorage2DMultisample(target(), size().samples, format, size().width, size().height, GL_TRUE);
    }
    glBindTexture(target(), 0);
    return texture;
}

void GlTextureVisibility::makeStorage(const GlInfo& info)
{
    m_framebuffer.reset();
    m_sumsFramebuffer.reset();
    m_ids.reset();
    m_depths.reset();
    m_sums.reset();
    if (bands().empty()) return;
    if (size().samples > info.maxIntegerSamples)
        throw Error("The graphics card offers at most " + std::to_string(info.maxIntegerSamples) +
                    " samples a pixel for point numbers. Choose fewer samples or the CPU backend.");
    checkGlErrors("drawing");
    m_ids = storage(GL_R32UI);
    m_depths = storage(GL_DEPTH_COMPONENT32F);
    GlFramebuffer framebuffer = GlFramebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, m_ids.id(), 0);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, m_depths.id(), 0);
    checkGlErrors("making the picture's buffers");
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error("The graphics card cannot draw point numbers of " + std::to_string(size().samples) +
                    " samples a pixel. Choose 1 sample or the CPU backend.");
    m_framebuffer = std::move(framebuffer);
}

void GlTextureVisibility::emptySums()
{
    if (!m_sums) {
        checkGlErrors("drawing");
        m_sums = storage(GL_RGBA32F);
        m_sumsFramebuffer = GlFramebuffer::create();
        glBindFramebuffer(GL_FRAMEBUFFER, m_sumsFramebuffer.id());
        glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, m_sums.id(), 0);
        checkGlErrors("making room for mean colors");
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            throw Error("The graphics card cannot add up colors. Turn averaging off or choose the CPU backend.");
    }
    bindSums();
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const GLfloat none[4] = {};
    glClearBufferfv(GL_COLOR, 0, none);
}

void GlTextureVisibility::bindSums() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, m_sumsFramebuffer.id());
}

void GlTextureVisibility::bindFramebuffer() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, m_framebuffer.id());
}

void GlTextureVisibility::bindForReading(const Band&)
{
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(target(), m_depths.id());
    if (hasSums()) {
        glActiveTexture(GL_TEXTURE2);
        glBindTexture(target(), m_sums.id());
    }
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(target(), m_ids.id());
}

void GlTextureVisibility::emptyCells()
{
    if (!m_framebuffer) return;
    bindFramebuffer();
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    const GLuint none[4] = {kNoPoint, kNoPoint, kNoPoint, kNoPoint};
    const GLfloat farthest = 0.0f;
    glClearBufferuiv(GL_COLOR, 0, none);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
}

}  // namespace punctum::render
