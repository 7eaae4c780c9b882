// SPDX-License-Identifier: MIT
#include "ui/process/ScopeField.h"

#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/process/ClassesField.h"
#include "ui/select/RuleField.h"
#include "ui/select/Selection.h"
#include "ui/style/Widgets.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>

#include <utility>

namespace punctum::ui
{

namespace
{

constexpr int kCountDelay = 300;  ///< ms after the last change

std::bitset<256> lockedIn(const ViewSettings& settings)
{
    std::bitset<256> locked;
    for (std::size_t code = 0; code < locked.size(); ++code) locked[code] = settings.lockedClasses()[code];
    return locked;
}

}  // namespace

ScopeField::ScopeField(Workspace& workspace, const Selection& selection, const ViewFilter& filter,
                       const ViewSettings& settings, QWidget* parent)
    : QWidget(parent),
      m_workspace(workspace),
      m_selection(selection),
      m_filter(filter),
      m_settings(settings),
      m_kind(new QComboBox),
      m_classes(new ClassesField),
      m_condition(new RuleField),
      m_count(dimLabel({}))
{
    using Kind = StepScope::Kind;
    m_kind->addItem(tr("All points"), int(Kind::All));
    m_kind->addItem(tr("Selected points"), int(Kind::Selection));
    m_kind->addItem(tr("Classes"), int(Kind::Classes));
    m_kind->addItem(tr("Condition"), int(Kind::Condition));
    m_kind->addItem(tr("What is shown"), int(Kind::Shown));
    m_kind->setAccessibleName(tr("Points that may change"));
    m_kind->setToolTip(
        tr("Points that the step may change; others are looked at all the same. Locked classes never change."));
    mayBeNarrow(*m_kind);
    m_classes->edit().setAccessibleName(tr("Classes that may change"));
    m_condition->setAccessibleName(tr("Condition of points that may change"));
    m_condition->setPlaceholderText(QStringLiteral("Classification == 2"));
    m_count->setWordWrap(true);
    auto* grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setHorizontalSpacing(12);
    grid->setVerticalSpacing(6);
    grid->setColumnStretch(1, 1);
    grid->addWidget(dimLabel(tr("Changes")), 0, 0);
    grid->addWidget(m_kind, 0, 1);
    grid->addWidget(m_classes, 1, 0, 1, 2);
    grid->addWidget(m_condition, 2, 0, 1, 2);
    grid->addWidget(m_count, 3, 0, 1, 2);
    m_later.setSingleShot(true);
    m_later.setInterval(kCountDelay);
    connect(&m_later, &QTimer::timeout, this, &ScopeField::count);
    connect(m_kind, &QComboBox::currentIndexChanged, this, &ScopeField::follow);
    connect(m_classes, &ClassesField::changed, this, &ScopeField::follow);
    connect(m_condition, &RuleField::textChanged, this, &ScopeField::follow);
    connect(&m_selection, &Selection::changed, this, [this] {
        if (chosen() == Kind::Selection) follow();
    });
    connect(&m_filter, &ViewFilter::changed, this, [this] {
        if (chosen() == Kind::Shown) follow();
    });
    connect(&m_settings, &ViewSettings::changed, this, [this, before = lockedIn(m_settings)]() mutable {
        const auto now = lockedIn(m_settings);
        if (std::exchange(before, now) != now || chosen() == Kind::Shown) follow();
    });
    connect(&m_workspace, &Workspace::documentStateChanged, this, [this](const Document* document) {
        if (document == m_document) countLater();
    });
    follow();
}

StepScope::Kind ScopeField::chosen() const
{
    return m_narrows ? StepScope::Kind(m_kind->currentData().toInt()) : StepScope::Kind::All;
}

void ScopeField::setDocument(Document* document)
{
    m_document = document;
    m_classes->setDocument(document);
    countLater();
}

void ScopeField::setNarrows(bool narrows)
{
    m_narrows = narrows;
    m_kind->setEnabled(narrows);
    follow();
}

QString ScopeField::countText() const
{
    return m_count->text();
}

void ScopeField::follow()
{
    m_classes->setVisible(chosen() == StepScope::Kind::Classes);
    m_condition->setVisible(chosen() == StepScope::Kind::Condition);
    m_condition->markProblem({});
    markWrong(m_classes->edit(), {});
    countLater();
    emit changed();
}

std::optional<StepScope> ScopeField::scope(QString& problem) const
{
    StepScope scope;
    scope.kind = chosen();
    if (scope.kind == StepScope::Kind::Classes) {
        const auto classes = m_classes->classes();
        if (!classes || classes->none()) {
            problem = tr("Choose classes, such as 2, 8-9.");
            markWrong(m_classes->edit(), problem);
            return std::nullopt;
        }
        scope.classes = *classes;
    }
    if (scope.kind == StepScope::Kind::Condition) {
        scope.condition = m_condition->text().trimmed().toStdString();
        try {
            if (scope.condition.empty()) throw Error("Write a condition, such as Classification == 2.");
            expression::Condition::check(scope.condition);
        } catch (const Error& e) {
            problem = toQString(std::string(e.what()));
            m_condition->markProblem(problem);
            return std::nullopt;
        }
    }
    scope = filled(std::move(scope));
    if (scope.kind == StepScope::Kind::Selection && !scope.selection) {
        problem = tr("Nothing is selected.");
        return std::nullopt;
    }
    return scope;
}

StepScope ScopeField::filled(StepScope scope) const
{
    if (m_document) {
        scope.selection = m_selection.points(m_document);
        scope.visibility = m_filter.visibility(*m_document);
    }
    scope.locked = m_narrows ? lockedIn(m_settings) : std::bitset<256>();
    return scope;
}

void ScopeField::set(const StepScope& scope)
{
    m_kind->setCurrentIndex(m_kind->findData(int(scope.kind)));
    if (scope.kind == StepScope::Kind::Classes) m_classes->setClasses(scope.classes);
    if (scope.kind == StepScope::Kind::Condition) m_condition->setText(toQString(scope.condition));
}

void ScopeField::showEvent(QShowEvent* event)
{
    QWidget::showEvent(event);
    countLater();
}

void ScopeField::countLater()
{
    ++m_number;
    if (m_job != 0) m_workspace.cancel(std::exchange(m_job, 0));
    m_count->setText(m_narrows ? QString() : tr("This step changes all points."));
    m_count->setVisible(!m_count->text().isEmpty());
    if (m_narrows && isVisible()) m_later.start();
}

void ScopeField::count()
{
    if (!m_document || m_document->loading() || !isVisible() || !m_narrows) return;
    StepScope scope;
    scope.kind = chosen();
    QString problem;
    if (scope.kind != StepScope::Kind::All || m_settings.lockedClasses() != std::array<bool, 256>{}) {
        const auto said = this->scope(problem);
        if (!said) {  // it is said when somebody wants to run it; what is still empty is no mistake yet
            if (m_classes->text().isEmpty()) markWrong(m_classes->edit(), {});
            if (m_condition->text().trimmed().isEmpty()) m_condition->markProblem({});
            return;
        }
        scope = *said;
    }
    if (scope.kind == StepScope::Kind::All && scope.locked.none()) return;  // nothing new in that
    const auto found = std::make_shared<PointIndex>(0);
    const PointIndex all = m_document->points() - m_document->deletedPoints();
    m_job = m_workspace.startJob(
        tr("Points that may change"),
        [scope, found, all, cloud = m_document->cloud()](Progress& progress) {
            const auto points = pointsOf(scope, *cloud, progress);
            *found = points ? points->count() : all;
        },
        [this, found, all, number = m_number, locked = scope.locked.any()](const JobInfo& info) {
            if (number != m_number) return;
            m_job = 0;
            QString text;
            if (info.state == JobState::Failed) text = toQString(info.error);
            if (info.state == JobState::Finished)
                text = tr("%1 of %2 may change").arg(pointsText(*found), punctum::ui::countText(all)) +
                       (locked ? tr("; locked classes do not.") : QStringLiteral("."));
            m_count->setText(text);
            m_count->setVisible(!text.isEmpty());
        },
        true);
    m_workspace.tie(*m_document, m_job);
}

}  // namespace punctum::ui
