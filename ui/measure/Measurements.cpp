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

}  // namespace

QString quantityText(const Quantity& quantity, const std::string& length)
{
    const QString unit = toQString(unitText(quantity.unit, length));
    QString number =
        localNumber(QString::number(quantity.value, 'f', quantity.unit == Quantity::Unit::Degrees ? 2 : 3));
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
    Entry entry{measure(document, kind, std::move(points)), &document, ++m_lastId, {}, {}};
    if (entry.measurement.quantities.empty()) return;
    m_entries.push_back(std::move(entry));
    if (kind == MeasureKind::Point) readPoint(m_entries.back());
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

Measurements::Entry* Measurements::find(quint64 id)
{
    const auto found = std::find_if(m_entries.begin(), m_entries.end(), [&](const Entry& e) { return e.id == id; });
    return found == m_entries.end() ? nullptr : &*found;
}

void Measurements::remove(quint64 id)
{
    if (std::erase_if(m_entries, [&](const Entry& e) { return e.id == id; }) != 0) emit changed();
}

void Measurements::clear()
{
    if (m_entries.empty()) return;
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
