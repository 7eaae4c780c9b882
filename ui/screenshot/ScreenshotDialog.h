// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Jobs.h"
#include "ui/settings/ScreenshotOptions.h"

#include <QDialog>
#include <QTimer>

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QSpinBox;

namespace punctum::ui
{

class Screenshots;

/// Asks how a picture of the view is to be: which view, how large, and what is on it; shows a small one meanwhile.
/// GUI thread only; deletes itself when closed.
class ScreenshotDialog final : public QDialog
{
    Q_OBJECT
public:
    ScreenshotDialog(Screenshots& screenshots, const ScreenshotOptions& preset, QWidget* parent);
    ~ScreenshotDialog() override;

    ScreenshotOptions options() const;

signals:
    /// It was closed with Save.
    void wanted(const punctum::ui::ScreenshotOptions& options);
    /// There is a new small picture.
    void previewed();

private:
    void addSize(QFormLayout& form, const ScreenshotOptions& preset);
    void addWhat(QFormLayout& form, const ScreenshotOptions& preset);
    QCheckBox* addMark(const QString& text, const QString& tip, bool on);
    void fillSizes();
    void chooseSize(int index);
    void change();
    void drawPreview();

    Screenshots& m_screenshots;
    QComboBox* m_view;
    QComboBox* m_sizes;
    QSpinBox* m_width;
    QSpinBox* m_height;
    QComboBox* m_samples;
    QCheckBox* m_transparent = nullptr;
    QCheckBox* m_legend = nullptr;
    QCheckBox* m_scaleBar = nullptr;
    QCheckBox* m_northArrow = nullptr;
    QCheckBox* m_measurements = nullptr;
    QCheckBox* m_ruler = nullptr;
    QLabel* m_preview;
    QTimer m_previewTimer;
    JobId m_job = 0;
    int m_asked = 0;  ///< previews so far: only the newest is shown
};

}  // namespace punctum::ui
