// SPDX-License-Identifier: MIT
#include "ui/measure/VolumeFields.h"

#include "ui/style/NumberField.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>

namespace punctum::ui
{

namespace
{

/// Below it, px, a name beside a field would leave too little for the longest choice.
constexpr int kRoomForNames = 290;

}  // namespace

VolumeFields::VolumeFields(QWidget* parent)
    : QWidget(parent),
      m_form(new QFormLayout(this)),
      m_base(new QComboBox),
      m_height(new NumberField),
      m_points(new QComboBox)
{
    const auto addBase = [this](const QString& text, VolumeBase base, const QString& tip) {
        m_base->addItem(text, int(base));
        m_base->setItemData(m_base->count() - 1, tip, Qt::ToolTipRole);
    };
    addBase(tr("Surface of the outline"), VolumeBase::Outline,
            tr("Triangulated from the heights along the edge; for piles and pits on uneven ground"));
    addBase(tr("Lowest of the outline"), VolumeBase::Lowest, tr("Level, as low as the lowest place of the edge"));
    addBase(tr("Plane of the outline"), VolumeBase::Plane,
            tr("Level or sloping, as the heights along the edge are on the whole"));
    addBase(tr("Height"), VolumeBase::Height, tr("Level, at the height that you write"));
    m_base->setAccessibleName(tr("Base of volumes"));
    m_base->setToolTip(tr("What the surface is compared with: of the chosen volume, and of those to come"));
    m_height->setAccessibleName(tr("Height of the base"));
    m_height->setPlaceholderText(tr("Height"));
    using Points = VolumeWish::Points;
    m_points->addItem(tr("Ground, else points shown"), int(Points::Automatic));
    m_points->addItem(tr("Ground"), int(Points::Ground));
    m_points->addItem(tr("Points shown"), int(Points::Shown));
    m_points->setAccessibleName(tr("Points of volumes"));
    m_points->setToolTip(
        tr("Of which points the surface is made; ground is what the menu View > Ground Surface says"));
    for (QComboBox* box : {m_base, m_points}) {
        mayBeNarrow(*box);
        connect(box, &QComboBox::activated, this, &VolumeFields::tell);
    }
    connect(m_height, &QLineEdit::editingFinished, this, &VolumeFields::tell);
    m_form->setContentsMargins(0, 0, 0, 0);
    m_form->setVerticalSpacing(8);
    m_form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    const auto addRow = [this](const QString& text, QWidget* field) {
        auto* const label = new QLabel(text);
        label->setMinimumHeight(kFieldHeight);  // in line with the middle of its field
        m_form->addRow(label, field);
    };
    addRow(tr("Base"), m_base);
    m_form->addRow(m_height);
    addRow(tr("Surface of"), m_points);
    setWish({});
}

/// In a narrow panel fields stand below their names, so that choices can be read.
void VolumeFields::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    const bool narrow = width() < kRoomForNames;
    m_form->setVerticalSpacing(narrow ? 3 : 8);
    m_form->setRowWrapPolicy(narrow ? QFormLayout::WrapAllRows : QFormLayout::DontWrapRows);
    for (QWidget* field : {static_cast<QWidget*>(m_base), static_cast<QWidget*>(m_points)})
        m_form->labelForField(field)->setMinimumHeight(narrow ? 0 : kFieldHeight);
}

VolumeWish VolumeFields::wish() const
{
    return {VolumeBase(m_base->currentData().toInt()), m_height->number().value_or(0),
            VolumeWish::Points(m_points->currentData().toInt())};
}

void VolumeFields::setWish(const VolumeWish& wish)
{
    m_base->setCurrentIndex(m_base->findData(int(wish.base)));
    m_points->setCurrentIndex(m_points->findData(int(wish.points)));
    const bool height = wish.base == VolumeBase::Height;
    if (height && m_height->number() != wish.height)
        m_height->put(wish.height, QString::number(wish.height, 'g', 12));
    m_height->setVisible(height);
}

void VolumeFields::tell()
{
    const bool height = wish().base == VolumeBase::Height;
    m_height->setVisible(height);
    if (height && !m_height->check()) {
        if (sender() == m_base) m_height->setFocus();
        return;
    }
    emit wishChanged(wish());
}

}  // namespace punctum::ui
