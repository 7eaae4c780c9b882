// SPDX-License-Identifier: MIT
#include "ui/process/ProcessingDock.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/process/ChainPanel.h"
#include "ui/process/ScopeField.h"
#include "ui/process/StepChooser.h"
#include "ui/process/StepForm.h"
#include "ui/process/StepIcons.h"
#include "ui/process/StepPreview.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QShortcut>
#include <QStackedWidget>
#include <QStyle>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr int kPreviewDelay = 350;  ///< ms after the last change of a value

constexpr int kMostResult = 92;              ///< px of what is said, before it scrolls
constexpr int kSides = 20, kScrollBar = 10;  ///< px
constexpr int kLeastPanel = 290;             ///< px, so that what is said is in sight
constexpr int kLeastHeight = 150;            ///< px of the list, and of a step's fields

/// The attribute that a rule sets; empty for a text that is no rule, which the step will say.
QString targetOfRule(const QString& text)
{
    try {
        return toQString(expression::Rule(text.toStdString()).target());
    } catch (const Error&) {
        return {};
    }
}

/// What of the attributes is worth looking at after a step that added none.
QString targetOf(const Step& step, const StepValues& values)
{
    for (const StepParameter& p : step.parameters())
        if (const auto found = values.find(p.key); found != values.end() && p.type == StepParameter::Type::Rule)
            return targetOfRule(toQString(found->second));
    return toQString(step.description().shows);
}

/// Whether somebody may be writing there, so that a letter is none of ours.
bool takesLetters(const QWidget* widget)
{
    return qobject_cast<const QLineEdit*>(widget) || qobject_cast<const QPlainTextEdit*>(widget) ||
           qobject_cast<const QAbstractSpinBox*>(widget) || qobject_cast<const QAbstractItemView*>(widget) ||
           qobject_cast<const QComboBox*>(widget);
}

void setPrimary(QPushButton& button, bool primary)
{
    if (button.property("primary").toBool() == primary) return;
    button.setProperty("primary", primary);
    button.style()->unpolish(&button);
    button.style()->polish(&button);
}

}  // namespace

/// What a job is about: some steps, one after another.
struct ProcessingDock::Run {
    std::vector<StepWish> steps;
    std::optional<MadeEdit> made;  ///< of the only one, where it was looked at before
    std::vector<EditOutcome> outcomes;
    std::atomic<int> at = 0;  ///< the one that runs
    bool chain = false;
    QString title;
};

ProcessingDock::ProcessingDock(Workspace& workspace, ViewRenderer& renderer, ViewSettings& settings,
                               Selection& selection, const ViewFilter& filter, QWidget* parent)
    : QDockWidget(tr("Process"), parent),
      m_workspace(workspace),
      m_pages(new QStackedWidget),
      m_chooser(new StepChooser),
      m_form(new StepForm),
      m_scope(new ScopeField(workspace, selection, filter, settings)),
      m_preview(new StepPreview(workspace, renderer, settings, this)),
      m_chain(new ChainPanel(workspace)),
      m_back(new QToolButton),
      m_picture(new QLabel),
      m_title(heading({})),
      m_help(dimLabel({})),
      m_source(dimLabel({})),
      m_show(new QCheckBox(tr("Show the result"))),
      m_previewButton(new QPushButton(tr("Preview"))),
      m_run(new QPushButton(tr("Run"))),
      m_before(new QPushButton(tr("Before (C)"))),
      m_add(new QPushButton(tr("Add to chain"))),
      m_progress(new QProgressBar),
      m_result(new QLabel),
      m_resultArea(scrollColumn(m_result))
{
    setObjectName(QStringLiteral("processing"));
    m_pages->addWidget(m_chooser);
    m_pages->addWidget(makeStepPage());
    auto* content = new QWidget;
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(m_pages, 1);
    column->addWidget(makeFooter());
    column->addWidget(m_chain);
    QScrollArea* const all = scrollColumn(content);  // a small window is not made larger by what is in here
    all->setFocusPolicy(Qt::NoFocus);
    all->setMinimumHeight(kLeastPanel);
    setWidget(all);
    setMinimumWidth(kLeastPanelWidth);
    m_pages->setMinimumHeight(kLeastHeight);
    m_again.setSingleShot(true);
    m_again.setInterval(kPreviewDelay);
    connectParts();
    m_form->setStep(allSteps().front());
    showSteps();
    updateState();
    qApp->installEventFilter(this);
}

