// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <QTimer>
#include <QWidget>

namespace punctum::ui
{

/// A ring around the pivot while the view is turned, and for a moment after another point became the pivot. A child
/// of a view; lets the mouse through. GUI thread only.
class PivotMark final : public QWidget
{
    Q_OBJECT
public:
    static constexpr int kMoment = 900;  ///< ms

    explicit PivotMark(QWidget* view);

    /// `pixelRatio`: px of the picture for each of the widget.
    void setCamera(const render::Camera& camera, double pixelRatio);
    /// Shown until told otherwise, and a moment longer.
    void hold(bool on);
    /// Shown for so long.
    void flash(int milliseconds = kMoment);

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    void place();

    render::Camera m_camera;
    double m_pixelRatio = 1.0;
    QTimer m_end;
};

}  // namespace punctum::ui
