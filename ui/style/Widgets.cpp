// SPDX-License-Identifier: MIT
#include "ui/style/Widgets.h"

#include <QComboBox>
#include <QResizeEvent>
#include <QStyle>
#include <QToolTip>

#include <algorithm>

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
    label->setWordWrap(true);
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

void mayBeNarrow(QComboBox& box)
{
    constexpr int kLeastLetters = 5;
    box.setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box.setMinimumContentsLength(kLeastLetters);
}

FoldingRow::FoldingRow(int spacing, int firstShare, int secondShare)
    : m_row(new QBoxLayout(QBoxLayout::LeftToRight, this)), m_first(new QHBoxLayout), m_second(new QHBoxLayout)
{
    m_row->setContentsMargins(0, 0, 0, 0);
    m_row->addLayout(m_first, firstShare);
    m_row->addLayout(m_second, secondShare);
    for (QBoxLayout* part : {m_row, static_cast<QBoxLayout*>(m_first), static_cast<QBoxLayout*>(m_second)})
        part->setSpacing(spacing);
}

QSize FoldingRow::minimumSizeHint() const
{
    const int width = std::max(m_first->minimumSize().width(), m_second->minimumSize().width());
    return {width, m_row->minimumSize().height()};
}

void FoldingRow::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    const int both = m_first->minimumSize().width() + m_row->spacing() + m_second->minimumSize().width();
    const auto direction = width() < both ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight;
    if (direction == m_row->direction()) return;
    m_row->setDirection(direction);
    updateGeometry();
}

}  // namespace punctum::ui
