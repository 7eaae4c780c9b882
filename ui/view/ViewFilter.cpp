// SPDX-License-Identifier: MIT
#include "ui/view/ViewFilter.h"

#include "core/expression/Condition.h"
#include "core/expression/ExpressionError.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"

#include <QPointer>

#include <algorithm>

namespace punctum::ui
{

ViewFilter::ViewFilter(Workspace& workspace, ViewRenderer& renderer, ViewSettings& settings, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_renderer(renderer), m_settings(settings)
{
    connect(&workspace, &Workspace::documentLoaded, this, [this](Document* document) {
        connect(document, &Document::partsShownChanged, this, [this, document] {
            applyAnew(*document);
            emit changed();
        });
        if (!m_text.isEmpty() || document->hiddenParts() != 0) apply(*document);
    });
    connect(&workspace, &Workspace::documentRemoved, this,
            [this](const Document* document, bool) { m_states.erase(document); });
    connect(&workspace, &Workspace::activeChanged, this, &ViewFilter::changed);
    connect(&workspace, &Workspace::cloudChanged, this, [this](Document* document, const ChangeNotice& notice) {
        if (document->loading()) return;
        if (notice.kind == ChangeNotice::Kind::Deleted) return apply(*document);
        if (m_text.isEmpty()) return;  // no value decides then
        const std::vector<std::string>& names = m_states[document].attributes;
        const bool other = notice.kind == ChangeNotice::Kind::Values && !names.empty() &&
                           std::none_of(names.begin(), names.end(), [&](const std::string& name) {
                               const Attribute* const a = document->findAttribute(toQString(name));
                               return a != nullptr && notice.concerns(*a);
                           });
        if (!other) apply(*document);
    });
}

void ViewFilter::setText(const QString& text)
{
    const QString wanted = text.trimmed();
    if (wanted == m_text) return;
    m_text = wanted;
    ++m_version;
    for (Document* document : m_workspace.documents())
        if (!document->loading()) apply(*document);
    emit changed();
}

/// What the job of now finds is no longer what is asked for.
void ViewFilter::applyAnew(Document& document)
{
    const auto found = m_states.find(&document);
    if (found == m_states.end() || found->second.job == 0) return apply(document);
    found->second.again = true;
    m_workspace.cancel(found->second.job);
}

void ViewFilter::apply(Document& document)
{
    State& state = m_states[&document];
    const std::vector<PointRange> notShown = document.hiddenRanges();
    if (m_text.isEmpty() && notShown.empty()) {
        if (state.job != 0) m_workspace.cancel(state.job);
        state = {};
        m_renderer.hide(document.cloud(), document.deleted());
        return;
    }
    if (state.job != 0) {
        state.again = true;
        if (state.version != m_version) m_workspace.cancel(state.job);
        return;
    }
    struct Result {
        std::shared_ptr<PointSet> hidden;
        quint64 count = 0;
        QString error;
        std::vector<std::string> attributes;
    };
    const auto result = std::make_shared<Result>();
    state.version = m_version;
    state.again = false;
    state.job = m_workspace.startJob(
        tr("Filter %1").arg(document.name()),
        [cloud = document.cloud(), deleted = document.deleted(), text = m_text.toStdString(), notShown,
         result](Progress& progress) {
            try {
                if (!text.empty()) {
                    const expression::Condition condition(text, *cloud);
                    result->attributes = condition.attributes();
                    result->hidden = expression::selectOthers(*cloud, condition, progress);
                    if (deleted) result->hidden->remove(*deleted);
                    result->count = result->hidden->count();
                }
            } catch (const expression::ExpressionError& wrong) {
                result->error = QString::fromUtf8(wrong.what());
            }
            if (!notShown.empty() && !result->hidden) result->hidden = std::make_shared<PointSet>(cloud->size());
            if (deleted && result->hidden) result->hidden->insert(*deleted);
            for (const PointRange& range : notShown) result->hidden->insert(range);
        },
        [this, target = QPointer<Document>(&document), result, version = m_version](const JobInfo& info) {
            if (!target) return;
            const auto found = m_states.find(target.data());
            if (found == m_states.end() || found->second.job != info.id) return;  // no longer wanted
            State& now = found->second;
            now.job = 0;
            const bool fine = info.state == JobState::Finished && version == m_version;
            if (fine) {
                now.hidden = result->hidden;
                now.count = result->count;
                now.error = result->error;
                now.attributes = result->attributes;
                m_renderer.hide(target->cloud(), now.hidden ? now.hidden : target->deleted());
            }
            if (now.again || !fine) apply(*target);
            emit changed();
        },
        true);
}

const ViewFilter::State* ViewFilter::activeState() const
{
    const auto found = m_states.find(m_workspace.active());
    return found == m_states.end() ? nullptr : &found->second;
}

QString ViewFilter::error() const
{
    const State* const state = activeState();
    return state ? state->error : QString();
}

std::optional<quint64> ViewFilter::hiddenCount() const
{
    const State* const state = activeState();
    if (!state || state->job != 0) return std::nullopt;
    return state->count;
}

bool ViewFilter::looking() const
{
    return std::any_of(m_states.begin(), m_states.end(), [](const auto& state) { return state.second.job != 0; });
}

Visibility ViewFilter::visibility(const Document& document) const
{
    Visibility visibility;
    visibility.classVisible = m_settings.display().classVisible;
    visibility.clip = m_settings.display().clip;
    const auto found = m_states.find(&document);
    if (found != m_states.end()) visibility.filtered = found->second.hidden;
    return visibility;
}

}  // namespace punctum::ui
