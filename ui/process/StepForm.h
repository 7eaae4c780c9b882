// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

#include <QPointer>
#include <QWidget>

#include <optional>
#include <vector>

class QFormLayout;
class QLabel;
class QPushButton;
class QToolButton;

namespace punctum::ui
{

class Document;

/// The fields of a step's values: units, presets that fit the data, marks on what was changed and a way back, and
/// what is seldom needed folded away. Made from the step's description. GUI thread only.
class StepForm final : public QWidget
{
    Q_OBJECT
public:
    explicit StepForm(QWidget* parent = nullptr);

    /// Null: no fields.
    void setStep(const Step* step);
    const Step* step() const noexcept { return m_step; }
    /// Whose attributes, classes and unit the fields go by; null: none.
    void setDocument(Document* document);
    /// What presets fit; nothing: not known yet.
    void setScale(const std::optional<DataScale>& scale);

    /// Puts a value into a field, as text; false when the step has no such parameter, or it cannot have the value.
    bool setValue(const QString& key, const QString& text);
    /// What the fields say; `changedOnly`: without what is as preset.
    StepValues values(bool changedOnly = false) const;
    /// Marks fields whose values cannot be used. The first reason; empty: all are well.
    QString check();
    /// `narrowed`: the step is told which points, so that some values are not needed.
    void setNarrowed(bool narrowed) { m_narrowed = narrowed; }
    /// Marks the field of rule or condition that an error is about.
    void markProblem(const QString& sentence);
    bool anyChanged() const;

signals:
    void changed();
    void returnPressed();
    void problemChanged(const QString& problem);

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    struct Field {
        StepParameter parameter;
        QWidget* widget = nullptr;
        QLabel* name = nullptr;
        QToolButton* reset = nullptr;
        QWidget* row = nullptr;
        QString preset;  ///< as valueOf() has it; empty: none, or not known yet
    };
    QWidget* makeField(const StepParameter& parameter);
    void addField(const StepParameter& parameter);
    void fillUnits();
    void fillAttributes();
    void fillClasses();
    void fillPresets();
    void fold();
    QString valueOf(const Field& field) const;
    bool matters(const Field& field) const;
    bool put(Field& field, const QString& text);
    void markChanged();

    const Step* m_step = nullptr;
    QPointer<Document> m_document;
    std::optional<DataScale> m_scale;
    QFormLayout* m_form;
    QPushButton* m_more;
    std::vector<Field> m_fields;
    bool m_narrowed = false;
    bool m_filling = false;  ///< the program changes fields
};

}  // namespace punctum::ui
