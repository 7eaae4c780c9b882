// SPDX-License-Identifier: MIT
#pragma once

#include "core/steps/Steps.h"
#include "core/task/Jobs.h"

#include <QDockWidget>
#include <QElapsedTimer>
#include <QPointer>

#include <vector>

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QProgressBar;
class QPushButton;

namespace punctum::ui
{

class Document;
class Workspace;

/// Chooses a processing step, asks for its parameters, runs it on the active document. GUI thread only.
class ProcessingDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit ProcessingDock(Workspace& workspace, QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// Shows the fields of this step ("normals").
    void chooseStep(const QString& name);
    /// Puts a value into a field, as text; false when the step has no such parameter.
    bool setValue(const QString& key, const QString& text);
    void run();
    bool running() const noexcept { return m_job != 0; }
    /// "Reclassify: 1,204 points changed."
    QString resultText() const;
    /// Called while a job runs, to show how far it is.
    void updateProgress();

signals:
    /// The step has made values worth looking at, and the user wants to see them.
    void showAttribute(const QString& name);

private:
    struct Field {
        StepParameter parameter;
        QWidget* widget = nullptr;
        QLabel* name = nullptr;
    };
    const Step* step() const;
    void buildFields();
    void fillUnits();
    void fillAttributes();
    void fillClasses();
    QString valueOf(const Field& field) const;
    /// Marks fields whose values cannot be used, and says why; false when there are some.
    bool checkFields();
    void updateState();
    void ended(quint64 job, const QString& title, quint64 changed, const QStringList& newAttributes,
               const JobInfo& info);

    Workspace& m_workspace;
    QPointer<Document> m_document;
    QComboBox* m_steps = nullptr;
    QLabel* m_help = nullptr;
    QFormLayout* m_form = nullptr;
    QCheckBox* m_show = nullptr;
    QPushButton* m_run = nullptr;
    QProgressBar* m_progress = nullptr;
    QLabel* m_result = nullptr;
    std::vector<Field> m_fields;
    JobId m_job = 0;
    QElapsedTimer m_running;  ///< since it began
    QString m_runningStep;
    QString m_target;  ///< attribute that it sets
};

}  // namespace punctum::ui
