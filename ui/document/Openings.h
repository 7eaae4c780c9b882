// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Jobs.h"

#include <QObject>
#include <QString>
#include <QStringList>

#include <memory>
#include <vector>

namespace punctum::ui
{

class Document;
class Workspace;

/// Files on their way into a workspace: those that were asked for together are one document, by one job.
///
/// A part of the Workspace; GUI thread only.
class Openings final : public QObject
{
    Q_OBJECT
public:
    explicit Openings(Workspace& workspace);

    /// Files (absolute paths) as one document, without those that are open or on their way. `origin`: the folder or
    /// virtual point cloud that they were found in; empty: they were named one by one.
    void open(const QStringList& paths, const QString& origin);
    /// Whether files are not documents yet, or still loading.
    bool any() const noexcept { return !m_opening.empty(); }

private:
    struct Opening;
    void start(const std::shared_ptr<Opening>& opening);
    void ready(const std::shared_ptr<Opening>& opening);
    void ended(const std::shared_ptr<Opening>& opening, const JobInfo& info);
    void tell(Document& document);

    Workspace& m_workspace;
    std::vector<std::shared_ptr<Opening>> m_opening;
};

}  // namespace punctum::ui
