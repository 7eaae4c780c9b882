// SPDX-License-Identifier: MIT
#include "ui/process/StepPreview.h"

#include "core/edit/History.h"
#include "core/process/Step.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/process/StepWish.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"

#include <algorithm>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr std::size_t kMostChanges = 5;  ///< of class to class that are told

/// "1 Unclassified to 2 Ground: 1,000", a line each.
QStringList changesText(const CommandPreview& preview)
{
    QStringList lines;
    const auto& changes = preview.classes;
    for (std::size_t k = 0; k < std::min(kMostChanges, changes.size()); ++k) {
        const auto& change = changes[k];
        const QString from = classText(change.from);
        const QString what =
            change.to ? from + QStringLiteral(" ") + QChar(0x2192) + QStringLiteral(" ") + classText(*change.to)
                      : from;
        lines << StepPreview::tr("%1: %2").arg(what, countText(change.points));
    }
    if (changes.size() > kMostChanges) {
        PointIndex rest = 0;
        for (std::size_t k = kMostChanges; k < changes.size(); ++k) rest += changes[k].points;
        lines << StepPreview::tr("others: %1").arg(countText(rest));
    }
    return lines;
}

}  // namespace

StepPreview::StepPreview(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings,
                         QObject* parent)
    : QObject(parent), m_workspace(workspace), m_renderer(renderer)
{
    const auto endAll = [this] {
        end();
        endLastEdit();
    };
    connect(&m_workspace, &Workspace::cloudChanged, this,
            [this, endAll](const Document* document, const ChangeNotice&) {
                if (document->cloud() == m_cloud || document->cloud() == m_beforeCloud) endAll();
            });
    connect(&m_workspace, &Workspace::activeChanged, this, endAll);
    connect(&settings, &ViewSettings::attributeChanged, this, endAll);
    // the window takes its parts away one after the other: nothing is left to be put right then
    connect(&m_workspace, &QObject::destroyed, this, [this] { m_cloud = m_beforeCloud = nullptr; });
}

void StepPreview::begin(Document& document, const StepWish& wish)
{
    end();
    endLastEdit();
    m_cloud = document.cloud();
    const auto found = std::make_shared<Found>();
    m_job = m_workspace.startJob(
        tr("Preview of %1").arg(toQString(findStep(wish.step)->title())),
        [wish, session = document.session(), found](Progress& progress) {
            Recipe recipe{wish.step, wish.values, pointsOf(wish.scope, *session->cloud(), progress)};
            found->made = session->make(recipe, progress);
            if (!found->made.command) return;
            found->preview = previewOf(*found->made.command, *session->cloud(), progress,
                                       findStep(wish.step)->description().shows);
        },
        [this, found, number = m_number](const JobInfo& info) {
            if (number != m_number) return;
            m_job = 0;
            if (info.state == JobState::Finished && found->made.command) {
                m_found = found;
                show();
                return tell();
            }
            end();
            if (info.state == JobState::Failed) emit failed(toQString(info.error));
            if (info.state == JobState::Finished) emit told(tr("No point would change."));
        });
    m_workspace.tie(document, m_job);
    emit toggled(true);
}

void StepPreview::show()
{
    display(m_cloud, m_before ? nullptr : &m_found->preview);
}

/// In the views and in their legends; null: the points as they are.
void StepPreview::display(const std::shared_ptr<PointCloud>& cloud, const CommandPreview* preview)
{
    m_renderer.setPreview(cloud, preview != nullptr ? preview->preview : nullptr);
    Document* const document = m_workspace.find(cloud.get());
    if (document == nullptr) return;
    document->setPreviewedClasses(preview != nullptr ? preview->classes
                                                     : std::vector<CommandPreview::ClassChange>());
}

void StepPreview::tell()
{
    const CommandPreview& preview = m_found->preview;
    QString first = preview.deletes ? tr("%1 would go.").arg(pointsText(preview.changed))
                                    : tr("%1 would change.").arg(pointsText(preview.changed));
    if (!preview.preview) first = tr("There is nothing to be seen of it; Apply does it.");
    if (const std::string& finding = m_found->made.command->finding(); !finding.empty())
        first += QLatin1Char(' ') + toQString(finding);
    emit told((QStringList{first} + changesText(preview)).join(QLatin1Char('\n')));
}

void StepPreview::end()
{
    if (!on()) return;
    ++m_number;
    if (const JobId job = std::exchange(m_job, 0); job != 0) m_workspace.cancel(job);
    if (const auto found = std::exchange(m_found, nullptr)) display(m_cloud, nullptr);
    m_cloud = nullptr;
    emit toggled(false);
}

std::optional<MadeEdit> StepPreview::take()
{
    if (!m_found) return std::nullopt;
    MadeEdit made = std::move(m_found->made);
    end();
    return made;
}

void StepPreview::showBefore(bool on)
{
    if (on == m_before) return;
    m_before = on;
    if (shown())
        show();
    else if (on)
        showLastEdit();
    else
        endLastEdit();
    emit beforeToggled(on);
}

void StepPreview::showLastEdit()
{
    Document* const document = m_workspace.active();
    if (document == nullptr || document->loading() || this->on() || !document->history().canUndo()) return;
    m_beforeCloud = document->cloud();
    const auto found = std::make_shared<CommandPreview>();
    m_beforeJob = m_workspace.startJob(
        tr("State before %1").arg(toQString(document->history().undoName())),
        [found, session = document->session()](Progress& progress) {
            *found = session->history().beforeLast(progress);
        },
        [this, found, number = m_beforeNumber](const JobInfo& info) {
            if (number != m_beforeNumber) return;
            m_beforeJob = 0;
            if (info.state == JobState::Finished && found->preview) display(m_beforeCloud, found.get());
        },
        true);
    m_workspace.tie(*document, m_beforeJob);
}

void StepPreview::endLastEdit()
{
    if (!m_beforeCloud) return;
    ++m_beforeNumber;
    if (const JobId job = std::exchange(m_beforeJob, 0); job != 0) m_workspace.cancel(job);
    display(m_beforeCloud, nullptr);
    m_beforeCloud = nullptr;
}

}  // namespace punctum::ui
