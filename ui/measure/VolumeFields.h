// SPDX-License-Identifier: MIT
#pragma once

#include "ui/measure/VolumeMeasure.h"

#include <QWidget>

class QComboBox;
class QFormLayout;

namespace punctum::ui
{

class NumberField;

/// What volumes are measured against and of which points: fields of the Measure panel. GUI thread only.
class VolumeFields final : public QWidget
{
    Q_OBJECT
public:
    explicit VolumeFields(QWidget* parent = nullptr);

    VolumeWish wish() const;
    /// Without a signal.
    void setWish(const VolumeWish& wish);
    QComboBox& base() noexcept { return *m_base; }
    NumberField& height() noexcept { return *m_height; }
    QComboBox& points() noexcept { return *m_points; }

signals:
    /// A person has chosen something else; not while a height is wanted and there is none.
    void wishChanged(const VolumeWish& wish);

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    void tell();

    QFormLayout* m_form;
    QComboBox* m_base;
    NumberField* m_height;
    QComboBox* m_points;
};

}  // namespace punctum::ui
