// SPDX-License-Identifier: MIT
#include "ui/section/SectionPane.h"

#include "ui/style/Icons.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"
#include "ui/view/Viewport.h"

#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QToolButton>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kFieldWidth = 92;  // px
const QMargins kBarMargins(10, 4, 6, 4);

}  // namespace

SectionPane::SectionPane(ViewRenderer& renderer, ViewSettings& settings, bool openGl, QWidget* parent)
    : QWidget(parent),
      m_title(new QLabel),
      m_bar(new QBoxLayout(QBoxLayout::LeftToRight)),
      m_row(new QBoxLayout(QBoxLayout::LeftToRight)),
      m_fields(new QHBoxLayout),
      m_buttons(new QHBoxLayout),
      m_width(new NumberSpin),
      m_exaggeration(new NumberSpin),
      m_viewport(new Viewport(renderer, settings, openGl))
{
    m_viewport->setFlat();
    m_title->setTextFormat(Qt::PlainText);
    m_title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    makeFields();
    addButtons();

    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    m_bar->setContentsMargins(kBarMargins);
    for (QBoxLayout* part : {m_bar, m_row, m_fields, m_buttons}) part->setSpacing(4);
    m_row->addLayout(m_fields);
    m_row->addLayout(m_buttons);
    m_bar->addWidget(m_title, 1);
    m_bar->addLayout(m_row);
    column->addLayout(m_bar);
    column->addWidget(m_viewport, 1);
}

void SectionPane::makeFields()
{
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
    m_fields->addWidget(dimLabel(tr("Width")));
    m_fields->addWidget(m_width);
    m_fields->addSpacing(6);
    m_fields->addWidget(dimLabel(tr("Heights")));
    m_fields->addWidget(m_exaggeration);
    m_fields->addStretch(1);
}

void SectionPane::addButtons()
{
    const auto add = [this](const char* icon, const QString& tip, auto act) {
        QToolButton* const button = addButton(QLatin1String(icon), tip);
        connect(button, &QToolButton::clicked, this, act);
        return button;
    };
    add("ahead", tr("Walk ahead by the width (Up or Right; with Shift by half)"), [this] { emit walked(1.0); });
    add("back", tr("Walk back by the width (Down or Left; with Shift by half)"), [this] { emit walked(-1.0); });
    add("turn", tr("Look from the other side"), &SectionPane::turnWanted);
    add("fit", tr("Show the whole section (F over the section)"), &SectionPane::fitWanted);
    add("beside", tr("Beside or below the main view"), &SectionPane::moveWanted);
    m_buttons->addStretch(1);
    m_close = add("close", tr("Close the section (Escape over the section)"), &SectionPane::closeWanted);
}

QToolButton* SectionPane::addButton(const QString& icon, const QString& tip)
{
    auto* const button = new QToolButton;
    button->setIcon(lineIcon(icon));
    button->setIconSize(QSize(18, 18));
    button->setToolTip(tip);
    button->setAccessibleName(tip);
    button->setFocusPolicy(Qt::TabFocus);
    m_buttons->addWidget(button);
    return button;
}

QSize SectionPane::minimumSizeHint() const
{
    const int part = std::max(m_fields->minimumSize().width(), m_buttons->minimumSize().width());
    const QSize view = m_viewport->minimumSize();
    return {std::max(part + kBarMargins.left() + kBarMargins.right(), view.width()),
            view.height() + m_bar->minimumSize().height()};
}

void SectionPane::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    // As many parts side by side as there is room for. The title of the moment is not asked: lines would come and
    // go as one walks.
    const int title = fontMetrics().horizontalAdvance(tr("1234.5 m long, 123.4 m wide  ·  1,234,567 points"));
    const int parts = m_fields->minimumSize().width() + m_row->spacing() + m_buttons->minimumSize().width();
    const int room = width() - kBarMargins.left() - kBarMargins.right();
    m_row->setDirection(room < parts ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
    m_bar->setDirection(room < parts + title ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
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
    putLength(*m_width, width, 2);
}

void SectionPane::setExaggeration(double times)
{
    const QSignalBlocker quiet(m_exaggeration);
    m_exaggeration->setValue(times);
}

}  // namespace punctum::ui
