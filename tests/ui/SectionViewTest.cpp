// SPDX-License-Identifier: MIT
// The section view by real mouse and key events, against plain loops over all points of a real file.
#include "SelectBench.h"

#include "render/store/PointStore.h"
#include "ui/basic/Text.h"
#include "ui/measure/MeasureTools.h"
#include "ui/measure/Measurements.h"
#include "ui/screenshot/Screenshots.h"
#include "ui/section/SectionOverlays.h"
#include "ui/section/SectionPane.h"
#include "ui/section/SectionTool.h"
#include "ui/section/Sections.h"
#include "ui/view/ClipFrame.h"
#include "ui/view/ShownPill.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"

#include <QDoubleSpinBox>
#include <QEventLoop>
#include <QImage>
#include <QLabel>
#include <QPushButton>
#include <QSettings>
#include <QToolButton>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

constexpr double kWidth = 40.0;  // feet

/// A bench whose hand can go to the section.
struct SectionBench : Bench {
    using Bench::Bench;

    Sections& sections() { return window->sections(); }
    const Section& section() { return *sections().section(); }
    SectionPane& pane() { return sections().pane(); }

    /// Opens the file and draws a line over its middle by two clicks; the hand is in the section then.
    bool beginSection()
    {
        if (!begin(Tool::None) || !drawLine(at(0.3, 0.62), at(0.6, 0.4)) || !sections().section()) return false;
        pane().widthField().setValue(kWidth);
        return toSection();
    }
    /// A place with a point under it, as near to this one as there is one.
    QPoint nearest(double x, double y)
    {
        const QPoint middle = at(x, y);
        for (int radius = 0; radius < 200; radius += 3)
            for (int step = 0; step < 16; ++step) {
                const double angle = step * std::acos(0.0) / 4;
                const QPoint p = middle + QPoint(int(radius * std::cos(angle)), int(radius * std::sin(angle)));
                if (pick(view(), p)) return p;
            }
        return middle;
    }
    bool drawLine(QPoint from, QPoint to)
    {
        drawnOn = nullptr;
        key(Qt::Key_X);
        if (!sections().tool().on()) return false;
        click(from);
        moveFree(to);
        click(to);
        return waitFor([&] { return !sections().tool().on(); });
    }
    bool toSection()
    {
        if (!sections().section()) return false;
        drawnOn = &sections().viewport();
        return settled();
    }
    /// Both pictures are finished, show what was asked for last, and nothing is counted any more.
    bool settled()
    {
        return waitFor([&] { return !sections().counting(); }) && done() && waitFor([&] {
                   const auto frame = sections().viewport().renderer().frame();
                   return frame && frame->report.converged && frame->camera == sections().viewport().camera() &&
                          frame->image.width == sections().viewport().pictureSize().width();
               });
    }
    void moveFree(QPoint p)
    {
        QMouseEvent event(QEvent::MouseMove, QPointF(p), view().mapToGlobal(QPointF(p)), Qt::NoButton, Qt::NoButton,
                          Qt::NoModifier);
        QApplication::sendEvent(&view(), &event);
    }
    std::optional<PickedPoint> pick(Viewport& viewport, QPoint p)
    {
        std::optional<PickedPoint> picked;
        QEventLoop wait;  // asked thousands of times: waitFor() looks every 10 ms
        const glm::ivec2 px(viewport.toPicture(p));
        viewport.renderer().pick(px.x, px.y, &viewport, [&](const std::optional<PickedPoint>& point) {
            picked = point;
            wait.quit();
        });
        wait.exec();
        return picked;
    }
    /// Whether the section has the point; its ends may lie on the edge.
    bool has(PointIndex i)
    {
        const glm::dvec2 place = section().placeOf(document->cloud()->world(i));
        return place.x >= -1e-5 && place.x <= section().length() + 1e-5 && std::abs(place.y) <= section().width / 2;
    }
    PointIndex counted()
    {
        PointIndex n = 0;
        for (PointIndex i = 0; i < document->points(); ++i) n += has(i) ? 1 : 0;
        return n;
    }
    std::function<bool(PointIndex)> inside()
    {
        return [this](PointIndex i) { return has(i); };
    }
};