QWidget* ProcessingDock::makeStepPage()
{
    m_back->setIcon(lineIcon(QStringLiteral("step-back")));
    m_back->setToolTip(tr("All steps (Alt+Left)"));
    m_back->setAccessibleName(tr("All steps"));
    m_back->setFocusPolicy(Qt::StrongFocus);
    for (QLabel* label : {m_help, m_source}) {
        label->setWordWrap(true);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    }
    m_show->setChecked(true);
    m_show->setToolTip(tr("Color the points by what the step made, as soon as it is there"));
    auto* page = new QWidget;
    auto* column = new QVBoxLayout(page);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    auto* head = new QHBoxLayout;
    head->setContentsMargins(6, 8, 10, 2);
    head->setSpacing(6);
    head->addWidget(m_back);
    head->addWidget(m_picture);
    head->addWidget(m_title, 1);
    auto* content = new QWidget;
    auto* inner = new QVBoxLayout(content);
    inner->setContentsMargins(10, 4, 12, 8);
    inner->setSpacing(10);
    inner->addWidget(m_help);
    inner->addWidget(m_source);
    inner->addWidget(m_form);
    inner->addWidget(m_scope);
    inner->addWidget(m_show);
    inner->addStretch(1);
    column->addLayout(head);
    column->addWidget(scrollColumn(content), 1);
    return page;
}

QWidget* ProcessingDock::makeFooter()
{
    auto* footer = new QWidget;
    footer->setObjectName(QStringLiteral("footer"));
    auto* column = new QVBoxLayout(footer);
    column->setContentsMargins(10, 6, 10, 6);
    column->setSpacing(6);
    m_previewButton->setCheckable(true);
    m_previewButton->setToolTip(
        tr("Show how the points would look, and count what would change; follows the values as long as it is on"));
    m_run->setProperty("primary", true);
    for (QPushButton* button : {m_before, m_add}) button->setProperty("flat", true);
    m_before->setToolTip(
        tr("As long as it is held, or the key C is: the points without the preview, or before the "
           "last edit"));
    m_add->setToolTip(tr("Put the step with these values at the end of the chain below"));
    m_progress->setRange(0, 1000);
    m_progress->setTextVisible(false);
    m_result->setWordWrap(true);
    m_result->setTextInteractionFlags(Qt::TextSelectableByMouse);
    auto* row = new QHBoxLayout;
    row->setSpacing(6);
    row->addWidget(m_previewButton, 1);
    row->addWidget(m_run, 1);
    auto* more = new FoldingRow(6);
    more->first().addWidget(m_before);
    more->second().addWidget(m_add);
    m_result->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    m_resultArea->setFocusPolicy(Qt::NoFocus);
    // What is told comes above the buttons, so that they do not move away from under the mouse.
    column->addWidget(m_resultArea);
    column->addWidget(m_progress);
    column->addLayout(row);
    column->addWidget(more);
    return footer;
}

void ProcessingDock::connectParts()
{
    connect(m_chooser, &StepChooser::chosen, this, [this](const QString& name) {
        chooseStep(name);
        m_previewButton->setFocus();
    });
    connect(m_back, &QToolButton::clicked, this, &ProcessingDock::showSteps);
    auto* back = new QShortcut(QKeySequence(Qt::ALT | Qt::Key_Left), this);
    back->setContext(Qt::WidgetWithChildrenShortcut);
    connect(back, &QShortcut::activated, this, &ProcessingDock::showSteps);
    connect(m_form, &StepForm::changed, this, &ProcessingDock::valuesChanged);
    connect(m_form, &StepForm::returnPressed, this, &ProcessingDock::run);
    connect(m_form, &StepForm::problemChanged, this, &ProcessingDock::say);
    connect(m_scope, &ScopeField::changed, this, &ProcessingDock::valuesChanged);
    connect(&m_again, &QTimer::timeout, this, &ProcessingDock::beginPreview);
    connect(m_previewButton, &QPushButton::clicked, this, &ProcessingDock::togglePreview);
    connect(m_before, &QPushButton::pressed, m_preview, [this] { m_preview->showBefore(true); });
    connect(m_before, &QPushButton::released, m_preview, [this] { m_preview->showBefore(false); });
    connect(m_preview, &StepPreview::told, this, [this](const QString& sentence) {
        say(sentence);
        updateState();
    });
    connect(m_preview, &StepPreview::failed, this, [this](const QString& sentence) {
        m_form->markProblem(sentence);
        say(sentence);
        m_previewButton->setChecked(false);
    });
    connect(m_preview, &StepPreview::toggled, this, [this](bool on) {
        if (on) say({});
        // ended by something else than a change of values: the wish is over, too
        if (!on && !m_again.isActive()) m_previewButton->setChecked(false);
        updateState();
    });
    connect(m_run, &QPushButton::clicked, this, [this] {
        if (m_job == 0)
            run();
        else if (m_since.hasExpired(QApplication::doubleClickInterval()))  // a double click means to run it
            m_workspace.cancel(m_job);
    });
    connect(m_add, &QPushButton::clicked, this, [this] {
        if (auto one = wish(true)) m_chain->add(std::move(*one));
        updateState();
    });
    connect(m_chain, &ChainPanel::runWanted, this, &ProcessingDock::runChain);
    connect(m_chain, &ChainPanel::failed, this, &ProcessingDock::say);
    connect(m_chain, &ChainPanel::chosen, this, [this](int row) {
        if (row < 0 || row >= int(m_chain->chain().size())) return;
        const StepWish wish = m_chain->chain()[std::size_t(row)];
        chooseStep(toQString(wish.step));
        m_form->setStep(findStep(wish.step));
        for (const auto& [key, text] : wish.values) setValue(toQString(key), toQString(text));
        m_scope->set(wish.scope);
    });
    connect(&m_workspace, &Workspace::documentStateChanged, this, [this](const Document* document) {
        if (document == m_document) lookAtScale();
        updateState();
    });
    connect(this, &QDockWidget::visibilityChanged, m_preview, [this](bool visible) {
        // what a view shows that nobody can tell from the truth must not outlive the panel that says so
        if (!visible) togglePreview(false);
    });
}

