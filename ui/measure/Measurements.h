// SPDX-License-Identifier: MIT
#pragma once

#include "core/measure/Measurement.h"
#include "core/measure/Nearest.h"
#include "core/task/Jobs.h"
#include "ui/measure/VolumeMeasure.h"

#include <QObject>
#include <QPointer>
#include <QString>

#include <functional>
#include <utility>
#include <vector>

namespace punctum::ui
{

class Document;
class Workspace;

/// The measurements of all open documents, in the order they were made. One goes with its document.
///
/// GUI thread only. What a point holds, and its neighbors, are read in a quiet job and come a little later.
class Measurements final : public QObject
{
    Q_OBJECT
public:
    struct Entry {
        Measurement measurement;
        QPointer<Document> document;
        quint64 id = 0;
        /// Of a Point: each attribute with its value, and the nearest points; empty until they are known.
        std::vector<std::pair<QString, QString>> attributes;
        std::vector<NearPoint> nearest;
        /// Of a Volume: how it is measured, and the job that does; 0: it is done.
        VolumeWish wish{};
        JobId job = 0;
    };

    explicit Measurements(Workspace& workspace, QObject* parent = nullptr);

    const std::vector<Entry>& entries() const noexcept { return m_entries; }
    /// With its quantities, not kept; no quantities while points are missing.
    static Measurement measure(const Document& document, MeasureKind kind, std::vector<MeasuredPoint> points);
    void add(Document& document, MeasureKind kind, std::vector<MeasuredPoint> points);
    /// How volumes are measured that are added from now on, and this one (0: none), which is measured again.
    void setVolumeWish(quint64 id, const VolumeWish& wish);
    const VolumeWish& volumeWish() const noexcept { return m_wish; }
    /// Where volumes ask which points are ground or shown.
    void setVolumeScope(std::function<VolumeScope(const Document&)> scope) { m_scope = std::move(scope); }
    void remove(quint64 id);
    void clear();
    /// Name and value in lines, with tabs between; all of them, or one.
    QString text(quint64 id = 0) const;
    /// Writes all as CSV, in a job.
    void exportTo(const QString& path);

signals:
    void changed();
    void added(quint64 id);

private:
    void readPoint(const Entry& entry);
    void startVolume(Entry& entry);
    void endVolume(Entry& entry, const JobInfo& info, const MeasuredVolume& found);
    Entry* find(quint64 id);

    Workspace& m_workspace;
    std::vector<Entry> m_entries;
    quint64 m_lastId = 0;
    VolumeWish m_wish;
    std::function<VolumeScope(const Document&)> m_scope;
};

/// "12.345 m".
QString quantityText(const Quantity& quantity, const std::string& length);
/// "Distance".
QString kindText(MeasureKind kind);

}  // namespace punctum::ui
