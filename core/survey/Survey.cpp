// SPDX-License-Identifier: MIT
#include "core/survey/Survey.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/Text.h"
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Residency.h"
#include "core/las/Crs.h"
#include "core/las/CrsChange.h"
#include "core/las/FinishSaves.h"
#include "core/las/GpsTime.h"
#include "core/las/Leftovers.h"
#include "core/las/Parallel.h"
#include "core/las/RecordBlocks.h"
#include "core/las/SourceParser.h"
#include "core/survey/Member.h"
#include "core/survey/PackedFields.h"
#include "core/task/Progress.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace punctum
{

namespace fs = std::filesystem;

namespace
{

/// Files that stay open until they are read. Of more, the only chunk of a file is not decoded to prove the header's
/// count either: that takes milliseconds a file.
constexpr std::size_t kMostOpen = 64;
constexpr std::uint64_t kDrawnBytes = 17;  ///< of a point, for drawing it
constexpr double kSameSize = 1e-7;         ///< of units, relative: a foot and a US survey foot differ by 2e-6
constexpr std::size_t kMostNamed = 3;      ///< files named in one sentence

/// A file that was opened, or why it could not be.
struct Opened {
    std::unique_ptr<las::Reader> reader;
    std::shared_ptr<const las::SourceFile> source;
    std::string failure;
};

/// Each file once, in the order of their paths: the same files are the same survey, however they are named.
std::vector<fs::path> distinct(const std::vector<fs::path>& files)
{
    std::set<fs::path> seen;
    std::vector<fs::path> once;
    for (const fs::path& file : files) {
        std::error_code error;
        const fs::path real = fs::weakly_canonical(file, error);
        if (seen.insert(error ? file : real).second) once.push_back(file);
    }
    std::sort(once.begin(), once.end());
    return once;
}

std::string nameOf(const fs::path& path)
{
    return path.filename().string();
}

/// "a.laz, b.laz, c.laz and 12 others".
std::string listOf(const std::vector<std::string>& names)
{
    std::string text;
    const std::size_t n = names.size() <= kMostNamed + 1 ? names.size() : kMostNamed;
    for (std::size_t k = 0; k < n; ++k) text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
    if (n < names.size()) text += " and " + std::to_string(names.size() - n) + " others";
    return text;
}

/// Changes from other coordinate systems into the survey's: PROJ takes milliseconds to make one, and thousands of
/// files may have the same.
class CrsChanges
{
public:
    /// Null: the points cannot be converted.
    const las::CrsChange* from(const std::string& crs, const std::string& to)
    {
        const auto [change, isNew] = m_changes.try_emplace(crs);
        if (isNew) change->second = las::CrsChange::between(crs, to);
        return change->second.get();
    }

private:
    std::map<std::string, std::unique_ptr<las::CrsChange>> m_changes;
};

/// What heights are to be multiplied with after a change, where the units of two systems differ: PROJ converts them
/// only where both systems say something on heights. Meters of the units; 0: not known.
double heightFactor(const las::CrsChange& change, const glm::dvec3& place, double from, double to)
{
    if (from <= 0.0 || to <= 0.0) return 1.0;
    std::vector<glm::dvec3> above{place, place + glm::dvec3(0.0, 0.0, 1.0)};
    change(above);
    const double done = above[1].z - above[0].z, wanted = from / to;
    return std::abs(done - 1.0) < kSameSize && std::abs(wanted - 1.0) > kSameSize ? wanted : 1.0;
}

}  // namespace

/// One changes coordinates for one thread.
struct Survey::ChangesOfThreads {
    tbb::enumerable_thread_specific<CrsChanges> own;
};

Survey::Survey() = default;

Survey::~Survey() = default;

std::unique_ptr<Survey> Survey::open(const std::vector<fs::path>& files, Progress& progress)
{
    const std::vector<fs::path> paths = distinct(files);
    if (paths.empty()) throw Error("There is no file to open.");
    std::unique_ptr<Survey> survey(new Survey());
    progress.begin(paths.size() == 1 ? "Opening" : "Opening files", paths.size());
    survey->m_warnings = las::finishSaves(paths);
    las::FolderLeftovers leftovers;
    std::vector<Opened> opened(paths.size());
    const bool keepOpen = paths.size() <= kMostOpen;
    las::KnownCrs crs;
    const las::ParseOptions options{keepOpen ? las::OnlyChunk::Prove : las::OnlyChunk::Believe, &crs};
    las::forEachInOrder(paths.size(), [&](std::vector<std::byte>&, std::size_t k) {
        progress.check();
        try {
            opened[k].reader = las::Reader::open(paths[k], &leftovers, options);
            opened[k].source = opened[k].reader->source();
            if (!keepOpen) opened[k].reader->close();
        } catch (const Error& e) {
            if (paths.size() == 1) throw;
            opened[k].failure = e.what();
        }
        progress.add(1);
    });
    PointIndex points = 0;
    std::string failure;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        Opened& o = opened[k];
        if (!o.source) {
            if (failure.empty()) failure = o.failure;
            survey->m_losses.push_back(o.failure + " It is left out.");
            continue;
        }
        survey->m_parts.push_back({paths[k], {points, points + o.source->pointCount}, o.source, false});
        survey->m_members.push_back(std::make_unique<Member>());
        survey->m_members.back()->reader = std::move(o.reader);
        points += o.source->pointCount;
    }
    if (survey->m_parts.empty()) throw Error(failure);
    survey->m_warnings.insert(survey->m_warnings.end(), survey->m_losses.begin(), survey->m_losses.end());
    survey->unite();
    return survey;
}

