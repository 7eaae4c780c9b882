// SPDX-License-Identifier: MIT
#include "render/gl/GlObjects.h"

#include "core/Error.h"

#include <dlfcn.h>
#include <epoxy/gl.h>

#include <cassert>
#include <vector>

namespace punctum::render
{
namespace
{

constexpr GLenum kCaps[] = {GL_DEPTH_TEST,  GL_BLEND,  GL_SCISSOR_TEST, GL_PROGRAM_POINT_SIZE,
                            GL_MULTISAMPLE, GL_DITHER, GL_STENCIL_TEST, GL_FRAMEBUFFER_SRGB};

constexpr GLenum kBlend[] = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA, GL_BLEND_SRC_RGB,
                             GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,      GL_BLEND_DST_ALPHA};

std::string join(std::initializer_list<std::string_view> pieces)
{
    std::string text;
    for (const std::string_view piece : pieces) text += piece;
    return text;
}

/// A compiled shader, deleted at the end of the scope: the program keeps its own reference.
struct Shader {
    GLuint id = 0;
    Shader(std::string_view name, GLenum stage, const std::string& source) : id(glCreateShader(stage))
    {
        const char* text = source.data();
        const GLint length = GLint(source.size());
        glShaderSource(id, 1, &text, &length);
        glCompileShader(id);
        GLint ok = 0;
        glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
        if (ok) return;
        GLint size = 0;
        glGetShaderiv(id, GL_INFO_LOG_LENGTH, &size);
        std::string log(std::size_t(size > 0 ? size : 1), '\0');
        glGetShaderInfoLog(id, GLsizei(log.size()), nullptr, log.data());
        glDeleteShader(id);
        throw Error("The graphics driver refused the shader " + std::string(name) + ": " + log.c_str());
    }
    ~Shader() { glDeleteShader(id); }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
};

void link(std::string_view name, GLuint program, std::initializer_list<GLuint> shaders)
{
    for (const GLuint shader : shaders) glAttachShader(program, shader);
    glLinkProgram(program);
    for (const GLuint shader : shaders) glDetachShader(program, shader);
    GLint ok = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (ok) return;
    GLint size = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &size);
    std::string log(std::size_t(size > 0 ? size : 1), '\0');
    glGetProgramInfoLog(program, GLsizei(log.size()), nullptr, log.data());
    throw Error("The graphics driver could not link the shader " + std::string(name) + ": " + log.c_str());
}

/// One object, by the function that makes names of its kind.
GlId generated(void (*generate)(GLsizei, GLuint*))
{
    GLuint id = 0;
    generate(1, &id);
    return id;
}

}  // namespace

GlId GlBufferKind::create()
{
    return generated(glGenBuffers);
}
void GlBufferKind::destroy(GlId id) noexcept
{
    glDeleteBuffers(1, &id);
}

GlId GlTextureKind::create()
{
    return generated(glGenTextures);
}
void GlTextureKind::destroy(GlId id) noexcept
{
    glDeleteTextures(1, &id);
}

GlId GlFramebufferKind::create()
{
    return generated(glGenFramebuffers);
}
void GlFramebufferKind::destroy(GlId id) noexcept
{
    glDeleteFramebuffers(1, &id);
}

GlId GlVertexArrayKind::create()
{
    return generated(glGenVertexArrays);
}
void GlVertexArrayKind::destroy(GlId id) noexcept
{
    glDeleteVertexArrays(1, &id);
}

GlId GlQueryKind::create()
{
    return generated(glGenQueries);
}
void GlQueryKind::destroy(GlId id) noexcept
{
    glDeleteQueries(1, &id);
}

GlId GlProgramKind::create()
{
    return glCreateProgram();
}
void GlProgramKind::destroy(GlId id) noexcept
{
    glDeleteProgram(id);
}

GlBuffer GlBuffer::allocate(std::size_t bytes)
{
    checkGlErrors("drawing");
    GlBuffer buffer;
    buffer.m_handle = GlHandle<GlBufferKind>::create();
    // COPY_WRITE is bound by nobody for drawing: nothing to put back.
    glBindBuffer(GL_COPY_WRITE_BUFFER, buffer.id());
    glBufferData(GL_COPY_WRITE_BUFFER, GLsizeiptr(bytes), nullptr, GL_DYNAMIC_DRAW);
    checkGlErrors("reserving memory");
    buffer.m_size = bytes;
    return buffer;
}

