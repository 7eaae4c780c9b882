// SPDX-License-Identifier: MIT
#pragma once

#include "ui/view/ViewRenderer.h"

#include <QWidget>

#include <memory>

namespace punctum::ui
{

/// What puts pictures on the screen: a QOpenGLWidget, or a plain widget where there is no OpenGL.
/// GUI thread only. The widget lets the mouse through to its parent.
class ViewSurface
{
public:
    virtual ~ViewSurface() = default;
    virtual QWidget& widget() = 0;
    /// Shows this picture from the next repaint on.
    virtual void showFrame(std::shared_ptr<const Frame> frame) = 0;
    virtual bool usesOpenGl() const = 0;
};

/// Whether widgets can have an OpenGL context on this platform, one that a device draws unless `software` will do:
/// a software renderer takes longer to show a picture than we take to draw it. Tries one; needs the application
/// object.
bool openGlWidgetsWork(bool software);
/// The widget becomes a child of `parent`, which owns it; the surface is another view on it.
ViewSurface* makeViewSurface(QWidget& parent, bool openGl);

}  // namespace punctum::ui
