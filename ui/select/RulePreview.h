// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Preview.h"
#include "core/task/Jobs.h"

#include <QObject>
#include <QString>

#include <memory>

namespace punctum
{
class PointCloud;
}
namespace punctum::expression
{
class Rule;
}

namespace punctum::ui
{

class Document;
class ViewRenderer;
class ViewSettings;
class Workspace;

/// Shows in all views how the points would look after a rule, without changing the cloud, until it is ended: by
/// end(), by any change of the document, by another document or another attribute that is shown.
///
/// GUI thread only; every call returns at once, and the work is done by a job, which end() cancels.
class RulePreview final : public QObject
{
    Q_OBJECT
public:
    RulePreview(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings,
                QObject* parent = nullptr);

    /// Instead of the one before. `within`: the points that may change; null: all.
    void begin(const Document& document, const expression::Rule& rule, std::shared_ptr<const PointSet> within);
    void end();
    /// It is shown, or being worked out.
    bool on() const noexcept { return m_cloud != nullptr; }

signals:
    /// What would change, or why nothing can be shown.
    void told(const QString& sentence);
    /// What is wrong with the rule.
    void failed(const QString& sentence);
    void toggled(bool on);

private:
    struct Found;
    void show(const Found& found);

    Workspace& m_workspace;
    ViewRenderer& m_renderer;
    std::shared_ptr<const PointCloud> m_cloud;
    JobId m_job = 0;
    std::uint64_t m_number = 0;  ///< of the preview: what a job brings for one before is dropped
};

}  // namespace punctum::ui
