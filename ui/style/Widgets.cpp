// SPDX-License-Identifier: MIT
#include "ui/style/Widgets.h"

#include <QStyle>
#include <QToolTip>

namespace punctum::ui
{

QLabel* dimLabel(const QString& text)
{
    auto* label = new QLabel(text);
    label->setProperty("dim", true);
    return label;
}

QLabel* heading(const QString& text)
{
    auto* label = new QLabel(text);
    QFont bold = label->font();
    bold.setBold(true);
    label->setFont(bold);
    return label;
}

void markWrong(QWidget& field, const QString& why)
{
    constexpr char kWhy[] = "whyWrong", kTip[] = "tipWhenRight";
    const QString before = wrongness(field);
    if (why == before) return;
    if (before.isEmpty()) field.setProperty(kTip, field.toolTip());
    field.setProperty(kWhy, why);
    field.setToolTip(why.isEmpty() ? field.property(kTip).toString() : why);
    field.setAccessibleDescription(why);
    if (field.property("wrong").toBool() != !why.isEmpty()) {
        field.setProperty("wrong", !why.isEmpty());
        field.style()->unpolish(&field);
        field.style()->polish(&field);
        field.update();
    }
    if (!why.isEmpty() && field.isVisible())
        QToolTip::showText(field.mapToGlobal(QPoint(0, field.height() / 2)), why, &field);
}

QString wrongness(const QWidget& field)
{
    return field.property("whyWrong").toString();
}

QScrollArea* scrollColumn(QWidget* content)
{
    auto* area = new QScrollArea;
    area->setWidget(content);
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    return area;
}

}  // namespace punctum::ui
