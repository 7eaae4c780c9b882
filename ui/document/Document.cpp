// SPDX-License-Identifier: MIT
#include "ui/document/Document.h"

#include "core/edit/History.h"
#include "core/session/Session.h"
#include "render/camera/Camera.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"

#include <QFileInfo>

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

namespace punctum::ui
{

Document::Document(std::shared_ptr<Session> session, std::shared_ptr<render::PointStore> store, QObject* parent)
    : QObject(parent),
      m_session(std::move(session)),
      m_store(std::move(store)),
      m_facts(factsOf(*m_session->source())),
      m_units(m_session->source()->units),
      m_many(m_session->many()),
      m_path(toQString(m_session->openedPath())),
      m_recovered(m_session->damaged()),
      m_bounds(m_session->survey().firstBounds()),
      m_attributes(cloud()->attributes())  // nobody else knows the cloud's list yet
{
    const Survey& survey = m_session->survey();
    const std::set<std::string> losses(survey.losses().begin(), survey.losses().end());
    for (const std::string& loss : survey.losses()) m_losses << toQString(loss);
    m_facts.warnings.clear();
    for (const std::string& warning : survey.warnings())
        if (!losses.contains(warning)) m_facts.warnings.push_back(warning);
    if (m_many) {
        m_facts.bytes = 0;
        for (const Survey::Part& part : survey.parts()) m_facts.bytes += part.source->fileSize;
    }
    takeParts();
    m_name = fileName();
}

const std::shared_ptr<PointCloud>& Document::cloud() const noexcept
{
    return m_session->cloud();
}

const History& Document::history() const noexcept
{
    return m_session->history();
}

QString Document::fileName() const
{
    if (!m_many) return QFileInfo(m_path).fileName();
    return named() ? QFileInfo(m_origin).fileName() : tr("%1 files").arg(countText(m_parts.size()));
}

void Document::setOrigin(const QString& origin)
{
    m_origin = origin;
    m_name = fileName();
}

// -- the files

void Document::takeParts()
{
    const std::vector<SessionPart> files = m_session->parts();
    const std::vector<Survey::Part>& opened = m_session->survey().parts();
    m_parts.resize(files.size());
    for (std::size_t k = 0; k < files.size(); ++k) {
        Part& part = m_parts[k];
        part.path = toQString(files[k].path);
        part.name = toQString(files[k].path.filename());
        part.points = files[k].points;
        part.moved = opened[k].moved;
        part.damaged = files[k].damaged;
        if (part.bounds.empty() && !part.moved) part.bounds = files[k].source->firstBounds;
    }
}

std::vector<PointRange> Document::hiddenRanges() const
{
    std::vector<PointRange> ranges;
    for (const Part& part : m_parts)
        if (!part.shown) ranges.push_back(part.points);
    return ranges;
}

int Document::hiddenParts() const
{
    return int(std::count_if(m_parts.begin(), m_parts.end(), [](const Part& part) { return !part.shown; }));
}

void Document::setShown(const std::vector<std::size_t>& parts, bool shown)
{
    bool other = false;
    for (const std::size_t k : parts)
        if (k < m_parts.size()) other = std::exchange(m_parts[k].shown, shown) != shown || other;
    if (other) emit partsShownChanged();
}

void Document::showAllParts()
{
    std::vector<std::size_t> all(m_parts.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    setShown(all, true);
}

void Document::setPartFacts(const std::vector<PartFacts>& facts)
{
    for (std::size_t k = 0; k < std::min(facts.size(), m_parts.size()); ++k) {
        if (!facts[k].bounds.empty()) m_parts[k].bounds = facts[k].bounds;
        m_parts[k].crs = facts[k].crs;
    }
    emit partsChanged();
}

void Document::setChangedParts(const std::vector<bool>& changed)
{
    bool other = false;
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        const bool now = k < changed.size() && changed[k];
        other = std::exchange(m_parts[k].changed, now) != now || other;
    }
    if (other) emit partsChanged();
}

QString Document::origin() const
{
    return m_origin.isEmpty() ? m_path : m_origin;
}

void Document::setDistinction(const QString& part)
{
    const QString name = part.isEmpty() ? fileName() : QStringLiteral("%1 (%2)").arg(fileName(), part);
    if (name == std::exchange(m_name, name)) return;
    emit stateChanged();
}

double Document::loadedShare() const noexcept
{
    if (!loading()) return 1.0;
    return points() == 0 ? 0.0 : double(m_store->filled()) / double(points());
}

bool Document::modified() const
{
    return history().modified();
}

const Attribute* Document::findAttribute(const QString& name) const
{
    const std::string wanted = name.toStdString();
    for (const Attribute& attribute : m_attributes)
        if (attribute.name == wanted) return &attribute;
    return nullptr;
}

QString Document::coordinateUnit() const
{
    return toQString(m_units.horizontal);
}

QString Document::lengthUnit() const
{
    return toQString(trueLengths(m_units, {}).unit);
}

glm::dvec3 Document::viewStretch(const WorldBounds& bounds) const
{
    return trueLengths(m_units, bounds).stretch;
}

const AttributeFigures* Document::figures(const QString& name) const
{
    const auto found = m_figures.find(name);
    return found == m_figures.end() ? nullptr : &found->second;
}

const DistinctValues* Document::values(const QString& name) const
{
    const auto found = m_values.find(name);
    return found == m_values.end() ? nullptr : &found->second;
}

void Document::setLoaded(const las::ReadResult& result)
{
    m_state = State::Ready;
    for (const std::string& warning : result.warnings) m_losses << toQString(warning);  // of damaged points
    for (const PointRange& range : result.missing) m_missingPoints += range.size();
    m_recovered = m_recovered || !result.missing.empty();
    takeParts();
    m_rawBounds = result.bounds;
    m_bounds = cloud()->coordinates().toWorld(result.bounds);
    emit stateChanged();
    emit partsChanged();
}

void Document::setAttributes(std::vector<Attribute> attributes)
{
    m_attributes = std::move(attributes);
    emit attributesChanged();
}

void Document::setFigures(const QString& name, const AttributeFigures& figures)
{
    m_figures[name] = figures;
    for (int axis = 0; axis < 3; ++axis)
        if (name == QLatin1Char("XYZ"[axis])) takeBounds(axis, figures[0]);
    emit figuresChanged(name);
}

void Document::takeBounds(int axis, const AttributeStatistics& figures)
{
    // Points that could not be read are 0, and nowhere.
    if (figures.count == 0 || m_missingPoints != 0) return;
    const WorldBounds before = m_bounds;
    m_bounds.min[axis] = toDouble(figures.min);
    m_bounds.max[axis] = toDouble(figures.max);
    if (before.min != m_bounds.min || before.max != m_bounds.max) emit stateChanged();
}

void Document::setValues(const QString& name, DistinctValues values)
{
    m_values[name] = std::move(values);
}

void Document::forgetFigures(const QStringList& names)
{
    for (const QString& name : names) {
        m_figures.erase(name);
        m_values.erase(name);
    }
}

void Document::setDeleted(std::shared_ptr<const PointSet> points, PointIndex count)
{
    m_deleted = std::move(points);
    m_deletedPoints = count;
    emit stateChanged();
}

void Document::setClassCounts(const std::array<std::uint64_t, 256>& counts)
{
    m_classCounts = counts;
    emit classCountsChanged();
}

std::optional<std::array<std::uint64_t, 256>> Document::classCountsShown() const
{
    auto counts = m_classCounts;
    if (!counts) return counts;
    for (const CommandPreview::ClassChange& change : m_previewedClasses) {
        (*counts)[change.from] -= std::min<std::uint64_t>((*counts)[change.from], change.points);
        if (change.to) (*counts)[*change.to] += change.points;
    }
    return counts;
}

void Document::setPreviewedClasses(std::vector<CommandPreview::ClassChange> changes)
{
    if (changes.empty() && m_previewedClasses.empty()) return;
    m_previewedClasses = std::move(changes);
    emit previewedClassesChanged();
}

void Document::setSpacing(double spacing)
{
    m_spacing = spacing;
    emit stateChanged();
}

void Document::setUnsavedChanges(const QString& changes)
{
    if (changes == m_unsavedChanges) return;
    m_unsavedChanges = changes;
    emit stateChanged();
}

void Document::setSavedAs(const std::filesystem::path& path, LastSave save)
{
    m_lastSave = std::move(save);
    if (path != m_session->openedPath()) m_recovered = false;  // the damaged file is another one now
    if (!m_many || path != toPath(m_path)) m_origin = m_many ? toQString(path) : QString();
    m_path = toQString(path);
    m_name = fileName();  // until it is compared with the others again
    takeParts();
    emit stateChanged();
    emit partsChanged();
}

void Document::noteEdit()
{
    emit stateChanged();
}

}  // namespace punctum::ui
