// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace punctum::render
{

/// An OpenGL core context (4.5, or whatever is there down to 4.3) that needs no window and no display: for the
/// command line and for tests. Move-only; owns the context. Works next to an X display and without one.
///
/// The context belongs to the thread in which it was made current last. Objects made in it must be destroyed
/// before it, while it is current.
class EglContext
{
public:
    /// An empty one: needs no EGL.
    EglContext() noexcept = default;
    /// Opens a context and makes it current. Throws Error, one sentence, when the machine offers none.
    static EglContext create();
    ~EglContext();
    EglContext(EglContext&& other) noexcept;
    EglContext& operator=(EglContext&& other) noexcept;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    explicit operator bool() const noexcept { return m_context != nullptr; }
    /// Throws Error when the driver refuses.
    void makeCurrent();
    /// No context is current in this thread any more.
    void doneCurrent() noexcept;
    /// "surfaceless", "device 0", "default display": which way the context was found.
    const std::string& platform() const noexcept { return m_platform; }

private:
    void* m_display = nullptr;  ///< EGLDisplay, shared by the whole process: never terminated
    void* m_context = nullptr;  ///< EGLContext
    std::string m_platform;
};

}  // namespace punctum::render
