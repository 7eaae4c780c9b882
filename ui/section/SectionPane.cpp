// SPDX-License-Identifier: MIT
#include "ui/section/SectionPane.h"

#include "ui/Viewport.h"
#include "ui/style/Icons.h"
#include "ui/style/Widgets.h"

#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QToolButton>

namespace punctum::ui
{

namespace
{

constexpr int kFieldWidth = 92;  // px

}  // namespace

SectionPane::SectionPane(ViewRenderer& renderer, ViewSettings& settings, bool openGl, QWidget* parent)
    : QWidget(parent),
      m_bar(new QBoxLayout(QBoxLayout::LeftToRight)),
      m_title(new QLabel),
      m_width(new QDoubleSpinBox),
      m_exaggeration(new QDoubleSpinBox),
      m_viewport(new Viewport(renderer, settings, openGl))
{
    m_viewport->setFlat();
    m_title->setTextFormat(Qt::PlainText);
    m_title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);

    m_width->setRange(0.01, 1e6);
    m_width->setDecimals(2);
    m_width->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    m_width->setKeyboardTracking(false);
    m_width->setAccessibleName(tr("Width of the section"));
    m_width->setToolTip(
        tr("Width of the section, half to each side of its line (Ctrl and wheel over the section)"));
    connect(m_width, &QDoubleSpinBox::valueChanged, this, &SectionPane::widthChosen);
    m_exaggeration->setRange(0.1, 100.0);
    m_exaggeration->setDecimals(1);
    m_exaggeration->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    m_exaggeration->setKeyboardTracking(false);
    m_exaggeration->setPrefix(QStringLiteral("× "));
    m_exaggeration->setAccessibleName(tr("Exaggeration of heights"));
    m_exaggeration->setToolTip(tr("How many times as high heights look"));
    connect(m_exaggeration, &QDoubleSpinBox::valueChanged, this, &SectionPane::exaggerationChosen);

    for (QDoubleSpinBox* field : {m_width, m_exaggeration}) {
        field->setMaximumWidth(kFieldWidth);
        // after Enter, keys go to the section again
        connect(field, &QDoubleSpinBox::editingFinished, this, [this, field] {
            if (field->hasFocus()) m_viewport->setFocus();
        });
    }
    auto* const row = new QHBoxLayout;
    row->setSpacing(4);
    row->addWidget(dimLabel(tr("Width")));
    row->addWidget(m_width);
    row->addSpacing(6);
    row->addWidget(dimLabel(tr("Heights")));
    row->addWidget(m_exaggeration);
    row->addSpacing(6);
    connect(
        addButton(*row, QStringLiteral("ahead"), tr("Walk ahead by the width (Up or Right; with Shift by half)")),
        &QToolButton::clicked, this, [this] { emit walked(1.0); });
    connect(
        addButton(*row, QStringLiteral("back"), tr("Walk back by the width (Down or Left; with Shift by half)")),
        &QToolButton::clicked, this, [this] { emit walked(-1.0); });
    connect(addButton(*row, QStringLiteral("turn"), tr("Look from the other side")), &QToolButton::clicked, this,
            &SectionPane::turnWanted);
    connect(addButton(*row, QStringLiteral("fit"), tr("Show the whole section (F over the section)")),
            &QToolButton::clicked, this, &SectionPane::fitWanted);
    connect(addButton(*row, QStringLiteral("beside"), tr("Beside or below the main view")), &QToolButton::clicked,
            this, &SectionPane::moveWanted);
    m_close = addButton(*row, QStringLiteral("close"), tr("Close the section (Escape over the section)"));
    connect(m_close, &QToolButton::clicked, this, &SectionPane::closeWanted);

    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    m_bar->setContentsMargins(10, 4, 6, 4);
    m_bar->setSpacing(4);
    m_bar->addWidget(m_title, 1);
    m_bar->addLayout(row);
    column->addLayout(m_bar);
    column->addWidget(m_viewport, 1);
}

QToolButton* SectionPane::addButton(QBoxLayout& row, const QString& icon, const QString& tip)
{
    auto* const button = new QToolButton;
    button->setIcon(lineIcon(icon));
    button->setIconSize(QSize(18, 18));
    button->setToolTip(tip);
    button->setAccessibleName(tip);
    button->setFocusPolicy(Qt::TabFocus);
    row.addWidget(button);
    return button;
}

void SectionPane::setNarrow(bool narrow)
{
    m_bar->setDirection(narrow ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
}

void SectionPane::setTitle(const QString& title)
{
    m_title->setText(title);
    m_title->setToolTip(title);
}

QString SectionPane::title() const
{
    return m_title->text();
}

void SectionPane::setWidth(double width, const QString& unit)
{
    const QSignalBlocker quiet(m_width);
    m_width->setSuffix(unit.isEmpty() ? QString() : QLatin1Char(' ') + unit);
    m_width->setValue(width);
}

void SectionPane::setExaggeration(double times)
{
    const QSignalBlocker quiet(m_exaggeration);
    m_exaggeration->setValue(times);
}

}  // namespace punctum::ui
