// SPDX-License-Identifier: MIT
#include "ui/docks/JobsModel.h"

#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"

#include <algorithm>

namespace punctum::ui
{

namespace
{
constexpr int kTick = 100;      // ms
constexpr int kQuietFor = 400;  // ms
}  // namespace

JobsModel::JobsModel(Workspace& workspace, QObject* parent) : QAbstractListModel(parent), m_workspace(workspace)
{
    m_timer.setInterval(kTick);
    connect(&m_timer, &QTimer::timeout, this, &JobsModel::tick);
    connect(&m_workspace, &Workspace::jobStarted, this, &JobsModel::start);
    connect(&m_workspace, &Workspace::jobEnded, this, &JobsModel::end);
}

void JobsModel::start(quint64 id, const QString& title, bool quiet)
{
    Entry entry;
    entry.info.id = id;
    entry.info.title = title.toStdString();
    entry.quiet = quiet;
    entry.clock.start();
    if (quiet)
        m_waiting.push_back(entry);
    else
        list(entry);
    if (!m_timer.isActive()) m_timer.start();  // started anew by each, it would never end while many begin
}

void JobsModel::list(Entry entry)
{
    // above what has failed
    std::size_t row = m_entries.size();
    while (row > 0 && m_entries[row - 1].info.state == JobState::Failed) --row;
    beginInsertRows({}, int(row), int(row));
    entry.listed = true;
    m_entries.insert(m_entries.begin() + std::ptrdiff_t(row), std::move(entry));
    endInsertRows();
}

void JobsModel::removeRow(std::size_t row)
{
    beginRemoveRows({}, int(row), int(row));
    m_entries.erase(m_entries.begin() + std::ptrdiff_t(row));
    endRemoveRows();
}

void JobsModel::end(const JobInfo& info)
{
    std::erase_if(m_waiting, [&](const Entry& e) { return e.info.id == info.id; });
    for (std::size_t row = 0; row < m_entries.size(); ++row) {
        if (m_entries[row].info.id != info.id) continue;
        m_entries[row].info = info;
        m_entries[row].clock.restart();
        emit dataChanged(index(int(row)), index(int(row)));
        if (m_entries[row].quiet && info.state != JobState::Failed) removeRow(row);
        break;
    }
    emit ticked();
}

void JobsModel::tick()
{
    const std::vector<JobInfo> running = m_workspace.jobs().running();  // by rising ids
    const auto find = [&](quint64 id) {
        const auto found = std::lower_bound(running.begin(), running.end(), id,
                                            [](const JobInfo& info, quint64 wanted) { return info.id < wanted; });
        return found != running.end() && found->id == id ? &*found : nullptr;
    };
    for (std::size_t i = 0; i < m_waiting.size();) {
        // The time of a job that waits for its turn has not begun; of one that has ended, the end is on its way.
        const JobInfo* const now = find(m_waiting[i].info.id);
        if (!now || now->waiting) m_waiting[i].clock.restart();
        if (m_waiting[i].clock.elapsed() < kQuietFor) {
            ++i;
            continue;
        }
        list(m_waiting[i]);
        m_waiting.erase(m_waiting.begin() + std::ptrdiff_t(i));
    }
    bool busy = !m_waiting.empty();
    for (std::size_t row = 0; row < m_entries.size();) {
        Entry& entry = m_entries[row];
        if (entry.info.state != JobState::Running) {
            if (entry.clock.elapsed() > (entry.info.state == JobState::Failed ? m_failedStays : m_endedStays)) {
                removeRow(row);
                continue;
            }
            busy = true;
            ++row;
            continue;
        }
        busy = true;
        if (const JobInfo* const now = find(entry.info.id)) {
            entry.info.stage = now->waiting ? tr("Waits for its turn").toStdString() : now->stage;
            entry.info.fraction = now->fraction;
            emit dataChanged(index(int(row)), index(int(row)));
        }
        ++row;
    }
    emit ticked();
    if (!busy) m_timer.stop();
}

void JobsModel::closeOrCancel(quint64 id)
{
    for (std::size_t row = 0; row < m_entries.size(); ++row) {
        if (m_entries[row].info.id != id) continue;
        if (m_entries[row].info.state == JobState::Running) {
            m_entries[row].cancelling = true;
            m_workspace.cancel(id);
            emit dataChanged(index(int(row)), index(int(row)));
        } else {
            removeRow(row);
        }
        return;
    }
}

int JobsModel::rowCount(const QModelIndex& parent) const
{
    return parent.isValid() ? 0 : int(m_entries.size());
}

QVariant JobsModel::data(const QModelIndex& index, int role) const
{
    if (!index.isValid() || index.row() >= rowCount()) return {};
    const Entry& entry = m_entries[std::size_t(index.row())];
    switch (role) {
        case Qt::DisplayRole:
            return toQString(entry.info.title);
        case IdRole:
            return qulonglong(entry.info.id);
        case StageRole:
            switch (entry.info.state) {
                case JobState::Running:
                    return entry.cancelling ? tr("Stopping") : toQString(entry.info.stage);
                case JobState::Finished:
                    return tr("Done");
                case JobState::Cancelled:
                    return tr("Cancelled");
                case JobState::Failed:
                    return tr("Failed");
            }
            return {};
        case StateRole:
            return int(entry.info.state);
        case FractionRole:
            return entry.info.state == JobState::Running ? entry.info.fraction : 1.0;
        case ErrorRole:
            return toQString(entry.info.error);
        default:
            return {};
    }
}

}  // namespace punctum::ui
