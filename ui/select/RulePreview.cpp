// SPDX-License-Identifier: MIT
#include "ui/select/RulePreview.h"

#include "core/cloud/PointCloud.h"
#include "core/expression/Rule.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"

#include <algorithm>
#include <array>
#include <shared_mutex>
#include <utility>
#include <vector>

namespace punctum::ui
{

namespace
{

/// "1,000 of 1 Unclassified, 204 of 5 High Vegetation", the most frequent first.
QString classesText(const std::array<std::uint64_t, 256>& counts)
{
    constexpr std::size_t kMost = 4;
    std::vector<unsigned> codes;
    for (unsigned code = 0; code < counts.size(); ++code)
        if (counts[code] != 0) codes.push_back(code);
    std::stable_sort(codes.begin(), codes.end(), [&](unsigned a, unsigned b) { return counts[a] > counts[b]; });
    QStringList parts;
    for (std::size_t k = 0; k < std::min(kMost, codes.size()); ++k)
        parts << RulePreview::tr("%1 of %2").arg(countText(counts[codes[k]]), classText(codes[k]));
    if (codes.size() > kMost) parts << RulePreview::tr("others");
    return parts.join(QStringLiteral(", "));
}

}  // namespace

struct RulePreview::Found {
    std::shared_ptr<const Preview> preview;  ///< null: nothing would change
    PointIndex count = 0;
    QString now, after;  ///< classes of the points; empty where there are none, and where they would not change

    void countClasses(const PointCloud& cloud, Progress& progress)
    {
        PointSet others = *preview->points;
        others.invert();
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const classes = cloud.findAttribute("Classification");
        if (classes == nullptr) return;
        now = classesText(countValues(*classes, progress, &others));
        if (preview->attributes.front().name == classes->name)
            after = classesText(countValues(preview->attributes.front(), progress, &others));
    }
};

RulePreview::RulePreview(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings,
                         QObject* parent)
    : QObject(parent), m_workspace(workspace), m_renderer(renderer)
{
    connect(&m_workspace, &Workspace::cloudChanged, this, [this](const Document* document, const ChangeNotice&) {
        if (document->cloud() == m_cloud) end();
    });
    connect(&m_workspace, &Workspace::activeChanged, this, &RulePreview::end);
    connect(&settings, &ViewSettings::attributeChanged, this, &RulePreview::end);
    // the window takes its parts away one after the other: nothing is left to be put right then
    connect(&m_workspace, &QObject::destroyed, this, [this] { m_cloud = nullptr; });
}

void RulePreview::begin(const Document& document, const expression::Rule& rule,
                        std::shared_ptr<const PointSet> within)
{
    end();
    m_cloud = document.cloud();
    const auto found = std::make_shared<Found>();
    m_job = m_workspace.startJob(
        tr("Preview of the rule"),
        [rule, cloud = m_cloud, within = std::move(within), found](Progress& progress) {
            found->preview = rule.preview(*cloud, within.get(), progress);
            if (!found->preview) return;
            found->count = found->preview->points->count();
            found->countClasses(*cloud, progress);
        },
        [this, found, number = m_number](const JobInfo& info) {
            if (number != m_number) return;
            m_job = 0;
            if (info.state == JobState::Finished && found->preview) return show(*found);
            end();
            if (info.state == JobState::Failed) emit failed(toQString(info.error));
            if (info.state == JobState::Finished) emit told(tr("No point would change."));
        },
        true);
    emit toggled(true);
}

void RulePreview::show(const Found& found)
{
    m_renderer.setPreview(m_cloud, found.preview);
    QStringList lines{tr("%1 would change.").arg(pointsText(found.count))};
    if (!found.now.isEmpty()) lines << tr("Now: %1.").arg(found.now);
    if (!found.after.isEmpty()) lines << tr("Then: %1.").arg(found.after);
    emit told(lines.join(QLatin1Char('\n')));
}

void RulePreview::end()
{
    if (!on()) return;
    ++m_number;
    if (const JobId job = std::exchange(m_job, 0); job != 0)
        m_workspace.cancel(job);
    else
        m_renderer.setPreview(m_cloud, nullptr);
    m_cloud = nullptr;
    emit toggled(false);
}

}  // namespace punctum::ui