void ProcessingDock::showSteps()
{
    togglePreview(false);
    m_pages->setCurrentIndex(0);
    say({});
    m_chooser->mark(m_form->step());
    if (isAncestorOf(QApplication::focusWidget())) m_chooser->search().setFocus();
    updateState();
}

void ProcessingDock::chooseStep(const QString& name)
{
    const Step* const step = findStep(name.toStdString());
    if (step == nullptr) return;
    togglePreview(false);
    if (m_form->step() != step) m_form->setStep(step);
    const StepDescription& about = step->description();
    m_picture->setPixmap(stepIcon(*step).pixmap(24, 24));
    m_title->setText(toQString(about.title));
    m_help->setText(toQString(about.help));
    m_source->setText(about.source.empty() ? QString() : tr("Method: %1").arg(toQString(about.source)));
    m_source->setVisible(!about.source.empty());
    m_scope->setNarrows(about.narrows);
    m_pages->setCurrentIndex(1);
    say({});
    lookAtScale();
    updateState();
}

QString ProcessingDock::resultText() const
{
    return m_result->text();
}

void ProcessingDock::say(const QString& text)
{
    if (text == m_result->text()) return;
    m_result->setText(text);
    fitResult();
}

/// As many lines as there are, up to some; the rest is scrolled to.
void ProcessingDock::fitResult()
{
    m_resultArea->setVisible(!m_result->text().isEmpty());
    const int height = m_result->heightForWidth(std::max(40, width() - kSides - kScrollBar));
    m_resultArea->setFixedHeight(std::clamp(height, 1, kMostResult));
}

void ProcessingDock::resizeEvent(QResizeEvent* event)
{
    QDockWidget::resizeEvent(event);
    fitResult();
}

bool ProcessingDock::setValue(const QString& key, const QString& text)
{
    return m_form->setValue(key, text);
}

void ProcessingDock::setDocument(Document* document)
{
    m_document = document;
    m_scale.reset();
    if (m_scaleJob != 0) m_workspace.cancel(std::exchange(m_scaleJob, 0));
    m_form->setDocument(document);
    m_scope->setDocument(document);
    say({});
    lookAtScale();
    updateState();
}

/// Presets that fit the data, once the points are there and a step wants them.
void ProcessingDock::lookAtScale()
{
    if (!m_document || m_document->loading() || m_scale || m_scaleJob != 0 || m_form->step() == nullptr) return;
    const auto& parameters = m_form->step()->parameters();
    if (std::none_of(parameters.begin(), parameters.end(), [](auto& p) { return p.fit.used(); })) return;
    const auto found = std::make_shared<DataScale>();
    m_scaleJob = m_workspace.startJob(
        tr("Spacing of %1").arg(m_document->name()),
        [found, cloud = m_document->cloud()](Progress& progress) { *found = dataScale(*cloud, progress); },
        [this, found, target = QPointer<Document>(m_document)](const JobInfo& info) {
            if (info.id != m_scaleJob) return;
            m_scaleJob = 0;
            if (info.state != JobState::Finished || target != m_document) return;
            m_scale = *found;
            m_form->setScale(m_scale);
        },
        true);
    m_workspace.tie(*m_document, m_scaleJob);
}

