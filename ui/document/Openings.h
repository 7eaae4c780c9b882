// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Jobs.h"

#include <QObject>
#include <QString>
#include <QStringList>

#include <deque>
#include <memory>
#include <vector>

namespace punctum::ui
{

class Document;
class Workspace;

/// Files on their way into a workspace, a few at a time. Many that were asked for together are one job in the list,
/// by which all of them can be stopped, and what there is to say of them is said at the end, once.
///
/// A part of the Workspace; GUI thread only.
class Openings final : public QObject
{
    Q_OBJECT
public:
    explicit Openings(Workspace& workspace);

    /// Files (absolute paths), without those that are open or on their way. `origin`: the folder that they were
    /// found in; empty: they were named one by one. The first that can be read becomes active.
    void open(const QStringList& paths, const QString& origin);
    /// Whether files are not documents yet, or still loading.
    bool any() const noexcept { return !m_opening.empty() || !m_waiting.empty(); }

private:
    struct Opening;
    struct Batch;
    /// Starts those that wait, as far as there is room for them.
    void startNext();
    void start(const std::shared_ptr<Opening>& opening);
    void ready(const std::shared_ptr<Opening>& opening);
    void ended(const std::shared_ptr<Opening>& opening, const JobInfo& info);
    void fail(const Opening& opening, const QString& sentence);
    void tell(const std::shared_ptr<Batch>& batch, Document& document);
    void startBatch(const std::shared_ptr<Batch>& batch);
    void endBatch(const std::shared_ptr<Batch>& batch, const JobInfo& info);

    Workspace& m_workspace;
    std::vector<std::shared_ptr<Opening>> m_opening;
    /// Begun when the window has taken in what came before, so that it is never flooded.
    std::deque<std::shared_ptr<Opening>> m_waiting;
};

}  // namespace punctum::ui
