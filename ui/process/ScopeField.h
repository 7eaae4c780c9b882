// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/StepScope.h"
#include "core/task/Jobs.h"

#include <QPointer>
#include <QTimer>
#include <QWidget>

#include <optional>

class QComboBox;
class QLabel;

namespace punctum::ui
{

class ClassesField;
class Document;
class RuleField;
class Selection;
class ViewFilter;
class ViewSettings;
class Workspace;

/// Which points a step may change: all, what is selected, some classes, a condition, or what is shown; and how many
/// these are, counted by a job. Locked classes are left out. GUI thread only.
class ScopeField final : public QWidget
{
    Q_OBJECT
public:
    ScopeField(Workspace& workspace, const Selection& selection, const ViewFilter& filter,
               const ViewSettings& settings, QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// Whether the step can be told; it cannot: all points change.
    void setNarrows(bool narrows);
    /// As the fields say. Marks what is wrong and says it in `problem`.
    std::optional<StepScope> scope(QString& problem) const;
    /// What was said before, with what is selected, shown and locked now.
    StepScope filled(StepScope scope) const;
    void set(const StepScope& scope);
    QComboBox& kind() noexcept { return *m_kind; }
    ClassesField& classes() noexcept { return *m_classes; }
    RuleField& condition() noexcept { return *m_condition; }
    QString countText() const;

signals:
    void changed();

protected:
    void showEvent(QShowEvent* event) override;

private:
    void follow();
    void countLater();
    void count();
    StepScope::Kind chosen() const;

    Workspace& m_workspace;
    const Selection& m_selection;
    const ViewFilter& m_filter;
    const ViewSettings& m_settings;
    QPointer<Document> m_document;
    QComboBox* m_kind;
    ClassesField* m_classes;
    RuleField* m_condition;
    QLabel* m_count;
    QTimer m_later;
    JobId m_job = 0;
    std::uint64_t m_number = 0;  ///< of the count: what a job brings for one before is dropped
    bool m_narrows = true;
};

}  // namespace punctum::ui
