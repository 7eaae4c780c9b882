// SPDX-License-Identifier: MIT
#include "ui/view/ShownCount.h"

#include "core/session/Session.h"
#include "core/task/Progress.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kPause = 120;  // ms without a change, while a face is dragged for example

/// How many of the hidden classes there are in the open files.
int hiddenClasses(const Workspace& workspace, const std::array<bool, 256>& visible)
{
    int hidden = 0;
    for (std::size_t code = 0; code < visible.size(); ++code) {
        if (visible[code]) continue;
        for (const Document* document : workspace.documents()) {
            const auto& counts = document->classCounts();
            if (!counts || (*counts)[code] == 0) continue;
            ++hidden;
            break;
        }
    }
    return hidden;
}

}  // namespace

ShownCount::ShownCount(Workspace& workspace, const ViewSettings& settings, const ViewFilter& filter,
                       QObject* parent)
    : QObject(parent), m_workspace(workspace), m_settings(settings), m_filter(filter)
{
    m_classes.fill(true);
    m_pause.setSingleShot(true);
    m_pause.setInterval(kPause);
    connect(&m_pause, &QTimer::timeout, this, &ShownCount::count);
    connect(&settings, &ViewSettings::changed, this, &ShownCount::lookAtSettings);
    connect(&filter, &ViewFilter::changed, this, &ShownCount::ask);
    connect(&workspace, &Workspace::documentLoaded, this, [this](const Document* document) {
        connect(document, &Document::classCountsChanged, this, &ShownCount::ask);
        ask();
    });
    connect(&workspace, &Workspace::documentRemoved, this, &ShownCount::ask);
    connect(&workspace, &Workspace::cloudChanged, this, &ShownCount::ask);
}

void ShownCount::lookAtSettings()
{
    const render::DisplaySettings& display = m_settings.display();
    if (display.classVisible == m_classes && display.clip == m_clip) return;
    m_classes = display.classVisible;
    m_clip = display.clip;
    ask();
}

void ShownCount::ask()
{
    ShownState state;
    for (const Document* document : m_workspace.documents()) {
        if (document->loading()) continue;
        state.all += document->points();
        state.deleted += document->deletedPoints();
    }
    state.shown = state.all - state.deleted;
    if (!m_filter.text().isEmpty()) state.reasons << tr("filter");
    int files = 0;
    for (const Document* document : m_workspace.documents()) files += document->hiddenParts();
    if (files != 0) state.reasons << (files == 1 ? tr("1 file") : tr("%1 files").arg(files));
    if (m_clip.box) state.reasons << tr("box");
    if (const std::size_t cuts = m_clip.planes.size(); cuts != 0)
        state.reasons << (cuts == 1 ? tr("1 cut") : tr("%1 cuts").arg(cuts));
    if (const int classes = hiddenClasses(m_workspace, m_classes); classes != 0)
        state.reasons << (classes == 1 ? tr("1 class") : tr("%1 classes").arg(classes));
    state.known = state.reasons.isEmpty();
    m_again = !state.known;
    if (m_job != 0) m_workspace.cancel(m_job);
    if (m_again)
        m_pause.start();
    else
        m_pause.stop();
    publish(std::move(state));
}

void ShownCount::count()
{
    if (m_job != 0 || m_filter.looking()) return;  // it tells when it has found the points
    m_again = false;
    std::vector<std::pair<std::shared_ptr<PointCloud>, Visibility>> clouds;
    for (const Document* document : m_workspace.documents())
        if (!document->loading()) clouds.emplace_back(document->cloud(), m_filter.visibility(*document));
    const auto shown = std::make_shared<PointIndex>(0);
    m_job = m_workspace.startJob(
        tr("Count what is shown"),
        [clouds = std::move(clouds), shown](Progress& progress) {
            for (const auto& [cloud, visibility] : clouds) {
                const auto hidden = hiddenPoints(*cloud, visibility, progress);
                *shown += cloud->size() - (hidden ? hidden->count() : 0);
            }
        },
        [this, shown](const JobInfo& info) {
            m_job = 0;
            if (m_again) return m_pause.start();
            if (info.state != JobState::Finished || m_state.known) return;
            ShownState state = m_state;
            state.shown = *shown;
            state.known = true;
            publish(std::move(state));
        },
        true);
}

void ShownCount::publish(ShownState state)
{
    m_state = std::move(state);
    emit changed();
}

QString ShownState::text() const
{
    if (!some()) return {};
    QStringList whys = reasons;
    if (deleted != 0) whys << ShownCount::tr("%1 deleted").arg(countText(deleted));
    const QString why = whys.join(QStringLiteral(", "));
    return known ? ShownCount::tr("%1 of %2 shown: %3").arg(countText(shown), countText(all), why)
                 : ShownCount::tr("Part of %1 shown: %2").arg(countText(all), why);
}

QString ShownCount::progressText(const render::FrameReport& report) const
{
    if (!report.converged) return tr("%1 % drawn").arg(int(std::floor(report.share * 100.0)));
    const auto& documents = m_workspace.documents();
    const auto loading = [](const auto& d) { return d->loading(); };
    const auto sightRead = [](const auto& d) { return !d->loading() || d->session()->readingOrder()->sightRead(); };
    if (std::any_of(documents.begin(), documents.end(), loading)) {
        if (report.current && std::all_of(documents.begin(), documents.end(), sightRead))
            return report.partly
                       ? tr("All in sight is read, and drawn as finely as this view can show; the rest follows")
                       : tr("All in sight is read and drawn; the rest follows");
        return report.partly ? tr("Points read so far are drawn, as finely as this view can show")
                             : tr("All points read so far are drawn");
    }
    if (report.partly) return tr("Drawn as finely as this view can show: %1 points").arg(countText(report.asked));
    if (!m_state.some()) return tr("All points drawn");
    if (!m_state.known) return tr("All shown points drawn");
    return m_state.shown == 0 ? tr("No point is shown")
                              : tr("All %1 shown points drawn").arg(countText(m_state.shown));
}

}  // namespace punctum::ui