void Survey::unite()
{
    if (m_parts.size() == 1 && m_losses.empty()) {
        const auto& source = m_parts[0].source;
        m_cloud = m_members[0]->reader->createCloud();
        m_firstBounds = source->firstBounds;
        m_sampledBounds = source->sampledBounds;
        m_warnings.insert(m_warnings.end(), source->warnings.begin(), source->warnings.end());
        m_losses = source->losses;
        return;
    }
    const PointIndex points = m_parts.back().points.last;
    std::vector<std::shared_ptr<const las::SourceFile>> sources;
    std::vector<GridOfPart> grids;
    for (const Part& part : m_parts) {
        sources.push_back(part.source);
        grids.push_back({part.source->coordinates, part.source->firstBounds, part.points.size()});
        for (const std::string& w : part.source->warnings) m_warnings.push_back(nameOf(part.path) + ": " + w);
        for (const std::string& w : part.source->losses) m_losses.push_back(nameOf(part.path) + ": " + w);
    }
    compareFiles();
    for (std::size_t k = 0; k < m_parts.size(); ++k)
        if (m_parts[k].moved) {
            grids[k].bounds = m_members[k]->movedBounds;
            grids[k].points = 0;  // its steps are those of no axis of the survey
        }
    const CommonGrid grid = commonGrid(grids);
    RecordUnion all = uniteRecords(sources, grid.coordinates, points);
    m_cloud = std::make_shared<PointCloud>(points, grid.coordinates);
    las::makeColumns(*m_cloud, all.source->layout);
    m_cloud->setUnits(all.source->units);
    m_cloud->setSource(all.source);
    m_cloud->setArriving(std::make_shared<BlockBoxes>(points));
    m_columns.assign(m_cloud->columns().begin(), m_cloud->columns().end());

    std::vector<std::vector<PointRange>> absent(m_columns.size());
    std::vector<CloudPart> parts;
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        Member& member = *m_members[k];
        const Part& part = m_parts[k];
        member.links = std::move(all.parts[k]);
        member.grid = GridChange(part.source->coordinates, grid.coordinates);
        std::vector<bool> there(m_columns.size(), false);
        for (const FieldLink& link : member.links.fields)
            if (link.column >= 0) there[std::size_t(link.column)] = true;
        for (std::size_t c = 0; c < there.size(); ++c) {
            const bool converted = member.links.converted && isExtendedField(all.source->layout.fields[c].column);
            if (there[c] || converted || part.points.empty()) continue;
            if (!absent[c].empty() && absent[c].back().last == part.points.first)
                absent[c].back().last = part.points.last;
            else
                absent[c].push_back(part.points);
        }
        parts.push_back({part.points, part.source});
        const WorldBounds& bounds = part.moved ? member.movedBounds : part.source->firstBounds;
        m_firstBounds.include(bounds);
        if (bounds.empty()) continue;
        const glm::dvec3 low = grid.coordinates.toRaw(bounds.min), high = grid.coordinates.toRaw(bounds.max);
        for (const glm::dvec3& p : {low, high})
            m_sampledBounds.include(std::llround(std::clamp(p.x, -0x1p31, 0x1p31)),
                                    std::llround(std::clamp(p.y, -0x1p31, 0x1p31)),
                                    std::llround(std::clamp(p.z, -0x1p31, 0x1p31)));
    }
    for (std::size_t c = 0; c < absent.size(); ++c) m_columns[c]->setAbsent(std::move(absent[c]));
    m_cloud->setParts(std::move(parts));
    if (!grid.rounded.empty()) {
        std::vector<std::string> names;
        for (const std::size_t k : grid.rounded)
            if (!m_parts[k].moved) names.push_back(nameOf(m_parts[k].path));
        if (!names.empty())
            m_warnings.push_back(
                "The steps of the coordinates of " + listOf(names) +
                " do not fit those of the other files: among these they are shown to within half a "
                "step. They are saved as they are.");
    }
}

