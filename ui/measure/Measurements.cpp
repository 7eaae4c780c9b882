// SPDX-License-Identifier: MIT
#include "ui/measure/Measurements.h"

#include "core/session/TextFile.h"
#include "core/task/Jobs.h"
#include "core/task/Progress.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"

#include <QFileInfo>

#include <algorithm>
#include <cmath>
#include <memory>
#include <shared_mutex>

namespace punctum::ui
{

namespace
{

constexpr std::size_t kNeighbors = 6;

/// What a job found out of a point.
struct PointDetails {
    std::vector<std::pair<QString, QString>> attributes;
    std::vector<NearPoint> nearest;
};

QString attributeText(const Attribute& attribute, PointIndex index)
{
    QStringList parts;
    for (std::uint32_t c = 0; c < attribute.components; ++c) parts << shownValueOf(attribute, index, c);
    QString text = parts.join(QLatin1String(", "));
    if (attribute.kind == AttributeKind::Class && !attribute.lacks(index))
        text = classText(unsigned(std::clamp(attribute.number(index), 0.0, 255.0)));
    return text;
}

/// Without what others show as well: of RGB and its three parts, the parts.
std::vector<std::pair<QString, QString>> attributesOf(const PointCloud& cloud, PointIndex index)
{
    const std::shared_lock lock(cloud.mutex());
    std::vector<std::pair<QString, QString>> all;
    for (const Attribute& a : cloud.attributes())
        if (a.components == 1 && a.kind != AttributeKind::Opaque)
            all.emplace_back(toQString(a.name), attributeText(a, index));
    return all;
}

int decimalsOf(Quantity::Unit unit)
{
    if (unit == Quantity::Unit::None) return 0;  // a number of points
    return unit == Quantity::Unit::Degrees ? 2 : 3;
}

}  // namespace

QString quantityText(const Quantity& quantity, const std::string& length)
{
    const QString unit = toQString(unitText(quantity.unit, length));
    QString number = localNumber(QString::number(quantity.value, 'f', decimalsOf(quantity.unit)));
    if (unit.isEmpty()) return number;
    return unit == QStringLiteral("°") ? number + unit : number + QLatin1Char(' ') + unit;
}

QString kindText(MeasureKind kind)
{
    switch (kind) {
        case MeasureKind::Point:
            return Measurements::tr("Point");
        case MeasureKind::Distance:
            return Measurements::tr("Distance");
        case MeasureKind::Height:
            return Measurements::tr("Height");
        case MeasureKind::Angle:
            return Measurements::tr("Angle");
        case MeasureKind::Area:
            return Measurements::tr("Area");
        case MeasureKind::Box:
            return Measurements::tr("Box");
        case MeasureKind::Volume:
            return Measurements::tr("Volume");
    }
    return {};
}

Measurements::Measurements(Workspace& workspace, QObject* parent) : QObject(parent), m_workspace(workspace)
{
    connect(&workspace, &Workspace::documentRemoved, this, [this](Document* document) {
        if (std::erase_if(m_entries, [&](const Entry& e) { return e.document == document; }) != 0) emit changed();
    });
}

Measurement Measurements::measure(const Document& document, MeasureKind kind, std::vector<MeasuredPoint> points)
{
    Measurement m;
    m.kind = kind;
    m.file = document.name().toStdString();
    m.length = document.lengthUnit().toStdString();
    m.coordinates = document.cloud()->coordinates();
    m.decimals = lengthDecimals(m.coordinates, document.viewStretch(document.bounds()));
    m.quantities = quantitiesOf(kind, points, document.viewStretch(document.bounds()));
    m.points = std::move(points);
    return m;
}

void Measurements::add(Document& document, MeasureKind kind, std::vector<MeasuredPoint> points)
{
    Entry entry{measure(document, kind, std::move(points)), &document, ++m_lastId, {}, {}, m_wish};
    if (entry.measurement.quantities.empty()) return;
    m_entries.push_back(std::move(entry));
    if (kind == MeasureKind::Point) readPoint(m_entries.back());
    if (kind == MeasureKind::Volume) startVolume(m_entries.back());
    emit changed();
    emit added(m_lastId);
}

void Measurements::readPoint(const Entry& entry)
{
    const auto details = std::make_shared<PointDetails>();
    const std::shared_ptr<const PointCloud> cloud = entry.document->cloud();
    const PointIndex index = entry.measurement.points.front().index;
    const glm::dvec3 stretch = entry.document->viewStretch(entry.document->bounds());
    m_workspace.startJob(
        tr("Look at a point"),
        [=](Progress& progress) {
            details->attributes = attributesOf(*cloud, index);
            details->nearest = nearestTo(*cloud, index, kNeighbors, stretch, progress);
        },
        [self = QPointer(this), details, id = entry.id](const JobInfo&) {
            Entry* const found = self ? self->find(id) : nullptr;
            if (found == nullptr) return;
            found->attributes = std::move(details->attributes);
            found->nearest = std::move(details->nearest);
            emit self->changed();
        },
        true);
}

void Measurements::setVolumeWish(quint64 id, const VolumeWish& wish)
{
    m_wish = wish;
    Entry* const entry = find(id);
    if (entry == nullptr || entry->measurement.kind != MeasureKind::Volume || entry->wish == wish) return;
    entry->wish = wish;
    startVolume(*entry);
    emit changed();
}

void Measurements::startVolume(Entry& entry)
{
    if (entry.job != 0) m_workspace.cancel(entry.job);
    const auto found = std::make_shared<MeasuredVolume>();
    const VolumeScope scope = m_scope ? m_scope(*entry.document) : VolumeScope{};
    entry.job = m_workspace.startJob(
        tr("Volume"),
        [found, scope, wish = entry.wish, corners = entry.measurement.points,
         cloud = std::shared_ptr<const PointCloud>(entry.document->cloud())](Progress& progress) {
            *found = measureVolume(*cloud, corners, wish, scope, progress);
        },
        [self = QPointer(this), found, id = entry.id](const JobInfo& info) {
            Entry* const measured = self ? self->find(id) : nullptr;
            if (measured != nullptr && measured->job == info.id) self->endVolume(*measured, info, *found);
        });
    m_workspace.tie(*entry.document, entry.job);
}

/// What could not be measured keeps its outline, so that another base or other points can be tried.
void Measurements::endVolume(Entry& entry, const JobInfo& info, const MeasuredVolume& found)
{
    entry.job = 0;
    Measurement& m = entry.measurement;
    if (info.state == JobState::Finished) {
        m.quantities = ui::quantitiesOf(found);
        m.facts = factsOf(found, entry.wish);
    } else {
        m.quantities = measure(*entry.document, m.kind, m.points).quantities;
        m.facts = {{"Not measured", info.state == JobState::Failed ? info.error : "cancelled"}};
        if (info.state == JobState::Failed)
            m_workspace.say(MessageKind::Warning, toQString(info.error), {}, entry.document);
    }
    emit changed();
}

Measurements::Entry* Measurements::find(quint64 id)
{
    const auto found = std::find_if(m_entries.begin(), m_entries.end(), [&](const Entry& e) { return e.id == id; });
    return found == m_entries.end() ? nullptr : &*found;
}

void Measurements::remove(quint64 id)
{
    const Entry* const entry = find(id);
    if (entry == nullptr) return;
    if (entry->job != 0) m_workspace.cancel(entry->job);
    std::erase_if(m_entries, [&](const Entry& e) { return e.id == id; });
    emit changed();
}

void Measurements::clear()
{
    if (m_entries.empty()) return;
    for (const Entry& e : m_entries)
        if (e.job != 0) m_workspace.cancel(e.job);
    m_entries.clear();
    emit changed();
}

QString Measurements::text(quint64 id) const
{
    QString all;
    for (const Entry& e : m_entries) {
        if (id != 0 && e.id != id) continue;
        const auto line = [&](const QString& name, const QString& value) {
            all += name + QLatin1Char('\t') + value + QLatin1Char('\n');
        };
        line(kindText(e.measurement.kind), toQString(e.measurement.file));
        if (e.measurement.kind != MeasureKind::Point)
            for (const Quantity& q : e.measurement.quantities)
                line(toQString(q.name), quantityText(q, e.measurement.length));
        else
            line(tr("Index"), QString::number(e.measurement.points.front().index));
        for (const auto& [name, value] : e.measurement.facts) line(toQString(name), toQString(value));
        for (const auto& [name, value] : e.attributes) line(name, value);
        for (const NearPoint& n : e.nearest)
            line(tr("Neighbor %1").arg(n.index), quantityText({"", n.distance}, e.measurement.length));
    }
    return all;
}

void Measurements::exportTo(const QString& path)
{
    std::vector<Measurement> all;
    for (const Entry& e : m_entries) all.push_back(e.measurement);
    const QString name = QFileInfo(path).fileName();
    m_workspace.startJob(
        tr("Export %1").arg(name),
        [all = std::move(all), target = toPath(path)](Progress&) { writeText(target, toCsv(all)); },
        [workspace = &m_workspace, name, count = m_entries.size()](const JobInfo& end) {
            if (end.state == JobState::Finished)
                workspace->say(MessageKind::Info,
                               count == 1 ? tr("1 measurement was written to %1.").arg(name)
                                          : tr("%1 measurements were written to %2.").arg(count).arg(name));
            else if (end.state == JobState::Failed)
                workspace->say(MessageKind::Error, toQString(end.error));
        });
}

}  // namespace punctum::ui