void GlBuffer::reserve(std::size_t bytes)
{
    if (m_size >= bytes) return;
    *this = GlBuffer();  // its memory may be needed for the new one
    *this = allocate(bytes);
}

void GlBuffer::clear(std::uint32_t value)
{
    assert(m_size % 4 == 0);
    glBindBuffer(GL_COPY_WRITE_BUFFER, id());
    glClearBufferData(GL_COPY_WRITE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void GlBuffer::write(std::size_t offset, const void* data, std::size_t bytes, GlTraffic& traffic)
{
    traffic.up += bytes;
    assert(offset <= m_size && bytes <= m_size - offset);
    glBindBuffer(GL_COPY_WRITE_BUFFER, id());
    glBufferSubData(GL_COPY_WRITE_BUFFER, GLintptr(offset), GLsizeiptr(bytes), data);
}

void GlBuffer::read(std::size_t offset, void* data, std::size_t bytes, GlTraffic& traffic) const
{
    traffic.down += bytes;
    assert(offset <= m_size && bytes <= m_size - offset);
    glBindBuffer(GL_COPY_READ_BUFFER, id());
    glGetBufferSubData(GL_COPY_READ_BUFFER, GLintptr(offset), GLsizeiptr(bytes), data);
}

GlProgram GlProgram::graphics(std::string_view name, std::initializer_list<std::string_view> vertex,
                              std::initializer_list<std::string_view> fragment)
{
    const Shader v(name, GL_VERTEX_SHADER, join(vertex));
    const Shader f(name, GL_FRAGMENT_SHADER, join(fragment));
    GlProgram program;
    program.m_handle = GlHandle<GlProgramKind>::create();
    link(name, program.id(), {v.id, f.id});
    return program;
}

GlProgram GlProgram::compute(std::string_view name, std::initializer_list<std::string_view> source)
{
    const Shader c(name, GL_COMPUTE_SHADER, join(source));
    GlProgram program;
    program.m_handle = GlHandle<GlProgramKind>::create();
    link(name, program.id(), {c.id});
    return program;
}

void GlProgram::use() const
{
    glUseProgram(id());
}

GlSync GlSync::insert()
{
    GlSync sync;
    sync.m_sync = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    return sync;
}

GlSync::~GlSync()
{
    if (m_sync) glDeleteSync(static_cast<GLsync>(m_sync));
}

void GlSync::wait() const
{
    if (!m_sync) return;
    constexpr GLuint64 kSecond = 1'000'000'000;
    for (;;) {
        const GLenum state = glClientWaitSync(static_cast<GLsync>(m_sync), GL_SYNC_FLUSH_COMMANDS_BIT, kSecond);
        if (state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED) return;
        if (state == GL_WAIT_FAILED) {
            checkGlErrors("waiting for the graphics card");
            throw Error("The graphics card stopped answering. Restart the program or choose the CPU backend.");
        }
    }
}

GlStateGuard::GlStateGuard()
{
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &m_drawFramebuffer);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &m_readFramebuffer);
    glGetIntegerv(GL_CURRENT_PROGRAM, &m_program);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &m_vertexArray);
    glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &m_packBuffer);
    glGetIntegerv(GL_VIEWPORT, m_viewport);
    glGetIntegerv(GL_DEPTH_FUNC, &m_depthFunc);
    glGetIntegerv(GL_ACTIVE_TEXTURE, &m_activeTexture);
    glGetIntegerv(GL_PACK_ALIGNMENT, &m_packAlignment);
    glGetIntegerv(GL_PACK_ROW_LENGTH, &m_packRowLength);
    for (std::size_t i = 0; i < std::size(kBlend); ++i) glGetIntegerv(kBlend[i], &m_blend[i]);
    glGetBooleanv(GL_DEPTH_WRITEMASK, &m_depthMask);
    glGetBooleanv(GL_COLOR_WRITEMASK, m_colorMask);
    for (std::size_t i = 0; i < std::size(kCaps); ++i) m_caps[i] = glIsEnabled(kCaps[i]);
    m_clipControl = epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
    if (m_clipControl) {
        glGetIntegerv(GL_CLIP_ORIGIN, &m_clipOrigin);
        glGetIntegerv(GL_CLIP_DEPTH_MODE, &m_clipDepth);
    }
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

