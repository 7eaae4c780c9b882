// SPDX-License-Identifier: MIT
#include "ui/view/PivotMark.h"

#include <QPainter>

#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kSize = 30;  // px of the widget
constexpr double kRing = 7.0;

}  // namespace

PivotMark::PivotMark(QWidget* view) : QWidget(view)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setFixedSize(kSize, kSize);
    m_end.setSingleShot(true);
    connect(&m_end, &QTimer::timeout, this, &QWidget::hide);
    hide();
}

void PivotMark::setCamera(const render::Camera& camera, double pixelRatio)
{
    m_camera = camera;
    m_pixelRatio = pixelRatio;
    if (isVisible()) place();
}

void PivotMark::hold(bool on)
{
    if (!on) {
        if (isVisible()) m_end.start(kMoment);
        return;
    }
    m_end.stop();
    place();
    show();
}

void PivotMark::flash(int milliseconds)
{
    place();
    show();
    m_end.start(milliseconds);
}

void PivotMark::place()
{
    const glm::dvec2 size = glm::dvec2(parentWidget()->width(), parentWidget()->height()) * m_pixelRatio;
    const glm::dvec3 px = m_camera.project(m_camera.pivot, size);
    // Far outside it has no place that fits an int.
    const bool near = px.z >= m_camera.nearDepth() && std::abs(px.x) < 1e6 && std::abs(px.y) < 1e6;
    const QPoint middle = near
                              ? QPoint(int(std::lround(px.x / m_pixelRatio)), int(std::lround(px.y / m_pixelRatio)))
                              : QPoint(-kSize, -kSize);
    move(middle - QPoint(kSize / 2, kSize / 2));
}

void PivotMark::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QPointF middle(kSize / 2.0, kSize / 2.0);
    // A light line in a dark one: seen on any picture.
    for (const auto& [color, width] :
         {std::pair(QColor(0, 0, 0, 170), 3.6), std::pair(QColor(255, 255, 255), 1.6)}) {
        painter.setPen(QPen(color, width, Qt::SolidLine, Qt::RoundCap));
        painter.drawEllipse(middle, kRing, kRing);
        for (const QPointF& way : {QPointF(1, 0), QPointF(-1, 0), QPointF(0, 1), QPointF(0, -1)})
            painter.drawLine(middle + way * (kRing + 1), middle + way * (kRing + 5));
        painter.drawPoint(middle);
    }
}

}  // namespace punctum::ui
