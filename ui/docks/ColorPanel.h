// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <QWidget>

#include <optional>
#include <utility>

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QHBoxLayout;
class QLabel;
class QPushButton;
class QSpinBox;

namespace punctum::ui
{

class NumberField;
class ToneRow;
class ViewSettings;

/// How the shown attribute becomes colors, and how large points are: color map, range, size, samples.
/// GUI thread only; borrows the settings.
class ColorPanel final : public QWidget
{
    Q_OBJECT
public:
    explicit ColorPanel(ViewSettings& settings, QWidget* parent = nullptr);

    /// The range that is drawn at present, for the fields.
    void setRange(std::pair<double, double> range);
    /// Color map and range mean something for scalar attributes only, the tone for colors; others are not shown.
    void setKind(std::optional<AttributeKind> kind);

private:
    void takeSettings();
    void takeSize();
    void applyRange();
    void automaticRange();
    /// Shows the range that is drawn in fields that nobody types in.
    void fillRange();

    ViewSettings& m_settings;
    QFormLayout* m_form = nullptr;
    QHBoxLayout* m_colorsRow = nullptr;
    QHBoxLayout* m_rangeRow = nullptr;
    std::optional<AttributeKind> m_kind = AttributeKind::Opaque;  ///< whose rows are shown; not yet: all
    QComboBox* m_map = nullptr;
    NumberField* m_low = nullptr;
    NumberField* m_high = nullptr;
    QPushButton* m_auto = nullptr;
    QLabel* m_problem = nullptr;  ///< of the range
    QSpinBox* m_bands = nullptr;
    QCheckBox* m_eyeDome = nullptr;
    QDoubleSpinBox* m_size = nullptr;
    QComboBox* m_sizing = nullptr;
    QCheckBox* m_round = nullptr;
    QCheckBox* m_averaged = nullptr;
    QComboBox* m_samples = nullptr;
    ToneRow* m_tone = nullptr;
    std::pair<double, double> m_range{0.0, 0.0};
    QString m_attribute;  ///< that the range is of
};

}  // namespace punctum::ui