GlStateGuard::~GlStateGuard()
{
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(m_drawFramebuffer));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(m_readFramebuffer));
    glUseProgram(GLuint(m_program));
    glBindVertexArray(GLuint(m_vertexArray));
    glBindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(m_packBuffer));
    glViewport(m_viewport[0], m_viewport[1], m_viewport[2], m_viewport[3]);
    glDepthFunc(GLenum(m_depthFunc));
    glActiveTexture(GLenum(m_activeTexture));
    glPixelStorei(GL_PACK_ALIGNMENT, m_packAlignment);
    glPixelStorei(GL_PACK_ROW_LENGTH, m_packRowLength);
    glBlendEquationSeparate(GLenum(m_blend[0]), GLenum(m_blend[1]));
    glBlendFuncSeparate(GLenum(m_blend[2]), GLenum(m_blend[3]), GLenum(m_blend[4]), GLenum(m_blend[5]));
    glDepthMask(m_depthMask);
    glColorMask(m_colorMask[0], m_colorMask[1], m_colorMask[2], m_colorMask[3]);
    for (std::size_t i = 0; i < std::size(kCaps); ++i) (m_caps[i] ? glEnable : glDisable)(kCaps[i]);
    if (m_clipControl) glClipControl(GLenum(m_clipOrigin), GLenum(m_clipDepth));
}

bool hasCurrentGlContext() noexcept
{
    // Epoxy ends the process when it is asked without a context, so the window system's library is asked first.
    const auto current = [](const char* library, const char* function) {
        void* const handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
        if (!handle) return false;
        using Get = void* (*)();
        const Get get = reinterpret_cast<Get>(dlsym(handle, function));
        const bool yes = get && get() != nullptr;
        dlclose(handle);
        return yes;
    };
    return current("libEGL.so.1", "eglGetCurrentContext") || current("libGLX.so.0", "glXGetCurrentContext") ||
           current("libGL.so.1", "glXGetCurrentContext");
}

GlInfo requireGl43()
{
    if (!hasCurrentGlContext()) throw Error("There is no OpenGL context to draw with. Use the CPU backend.");
    GlInfo info;
    const int version = epoxy_gl_version();
    info.major = version / 10;
    info.minor = version % 10;
    if (const GLubyte* text = glGetString(GL_RENDERER)) info.renderer = reinterpret_cast<const char*>(text);
    if (const GLubyte* text = glGetString(GL_VERSION)) info.driver = reinterpret_cast<const char*>(text);
    GLint profile = 0;
    if (epoxy_is_desktop_gl() && version >= 32) glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    if (version < 43 || !(profile & GL_CONTEXT_CORE_PROFILE_BIT))
        throw Error("This backend needs OpenGL 4.3 core or later, and " + info.renderer + " offers " +
                    std::to_string(info.major) + "." + std::to_string(info.minor) +
                    (version >= 43 ? " without the core profile" : "") + ". Use the CPU backend.");
    info.clipControl = version >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
    if (version >= 44 || epoxy_has_gl_extension("GL_ARB_query_buffer_object")) {
        GLint bits = 0;
        glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
        info.timesToBuffers = bits > 0;
    }
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &info.maxTextureSize);
    glGetIntegerv(GL_MAX_INTEGER_SAMPLES, &info.maxIntegerSamples);
    GLint64 block = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
    info.maxStorageBlock = block;
    GLint dims[2]{};
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, dims);
    info.maxViewport = dims[0] < dims[1] ? dims[0] : dims[1];
    return info;
}

void checkGlErrors(std::string_view doing)
{
    GLenum first = GL_NO_ERROR;
    // A lost context may report errors without end.
    for (int i = 0; i < 16; ++i) {
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) break;
        if (first == GL_NO_ERROR || error == GL_OUT_OF_MEMORY) first = error;
    }
    if (first == GL_NO_ERROR) return;
    if (first == GL_OUT_OF_MEMORY)
        throw Error(
            "The graphics card has no memory left for these points. Close a cloud or choose the CPU backend.");
    char code[16];
    std::snprintf(code, sizeof code, "0x%04x", first);
    throw Error("The graphics driver reported error " + std::string(code) + " while " + std::string(doing) +
                ". Choose the CPU backend.");
}

}  // namespace punctum::render