/// Coordinate systems and clocks that differ.
void Survey::compareFiles()
{
    const std::string* crs = nullptr;
    const CoordinateUnits* units = nullptr;
    const las::SourceFile* timed = nullptr;
    for (const Part& part : m_parts) {
        if (crs == nullptr && !part.source->crs.empty()) {
            crs = &part.source->crs;
            units = &part.source->units;
        }
        if (timed == nullptr && las::hasGpsTime(part.source->layout.shownFormat())) timed = part.source.get();
    }
    std::map<std::string, bool> same;                        // by text: PROJ is asked once for each
    std::map<std::pair<std::string, double>, bool> inUnits;  // likewise
    const auto inItsUnits = [&](const CoordinateUnits& of, const std::string& system) {
        const auto [is, isNew] = inUnits.try_emplace({system, of.horizontalSize});
        if (isNew) is->second = las::isInUnitsOf(of, system);
        return is->second;
    };
    const auto sameSize = [](double a, double b) {
        return a <= 0.0 || b <= 0.0 || std::abs(a / b - 1.0) < kSameSize;
    };
    CrsChanges changes;
    std::vector<std::string> moved, others, unknown, clocks;
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        Part& part = m_parts[k];
        const las::SourceFile& source = *part.source;
        if (las::hasGpsTime(source.layout.shownFormat()) &&
            las::gpsClock(source.header) != las::gpsClock(timed->header))
            clocks.push_back(nameOf(part.path));
        if (crs == nullptr || part.points.empty()) continue;
        if (source.crs.empty()) {
            unknown.push_back(nameOf(part.path));
            continue;
        }
        const auto known = same.find(source.crs);
        const bool equal = known != same.end()
                               ? known->second
                               : same.emplace(source.crs, las::sameCrs(*crs, source.crs)).first->second;
        // a file may state another unit than its system has, which is believed
        if (equal && sameSize(source.units.horizontalSize, units->horizontalSize) &&
            sameSize(source.units.verticalSize, units->verticalSize))
            continue;
        const las::CrsChange* const change =
            !equal && inItsUnits(source.units, source.crs) && inItsUnits(*units, *crs)
                ? changes.from(source.crs, *crs)
                : nullptr;
        if (change == nullptr || source.firstBounds.empty()) {
            others.push_back(nameOf(part.path));
            continue;
        }
        std::vector<glm::dvec3> corners;
        for (unsigned c = 0; c < 8; ++c)
            corners.emplace_back((c & 1u) != 0 ? source.firstBounds.max.x : source.firstBounds.min.x,
                                 (c & 2u) != 0 ? source.firstBounds.max.y : source.firstBounds.min.y,
                                 (c & 4u) != 0 ? source.firstBounds.max.z : source.firstBounds.min.z);
        const double heights = heightFactor(*change, 0.5 * (source.firstBounds.min + source.firstBounds.max),
                                            source.units.verticalSize, units->verticalSize);
        (*change)(corners);
        for (glm::dvec3& p : corners) p.z *= heights;
        WorldBounds bounds;
        for (const glm::dvec3& p : corners)
            if (!std::isnan(p.x)) bounds.include(WorldBounds{p, p});
        if (bounds.empty()) {
            others.push_back(nameOf(part.path));
            continue;
        }
        part.moved = true;
        m_members[k]->movedBounds = bounds;
        m_members[k]->heights = heights;
        m_members[k]->from = source.crs;
        m_members[k]->to = *crs;
        moved.push_back(nameOf(part.path));
    }
    const auto say = [&](const std::vector<std::string>& names, const std::string& one,
                         const std::string& several) {
        if (!names.empty()) m_warnings.push_back(listOf(names) + (names.size() == 1 ? one : several));
    };
    const std::string system = crs != nullptr ? las::crsName(*crs) : std::string();
    say(moved, " has another coordinate system; its points are shown in " + system + ", and saved as they are.",
        " have another coordinate system; their points are shown in " + system + ", and saved as they are.");
    say(others,
        " has another coordinate system or unit, which cannot be converted: its points may be in a wrong place.",
        " have another coordinate system or unit, which cannot be converted: their points may be in a wrong "
        "place.");
    say(unknown, " states no coordinate system; it is taken to be " + system + ".",
        " state no coordinate system; it is taken to be " + system + ".");
    say(clocks, " counts GPS times in another way than the first file that has them.",
        " count GPS times in another way than the first file that has them.");
}

