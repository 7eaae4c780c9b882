// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "render/color/ColorMap.h"

#include <QString>
#include <QStringList>
#include <QWidget>

#include <algorithm>

namespace punctum::ui
{

/// What lies over the picture: small panels that let the mouse through. GUI thread only.

/// Base of them: a rounded, translucent, dark plate, readable on any picture.
class OverlayPanel : public QWidget
{
    Q_OBJECT
public:
    explicit OverlayPanel(QWidget* parent);

protected:
    void paintPlate(QPainter& painter) const;
};

/// File name, number of points, and a slim line of progress while points arrive.
class TitleOverlay final : public OverlayPanel
{
    Q_OBJECT
public:
    using OverlayPanel::OverlayPanel;
    void setContent(const QString& title, const QString& detail);
    /// 0 to 1; negative: nothing is being read.
    void setProgress(double share);
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    QString m_title, m_detail;
    double m_progress = -1.0;
};

/// The color bar: attribute, unit, lowest and highest value. Without a bar for colors that explain themselves.
class LegendOverlay final : public OverlayPanel
{
    Q_OBJECT
public:
    struct Content {
        QString title, unit;
        bool bar = false;
        render::ColorTable table{};
        QString low, high;
        QString remark;  ///< instead of a bar: "one color for each value"
        friend bool operator==(const Content&, const Content&) = default;
    };
    using OverlayPanel::OverlayPanel;
    void setContent(const Content& content);
    const Content& content() const noexcept { return m_content; }
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    Content m_content;
};

/// North arrow and scale bar for the present camera.
class CompassOverlay final : public OverlayPanel
{
    Q_OBJECT
public:
    using OverlayPanel::OverlayPanel;
    /// `unit`: of what the camera sees, "" when unknown. `pixelRatio`: px of the picture for each of the widget.
    void setCamera(const render::Camera& camera, double pictureHeightPx, double pixelRatio, const QString& unit);
    QSize sizeHint() const override { return {std::max(96, 54 + m_barLength + 16), 44}; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    double m_yaw = 0.0;
    int m_barLength = 0;
    QString m_barText;
};

/// Shown while nothing is open.
class EmptyPage final : public QWidget
{
    Q_OBJECT
public:
    explicit EmptyPage(QWidget* parent);

signals:
    void openRequested();
};

/// Says over the whole view what dropping here will do.
class DropHint final : public QWidget
{
    Q_OBJECT
public:
    explicit DropHint(QWidget* parent);
    void setText(const QString& text);
    QString text() const { return m_text; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    QString m_text;
};

/// 1, 2 or 5 times a power of ten: the longest round length that is not above `limit`. 0 for limits <= 0.
double roundLength(double limit);

}  // namespace punctum::ui
