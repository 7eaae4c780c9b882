// SPDX-License-Identifier: MIT
#pragma once

#include <QWidget>

class QDoubleSpinBox;
class QPushButton;
class QSpinBox;

namespace punctum::ui
{

class ViewSettings;

/// Brightness, contrast and gamma of the colors of a file, in one row. GUI thread only; borrows the settings.
class ToneRow final : public QWidget
{
    Q_OBJECT
public:
    explicit ToneRow(ViewSettings& settings, QWidget* parent = nullptr);

private:
    void takeSettings();
    void apply();

    ViewSettings& m_settings;
    QSpinBox* m_brightness = nullptr;  ///< %
    QSpinBox* m_contrast = nullptr;    ///< %
    QDoubleSpinBox* m_gamma = nullptr;
    QPushButton* m_reset = nullptr;
};

}  // namespace punctum::ui
