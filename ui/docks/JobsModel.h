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

/// The jobs that run, and for a moment those that ended; errors stay until closed. GUI thread only.
class JobsModel final : public QAbstractListModel
{
    Q_OBJECT
public:
    enum Role { IdRole = Qt::UserRole, StageRole, StateRole, FractionRole, ErrorRole };

    explicit JobsModel(Workspace& workspace, QObject* parent = nullptr);

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
    std::vector<Entry> m_entries;  ///< listed
    std::vector<Entry> m_waiting;  ///< quiet ones that have not taken long yet
};

}  // namespace punctum::ui