std::optional<StepWish> ProcessingDock::wish(bool changedOnly)
{
    if (m_form->step() == nullptr) return std::nullopt;
    QString problem;
    auto scope = m_scope->scope(problem);
    if (!scope) {
        say(problem);
        return std::nullopt;
    }
    m_form->setNarrowed(scope->kind != StepScope::Kind::All);
    if (problem = m_form->check(); !problem.isEmpty()) {
        say(problem);
        return std::nullopt;
    }
    return StepWish{m_form->step()->name(), m_form->values(changedOnly), std::move(*scope)};
}

void ProcessingDock::valuesChanged()
{
    m_form->markProblem({});
    if (!m_previewButton->isChecked()) return;
    m_again.start();
    m_preview->end();
}

void ProcessingDock::togglePreview(bool on)
{
    m_again.stop();
    m_previewButton->setChecked(on);
    if (on)
        beginPreview();
    else
        m_preview->end();
}

void ProcessingDock::beginPreview()
{
    const bool ready = m_document && !m_document->loading() && m_job == 0;
    const auto one = ready ? wish() : std::nullopt;
    if (!one) return m_previewButton->setChecked(false);
    m_preview->begin(*m_document, *one);
    m_previewButton->setChecked(true);
}

void ProcessingDock::run()
{
    if (!m_document || m_document->loading() || m_job != 0) return;
    auto one = wish();
    if (!one) return;
    const auto run = std::make_shared<Run>();
    run->title = toQString(m_form->step()->title());
    m_again.stop();
    if (m_preview->shown()) run->made = m_preview->take();
    m_preview->end();
    run->steps.push_back(std::move(*one));
    start(run);
}

void ProcessingDock::runChain()
{
    if (!m_document || m_document->loading() || m_job != 0 || m_chain->chain().empty()) return;
    togglePreview(false);
    const auto run = std::make_shared<Run>();
    run->title = tr("Chain");
    run->chain = true;
    run->steps = m_chain->chain();
    for (StepWish& wish : run->steps) {
        const bool narrows = findStep(wish.step)->description().narrows;
        wish.scope = m_scope->filled(wish.scope);
        if (!narrows) wish.scope = {};
    }
    start(run);
}

void ProcessingDock::start(const std::shared_ptr<Run>& run)
{
    say({});
    m_since.start();
    m_running = run;
    m_job = m_workspace.startJob(
        tr("%1 of %2").arg(run->title, m_document->name()),
        [run, session = m_document->session()](Progress& progress) {
            if (run->made) {
                if (auto done = session->apply(std::move(*run->made), progress)) {
                    run->outcomes.push_back(std::move(*done));
                    return;
                }
            }
            for (const StepWish& wish : run->steps) {
                const Recipe recipe{wish.step, wish.values, pointsOf(wish.scope, *session->cloud(), progress)};
                run->outcomes.push_back(session->edit(recipe, progress));
                ++run->at;
            }
        },
        [this, run, alive = m_document](const JobInfo& info) {
            if (alive) m_workspace.edited(*alive);
            ended(run, info);
        });
    m_workspace.tie(*m_document, m_job);
    updateState();
}

void ProcessingDock::updateState()
{
    const bool busy = m_job != 0, step = m_pages->currentIndex() == 1;
    const bool ready = m_document && !m_document->loading();
    m_run->setText(busy ? tr("Cancel") : m_preview->shown() ? tr("Apply") : tr("Run"));
    setPrimary(*m_run, !busy);
    m_run->setEnabled(busy || ready);
    m_run->setToolTip(busy                 ? tr("Stop; nothing changes")
                      : m_preview->shown() ? tr("Change the points as the preview shows. It can be undone.")
                                           : tr("Run this step on the active file. It can be undone."));
    m_run->setVisible(step || busy);
    m_previewButton->setVisible(step);
    m_previewButton->setEnabled(ready && !busy);
    m_before->setVisible(step);
    m_before->setEnabled(ready && (m_preview->shown() || m_document->history().canUndo()));
    m_add->setVisible(step);
    m_progress->setVisible(busy);
    fitResult();
    m_back->setEnabled(!busy);
    m_chooser->setEnabled(!busy);
    m_chain->setBusy(busy || !ready);
    m_chain->setVisible(!step || !m_chain->chain().empty());
}

