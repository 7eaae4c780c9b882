// SPDX-License-Identifier: MIT
#pragma once

#include "core/measure/Measurement.h"
#include "render/camera/Camera.h"

#include <QObject>
#include <QPointF>
#include <QPointer>
#include <QWidget>

#include <optional>
#include <vector>

class QKeyEvent;
class QMouseEvent;

namespace punctum::ui
{

class Document;
class Measurements;
class Viewport;
class Workspace;
struct PickedPoint;

/// Measurements over the picture: their points, lines and values, which stay with the points as the camera moves.
/// Those with points that the view's cuts take away are not shown. Lets the mouse through. GUI thread only.
class MeasureOverlay final : public QWidget
{
    Q_OBJECT
public:
    MeasureOverlay(Viewport& viewport, const Measurements& measurements);

    /// One that is being made, with the point under the mouse as its last; too few points: no value yet.
    void setUnfinished(std::optional<Measurement> measurement);
    /// The value shown at the unfinished one; empty while there is none.
    QString unfinishedText() const;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    Viewport& m_viewport;
    const Measurements& m_measurements;
    std::optional<Measurement> m_unfinished;
};

/// Clicking points to measure. A click takes the point under the mouse; drags go on moving the camera. Backspace
/// takes the last point back, Enter, the right button, a double click or a click on the first corner closes an
/// area, Escape gives up the points, then the tool.
///
/// The points of one measurement may be clicked in several views.
///
/// GUI thread only. Borrows all it is given, which must outlive it.
class MeasureTools final : public QObject
{
    Q_OBJECT
public:
    MeasureTools(Viewport& viewport, Workspace& workspace, Measurements& measurements, QObject* parent = nullptr);
    /// Another view to click in.
    void addView(Viewport& viewport);

    std::optional<MeasureKind> tool() const noexcept { return m_tool; }
    void setTool(std::optional<MeasureKind> tool);
    /// Points clicked and not yet part of a finished measurement.
    std::size_t pointsTaken() const noexcept { return m_points.size(); }
    /// Of the first view.
    const MeasureOverlay& overlay() const noexcept { return *m_views.front().overlay; }

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void toolChanged();
    void pointTaken();

private:
    bool pressed(const QMouseEvent& event);
    bool released(Viewport& viewport, const QMouseEvent& event);
    bool keyPressed(const QKeyEvent& event);
    void pick(Viewport& viewport, QPointF at);
    void setUnfinished(const std::optional<Measurement>& measurement);
    void take(const PickedPoint& point);
    void follow(const std::optional<PickedPoint>& point);
    void finish();
    void closeArea();
    bool isOnFirst(const Viewport& viewport, QPointF at) const;
    void giveUp();

    struct View {
        Viewport* viewport;
        MeasureOverlay* overlay;
    };
    std::vector<View> m_views;
    Workspace& m_workspace;
    Measurements& m_measurements;
    std::optional<MeasureKind> m_tool;
    QPointer<Document> m_document;  ///< that the points are of
    std::vector<MeasuredPoint> m_points;
    std::optional<QPointF> m_press;  ///< where a click has begun
    int m_picks = 0;                 ///< points under clicks that are still being looked for
    bool m_closing = false;          ///< when they are found
};

}  // namespace punctum::ui
