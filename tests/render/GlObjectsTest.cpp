// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "render/gl/EglContext.h"
#include "render/gl/GlObjects.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <QTest>

#include <array>

using namespace punctum;
using namespace punctum::render;

class GlObjectsTest : public QObject
{
    Q_OBJECT

private slots:
    void emptyObjectsNeedNoContext();
    void noContextIsOneSentence();
    void contextsComeAndGo();
    void olderProfileIsOneSentence();
    void objectsAreMovedNotCopied();
    void buffersKeepBytes();
    void memoryThatIsNotThere();
    void shaderErrorsCarryTheLog();
    void fencesAreReached();
    void stateIsPutBack();
};

namespace
{

/// One context for all tests that need one; skips the test where the machine has none.
EglContext& context()
{
    static EglContext egl;
    if (!egl) egl = EglContext::create();
    return egl;
}

QString whyNoContext()
{
    try {
        context().makeCurrent();
        return {};
    } catch (const Error& e) {
        return QString::fromUtf8(e.what());
    }
}

}  // namespace

#define NEEDS_CONTEXT() \
    if (const QString why = whyNoContext(); !why.isEmpty()) QSKIP(qPrintable(why))

void GlObjectsTest::emptyObjectsNeedNoContext()
{
    GlTexture texture;
    GlTexture other = std::move(texture);
    other.reset();
    QCOMPARE(other.id(), 0u);
    QCOMPARE(other.release(), 0u);
    GlBuffer buffer;
    buffer = GlBuffer();
    QVERIFY(!buffer);
    QCOMPARE(buffer.size(), std::size_t(0));
    GlProgram program;
    QVERIFY(!program);
    GlSync sync;
    sync.wait();
    EglContext empty;
    empty.doneCurrent();
    QVERIFY(!empty);
    static_assert(!std::is_copy_constructible_v<GlTexture> && !std::is_copy_assignable_v<GlBuffer>);
    static_assert(std::is_nothrow_move_constructible_v<GlFramebuffer>);
}

void GlObjectsTest::noContextIsOneSentence()
{
    QVERIFY(!hasCurrentGlContext());
    try {
        (void)requireGl43();
        QFAIL("no Error");
    } catch (const Error& e) {
        QVERIFY(QString(e.what()).contains("no OpenGL context"));
    }
}

void GlObjectsTest::contextsComeAndGo()
{
    NEEDS_CONTEXT();
    QVERIFY(hasCurrentGlContext());
    const GlInfo info = requireGl43();
    QVERIFY(info.major * 10 + info.minor >= 43);
    QVERIFY(!info.renderer.empty());
    QVERIFY(info.maxTextureSize >= 4096);
    context().doneCurrent();
    QVERIFY(!hasCurrentGlContext());
    {
        // A second one, and its end, leave the first alone.
        EglContext second = EglContext::create();
        EglContext moved = std::move(second);
        QVERIFY(!second);
        QVERIFY(hasCurrentGlContext());
    }
    QVERIFY(!hasCurrentGlContext());
    context().makeCurrent();
    QVERIFY(hasCurrentGlContext());
}

void GlObjectsTest::olderProfileIsOneSentence()
{
    NEEDS_CONTEXT();
    const EGLDisplay display = eglGetCurrentDisplay();
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 2, EGL_CONTEXT_MINOR_VERSION, 1, EGL_NONE};
    const EGLContext old = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (old == EGL_NO_CONTEXT) QSKIP("The driver has no contexts of OpenGL 2.1.");
    QVERIFY(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, old));
    QString sentence;
    try {
        (void)requireGl43();
    } catch (const Error& e) {
        sentence = e.what();
    }
    context().makeCurrent();
    eglDestroyContext(display, old);
    QVERIFY2(sentence.contains("needs OpenGL 4.3 core"), qPrintable(sentence));
}

void GlObjectsTest::objectsAreMovedNotCopied()
{
    NEEDS_CONTEXT();
    GlId id = 0;
    {
        GlTexture a = GlTexture::create();
        id = a.id();
        glBindTexture(GL_TEXTURE_2D, id);
        QVERIFY(glIsTexture(id));
        GlTexture b = std::move(a);
        QCOMPARE(a.id(), 0u);
        QCOMPARE(b.id(), id);
        GlTexture& same = b;
        b = std::move(same);  // to itself: nothing is lost
        QCOMPARE(b.id(), id);
    }
    QVERIFY(!glIsTexture(id));
    GlVertexArray array = GlVertexArray::create();
    glBindVertexArray(array.id());
    const GlId given = array.release();
    array.reset();
    QVERIFY(glIsVertexArray(given));
    GlVertexArray::wrap(given).reset();
    QVERIFY(!glIsVertexArray(given));
}

