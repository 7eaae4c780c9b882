// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Jobs.h"

#include <QAbstractListModel>
#include <QElapsedTimer>
#include <QTimer>

#include <vector>

namespace punctum::ui
{

class Workspace;

/// The jobs that run, and for a while those that ended. Why one failed is told where its work was asked for, so
/// that here it is a hint. GUI thread only.
class JobsModel final : public QAbstractListModel
{
    Q_OBJECT
public:
    enum Role { IdRole = Qt::UserRole, StageRole, StateRole, FractionRole, ErrorRole };

    explicit JobsModel(Workspace& workspace, QObject* parent = nullptr);

    /// How long what has ended, and what has failed, is listed.
    void setStay(int endedMs, int failedMs)
    {
        m_endedStays = endedMs;
        m_failedStays = failedMs;
    }
    /// A finished entry goes, a running job is asked to stop.
    void closeOrCancel(quint64 id);
    const JobInfo& info(int row) const { return m_entries[std::size_t(row)].info; }

    int rowCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;

signals:
    /// Comes some ten times a second while jobs run: progress may be read anew.
    void ticked();

private:
    struct Entry {
        JobInfo info;
        bool quiet = false;  ///< only listed while it runs, and only when it takes long
        bool listed = false;
        QElapsedTimer clock;  ///< since its start, then since its end
        bool cancelling = false;
    };
    void start(quint64 id, const QString& title, bool quiet);
    void end(const JobInfo& info);
    void tick();
    void list(Entry entry);
    void removeRow(std::size_t row);

    Workspace& m_workspace;
    QTimer m_timer;
    int m_endedStays = 2500, m_failedStays = 10000;  ///< ms
    std::vector<Entry> m_entries;                    ///< listed
    std::vector<Entry> m_waiting;                    ///< quiet ones that have not taken long yet
};

}  // namespace punctum::ui
