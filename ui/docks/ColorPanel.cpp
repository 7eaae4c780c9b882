// SPDX-License-Identifier: MIT
#include "ui/docks/ColorPanel.h"

#include "render/color/ColorMap.h"
#include "ui/basic/Text.h"
#include "ui/docks/ToneRow.h"
#include "ui/style/NumberField.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"
#include "ui/view/ViewSettings.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPainter>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QStyle>

#include <cmath>

namespace punctum::ui
{

namespace
{

// px; all of a row stands side by side in the narrowest panel.
constexpr int kLeastNumber = 40, kLeastSpin = 60;

QIcon gradientIcon(const render::ColorTable& table, QSize size)
{
    QImage line(256, 1, QImage::Format_RGB32);
    for (int i = 0; i < 256; ++i) {
        const render::Rgba8 c = table[std::size_t(i)];
        line.setPixel(i, 0, qRgb(c.r, c.g, c.b));
    }
    QPixmap pixmap(size);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(
        QBrush(QPixmap::fromImage(line.scaled(size, Qt::IgnoreAspectRatio, Qt::SmoothTransformation))));
    painter.drawRoundedRect(QRectF(QPointF(), QSizeF(size)), 3, 3);
    return QIcon(pixmap);
}

}  // namespace

ColorPanel::ColorPanel(ViewSettings& settings, QWidget* parent)
    : QWidget(parent),
      m_settings(settings),
      m_map(new QComboBox),
      m_low(new NumberField),
      m_high(new NumberField),
      m_auto(new QPushButton(tr("Auto"))),
      m_problem(dimLabel({})),
      m_bands(new QSpinBox),
      m_eyeDome(new QCheckBox(tr("Eye-dome"))),
      m_size(new NumberSpin),
      m_sizing(new QComboBox),
      m_round(new QCheckBox(tr("Round"))),
      m_averaged(new QCheckBox(tr("Averaged"))),
      m_samples(new QComboBox),
      m_tone(new ToneRow(settings))
{
    const QSize icon(40, 12);
    m_map->setIconSize(icon);
    for (QComboBox* box : {m_map, m_sizing, m_samples}) mayBeNarrow(*box);
    m_map->setMinimumContentsLength(0);  // the colors say it
    m_auto->setStyleSheet(QStringLiteral("padding: 6px 8px"));
    m_map->addItem(tr("Automatic"), QString());
    for (const render::ColorMap& map : render::colorMaps())
        m_map->addItem(gradientIcon(map.table, icon), toQString(map.name), toQString(map.name));
    m_map->setToolTip(
        tr("Colors from the lowest to the highest value; automatic: grey for Intensity, else viridis"));
    m_map->setAccessibleName(tr("Color map"));
    connect(m_map, &QComboBox::currentIndexChanged, this,
            [this](int index) { m_settings.setColorMap(m_map->itemData(index).toString()); });

    m_low->setToolTip(tr("Value that gets the first color"));
    m_low->setAccessibleName(tr("Lowest value"));
    m_high->setToolTip(tr("Value that gets the last color"));
    m_high->setAccessibleName(tr("Highest value"));
    for (NumberField* field : {m_low, m_high}) {
        field->setMinimumWidth(kLeastNumber);
        connect(field, &QLineEdit::editingFinished, this, &ColorPanel::applyRange);
        connect(field, &NumberField::problemChanged, this, [this] {
            m_problem->setText(m_low->problem().isEmpty() ? m_high->problem() : m_low->problem());
            m_problem->setMinimumHeight(m_problem->heightForWidth(contentsRect().width()));
            m_problem->setVisible(!m_problem->text().isEmpty());
        });
    }
    m_problem->setWordWrap(true);
    m_problem->hide();
    m_auto->setToolTip(
        tr("Range from the 2nd to the 98th percentile of the values, so that outliers do not flatten "
           "the colors"));
    connect(m_auto, &QPushButton::clicked, this, &ColorPanel::automaticRange);

    m_bands->setRange(1, 64);
    m_bands->setSpecialValueText(tr("smooth"));
    m_bands->setToolTip(tr("Steps of color instead of a smooth change, to see levels"));
    m_bands->setAccessibleName(tr("Steps of color"));
    connect(m_bands, &QSpinBox::valueChanged, this, [this](int n) { m_settings.setBands(n); });
    m_eyeDome->setToolTip(
        tr("Shades each point by how far it lies behind its neighbors, so that shapes stand out (L)"));
    connect(m_eyeDome, &QCheckBox::toggled, this, [this](bool on) { m_settings.setEyeDome(on ? 1.0 : 0.0); });

    m_size->setMinimumWidth(kLeastSpin);
    m_bands->setMinimumWidth(kLeastSpin);
    m_size->setToolTip(tr("Width of a point (+ and -)"));
    m_size->setAccessibleName(tr("Point size"));
    m_size->setKeyboardTracking(false);
    connect(m_size, &QDoubleSpinBox::valueChanged, this, [this](double size) { m_settings.setSize(size); });
    m_sizing->addItem(tr("pixels"), int(render::PointSizing::Pixels));
    m_sizing->addItem(tr("in the world"), int(render::PointSizing::World));
    m_sizing->addItem(tr("spacings"), int(render::PointSizing::Density));
    m_sizing->setToolTip(
        tr("What the width is measured in: pixels, units of the coordinates (meters for degrees), or "
           "spacings between the points of the cloud"));
    m_sizing->setAccessibleName(tr("Point size by"));
    connect(m_sizing, &QComboBox::activated, this,
            [this] { m_settings.setSizing(render::PointSizing(m_sizing->currentData().toInt())); });
    m_round->setToolTip(tr("Points are circles instead of squares, where they are wider than 1.5 px"));
    connect(m_round, &QCheckBox::toggled, this, [this](bool on) { m_settings.setRound(on); });
    m_averaged->setToolTip(tr("Each pixel shows the mean color of all points near its front: less noise"));
    connect(m_averaged, &QCheckBox::toggled, this, [this](bool on) { m_settings.setAveraged(on); });
    m_samples->addItem(tr("1, fast"), 1);
    m_samples->addItem(tr("4, smooth"), 4);
    m_samples->addItem(tr("8, smoother"), 8);
    m_samples->addItem(tr("16, smoothest"), 16);
    m_samples->setToolTip(tr("Samples in each pixel: more make thin things and edges smooth, and take longer"));
    m_samples->setAccessibleName(tr("Samples"));
    connect(m_samples, &QComboBox::activated, this,
            [this] { m_settings.setSamples(m_samples->currentData().toInt()); });

    QHBoxLayout* const colors = m_colorsRow = new QHBoxLayout;
    colors->setSpacing(6);
    colors->addWidget(m_map, 3);
    colors->addWidget(m_bands, 2);
    QHBoxLayout* const range = m_rangeRow = new QHBoxLayout;
    range->setSpacing(5);
    range->addWidget(m_low, 1);
    range->addWidget(dimLabel(tr("to")));
    range->addWidget(m_high, 1);
    range->addWidget(m_auto);

    for (QWidget* field : std::initializer_list<QWidget*>{m_bands, m_size, m_round, m_averaged, m_eyeDome})
        field->setMinimumHeight(kFieldHeight);  // as the boxes and fields beside them

    auto* points = new QHBoxLayout;
    points->setSpacing(6);
    points->addWidget(m_size, 1);
    points->addWidget(m_sizing, 1);
    auto* shape = new FoldingRow(6, 2, 1);
    shape->first().addWidget(m_round, 1);
    shape->first().addWidget(m_averaged, 1);
    shape->second().addWidget(m_eyeDome, 1);

    QFormLayout* const form = m_form = new QFormLayout(this);
    form->setContentsMargins(0, 4, 0, 0);
    form->setHorizontalSpacing(6);
    form->setVerticalSpacing(8);
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    const auto addRow = [&](const QString& text, auto* field) {
        QLabel* const label = dimLabel(text);
        label->setMinimumHeight(kFieldHeight);  // in line with the middle of its field
        form->addRow(label, field);
    };
    addRow(tr("Colors"), colors);
    addRow(tr("Range"), range);
    form->addRow(m_problem);
    addRow(tr("Tone"), m_tone);
    addRow(tr("Points"), points);
    addRow(tr("Look"), shape);
    addRow(tr("Samples"), m_samples);

    connect(&m_settings, &ViewSettings::changed, this, &ColorPanel::takeSettings);
    takeSettings();
    setKind(std::nullopt);
}

void ColorPanel::takeSettings()
{
    const QSignalBlocker noMap(m_map), noSize(m_size), noSamples(m_samples), noBands(m_bands), noDome(m_eyeDome),
        noSizing(m_sizing), noRound(m_round), noAveraged(m_averaged);
    if (m_attribute != m_settings.attribute()) {  // what was typed was about another one
        m_attribute = m_settings.attribute();
        for (NumberField* field : {m_low, m_high}) field->put({});
    }
    m_bands->setValue(std::max(1, m_settings.display().bands));
    m_eyeDome->setChecked(m_settings.display().eyeDome > 0);
    m_map->setCurrentIndex(std::max(0, m_map->findData(m_settings.colorMap())));
    takeSize();
    m_round->setChecked(m_settings.display().round);
    m_averaged->setChecked(m_settings.display().averaged);
    m_samples->setCurrentIndex(std::max(0, m_samples->findData(m_settings.display().samples)));
}

void ColorPanel::takeSize()
{
    const render::PointSizing sizing = m_settings.display().sizing;
    m_sizing->setCurrentIndex(std::max(0, m_sizing->findData(int(sizing))));
    switch (sizing) {
        case render::PointSizing::Pixels:
            m_size->setDecimals(1);
            m_size->setRange(1.0, 20.0);
            m_size->setSingleStep(0.5);
            break;
        case render::PointSizing::World:
            m_size->setDecimals(4);
            m_size->setRange(0.0001, 1e6);
            m_size->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
            break;
        case render::PointSizing::Density:
            m_size->setDecimals(2);
            m_size->setRange(0.1, 20.0);
            m_size->setSingleStep(0.25);
            break;
    }
    if (sizing != render::PointSizing::World) m_size->setStepType(QAbstractSpinBox::DefaultStepType);
    m_size->setValue(m_settings.size());
}

void ColorPanel::setKind(std::optional<AttributeKind> kind)
{
    const bool scalar = kind == AttributeKind::Scalar;
    if (kind != m_kind) {  // asked for each frame
        m_form->setRowVisible(m_colorsRow, scalar);
        m_form->setRowVisible(m_rangeRow, scalar);
        m_form->setRowVisible(m_tone, kind == AttributeKind::Color);
        m_kind = kind;
    }
    for (QWidget* widget : std::initializer_list<QWidget*>{m_map, m_low, m_high, m_auto, m_bands})
        widget->setEnabled(scalar);
    m_tone->setEnabled(kind == AttributeKind::Color);
    if (!scalar)
        for (NumberField* field : {m_low, m_high}) field->put({});
}

void ColorPanel::setRange(std::pair<double, double> range)
{
    if (!m_low->isEnabled()) return;
    m_range = range;
    fillRange();
}

void ColorPanel::fillRange()
{
    if (!m_low->problem().isEmpty() || !m_high->problem().isEmpty()) return;  // what is wrong stays to be seen
    const double width = m_range.second - m_range.first;
    m_low->put(m_range.first, plainNumber(m_range.first, width));
    m_high->put(m_range.second, plainNumber(m_range.second, width));
}

void ColorPanel::automaticRange()
{
    for (NumberField* field : {m_low, m_high}) field->put({});
    m_settings.setRange(std::nullopt);
    fillRange();
}

void ColorPanel::applyRange()
{
    const bool both = m_low->check() & m_high->check();
    // Leaving a field that nobody changed must not pin the range down.
    if (!both || (m_low->untouched() && m_high->untouched())) return;
    const auto low = m_low->number(), high = m_high->number();
    if (!low || !high) return;
    if (*high <= *low) return m_high->refuse(tr("The highest value must be above the lowest."));
    for (NumberField* field : {m_low, m_high}) field->setModified(false);
    m_settings.setRange(std::pair(*low, *high));
}

}  // namespace punctum::ui