void GlObjectsTest::buffersKeepBytes()
{
    NEEDS_CONTEXT();
    GlBuffer buffer = GlBuffer::allocate(64);
    QCOMPARE(buffer.size(), std::size_t(64));
    buffer.clear();
    const std::array<std::uint32_t, 3> in{1, 2, 0xFFFFFFFF};
    GlTraffic traffic;
    buffer.write(8, in.data(), sizeof in, traffic);
    std::array<std::uint32_t, 16> out;
    out.fill(7);
    buffer.read(0, out.data(), sizeof out, traffic);
    QCOMPARE(traffic.up, sizeof in);
    QCOMPARE(traffic.down, sizeof out);
    QCOMPARE(out, (std::array<std::uint32_t, 16>{0, 0, 1, 2, 0xFFFFFFFF}));
}

void GlObjectsTest::memoryThatIsNotThere()
{
    NEEDS_CONTEXT();
    try {
        (void)GlBuffer::allocate(std::size_t(1) << 60);
        QFAIL("no Error");
    } catch (const Error& e) {
        QVERIFY2(QString(e.what()).contains("no memory left"), e.what());
    }
    checkGlErrors("testing");  // the error was taken: nothing is left behind
}

void GlObjectsTest::shaderErrorsCarryTheLog()
{
    NEEDS_CONTEXT();
    try {
        (void)GlProgram::compute("broken.comp", {"#version 430 core\n", "void main() { undeclared = 1; }\n"});
        QFAIL("no Error");
    } catch (const Error& e) {
        QVERIFY2(QString(e.what()).contains("broken.comp") && QString(e.what()).contains("undeclared"), e.what());
    }
    try {
        (void)GlProgram::graphics(
            "unlinked", {"#version 430 core\nvoid main() { gl_Position = vec4(0); }\n"},
            {"#version 430 core\nin vec4 missing; out vec4 c; void main() { c = missing; }\n"});
        QFAIL("no Error");
    } catch (const Error& e) {
        QVERIFY2(QString(e.what()).contains("unlinked"), e.what());
    }
    checkGlErrors("testing");
}

void GlObjectsTest::fencesAreReached()
{
    NEEDS_CONTEXT();
    GlBuffer buffer = GlBuffer::allocate(1 << 20);
    buffer.clear();
    const GlSync sync = GlSync::insert();
    QVERIFY(bool(sync));
    sync.wait();
    GlSync moved = GlSync::insert();
    GlSync to = std::move(moved);
    QVERIFY(!moved && bool(to));
    to.wait();
}

void GlObjectsTest::stateIsPutBack()
{
    NEEDS_CONTEXT();
    GlFramebuffer framebuffer = GlFramebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glViewport(1, 2, 3, 4);
    glEnable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    {
        const GlStateGuard guard;
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, 9, 9);
        glDisable(GL_BLEND);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GREATER);
        if (requireGl43().clipControl) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    }
    GLint v[4]{};
    glGetIntegerv(GL_VIEWPORT, v);
    QCOMPARE(v[3], 4);
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, v);
    QCOMPARE(GLuint(v[0]), framebuffer.id());
    QVERIFY(glIsEnabled(GL_BLEND) && !glIsEnabled(GL_DEPTH_TEST));
    glGetIntegerv(GL_DEPTH_FUNC, v);
    QCOMPARE(v[0], GL_LEQUAL);
    glGetIntegerv(GL_PACK_ALIGNMENT, v);
    QCOMPARE(v[0], 1);
    if (requireGl43().clipControl) {
        glGetIntegerv(GL_CLIP_DEPTH_MODE, v);
        QCOMPARE(v[0], GL_NEGATIVE_ONE_TO_ONE);
    }
    checkGlErrors("testing");
}

QTEST_APPLESS_MAIN(GlObjectsTest)
#include "GlObjectsTest.moc"
