// SPDX-License-Identifier: MIT
#pragma once

#include "UiTest.h"

#include "core/edit/History.h"
#include "ui/document/Workspace.h"
#include "ui/select/SelectTools.h"
#include "ui/select/Selection.h"
#include "ui/view/Viewport.h"

#include <QMouseEvent>
#include <QWheelEvent>

#include <cmath>
#include <functional>
#include <vector>

// Drawing on a view by mouse and keys, and comparing what that selects with a plain loop over all points.

namespace punctum::ui::test
{

using Tool = SelectTools::Tool;

/// A window with the file open, seen from above.
struct Bench : TestWindow {
    Document* document = nullptr;
    Viewport* drawnOn = nullptr;  ///< where the hand is; null: the main view

    explicit Bench(const QString& settings = {}) : TestWindow(ViewKind::Automatic, settings) {}

    bool begin(Tool tool, const QString& file = surveyFile())
    {
        document = open(file);
        if (document == nullptr) return false;
        window->activateWindow();
        if (!QTest::qWaitForWindowActive(window.get())) return false;
        window->viewport().setFocus();
        window->selectTools().setTool(tool);
        return settle();
    }
    Viewport& view() { return drawnOn ? *drawnOn : window->viewport(); }
    Selection& selection() { return window->selection(); }
    bool done()
    {
        return waitFor([&] { return !selection().busy() && !window->workspace().busy(); }) && settle();
    }
    std::shared_ptr<const PointSet> points() { return selection().points(document); }

    QPoint at(double x, double y) { return {int(view().width() * x), int(view().height() * y)}; }
    void press(QPoint p, Qt::KeyboardModifiers m = {}) { QTest::mousePress(&view(), Qt::LeftButton, m, p); }
    void move(QPoint p)
    {
        QMouseEvent event(QEvent::MouseMove, QPointF(p), view().mapToGlobal(QPointF(p)), Qt::NoButton,
                          Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&view(), &event);
    }
    void release(QPoint p, Qt::KeyboardModifiers m = {}) { QTest::mouseRelease(&view(), Qt::LeftButton, m, p); }
    void drag(QPoint from, QPoint to, Qt::KeyboardModifiers m = {})
    {
        press(from, m);
        for (int k = 1; k <= 4; ++k) move(from + (to - from) * k / 4);
        release(to, m);
    }
    void click(QPoint p) { QTest::mouseClick(&view(), Qt::LeftButton, {}, p); }
    /// With Space held. Whether the camera moved, as it must.
    bool dragCamera(QPoint from, QPoint to)
    {
        const render::Camera before = view().camera();
        QTest::keyPress(&view(), Qt::Key_Space);
        drag(from, to);
        QTest::keyRelease(&view(), Qt::Key_Space);
        return !(view().camera() == before);
    }
    void key(Qt::Key k) { QTest::keyClick(&view(), k); }
    void wheel(QPoint p, int notches)
    {
        QWheelEvent event(QPointF(p), view().mapToGlobal(QPointF(p)), {}, QPoint(0, 120 * notches), Qt::NoButton,
                          Qt::NoModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(&view(), &event);
    }
    bool runEdit(const std::function<void()>& edit)
    {
        const std::size_t before = document->history().position();
        edit();
        return waitFor([&] { return document->history().position() > before; }) && done();
    }

    glm::dvec2 px(PointIndex i)
    {
        const QSize size = view().pictureSize();
        return view().camera().project(document->cloud()->world(i), {size.width(), size.height()});
    }
    /// The points whose px (its middle, in px of the picture) satisfies `in`, and that satisfy `may`.
    /// Compares; what lies on the edge of a px by less than a thousandth may go either way.
    QString unlike(
        const PointSet* got, const std::function<bool(glm::dvec2)>& in,
        const std::function<bool(PointIndex)>& may = [](PointIndex) { return true; })
    {
        const QSize size = view().pictureSize();
        PointIndex found = 0;
        for (PointIndex i = 0; i < document->points(); ++i) {
            const glm::dvec2 p = px(i);
            const bool shown = p.x >= 0 && p.y >= 0 && p.x < size.width() && p.y < size.height();
            const bool expected = shown && may(i) && in(glm::dvec2(std::floor(p.x) + 0.5, std::floor(p.y) + 0.5));
            found += expected ? 1 : 0;
            const bool edge = std::abs(p.x - std::round(p.x)) < 1e-3 || std::abs(p.y - std::round(p.y)) < 1e-3;
            if ((got != nullptr && got->contains(i)) != expected && !edge)
                return QStringLiteral("point %1 at %2 %3 expected %4").arg(i).arg(p.x).arg(p.y).arg(expected);
        }
        return found > 100 ? QString() : QStringLiteral("only %1 points are expected").arg(found);
    }
    double ratio() { return view().devicePixelRatioF(); }
};

inline bool insidePolygon(const std::vector<glm::dvec2>& corners, glm::dvec2 p)
{
    bool in = false;
    for (std::size_t k = 0, j = corners.size() - 1; k < corners.size(); j = k++) {
        const glm::dvec2 a = corners[k], b = corners[j];
        if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
    }
    return in;
}

}  // namespace punctum::ui::test

#define SAME(what)                                    \
    do {                                              \
        const QString wrong = (what);                 \
        QVERIFY2(wrong.isEmpty(), qPrintable(wrong)); \
    } while (false)
