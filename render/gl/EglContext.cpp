// SPDX-License-Identifier: MIT
#include "render/gl/EglContext.h"

#include "core/Error.h"

#include <epoxy/egl.h>

#include <functional>
#include <string_view>
#include <utility>
#include <vector>

namespace punctum::render
{
namespace
{

bool contains(const char* list, std::string_view name)
{
    if (!list) return false;
    std::string_view rest(list);
    while (!rest.empty()) {
        const std::size_t end = rest.find(' ');
        if (rest.substr(0, end) == name) return true;
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
    }
    return false;
}

EGLContext openOn(EGLDisplay display)
{
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) return EGL_NO_CONTEXT;
    const char* const extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!contains(extensions, "EGL_KHR_surfaceless_context") || !eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;

    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!contains(extensions, "EGL_KHR_no_config_context")) {
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
        EGLint found = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &found) || found < 1) return EGL_NO_CONTEXT;
    }
    for (const EGLint version : {5, 4, 3}) {
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     version,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
        if (context == EGL_NO_CONTEXT) continue;
        if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
        eglDestroyContext(display, context);
    }
    return EGL_NO_CONTEXT;
}

}  // namespace

EglContext EglContext::create()
{
    const char* const client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto platformDisplay =
        contains(client, "EGL_EXT_platform_base")
            ? reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"))
            : nullptr;

    struct Way {
        std::string name;
        std::function<EGLDisplay()> open;
    };
    std::vector<Way> ways;
    if (platformDisplay && contains(client, "EGL_MESA_platform_surfaceless"))
        ways.push_back({"surfaceless", [&] {
                            return platformDisplay(EGL_PLATFORM_SURFACELESS_MESA,
                                                   reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr);
                        }});
    const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    if (platformDisplay && queryDevices && contains(client, "EGL_EXT_platform_device")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (queryDevices(EGLint(std::size(devices)), devices, &count))
            for (EGLint i = 0; i < count; ++i)
                ways.push_back({"device " + std::to_string(i), [device = devices[i], platformDisplay] {
                                    return platformDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
                                }});
    }
    ways.push_back({"default display", [] { return eglGetDisplay(EGL_DEFAULT_DISPLAY); }});

    for (const Way& way : ways) {
        const EGLDisplay display = way.open();
        if (const EGLContext context = openOn(display); context != EGL_NO_CONTEXT) {
            EglContext result;
            result.m_display = display;
            result.m_context = context;
            result.m_platform = way.name;
            return result;
        }
    }
    throw Error(
        "OpenGL 4.3 without a window is not available on this machine. Install the Mesa EGL driver or use the CPU "
        "backend.");
}

EglContext::~EglContext()
{
    if (!m_context) return;
    doneCurrent();
    eglDestroyContext(m_display, m_context);
}

EglContext::EglContext(EglContext&& other) noexcept
    : m_display(std::exchange(other.m_display, nullptr)),
      m_context(std::exchange(other.m_context, nullptr)),
      m_platform(std::move(other.m_platform))
{
}

EglContext& EglContext::operator=(EglContext&& other) noexcept
{
    std::swap(m_display, other.m_display);
    std::swap(m_context, other.m_context);
    std::swap(m_platform, other.m_platform);
    return *this;
}

void EglContext::makeCurrent()
{
    if (!m_context || !eglBindAPI(EGL_OPENGL_API) ||
        !eglMakeCurrent(m_display, EGL_NO_SURFACE, EGL_NO_SURFACE, m_context))
        throw Error("The OpenGL context could not be used in this thread. Use the CPU backend.");
}

void EglContext::doneCurrent() noexcept
{
    if (m_context && eglGetCurrentContext() == m_context)
        eglMakeCurrent(m_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace punctum::render