std::size_t Survey::partOf(PointIndex point) const noexcept
{
    const auto after = std::upper_bound(m_parts.begin(), m_parts.end(), point,
                                        [](PointIndex p, const Part& part) { return p < part.points.last; });
    return std::min(std::size_t(after - m_parts.begin()), m_parts.size() - 1);
}

// -- reading

/// The array in which all parts keep a field of this kind for themselves. What no part writes to takes no memory.
std::shared_ptr<Column> Survey::ownColumn(const las::RecordField& field)
{
    const std::string key = field.column + '\0' + char(field.type) + std::to_string(field.components);
    const std::lock_guard lock(m_mutex);
    std::shared_ptr<Column>& column = m_own[key];
    if (!column) column = std::make_shared<Column>(field.column, field.type, m_cloud->size(), field.components);
    return column;
}

/// Whether the part keeps the field for itself.
bool Survey::isOwn(std::size_t part, std::size_t field) const
{
    const Member& member = *m_members[part];
    if (field < 3) return !member.grid.same() || m_parts[part].moved;
    return member.links.fields[field].column < 0 &&
           !(member.links.converted &&
             isClassicField(m_parts[part].source->layout.field(std::int32_t(field)).column));
}

/// The columns that the part's reader fills.
std::shared_ptr<PointCloud> Survey::readingView(std::size_t part)
{
    const Part& p = m_parts[part];
    Member& member = *m_members[part];
    auto view = std::make_shared<PointCloud>(p.points.size(), p.source->coordinates);
    member.own.resize(member.links.fields.size());
    for (std::size_t k = 0; k < member.links.fields.size(); ++k) {
        const las::RecordField& field = p.source->layout.field(std::int32_t(k));
        const std::int32_t shared = member.links.fields[k].column;
        if (isOwn(part, k))
            view->addColumn(member.own[k] = std::make_shared<Column>(field.column, ownColumn(field), p.points));
        else if (shared >= 0)
            view->addColumn(std::make_shared<Column>(field.column, m_columns[std::size_t(shared)], p.points));
        else  // converted at once
            view->addColumn(std::make_shared<Column>(field.column, field.type, p.points.size(), field.components));
    }
    view->setSource(p.source);
    return view;
}

/// What is done with the points of a part while its file is read: they get their places in the survey.
class Survey::PartReading
{
public:
    PartReading(Survey& survey, std::size_t part, ChangesOfThreads& changes)
        : m_survey(survey),
          m_part(survey.m_parts[part]),
          m_member(*survey.m_members[part]),
          m_changes(changes),
          m_ownGrid(survey.isOwn(part, 0))
    {
        if (!m_member.view) m_member.view = survey.readingView(part);
        for (std::size_t axis = 0; axis < 3; ++axis)
            m_shared[axis] = survey.m_columns[axis]->values<std::int32_t>().data() + m_part.points.first;
    }
    PointCloud& view() const noexcept { return *m_member.view; }
    PointRange inSurvey(PointRange range) const noexcept
    {
        return {m_part.points.first + range.first, m_part.points.first + range.last};
    }
    bool hasOwnGrid() const noexcept { return m_ownGrid; }
    /// Of all points that arrived.
    const RawBounds& bounds() const noexcept { return m_bounds; }

    /// Points of the file that its reader has put into the view before all others. Any thread.
    void arrivedAhead(PointRange range)
    {
        if (m_ownGrid) (void)place(range);
        if (m_member.links.converted) convert(range);
        const auto first = std::size_t(range.first);
        m_survey.m_cloud->arriving()->includeAhead(inSurvey(range), m_shared[0] + first, m_shared[1] + first,
                                                   m_shared[2] + first);
    }
    /// Points of the file that its reader has put into the view. Any thread.
    void arrived(PointRange range)
    {
        const std::size_t beyond = m_ownGrid ? place(range) : 0;
        if (m_member.links.converted) convert(range);
        const auto first = std::size_t(range.first);
        const RawBounds box = m_survey.m_cloud->arriving()->include(inSurvey(range), m_shared[0] + first,
                                                                    m_shared[1] + first, m_shared[2] + first);
        if (!m_ownGrid) return;
        const std::lock_guard lock(m_mutex);
        m_bounds.include(box);
        m_member.beyond += beyond;
    }

