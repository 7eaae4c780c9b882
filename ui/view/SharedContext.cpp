// SPDX-License-Identifier: MIT
#include "ui/view/SharedContext.h"

#include "core/Error.h"

#include <QCoreApplication>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLExtraFunctions>
#include <QThread>

#include <utility>

namespace punctum::ui
{

namespace
{

QOpenGLExtraFunctions& functions()
{
    return *QOpenGLContext::currentContext()->extraFunctions();
}

QString refusal(const char* reason)
{
    return QCoreApplication::translate("SharedContext", reason);
}

}  // namespace

void FrameTexture::drawn() const
{
    const std::lock_guard lock(m_mutex);
    if (m_drawn != nullptr) functions().glDeleteSync(static_cast<GLsync>(m_drawn));
    m_drawn = functions().glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    functions().glFlush();  // the other context waits for it
}

std::shared_ptr<FrameTexture> FrameTextures::take(int width, int height)
{
    std::unique_ptr<FrameTexture> texture;
    {
        const std::lock_guard lock(m_mutex);
        while (!m_free.empty() && !texture) {
            texture = std::move(m_free.front());  // the one that was drawn longest ago
            m_free.erase(m_free.begin());
            if (texture->m_width == width && texture->m_height == height) break;
            destroy(*texture);
            texture = nullptr;
        }
    }
    QOpenGLExtraFunctions& gl = functions();
    if (texture) {
        if (texture->m_drawn != nullptr) {
            gl.glWaitSync(static_cast<GLsync>(texture->m_drawn), 0, GL_TIMEOUT_IGNORED);
            gl.glDeleteSync(static_cast<GLsync>(std::exchange(texture->m_drawn, nullptr)));
        }
    } else {
        texture = std::make_unique<FrameTexture>();
        texture->m_width = width;
        texture->m_height = height;
        gl.glGenTextures(1, &texture->m_id);
        gl.glBindTexture(GL_TEXTURE_2D, texture->m_id);
        gl.glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
        gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        gl.glBindTexture(GL_TEXTURE_2D, 0);
        if (gl.glGetError() != GL_NO_ERROR) {
            destroy(*texture);
            throw Error("The graphics card has no memory left for the picture.");
        }
    }
    return {texture.release(), [pool = shared_from_this()](FrameTexture* used) {
                pool->giveBack(std::unique_ptr<FrameTexture>(used));
            }};
}

void FrameTextures::giveBack(std::unique_ptr<FrameTexture> texture)
{
    const std::lock_guard lock(m_mutex);
    // No context may be current here; what is left over goes with the contexts that share it.
    if (!m_closed) m_free.push_back(std::move(texture));
}

void FrameTextures::close()
{
    const std::lock_guard lock(m_mutex);
    m_closed = true;
    for (const auto& texture : m_free) destroy(*texture);
    m_free.clear();
}

void FrameTextures::destroy(FrameTexture& texture)
{
    if (texture.m_drawn != nullptr)
        functions().glDeleteSync(static_cast<GLsync>(std::exchange(texture.m_drawn, nullptr)));
    if (texture.m_id != 0) functions().glDeleteTextures(1, &texture.m_id);
    texture.m_id = 0;
}

SharedContext::SharedContext() : m_textures(std::make_shared<FrameTextures>()) {}

SharedContext::~SharedContext() = default;

std::unique_ptr<SharedContext> SharedContext::create(QString& why)
{
    QOpenGLContext* const shared = QOpenGLContext::globalShareContext();
    if (shared == nullptr || !QOpenGLContext::supportsThreadedOpenGL()) {
        why = refusal("OpenGL cannot be shared between threads here.");
        return nullptr;
    }
    if (shared->format().version() < qMakePair(3, 2)) {  // widgets have the same, and need fences
        why = refusal("The window's OpenGL is older than 3.2.");
        return nullptr;
    }
    std::unique_ptr<SharedContext> made(new SharedContext);
    QSurfaceFormat format;
    format.setRenderableType(QSurfaceFormat::OpenGL);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setVersion(4, 5);
    format.setDepthBufferSize(0);
    format.setStencilBufferSize(0);
    made->m_context = std::make_unique<QOpenGLContext>();
    made->m_context->setFormat(format);
    made->m_context->setShareContext(shared);
    if (!made->m_context->create() || !QOpenGLContext::areSharing(made->m_context.get(), shared)) {
        why = refusal("The graphics driver does not share pictures between OpenGL contexts.");
        return nullptr;
    }
    const auto version = made->m_context->format().version();
    if (version < qMakePair(4, 3) || made->m_context->format().profile() != QSurfaceFormat::CoreProfile) {
        why = refusal("OpenGL that is shared with the window is older than 4.3.");
        return nullptr;
    }
    made->m_surface = std::make_unique<QOffscreenSurface>();
    made->m_surface->setFormat(made->m_context->format());
    made->m_surface->create();
    if (!made->m_surface->isValid()) {
        why = refusal("There is no OpenGL without a window here.");
        return nullptr;
    }
    made->m_context->moveToThread(nullptr);  // the render thread takes it
    return made;
}

void SharedContext::makeCurrent()
{
    if (m_context->thread() == nullptr) m_context->moveToThread(QThread::currentThread());
    if (!m_context->makeCurrent(m_surface.get()))
        throw Error("The OpenGL context that is shared with the window could not be used.");
}

void SharedContext::doneCurrent()
{
    if (QOpenGLContext::currentContext() == m_context.get()) m_context->doneCurrent();
}

void SharedContext::end()
{
    if (m_context->thread() == nullptr) m_context->moveToThread(QThread::currentThread());
    if (m_context->makeCurrent(m_surface.get())) m_textures->close();
    m_context = nullptr;
}

}  // namespace punctum::ui