bool within(double a, double b, double slack)
{
    return std::abs(a - b) <= slack;
}

}  // namespace

class SectionViewTest : public QObject
{
    Q_OBJECT

private slots:
    void aLineOpensIt()
    {
        SectionBench b;
        QVERIFY(b.begin(Tool::Rectangle));
        const QPoint from = b.nearest(0.35, 0.62), to = b.nearest(0.6, 0.45);
        const auto first = b.pick(b.view(), from), second = b.pick(b.view(), to);
        QVERIFY(first && second);
        const render::Camera before = b.view().camera();
        const QSize whole = b.view().size();
        QVERIFY(!b.sections().viewport().isVisible());
        b.key(Qt::Key_X);
        QCOMPARE(b.window->selectTools().tool(), Tool::None);  // one tool has the mouse
        b.click(from);
        b.moveFree(to);
        QVERIFY(waitFor([&] { return b.sections().band().draft().has_value(); }));
        b.key(Qt::Key_Escape);  // gives up the line, not the tool
        QVERIFY(!b.sections().band().draft());
        QVERIFY(b.sections().tool().on());
        b.click(from);
        b.click(to);
        QVERIFY(waitFor([&] { return b.sections().section().has_value(); }));
        QVERIFY(!b.sections().tool().on());
        QVERIFY(b.section().from == glm::dvec2(first->world) && b.section().to == glm::dvec2(second->world));
        QVERIFY(b.sections().band().section() == b.sections().section());
        QVERIFY(b.toSection());
        QVERIFY(b.view().isVisible());
        QVERIFY(b.window->viewport().height() < whole.height());
        QVERIFY(b.window->viewport().camera().yaw == before.yaw &&
                b.window->viewport().camera().pitch == before.pitch);
        // left and right end are where one expects them, and all of it is in the picture
        const auto px = [&](const MeasuredPoint& p) {
            return b.view().camera().project(p.world, {b.view().width(), b.view().height()});
        };
        const double left = px({0, first->world}).x, right = px({0, second->world}).x;
        QVERIFY2(left >= 0 && left < 0.2 * b.view().width(), qPrintable(QString::number(left)));
        QVERIFY2(right <= b.view().width() && right > 0.8 * b.view().width(), qPrintable(QString::number(right)));
        QVERIFY(b.pane().title().contains(QString::number(b.section().length(), 'g', 4)));
        QVERIFY2(waitFor([&] {
                     return b.pane().title().contains(QLocale(QLocale::English).toString(qulonglong(b.counted())));
                 }),
                 qPrintable(b.pane().title()));
        // what the picture shows lies in the section
        int shown = 0;
        for (int x = 10; x < b.view().width(); x += 20)
            for (int y = 10; y < b.view().height(); y += 10)
                if (const auto point = b.pick(b.view(), {x, y})) {
                    QVERIFY(b.has(point->index));
                    ++shown;
                }
        QVERIFY2(shown > 20, qPrintable(QString::number(shown)));

        b.key(Qt::Key_Escape);
        QVERIFY(!b.sections().section());
        QVERIFY(!b.sections().viewport().isVisible());
        QVERIFY(!b.sections().viewport().renderer().frame());
        b.drawnOn = nullptr;
        QVERIFY(b.settle());

        // a drag draws one, too; the button closes it
        b.key(Qt::Key_X);
        b.drag(b.at(0.3, 0.5), b.at(0.6, 0.5));
        QVERIFY(waitFor([&] { return b.sections().section().has_value(); }));
        QVERIFY(b.toSection());
        QTest::mouseClick(&b.pane().closeButton(), Qt::LeftButton);
        QVERIFY(!b.sections().section());
    }