    /// They have been handed on: the survey's coordinates of a part that keeps its own are not needed at once.
    void handedOn(PointRange range) const noexcept
    {
        if (!m_ownGrid) return;  // the reader does it
        for (const std::int32_t* const axis : m_shared)
            Residency::instance().leave(reinterpret_cast<const std::byte*>(axis + range.first),
                                        std::size_t(range.size()) * sizeof(std::int32_t));
    }

private:
    /// Returns how many coordinates lie beyond what the survey's grid can hold.
    std::size_t place(PointRange range)
    {
        const auto first = std::size_t(range.first), n = std::size_t(range.size());
        std::size_t beyond = 0;
        if (!m_part.moved) {
            const std::int32_t* const own[3] = {view().rawX().data(), view().rawY().data(), view().rawZ().data()};
            for (int axis = 0; axis < 3; ++axis)
                beyond += m_member.grid(axis, {own[axis] + first, n}, m_shared[axis] + first);
            return beyond;
        }
        std::vector<glm::dvec3> points(n);
        for (std::size_t i = 0; i < n; ++i) points[i] = view().world(range.first + i);
        if (const auto* const change = m_changes.own.local().from(m_member.from, m_member.to)) (*change)(points);
        if (m_member.heights != 1.0)
            for (glm::dvec3& point : points) point.z *= m_member.heights;
        for (std::size_t i = 0; i < n; ++i) {
            const glm::dvec3 raw = m_survey.m_cloud->coordinates().toRaw(points[i]);
            for (int axis = 0; axis < 3; ++axis) {
                const double v = std::floor(raw[axis] + 0.5), c = std::clamp(v, -0x1p31, 0x1p31 - 1);
                beyond += std::size_t(!(v == c));
                m_shared[axis][first + i] = c == c ? std::int32_t(c) : 0;
            }
        }
        return beyond;
    }
    void convert(PointRange range)
    {
        const auto mine = [&](const char* name) {
            const auto& column = view().columns()[std::size_t(m_part.source->layout.find(name))];
            return column->data() + range.first * column->elementBytes();
        };
        const auto theirs = [&](const char* name) {
            const auto& column = m_survey.m_columns[std::size_t(m_survey.source()->layout.find(name))];
            return column->data() + (m_part.points.first + range.first) * column->elementBytes();
        };
        toExtended(
            {reinterpret_cast<std::uint8_t*>(mine("Returns")), reinterpret_cast<std::uint8_t*>(mine("Classes")),
             reinterpret_cast<std::int8_t*>(mine("ScanAngle"))},
            {reinterpret_cast<std::uint8_t*>(theirs("Returns")), reinterpret_cast<std::uint8_t*>(theirs("Flags")),
             reinterpret_cast<std::uint8_t*>(theirs("Classification")),
             reinterpret_cast<std::int16_t*>(theirs("ScanAngle"))},
            std::size_t(range.size()));
    }

    Survey& m_survey;
    const Part& m_part;
    Member& m_member;
    ChangesOfThreads& m_changes;
    bool m_ownGrid;
    std::int32_t* m_shared[3] = {};  ///< the part's coordinates in the survey
    std::mutex m_mutex;
    RawBounds m_bounds;
};

