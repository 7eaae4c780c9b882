// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace punctum::render
{

/// Name of an OpenGL object (GLuint); 0: none. This header needs no OpenGL header, so that it can be included
/// next to Qt's.
using GlId = unsigned int;

/// The kinds of objects that GlHandle owns. create/destroy need a current context; all throw nothing.
struct GlBufferKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};
struct GlTextureKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};
struct GlFramebufferKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};
struct GlVertexArrayKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};
struct GlQueryKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};
struct GlProgramKind {
    static GlId create();
    static void destroy(GlId id) noexcept;
};

/// Owns one OpenGL object. Move-only. Empty until create(): the empty state needs no context, neither to be made
/// nor to be destroyed; a full one must be destroyed while the context it was made in (or one that shares with
/// it) is current in this thread.
template <class Kind>
class GlHandle
{
public:
    GlHandle() noexcept = default;
    ~GlHandle() { reset(); }
    GlHandle(GlHandle&& other) noexcept : m_id(std::exchange(other.m_id, 0)) {}
    GlHandle& operator=(GlHandle&& other) noexcept
    {
        if (this != &other) {
            reset();
            m_id = std::exchange(other.m_id, 0);
        }
        return *this;
    }
    GlHandle(const GlHandle&) = delete;
    GlHandle& operator=(const GlHandle&) = delete;

    /// A new object of this kind.
    static GlHandle create() { return GlHandle(Kind::create()); }
    /// Takes over an object made elsewhere; 0 makes an empty handle.
    static GlHandle wrap(GlId id) noexcept { return GlHandle(id); }

    GlId id() const noexcept { return m_id; }
    explicit operator bool() const noexcept { return m_id != 0; }
    /// Gives the object away: the caller destroys it.
    [[nodiscard]] GlId release() noexcept { return std::exchange(m_id, 0); }
    /// Destroys the object.
    void reset() noexcept
    {
        if (m_id != 0) Kind::destroy(std::exchange(m_id, 0));
    }

private:
    explicit GlHandle(GlId id) noexcept : m_id(id) {}
    GlId m_id = 0;
};

using GlTexture = GlHandle<GlTextureKind>;
using GlFramebuffer = GlHandle<GlFramebufferKind>;
using GlVertexArray = GlHandle<GlVertexArrayKind>;
using GlQuery = GlHandle<GlQueryKind>;

/// Bytes brought to the device and back.
struct GlTraffic {
    std::uint64_t up = 0, down = 0;
};

/// Memory of the device. Sizes and offsets in bytes; one thread, that of the context.
class GlBuffer
{
public:
    GlBuffer() noexcept = default;
    /// Uninitialized memory. Throws Error when the device has none left.
    static GlBuffer allocate(std::size_t bytes);

    GlId id() const noexcept { return m_handle.id(); }
    std::size_t size() const noexcept { return m_size; }
    explicit operator bool() const noexcept { return bool(m_handle); }
    [[nodiscard]] GlId release() noexcept
    {
        m_size = 0;
        return m_handle.release();
    }

    /// Makes the buffer anew, uninitialized, when it is smaller. Throws Error.
    void reserve(std::size_t bytes);
    /// Sets each 4 bytes of the whole buffer, whose size must be a multiple of 4.
    void clear(std::uint32_t value = 0);
    /// [offset, offset + bytes) must lie inside the buffer. `traffic` counts.
    void write(std::size_t offset, const void* data, std::size_t bytes, GlTraffic& traffic);
    void read(std::size_t offset, void* data, std::size_t bytes, GlTraffic& traffic) const;

private:
    GlHandle<GlBufferKind> m_handle;
    std::size_t m_size = 0;
};

/// A linked program. Sources are given in pieces that are joined, so that shaders can share parts; `name` is what
/// the Error says when a piece does not compile (the driver's log is part of it).
class GlProgram
{
public:
    GlProgram() noexcept = default;
    /// Throws Error with the driver's log.
    static GlProgram graphics(std::string_view name, std::initializer_list<std::string_view> vertex,
                              std::initializer_list<std::string_view> fragment);
    /// Throws Error with the driver's log.
    static GlProgram compute(std::string_view name, std::initializer_list<std::string_view> source);

    GlId id() const noexcept { return m_handle.id(); }
    explicit operator bool() const noexcept { return bool(m_handle); }
    [[nodiscard]] GlId release() noexcept { return m_handle.release(); }
    void use() const;

private:
    GlHandle<GlProgramKind> m_handle;
};

/// A point in the stream of commands that can be waited for. Move-only, empty until insert().
class GlSync
{
public:
    GlSync() noexcept = default;
    ~GlSync();
    GlSync(GlSync&& other) noexcept : m_sync(std::exchange(other.m_sync, nullptr)) {}
    GlSync& operator=(GlSync&& other) noexcept
    {
        std::swap(m_sync, other.m_sync);
        return *this;
    }
    /// After everything asked for so far.
    static GlSync insert();
    explicit operator bool() const noexcept { return m_sync != nullptr; }
    /// Blocks until the device has come by. Does nothing when empty. Throws Error when the device is lost.
    void wait() const;

private:
    void* m_sync = nullptr;  ///< GLsync
};

/// Keeps what the backend changes of a context's state and puts it back, so that a context can be shared with a
/// toolkit that draws in between: framebuffers, program, vertex array, viewport, scissor, depth and blend state,
/// pixel packing, clip control.
class GlStateGuard
{
public:
    GlStateGuard();
    ~GlStateGuard();
    GlStateGuard(const GlStateGuard&) = delete;
    GlStateGuard& operator=(const GlStateGuard&) = delete;

private:
    int m_drawFramebuffer = 0, m_readFramebuffer = 0, m_program = 0, m_vertexArray = 0, m_packBuffer = 0;
    int m_viewport[4]{}, m_depthFunc = 0, m_clipOrigin = 0, m_clipDepth = 0, m_activeTexture = 0;
    int m_blend[6]{};  ///< equations and functions
    int m_packAlignment = 4, m_packRowLength = 0;
    unsigned char m_depthMask = 1, m_colorMask[4]{1, 1, 1, 1};
    bool m_clipControl = false;
    bool m_caps[8]{};
};

/// What a current context is able to do.
struct GlInfo {
    int major = 0, minor = 0;
    std::string renderer;  ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string driver;    ///< "4.5 (Core Profile) Mesa 22.3.6"
    bool clipControl = false;
    bool timesToBuffers = false;  ///< what the device's clock shows can be written to buffers
    int maxTextureSize = 0;
    int maxIntegerSamples = 1;
    std::int64_t maxStorageBlock = 0;  ///< bytes
    int maxViewport = 0;               ///< px, the smaller of both directions
};

/// Whether a context is current in this thread. Asks only libraries that the process has loaded already.
bool hasCurrentGlContext() noexcept;
/// The current context; throws Error, one sentence, when there is none or it is not OpenGL 4.3 core or later.
GlInfo requireGl43();
/// Throws Error when the device reported one since the last call; `doing`: "drawing points".
void checkGlErrors(std::string_view doing);

}  // namespace punctum::render
