// SPDX-License-Identifier: MIT
#pragma once

#include "core/session/Session.h"
#include "core/steps/Steps.h"
#include "core/task/Jobs.h"
#include "ui/process/StepWish.h"

#include <QDockWidget>
#include <QElapsedTimer>
#include <QPointer>
#include <QTimer>

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

class QCheckBox;
class QLabel;
class QProgressBar;
class QPushButton;
class QScrollArea;
class QStackedWidget;
class QToolButton;

namespace punctum::ui
{

class ChainPanel;
class Document;
class ScopeField;
class Selection;
class StepChooser;
class StepForm;
class StepPreview;
class ViewFilter;
class ViewRenderer;
class ViewSettings;
class Workspace;

/// The Process panel: finds a step, asks for its values and for the points that may change, shows what would come
/// of it, and does it on the active document; several one after another, too. What it knows of steps are their
/// descriptions. GUI thread only.
class ProcessingDock final : public QDockWidget
{
    Q_OBJECT
public:
    ProcessingDock(Workspace& workspace, ViewRenderer& renderer, ViewSettings& settings, Selection& selection,
                   const ViewFilter& filter, QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// Shows the fields of this step ("normals").
    void chooseStep(const QString& name);
    /// Puts a value into a field, as text; false when the step has no such parameter.
    bool setValue(const QString& key, const QString& text);
    void run();
    void runChain();
    bool running() const noexcept { return m_job != 0; }
    /// "Reclassify: 1,204 points changed."
    QString resultText() const;
    /// Called while a job runs, to show how far it is.
    void updateProgress();
    StepChooser& chooser() noexcept { return *m_chooser; }
    StepForm& form() noexcept { return *m_form; }
    ScopeField& scope() noexcept { return *m_scope; }
    StepPreview& preview() noexcept { return *m_preview; }
    ChainPanel& chain() noexcept { return *m_chain; }
    QPushButton& previewButton() noexcept { return *m_previewButton; }
    QPushButton& runButton() noexcept { return *m_run; }

signals:
    /// The step has made values worth looking at, and the user wants to see them.
    void showAttribute(const QString& name);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

private:
    struct Run;
    QWidget* makeStepPage();
    QWidget* makeFooter();
    void connectParts();
    void showSteps();
    std::optional<StepWish> wish(bool changedOnly = false);
    void valuesChanged();
    void togglePreview(bool on);
    void beginPreview();
    void start(const std::shared_ptr<Run>& run);
    void ended(const std::shared_ptr<Run>& run, const JobInfo& info);
    void lookAtScale();
    void updateState();
    void say(const QString& text);
    void fitResult();
    void showResultOf(const Step& step, const EditOutcome& outcome, const QString& target);

    Workspace& m_workspace;
    QPointer<Document> m_document;
    QStackedWidget* m_pages;
    StepChooser* m_chooser;
    StepForm* m_form;
    ScopeField* m_scope;
    StepPreview* m_preview;
    ChainPanel* m_chain;
    QToolButton* m_back;
    QLabel *m_picture, *m_title, *m_help, *m_source;
    QCheckBox* m_show;
    QPushButton *m_previewButton, *m_run, *m_before, *m_add;
    QProgressBar* m_progress;
    QLabel* m_result;
    QScrollArea* m_resultArea;  ///< some lines high at most
    QTimer m_again;             ///< values changed while a preview is wanted
    JobId m_job = 0;
    std::shared_ptr<Run> m_running;
    QElapsedTimer m_since;  ///< it began
    JobId m_scaleJob = 0;
    std::optional<DataScale> m_scale;  ///< of the document
};

}  // namespace punctum::ui
