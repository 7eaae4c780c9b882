// SPDX-License-Identifier: MIT
#include "ui/style/Widgets.h"

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
