// SPDX-License-Identifier: MIT
#include "ui/docks/ToneRow.h"

#include "ui/style/NumberField.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"
#include "ui/view/ViewSettings.h"

#include <QDoubleSpinBox>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>

#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kLeastField = 60;  // px

}  // namespace

ToneRow::ToneRow(ViewSettings& settings, QWidget* parent)
    : QWidget(parent),
      m_settings(settings),
      m_brightness(new QSpinBox),
      m_contrast(new QSpinBox),
      m_gamma(new NumberSpin),
      m_reset(new QPushButton(tr("Reset")))
{
    for (QSpinBox* field : {m_brightness, m_contrast}) {
        field->setRange(-100, 100);
        field->setSingleStep(5);
        field->setSuffix(QStringLiteral(" %"));
        connect(field, &QSpinBox::valueChanged, this, &ToneRow::apply);
    }
    m_brightness->setToolTip(tr("Brightness of the colors of the file"));
    m_brightness->setAccessibleName(tr("Brightness"));
    m_contrast->setToolTip(tr("Contrast of the colors of the file"));
    m_contrast->setAccessibleName(tr("Contrast"));
    m_gamma->setRange(0.1, 10.0);
    m_gamma->setDecimals(2);
    m_gamma->setSingleStep(0.1);
    m_gamma->setToolTip(tr("Gamma: above 1 dark colors become brighter, black and white stay as they are"));
    m_gamma->setAccessibleName(tr("Gamma"));
    connect(m_gamma, &QDoubleSpinBox::valueChanged, this, &ToneRow::apply);
    m_reset->setToolTip(tr("Colors as they are in the file"));
    connect(m_reset, &QPushButton::clicked, this, [this] { m_settings.setTone({}); });

    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    auto* row = new FoldingRow(6);
    column->addWidget(row);
    for (QWidget* field : std::initializer_list<QWidget*>{m_brightness, m_contrast, m_gamma, m_reset}) {
        field->setMinimumHeight(kFieldHeight);
        field->setMinimumWidth(kLeastField);
        QHBoxLayout& half = field == m_brightness || field == m_contrast ? row->first() : row->second();
        half.addWidget(field, 1);
    }
    connect(&m_settings, &ViewSettings::changed, this, &ToneRow::takeSettings);
    takeSettings();
}

void ToneRow::takeSettings()
{
    const QSignalBlocker noBrightness(m_brightness), noContrast(m_contrast), noGamma(m_gamma);
    const render::ColorTone& tone = m_settings.display().tone;
    m_brightness->setValue(int(std::lround(tone.brightness * 100.0)));
    m_contrast->setValue(int(std::lround(tone.contrast * 100.0)));
    m_gamma->setValue(tone.gamma);
}

void ToneRow::apply()
{
    m_settings.setTone({m_brightness->value() / 100.0, m_contrast->value() / 100.0, m_gamma->value()});
}

}  // namespace punctum::ui
