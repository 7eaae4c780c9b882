// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>

class QLabel;
class QPushButton;
class QTreeWidget;

namespace punctum::ui
{

class Measurements;
class MeasureTools;
class Menus;
class VolumeFields;

/// The list of measurements: each with its values, a point with all its attributes and its neighbors. GUI thread
/// only.
class MeasureDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit MeasureDock(Measurements& measurements, QWidget* parent = nullptr);

    QTreeWidget& list() noexcept { return *m_list; }
    QPushButton& copyButton() noexcept { return *m_copy; }
    QPushButton& exportButton() noexcept { return *m_export; }
    QPushButton& removeButton() noexcept { return *m_remove; }
    VolumeFields& volumeFields() noexcept { return *m_volume; }
    /// Whether volumes are being measured: their fields are shown then, as they are while a volume is chosen.
    void setMeasuringVolumes(bool on);

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    /// A place to write to is to be chosen.
    void exportWanted();

private:
    void fill();
    void fitColumns();
    void choose();
    quint64 chosen() const;

    Measurements& m_measurements;
    VolumeFields* m_volume;
    bool m_measuringVolumes = false;
    QTreeWidget* m_list;
    QLabel* m_hint;
    QPushButton* m_copy;
    QPushButton* m_export;
    QPushButton* m_remove;
};

/// Adds the menu Measure to the window, and its button to the tool bar.
void addMeasureMenu(Menus& menus, MeasureTools& tools, Measurements& measurements, MeasureDock& dock);

}  // namespace punctum::ui
