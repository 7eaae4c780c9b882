// SPDX-License-Identifier: MIT
#include "ui/style/Style.h"

#include "ui/style/Theme.h"

#include <QComboBox>
#include <QPainter>
#include <QStyleFactory>
#include <QStyleOptionComplex>
#include <QStyledItemDelegate>

namespace punctum::ui
{

namespace
{

constexpr qreal kRadius = 6.0;
constexpr int kDropDownMargin = 9;  // px beside the text of a line

void drawField(QPainter& painter, const QRect& rect, bool enabled, bool hover, bool focus, const QColor& fill,
               bool wrong = false)
{
    const ThemeColors& colors = themeColors();
    painter.setPen(QPen(wrong ? colors.error : focus ? colors.accent : colors.border, 1.0));
    painter.setBrush(enabled && hover ? colors.hover : fill);
    painter.drawRoundedRect(QRectF(rect).adjusted(0.5, 0.5, -0.5, -0.5), kRadius, kRadius);
}

/// An arrow head of two strokes; `up` of 1 or -1.
void drawChevron(QPainter& painter, const QRectF& rect, int up, const QColor& color, qreal half = 3.6)
{
    painter.setPen(QPen(color, 1.5, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter.setBrush(Qt::NoBrush);
    const QPointF c = rect.center();
    painter.drawPolyline(QPolygonF{QList<QPointF>{c + QPointF(-half, up * half / 2), c + QPointF(0, -up * half / 2),
                                                  c + QPointF(half, up * half / 2)}});
}

/// The list that drops down from a combo box.
bool isDropDown(const QWidget* widget)
{
    return widget && widget->inherits("QComboBoxListView");
}

}  // namespace

Style::Style() : QProxyStyle(QStyleFactory::create(QStringLiteral("Fusion"))) {}

void Style::polish(QWidget* widget)
{
    QProxyStyle::polish(widget);
    // Qt's own delegate of a combo box asks no style how high a line is.
    auto* const combo = qobject_cast<QComboBox*>(widget);
    if (combo && combo->itemDelegate()->inherits("QComboBoxDelegate"))
        combo->setItemDelegate(new QStyledItemDelegate(combo));
}

void Style::drawComplexControl(ComplexControl control, const QStyleOptionComplex* option, QPainter* painter,
                               const QWidget* widget) const
{
    const ThemeColors& colors = themeColors();
    const bool enabled = option->state & State_Enabled;
    const bool hover = option->state & State_MouseOver;
    const bool focus = option->state & State_HasFocus;
    const QColor mark = enabled ? colors.dim : colors.border;
    if (control == CC_ComboBox) {
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        drawField(*painter, option->rect, enabled, hover, focus, colors.raised);
        QRect arrow = option->rect;
        arrow.setLeft(arrow.right() - 24);
        drawChevron(*painter, arrow, -1, mark);
        painter->restore();
        return;
    }
    if (control == CC_SpinBox) {
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        drawField(*painter, option->rect, enabled, false, focus, colors.base,
                  widget && widget->property("wrong").toBool());
        const QRect up = subControlRect(control, option, SC_SpinBoxUp, widget);
        const QRect down = subControlRect(control, option, SC_SpinBoxDown, widget);
        const auto* spin = qstyleoption_cast<const QStyleOptionSpinBox*>(option);
        const auto color = [&](SubControl sub, QAbstractSpinBox::StepEnabledFlag step) {
            if (spin && !(spin->stepEnabled & step)) return colors.border;
            return enabled && (option->activeSubControls & sub) && hover ? colors.text : mark;
        };
        drawChevron(*painter, QRectF(up).adjusted(0, 2, 0, 0), 1,
                    color(SC_SpinBoxUp, QAbstractSpinBox::StepUpEnabled), 3.0);
        drawChevron(*painter, QRectF(down).adjusted(0, 0, 0, -2), -1,
                    color(SC_SpinBoxDown, QAbstractSpinBox::StepDownEnabled), 3.0);
        painter->restore();
        return;
    }
    QProxyStyle::drawComplexControl(control, option, painter, widget);
}

void Style::drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                          const QWidget* widget) const
{
    const ThemeColors& colors = themeColors();
    if (element == PE_IndicatorCheckBox || element == PE_IndicatorItemViewItemCheck) {
        const bool enabled = option->state & State_Enabled;
        const bool on = option->state & State_On;
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        QRectF box(0, 0, 15, 15);
        box.moveCenter(QRectF(option->rect).center());
        const QColor fill = on ? (enabled ? colors.accent : colors.border) : colors.base;
        painter->setPen(QPen(on ? fill : colors.dim, 1.1));
        painter->setBrush(fill);
        painter->drawRoundedRect(box, 4, 4);
        if (option->state & State_HasFocus) {
            painter->setPen(QPen(colors.accent, 1.2));
            painter->setBrush(Qt::NoBrush);
            painter->drawRoundedRect(box.adjusted(-2.4, -2.4, 2.4, 2.4), 5.5, 5.5);
        }
        if (on) {
            painter->setPen(QPen(colors.dark ? QColor(0x0c, 0x12, 0x1a) : QColor(Qt::white), 1.8, Qt::SolidLine,
                                 Qt::RoundCap, Qt::RoundJoin));
            painter->drawPolyline(
                QPolygonF{QList<QPointF>{box.topLeft() + QPointF(3.6, 7.8), box.topLeft() + QPointF(6.4, 10.7),
                                         box.topLeft() + QPointF(11.4, 4.7)}});
        }
        painter->restore();
        return;
    }
    if (element == PE_FrameFocusRect)
        return;  // fields and lists show the focus by their border, check marks by a ring
    QProxyStyle::drawPrimitive(element, option, painter, widget);
}

QSize Style::sizeFromContents(ContentsType type, const QStyleOption* option, const QSize& size,
                              const QWidget* widget) const
{
    QSize result = QProxyStyle::sizeFromContents(type, option, size, widget);
    if (type == CT_ComboBox || type == CT_SpinBox) result.setHeight(std::max(result.height(), kFieldHeight));
    if (type == CT_ItemViewItem && isDropDown(widget))
        result.setHeight(std::max(result.height() + 8, kFieldHeight));
    return result;
}

int Style::pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const
{
    switch (metric) {
        case PM_IndicatorWidth:
        case PM_IndicatorHeight:
            return 16;
        case PM_DockWidgetSeparatorExtent:
            return 5;
        case PM_FocusFrameHMargin:  // of the lines of a list
            return isDropDown(widget) ? kDropDownMargin : QProxyStyle::pixelMetric(metric, option, widget);
        default:
            return QProxyStyle::pixelMetric(metric, option, widget);
    }
}

int Style::styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget,
                     QStyleHintReturn* result) const
{
    if (hint == SH_ComboBox_Popup) return 0;  // a list that drops down and scrolls, not a menu over the field
    if (hint == SH_DialogButtonBox_ButtonsHaveIcons) return 0;
    return QProxyStyle::styleHint(hint, option, widget, result);
}

}  // namespace punctum::ui
