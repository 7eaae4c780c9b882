// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

class QOffscreenSurface;
class QOpenGLContext;

namespace punctum::ui
{

/// A picture on the device, that the render thread has made and a widget draws. Both threads' contexts share it.
class FrameTexture
{
public:
    unsigned id() const noexcept { return m_id; }
    int width() const noexcept { return m_width; }
    int height() const noexcept { return m_height; }
    /// GUI thread, its context current: has been drawn up to here. It is not written again before that is done.
    void drawn() const;

private:
    friend class FrameTextures;
    unsigned m_id = 0;
    int m_width = 0, m_height = 0;
    mutable std::mutex m_mutex;
    mutable void* m_drawn = nullptr;  ///< GLsync, after the last drawing of it
};

/// Textures of frames, some more than are looked at, to be filled again.
class FrameTextures : public std::enable_shared_from_this<FrameTextures>
{
public:
    /// Render thread, its context current: a texture of this size that nobody draws any more. It comes back from
    /// any thread. Throws Error.
    std::shared_ptr<FrameTexture> take(int width, int height);
    /// Render thread, its context current: no texture is given out any more.
    void close();

private:
    void giveBack(std::unique_ptr<FrameTexture> texture);
    static void destroy(FrameTexture& texture);

    std::mutex m_mutex;
    std::vector<std::unique_ptr<FrameTexture>> m_free;
    bool m_closed = false;
};

/// An OpenGL context for the render thread that shares textures with the window's widgets, so that pictures drawn
/// there are shown without coming back to the processor. Needs Qt::AA_ShareOpenGLContexts.
///
/// Made and destroyed in the GUI thread; everything else belongs to the render thread.
class SharedContext
{
public:
    /// Null where this is not to be had; `why` is a sentence then.
    static std::unique_ptr<SharedContext> create(QString& why);
    ~SharedContext();
    SharedContext(const SharedContext&) = delete;
    SharedContext& operator=(const SharedContext&) = delete;

    /// Throws Error when the driver refuses.
    void makeCurrent();
    void doneCurrent();
    /// The render thread ends.
    void end();
    FrameTextures& textures() noexcept { return *m_textures; }

private:
    SharedContext();
    std::unique_ptr<QOffscreenSurface> m_surface;
    std::unique_ptr<QOpenGLContext> m_context;
    std::shared_ptr<FrameTextures> m_textures;
};

}  // namespace punctum::ui