/// The first points of chunks all over the survey, of each file some. What cannot be read is told of by read().
void Survey::readFirsts(const Ahead& ahead, ChangesOfThreads& changes, Progress& progress)
{
    const PointIndex all = m_cloud->size();
    if (all == 0 || all < ahead.from) return;
    const bool beyond = all * (source()->layout.length + kDrawnBytes) > memoryBudget();
    const std::uint64_t points = beyond ? ahead.pointsBeyond : ahead.points;
    const std::vector<std::uint32_t> order = las::spreadOrder(std::uint32_t(m_parts.size()));
    // One chunk of each file, then the others: all of the survey is seen a little before any of it is seen better.
    for (const bool one : {true, false})
        las::forEachInOrder(m_parts.size(), [&](std::vector<std::byte>&, std::size_t turn) {
            const std::size_t k = order[turn];
            Member& member = *m_members[k];
            progress.check();
            const double share = double(m_parts[k].points.size()) / double(all);
            las::Reader::Pieces pieces{std::size_t(double(ahead.chunks) * share) + 1, one ? 0u : 1u, 1};
            if (!one) pieces.last = pieces.count;
            if (pieces.first >= pieces.last) return;
            try {
                las::Reader& reader = *member.reader;
                std::vector<PointRange> found;
                if (many()) {
                    PartReading reading(*this, k, changes);
                    reader.reopen();
                    found = reader.readFirsts(reading.view(), pieces, points, progress, [&](PointRange range) {
                        reading.arrivedAhead(range);
                        ahead.sink(reading.inSurvey(range));
                    });
                    if (m_parts.size() > kMostOpen) reader.close();
                } else {
                    found = reader.readFirsts(*m_cloud, pieces, points, progress, ahead.sink);
                }
                const auto before = std::ptrdiff_t(member.firsts.size());
                member.firsts.insert(member.firsts.end(), found.begin(), found.end());
                std::inplace_merge(member.firsts.begin(), member.firsts.begin() + before, member.firsts.end(),
                                   [](const PointRange& a, const PointRange& b) { return a.first < b.first; });
            } catch (const Error&) {
                // read() meets the same, and tells of it
            }
        });
}

las::ReadResult Survey::readPart(std::size_t part, ChangesOfThreads& changes, Progress& progress,
                                 const las::Reader::BatchSink& sink)
{
    Member& member = *m_members[part];
    const std::unique_ptr<las::Reader> reader = std::move(member.reader);  // which closes the file in the end
    reader->reopen();
    PartReading reading(*this, part, changes);
    las::ReadResult result = reader->read(
        reading.view(), progress,
        [&](PointRange range) {
            reading.arrived(range);
            if (sink) sink(reading.inSurvey(range));
            reading.handedOn(range);
        },
        member.firsts);
    if (reading.hasOwnGrid()) result.bounds = reading.bounds();
    if (member.beyond != 0)
        result.warnings.push_back(
            grouped(member.beyond) +
            " coordinates lie too far away from the other files, and are shown at the edge of "
            "what one survey can hold; they are saved as they are.");
    member.view.reset();
    return result;
}

las::ReadResult Survey::read(Progress& progress, const las::Reader::BatchSink& sink, const Ahead& ahead)
{
    const Residency::Filling filling;
    ChangesOfThreads changes;
    if (ahead.sink) readFirsts(ahead, changes, progress);
    if (!many()) {
        las::ReadResult result = m_members[0]->reader->read(*m_cloud, progress, sink, m_members[0]->firsts);
        m_members[0]->reader.reset();  // closes the file
        return result;
    }
    const Progress::Whole whole(progress, "Reading points", m_cloud->size());
    std::vector<las::ReadResult> results(m_parts.size());
    std::vector<std::string> failures(m_parts.size());
    const std::vector<std::uint32_t> order = las::spreadOrder(std::uint32_t(m_parts.size()));
    las::forEachInOrder(m_parts.size(), [&](std::vector<std::byte>&, std::size_t turn) {
        const std::size_t k = order[turn];
        progress.check();
        try {
            results[k] = readPart(k, changes, progress, sink);
        } catch (const Error& e) {
            failures[k] = e.what();
        }
    });
    progress.check();
    las::ReadResult all;
    std::size_t failed = 0;
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        const Part& part = m_parts[k];
        las::ReadResult& one = results[k];
        if (!failures[k].empty()) {
            ++failed;
            one = {};
            one.missing.push_back({0, part.points.size()});
            all.warnings.push_back(failures[k] + " Its points are missing.");
            las::PointsAsRead read;
            read.missing = one.missing;
            part.source->asRead->set(read);
        }
        for (const std::string& w : one.warnings) all.warnings.push_back(nameOf(part.path) + ": " + w);
        for (const PointRange& gone : one.missing)
            if (!gone.empty())
                all.missing.push_back({part.points.first + gone.first, part.points.first + gone.last});
        if (!one.bounds.empty()) all.bounds.include(one.bounds);
        m_members[k]->reader.reset();
    }
    if (failed == m_parts.size()) throw Error(failures.front());
    las::PointsAsRead read;
    read.missing = all.missing;
    source()->asRead->set(std::move(read));  // whoever writes all into one file leaves them out
    return all;
}

}  // namespace punctum