void ProcessingDock::updateProgress()
{
    const JobId job = m_job != 0 ? m_job : m_preview->job();
    if (job == 0) return m_progress->setVisible(false);
    m_progress->setVisible(true);
    for (const JobInfo& info : m_workspace.jobs().running()) {
        if (info.id != job) continue;
        const int count = m_running ? std::max(1, int(m_running->steps.size())) : 1;
        const int at = m_running ? std::min(int(m_running->at), count - 1) : 0;
        m_progress->setValue(int(std::lround((at + info.fraction) / count * 1000.0)));
        const QString stage = toQString(info.stage);
        const bool chain = m_running && m_running->chain;
        if (chain) m_chain->setCurrent(at);
        say(chain ? tr("%1 of %2: %3").arg(at + 1).arg(count).arg(stage) : stage);
    }
}

void ProcessingDock::ended(const std::shared_ptr<Run>& run, const JobInfo& info)
{
    if (run != m_running) return;
    m_job = 0;
    m_running.reset();
    m_chain->setCurrent(-1);
    quint64 changed = 0;
    QStringList names, findings;
    for (const EditOutcome& outcome : run->outcomes) {
        changed += outcome.changed;
        for (const std::string& name : outcome.newAttributes) names << toQString(name);
        if (!outcome.finding.empty()) findings << toQString(outcome.finding);
    }
    updateState();
    const QString done =
        run->chain ? tr("%1 of %2 steps done").arg(run->outcomes.size()).arg(run->steps.size()) : QString();
    if (info.state == JobState::Failed) {
        m_form->markProblem(toQString(info.error));
        say(run->chain ? tr("%1; then: %2").arg(done, toQString(info.error)) : toQString(info.error));
        if (!isVisible()) m_workspace.say(MessageKind::Error, toQString(info.error), {}, m_document);
    } else if (info.state == JobState::Cancelled) {
        say(run->chain ? tr("%1: cancelled, %2.").arg(run->title, done)
                       : tr("%1: cancelled, nothing changed.").arg(run->title));
    } else {
        QString text = changed == 0 ? tr("%1: no point had to change.").arg(run->title)
                       : run->chain ? tr("%1: %2, %3 changed.").arg(run->title, done, pointsText(changed))
                                    : tr("%1: %2 changed.").arg(run->title, pointsText(changed));
        if (!findings.isEmpty()) text += QLatin1Char(' ') + findings.join(QLatin1Char(' '));
        say(text);
        // what a step has found is told where the panel is not seen, too
        if (!isVisible() && !findings.isEmpty()) m_workspace.say(MessageKind::Info, text, {}, m_document);
    }
    emit m_workspace.stepEnded(info.id, run->title, changed, names, info);
    if (changed == 0 || run->outcomes.empty() || info.state != JobState::Finished) return;
    const StepWish& last = run->steps[run->outcomes.size() - 1];
    showResultOf(*findStep(last.step), run->outcomes.back(), targetOf(*findStep(last.step), last.values));
}

void ProcessingDock::showResultOf(const Step& step, const EditOutcome& outcome, const QString& target)
{
    if (!m_show->isChecked() || !m_document) return;
    // Of several new attributes the one that the step says, or that shows them together.
    QString wanted = toQString(step.description().shows);
    if (!outcome.newAttributes.empty() && m_document->findAttribute(wanted) == nullptr) wanted.clear();
    if (wanted.isEmpty())
        for (const std::string& name : outcome.newAttributes) {
            const Attribute* attribute = m_document->findAttribute(toQString(name));
            if (wanted.isEmpty() || (attribute && attribute->components == 3)) wanted = toQString(name);
        }
    if (wanted.isEmpty()) wanted = target;
    if (!wanted.isEmpty()) emit showAttribute(wanted);
}

/// The key C, wherever nobody writes: the state before, for as long as it is held.
bool ProcessingDock::eventFilter(QObject* watched, QEvent* event)
{
    const bool press = event->type() == QEvent::KeyPress, release = event->type() == QEvent::KeyRelease;
    if (press || release) {
        const auto& key = *static_cast<QKeyEvent*>(event);
        if (key.key() == Qt::Key_C && !key.isAutoRepeat() && watched->isWidgetType()) {
            const auto* widget = static_cast<QWidget*>(watched);
            const bool ours = widget->window() == window() && !takesLetters(QApplication::focusWidget());
            if (press && ours && key.modifiers() == Qt::NoModifier && m_document) m_preview->showBefore(true);
            if (release) m_preview->showBefore(false);
        }
    } else if (event->type() == QEvent::ApplicationDeactivate || event->type() == QEvent::WindowDeactivate) {
        m_preview->showBefore(false);  // the release of the key goes elsewhere
    }
    return QDockWidget::eventFilter(watched, event);
}

}  // namespace punctum::ui
