// SPDX-License-Identifier: MIT
#pragma once

#include "ui/marks/Legend.h"
#include "ui/marks/ScaleBar.h"

#include <QString>
#include <QWidget>

namespace punctum::ui
{

/// What lies over the picture: small panels that let the mouse through. GUI thread only.

/// Base of them.
class OverlayPanel : public QWidget
{
    Q_OBJECT
public:
    explicit OverlayPanel(QWidget* parent);

protected:
    MarkStyle markStyle() const { return {font()}; }
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

/// What the colors mean.
class LegendOverlay final : public OverlayPanel
{
    Q_OBJECT
public:
    using OverlayPanel::OverlayPanel;
    void setContent(const Legend& content);
    const Legend& content() const noexcept { return m_content; }
    /// What the view has for it, in logical px.
    void setRoom(QSize room);
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    Legend m_content;
    QSize m_room{232, 400};
};

/// North arrow and scale bar for the present camera.
class CompassOverlay final : public OverlayPanel
{
    Q_OBJECT
public:
    using OverlayPanel::OverlayPanel;
    /// `unit`: of what the camera sees, "" when unknown. `pixelRatio`: px of the picture for each of the widget.
    void setCamera(const render::Camera& camera, double pictureHeightPx, double pixelRatio, const QString& unit);
    const ScaleBar& content() const noexcept { return m_bar; }
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    ScaleBar m_bar;
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

}  // namespace punctum::ui
