// SPDX-License-Identifier: MIT
#include "ui/view/ViewSurface.h"

#include <QGuiApplication>
#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <QOpenGLTextureBlitter>
#include <QOpenGLWidget>
#include <QPainter>

namespace punctum::ui
{

namespace
{

/// One texture, the frame's or one that its picture is brought to, drawn over the whole widget: pixel for pixel
/// when the sizes agree, stretched for the few frames after a change of size.
class GlSurface final : public QOpenGLWidget, public ViewSurface, private QOpenGLFunctions
{
public:
    explicit GlSurface(QWidget& parent) : QOpenGLWidget(&parent)
    {
        QSurfaceFormat format = QSurfaceFormat::defaultFormat();
        format.setDepthBufferSize(0);
        format.setStencilBufferSize(0);
        format.setSamples(0);
        setFormat(format);
        setAttribute(Qt::WA_TransparentForMouseEvents);
    }
    ~GlSurface() override { releaseObjects(); }

    QWidget& widget() override { return *this; }
    bool usesOpenGl() const override { return true; }
    void showFrame(std::shared_ptr<const Frame> frame) override
    {
        m_frame = std::move(frame);
        update();
    }

protected:
    void initializeGL() override
    {
        initializeOpenGLFunctions();
        m_blitter.create();
        // A widget that moves to another window gets another context: its objects go with the old one.
        connect(
            context(), &QOpenGLContext::aboutToBeDestroyed, this, [this] { releaseObjects(); },
            Qt::DirectConnection);
    }
    void paintGL() override
    {
        glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        if (!m_frame || m_frame->empty()) return;
        if (!m_frame->texture) upload();
        glDisable(GL_BLEND);
        glDisable(GL_DEPTH_TEST);
        m_blitter.bind();
        m_blitter.blit(m_frame->texture ? m_frame->texture->id() : m_texture, QMatrix4x4(),
                       QOpenGLTextureBlitter::OriginTopLeft);
        m_blitter.release();
        if (m_frame->texture) m_frame->texture->drawn();
    }

private:
    void upload()
    {
        if (m_uploaded == m_frame->number && m_texture != 0) return;
        const render::Image& image = m_frame->image;
        if (m_texture == 0) {
            glGenTextures(1, &m_texture);
            m_textureSize = QSize();
        }
        glBindTexture(GL_TEXTURE_2D, m_texture);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        const QSize size(image.width, image.height);
        if (size != m_textureSize) {
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, size.width(), size.height(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                         image.pixels.data());
            m_textureSize = size;
        } else {
            glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.width(), size.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                            image.pixels.data());
        }
        m_uploaded = m_frame->number;
    }
    void releaseObjects()
    {
        if (!isValid()) return;
        makeCurrent();
        if (m_texture != 0) glDeleteTextures(1, &m_texture);
        m_texture = 0;
        m_blitter.destroy();
        doneCurrent();
    }

    std::shared_ptr<const Frame> m_frame;
    QOpenGLTextureBlitter m_blitter;
    GLuint m_texture = 0;
    QSize m_textureSize;
    std::uint64_t m_uploaded = 0;
};

class RasterSurface final : public QWidget, public ViewSurface
{
public:
    explicit RasterSurface(QWidget& parent) : QWidget(&parent)
    {
        setAttribute(Qt::WA_TransparentForMouseEvents);
        setAttribute(Qt::WA_OpaquePaintEvent);
    }
    QWidget& widget() override { return *this; }
    bool usesOpenGl() const override { return false; }
    void showFrame(std::shared_ptr<const Frame> frame) override
    {
        m_frame = std::move(frame);
        update();
    }

protected:
    void paintEvent(QPaintEvent*) override
    {
        QPainter painter(this);
        if (!m_frame || m_frame->image.width <= 0) {
            painter.fillRect(rect(), Qt::black);
            return;
        }
        const render::Image& image = m_frame->image;
        // Every pixel of a view's picture is opaque, which Qt cannot know but gains much by.
        const QImage wrapped(reinterpret_cast<const uchar*>(image.pixels.data()), image.width, image.height,
                             image.width * 4, QImage::Format_RGBX8888);
        painter.drawImage(rect(), wrapped);
    }

private:
    std::shared_ptr<const Frame> m_frame;
};

}  // namespace

bool openGlWidgetsWork(bool software)
{
    // Platforms without a screen have no way to bring an OpenGL picture into a window.
    static const QStringList without{QStringLiteral("offscreen"), QStringLiteral("minimal"),
                                     QStringLiteral("linuxfb"), QStringLiteral("vnc")};
    if (without.contains(QGuiApplication::platformName())) return false;
    QOpenGLContext context;
    if (!context.create()) return false;
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!surface.isValid() || !context.makeCurrent(&surface)) return false;
    const auto* name = reinterpret_cast<const char*>(context.functions()->glGetString(GL_RENDERER));
    const QString renderer = QString::fromLatin1(name ? name : "").toLower();
    context.doneCurrent();
    for (const char* slow : {"llvmpipe", "softpipe", "swrast", "software", "swiftshader"})
        if (!software && renderer.contains(QLatin1String(slow))) return false;
    return true;
}

ViewSurface* makeViewSurface(QWidget& parent, bool openGl)
{
    if (openGl) return new GlSurface(parent);
    return new RasterSurface(parent);
}

}  // namespace punctum::ui