    void toolsWorkInIt()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const double r = b.ratio();
        // rectangle
        b.key(Qt::Key_R);
        const QPoint from = b.at(0.3, 0.1), to = b.at(0.7, 0.9);
        b.drag(from, to);
        QVERIFY(b.done());
        SAME(b.unlike(
            b.points().get(),
            [&](glm::dvec2 p) {
                return p.x >= from.x() * r && p.x < to.x() * r && p.y >= from.y() * r && p.y < to.y() * r;
            },
            b.inside()));
        // above and below a line of two pieces; the second one also in the main view
        const auto line = [&](Tool tool, Qt::KeyboardModifiers modifiers, const std::vector<QPoint>& clicks) {
            QTest::keyClick(&b.view(), Qt::Key_A, modifiers);
            if (b.window->selectTools().tool() != tool) return QStringLiteral("the key did not choose the tool");
            for (const QPoint& p : clicks) b.click(p);
            b.key(Qt::Key_Return);
            if (!b.done()) return QStringLiteral("not done");
            const bool above = tool == Tool::AboveLine;
            return b.unlike(
                b.points().get(),
                [&](glm::dvec2 p) {
                    for (std::size_t k = 0; k + 1 < clicks.size(); ++k) {
                        const glm::dvec2 a(clicks[k].x() * r, clicks[k].y() * r),
                            e(clicks[k + 1].x() * r, clicks[k + 1].y() * r);
                        if (p.x < a.x || p.x >= e.x) continue;
                        const double y = a.y + (p.x - a.x) / (e.x - a.x) * (e.y - a.y);
                        return above ? p.y < y : p.y >= y;
                    }
                    return false;
                },
                b.drawnOn ? b.inside() : [](PointIndex) { return true; });
        };
        SAME(line(Tool::AboveLine, {}, {b.at(0.1, 0.8), b.at(0.5, 0.5), b.at(0.9, 0.7)}));
        SAME(line(Tool::BelowLine, Qt::ShiftModifier, {b.at(0.2, 0.3), b.at(0.6, 0.4), b.at(0.8, 0.2)}));
        b.drawnOn = nullptr;
        b.selection().clear();
        QVERIFY(b.settled());
        b.window->selectTools().setTool(Tool::None);
        SAME(line(Tool::AboveLine, {}, {b.at(0.3, 0.4), b.at(0.6, 0.5)}));
        QVERIFY(b.toSection());
        // the brush is where the mouse is
        b.window->selectTools().setTool(Tool::Brush);
        const double radius = b.window->selectTools().brushRadius() * r;
        const QPoint begin = b.at(0.3, 0.6), end = b.at(0.6, 0.6);
        b.drag(begin, end);
        QVERIFY(b.done());
        SAME(b.unlike(
            b.points().get(),
            [&](glm::dvec2 p) {
                const double x = std::clamp(p.x, begin.x() * r, end.x() * r);
                return std::hypot(p.x - x, p.y - begin.y() * r) <= radius;
            },
            b.inside()));
        // what is drawn on one section is not meant on the next one
        b.window->selectTools().setTool(Tool::Polygon);
        b.click(b.at(0.2, 0.2));
        b.click(b.at(0.6, 0.3));
        QCOMPARE(b.window->selectTools().corners(), std::size_t(2));
        b.key(Qt::Key_Up);
        QCOMPARE(b.window->selectTools().corners(), std::size_t(0));
        QVERIFY(b.settled());
    }

    void aKeySetsTheirClass()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
        std::vector<int> before(b.document->points());
        for (PointIndex i = 0; i < before.size(); ++i) before[i] = int(classes.number(i));
        b.key(Qt::Key_R);
        b.drag(b.at(0.2, 0.05), b.at(0.5, 0.95));
        QVERIFY(b.done());
        const auto points = b.points();
        QVERIFY(points && points->count() > 100);
        const auto shown = b.view().renderer().frame();
        b.window->viewSettings().setAttribute(QStringLiteral("Classification"));
        QVERIFY(waitFor([&] {
            return b.view().renderer().frame()->attribute == QLatin1String("Classification") &&
                   b.frame()->attribute == QLatin1String("Classification");
        }));
        QVERIFY(b.settled());
        const auto classified = b.view().renderer().frame();
        QVERIFY(difference(shown->image, classified->image) > 0.005);
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
        for (PointIndex i = 0; i < before.size(); ++i)
            QCOMPARE(int(classes.number(i)), points->contains(i) ? 6 : before[i]);
        b.selection().clear();
        QVERIFY(b.settled());
        // hidden classes are hidden in both
        b.window->viewSettings().setClassVisible(6, false);
        QVERIFY(b.settled());
        b.drag(b.at(0.01, 0.05), b.at(0.99, 0.95));
        QVERIFY(b.done());
        SAME(b.unlike(
            b.points().get(),
            [from = b.at(0.01, 0.05), to = b.at(0.99, 0.95), r = b.ratio()](glm::dvec2 p) {
                return p.x >= from.x() * r && p.x < to.x() * r && p.y >= from.y() * r && p.y < to.y() * r;
            },
            [&](PointIndex i) { return b.has(i) && classes.number(i) != 6; }));
        // what was selected since then is taken back first: the rectangle, and that nothing was
        for (int step = 0; step < 3; ++step) {
            QCOMPARE(b.document->history().position(), std::size_t(1));
            QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
            QVERIFY(b.done());
        }
        QVERIFY(waitFor([&] { return b.document->history().position() == 0; }, 20000) && b.done());
        for (PointIndex i = 0; i < before.size(); ++i) QCOMPARE(int(classes.number(i)), before[i]);
    }

    void arrowsWalk()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const Section start = b.section();
        const auto moved = [&] { return start.placeOf({b.section().from, 0}); };
        const auto at = [&](double steps) {
            return within(moved().x, 0, 1e-6) && within(moved().y, steps * start.width, 1e-6);
        };
        const auto first = b.view().renderer().frame();
        b.key(Qt::Key_Up);
        QVERIFY(at(1));
        QVERIFY(b.settled());
        QVERIFY(difference(first->image, b.view().renderer().frame()->image) > 0.001);
        b.key(Qt::Key_Right);
        QVERIFY(at(2));
        b.key(Qt::Key_Down);
        QTest::keyClick(&b.view(), Qt::Key_Left, Qt::ShiftModifier);
        QVERIFY(at(0.5));
        // from the main view as well
        QTest::keyClick(&b.window->viewport(), Qt::Key_Right);
        QVERIFY(at(1.5));
        QVERIFY(b.settled());
        b.key(Qt::Key_R);
        b.drag(b.at(0.02, 0.02), b.at(0.98, 0.98));
        QVERIFY(b.done());
        SAME(b.unlike(
            b.points().get(),
            [from = b.at(0.02, 0.02), to = b.at(0.98, 0.98), r = b.ratio()](glm::dvec2 p) {
                return p.x >= from.x() * r && p.x < to.x() * r && p.y >= from.y() * r && p.y < to.y() * r;
            },
            b.inside()));
        b.key(Qt::Key_Escape);  // the tool

        // width by wheel and field; the camera keeps its place when it was moved by hand
        b.press(b.at(0.5, 0.5));
        b.move(b.at(0.6, 0.55));
        b.move(b.at(0.65, 0.6));
        b.release(b.at(0.65, 0.6));
        QVERIFY(!b.view().fitted());
        QCOMPARE(b.view().camera().pitch, 0.0);  // moved, not turned
        const glm::dvec3 eye = b.view().camera().eye;
        b.key(Qt::Key_Up);
        QVERIFY(within(glm::distance(eye, b.view().camera().eye), start.width, 1e-6));
        QWheelEvent wheel(QPointF(b.at(0.5, 0.5)), b.view().mapToGlobal(QPointF(b.at(0.5, 0.5))), {}, {0, 240},
                          Qt::NoButton, Qt::ControlModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(&b.view(), &wheel);
        QVERIFY(within(b.section().width, start.width * 1.15 * 1.15, 0.01));
        b.pane().widthField().setValue(12.5);
        QCOMPARE(b.section().width, 12.5);
        b.pane().widthField().setFocus();
        QVERIFY(!b.view().hasFocus());
        QTest::keyClick(&b.pane().widthField(), Qt::Key_Return);
        QVERIFY(b.view().hasFocus());  // keys go to the section again
        QVERIFY(b.settled());
        QVERIFY2(b.pane().title().contains(QLocale(QLocale::English).toString(qulonglong(b.counted()))),
                 qPrintable(b.pane().title()));
        // heights twice as high
        const auto height = [&] {
            const glm::dvec3 low(b.section().from, 0), high(b.section().from, 10);
            const glm::dvec2 size(b.view().width(), b.view().height());
            return b.view().camera().project(low, size).y - b.view().camera().project(high, size).y;
        };
        const double once = height();
        b.pane().exaggerationField().setValue(2.0);
        QVERIFY(within(height() / once, 2.0, 1e-6));
        b.window->viewport().setCamera(b.window->viewport().camera());
        b.key(Qt::Key_F);
        QVERIFY(b.view().fitted());
        QVERIFY(!b.window->viewport().fitted());  // F was meant for the section
        // from the other side, left is right
        const Section one = b.section();
        b.sections().turn();
        QVERIFY(b.section().from == one.to && b.section().to == one.from);
    }

    void pointsAreLinked()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        std::optional<PickedPoint> target;
        QPoint place;
        for (int x = 30; x < b.view().width() && !target; x += 7)
            for (int y = 30; y < b.view().height() && !target; y += 7)
                if ((target = b.pick(b.view(), {x, y}))) place = {x, y};
        QVERIFY(target);
        b.moveFree(place);
        QVERIFY(waitFor([&] { return b.sections().mainMark().place() == target->world; }));
        QVERIFY(!b.sections().sectionMark().place());

        // in the main view: a point of the section is marked there, another one is not
        b.drawnOn = nullptr;
        std::optional<QPoint> in, out;
        for (int x = 30; x < b.view().width(); x += 5)
            for (int y = 30; y < b.view().height() && !(in && out); y += 5) {
                const auto point = b.pick(b.view(), {x, y});
                if (!point) continue;
                auto& found = b.has(point->index) ? in : out;
                if (!found) found = QPoint(x, y);
            }
        QVERIFY(in && out);
        const auto marked = b.pick(b.view(), *in);
        b.moveFree(*in);
        QVERIFY(waitFor([&] { return b.sections().sectionMark().place() == marked->world; }));
        QVERIFY(!b.sections().mainMark().place());
        b.moveFree(*out);
        QVERIFY(waitFor([&] { return !b.sections().sectionMark().place(); }));
        QVERIFY(b.sections().sectionMark().isHidden());
    }

    void boxIsDraggedInIt()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        Clip clip;
        clip.box = b.document->bounds();
        clip.box->max.z = (clip.box->min.z + clip.box->max.z) / 2;
        b.window->viewSettings().setClip(clip);
        QVERIFY(b.settled());
        const auto top = [&] { return b.window->viewSettings().display().clip.box->max.z; };
        const auto handle = b.view().clipFrame().handle(5);
        QVERIFY(handle && b.view().rect().contains(handle->toPoint()));
        const QPoint from = handle->toPoint(), to = from + QPoint(0, 15);
        b.press(from);
        b.move(to);
        QVERIFY(top() < clip.box->max.z);
        b.key(Qt::Key_Escape);  // takes back the drag; the section stays
        QVERIFY(b.sections().section());
        QCOMPARE(top(), clip.box->max.z);
        b.release(to);
        // a section that closes takes the drag along
        QVERIFY(b.settled());
        b.press(from);
        b.move(to);
        QVERIFY(b.view().clipFrame().dragging());
        b.sections().close();
        QVERIFY(!b.view().clipFrame().dragging());
    }

    void measuresInIt()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const std::array places{b.nearest(0.2, 0.5), b.nearest(0.5, 0.5)};
        b.key(Qt::Key_D);
        for (const QPoint& p : places) b.click(p);
        QVERIFY(waitFor([&] { return b.window->measurements().entries().size() == 1; }));
        for (const MeasuredPoint& p : b.window->measurements().entries().front().measurement.points)
            QVERIFY(b.has(p.index));
        b.key(Qt::Key_Escape);  // the tool ends first
        QVERIFY(!b.window->measureTools().tool());
        QVERIFY(b.sections().section());
        b.key(Qt::Key_Escape);
        QVERIFY(!b.sections().section());
    }

    void aShapeOutlivesTheSection()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        b.key(Qt::Key_R);
        const auto draw = [&] { b.drag(b.at(0.3, 0.1), b.at(0.7, 0.9)); };
        draw();
        QVERIFY(b.done());
        const auto expected = b.points();
        QVERIFY(expected && expected->count() > 100);
        const auto same = [&] { return b.done() && b.points() && *b.points() == *expected; };
        const auto anew = [&] {
            b.selection().clear();
            draw();
            return b.selection().busy();
        };
        // the other way round, and gone, before the shape was worked out
        QVERIFY(anew());
        b.sections().turn();
        QVERIFY(same());
        b.sections().turn();
        QVERIFY(b.settled());
        QVERIFY(anew());
        b.sections().close();
        b.drawnOn = nullptr;
        QVERIFY(same());
    }

    void aLineIsDrawnWhileTheCameraMoves()
    {
        SectionBench b;
        QVERIFY(b.begin(Tool::None));
        const QPoint first = b.nearest(0.4, 0.55);
        b.key(Qt::Key_X);
        b.click(first);
        b.moveFree(first + QPoint(40, 0));
        QVERIFY(waitFor([&] { return b.sections().band().draft().has_value(); }));
        QVERIFY(b.dragCamera(b.at(0.5, 0.5), b.at(0.7, 0.6)));
        QVERIFY(b.settle());
        b.click(first);  // where the first end was, and is no more
        QVERIFY(waitFor([&] { return b.sections().section().has_value(); }));
    }

    void isSmallInASmallWindow()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const QLabel* const title = b.pane().findChild<QLabel*>();
        QVERIFY(title);
        for (const int width : {1600, 1100, 920}) {
            b.window->resize(width, 800);
            QVERIFY(b.settled());
            QCOMPARE(b.window->width(), width);
            QVERIFY2(title->width() >= std::min(title->sizeHint().width(), b.pane().width() - 16),
                     qPrintable(QStringLiteral("%1 px of %2").arg(title->width()).arg(title->sizeHint().width())));
            for (QWidget* part : std::initializer_list<QWidget*>{
                     &b.pane().widthField(), &b.pane().exaggerationField(), &b.pane().closeButton()})
                QVERIFY(b.pane().rect().contains(QRect(part->mapTo(&b.pane(), QPoint()), part->size())));
        }
    }

    void aScreenshotShowsWhatHasTheKeys()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const QString path = b.folder.filePath(QStringLiteral("shot.png"));
        for (Viewport* view : {&b.sections().viewport(), &b.window->viewport()}) {
            view->setFocus();
            Screenshots& screenshots = b.window->screenshots();
            screenshots.save(path, screenshots.preset());
            QVERIFY(b.settled());
            QCOMPARE(QImage(path).size(), view->pictureSize());
        }
    }

    /// A shape that is finished counts, though the section closes at once and another file is still being read.
    void aFinishedShapeOutlivesItsSection()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        const auto endless = std::make_shared<PointCloud>(1000);
        b.window->renderer().addCloud(
            std::make_shared<render::PointStore>(endless, RawBounds{{0, 0, 0}, {1, 1, 1}}));
        b.key(Qt::Key_R);
        b.drag(b.at(0.1, 0.1), b.at(0.9, 0.9));
        b.sections().close();
        QVERIFY(waitFor([&] { return b.window->selection().count() > 0; }, 20000));
        b.window->renderer().removeCloud(endless);
    }

    void followsItsFileAndRemembersItsWidth()
    {
        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("s.ini"));
        const QString metric = folder.filePath(QStringLiteral("metric.las"));
        writeSample(metric, 60'000);
        const auto beginIn = [](SectionBench& b, const QString& file) {
            b.drawnOn = nullptr;
            return b.begin(Tool::None, file) && b.drawLine(b.nearest(0.4, 0.5), b.nearest(0.6, 0.5)) &&
                   b.toSection();
        };
        {
            SectionBench b(settings);
            QVERIFY(beginIn(b, metric));
            b.sections().setWidth(7.25);
            QVERIFY(b.settled());
            const auto before = b.view().renderer().frame();
            // another file comes and goes
            Document* const second = b.open(surveyFile());
            QVERIFY(second);
            QVERIFY(second->lengthUnit().isEmpty());
            QVERIFY(b.sections().section());
            b.sections().turn();
            b.sections().turn();
            QVERIFY2(b.pane().title().contains(QStringLiteral(" m long")), qPrintable(b.pane().title()));
            b.window->workspace().close(*second);
            QVERIFY(b.settled());
            QVERIFY(b.view().renderer().frame()->image == before->image);
            b.window->workspace().close(*b.document);
            QVERIFY(!b.sections().section());
            QVERIFY(!b.pane().isVisible());
        }
        SectionBench b(settings);
        QVERIFY(beginIn(b, metric));
        QCOMPARE(b.section().width, 7.25);
        // which is no width for a file that says no unit, and one of such a file is not remembered
        QVERIFY(beginIn(b, surveyFile()));
        QVERIFY(b.section().width != 7.25);
        b.sections().setWidth(3.5);
        QVERIFY(b.settled());
        QVERIFY(!QSettings(settings, QSettings::IniFormat).contains(QStringLiteral("section/width_")));
    }

    /// Where the view hides points of the section, the section says so.
    void hiddenPointsOfTheSectionAreTold()
    {
        SectionBench b;
        QVERIFY(b.beginSection());
        ShownPill& pill = b.sections().shownPill();
        QCOMPARE(pill.text(), QString());
        const Attribute intensity = *b.document->findAttribute(QStringLiteral("Intensity"));
        b.window->viewFilter().setText(QStringLiteral("Intensity > 100"));
        PointIndex all = 0, shown = 0;
        for (PointIndex i = 0; i < b.document->points(); ++i) {
            if (!b.has(i)) continue;
            ++all;
            shown += intensity.number(i) > 100 ? 1 : 0;
        }
        QVERIFY(shown > 0 && shown < all);
        const auto says = [&](const QString& text) {
            return waitFor([&] { return pill.text() == text && !b.sections().counting(); }, 20'000);
        };
        QVERIFY2(says(QStringLiteral("%1 of %2 shown: filter").arg(countText(shown), countText(all))),
                 qPrintable(pill.text()));
        QVERIFY(pill.isVisible() && b.view().rect().contains(pill.geometry()));
        // as one walks, the figures are those of what is seen
        b.sections().walk(1.0);
        QVERIFY(waitFor([&] { return !b.sections().counting(); }));
        all = 0;
        for (PointIndex i = 0; i < b.document->points(); ++i) all += b.has(i) ? 1 : 0;
        QVERIFY2(pill.text().contains(QStringLiteral(" of %1 shown").arg(countText(all))), qPrintable(pill.text()));
        QTest::mouseClick(&pill.showAllButton(), Qt::LeftButton);
        QVERIFY(says({}) && b.window->viewFilter().text().isEmpty());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<SectionViewTest>(); });
}
#include "SectionViewTest.moc"
