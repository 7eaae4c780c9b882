// SPDX-License-Identifier: MIT
// How the points of a survey come from its files.
#include "core/Error.h"
#include "core/Memory.h"
#include "core/Text.h"
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Residency.h"
#include "core/las/Parallel.h"
#include "core/las/RecordBlocks.h"
#include "core/survey/Member.h"
#include "core/survey/Overview.h"
#include "core/survey/PackedFields.h"
#include "core/survey/ReadingOrder.h"
#include "core/survey/Survey.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <iterator>
#include <list>
#include <optional>
#include <system_error>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::uint64_t kDrawnBytes = 17;  ///< of a point, for drawing it
/// Of where the first points of a chunk and those of the next one are, by which the box is larger that the chunk is
/// likely to be in, to each side: points of scanners and of tiles come about one after another.
constexpr double kBoxMargin = 0.5;
/// Of the files: where fewer are in sight, these are read before more first points of the others.
constexpr double kFew = 0.25;

}  // namespace

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

/// What is kept for the next opening, without pieces yet; null for surveys made of files that are no more.
std::unique_ptr<Overview> Survey::overview() const
{
    std::vector<Overview::Of> files;
    for (const Part& part : m_parts) {
        const las::RecordLayout& layout = part.source->layout;
        const las::CurrentFile file = part.source->current->get();
        std::error_code error;
        Overview::Of of{std::filesystem::absolute(part.path, error), file.stamp, part.points.size(), {}, 0};
        if (error) return nullptr;
        for (std::size_t k = 0; k < layout.fields.size() + layout.derived.size(); ++k) {
            const las::RecordField& field = layout.field(std::int32_t(k));
            of.layout += field.column + ' ' + std::to_string(int(field.type)) + ' ' +
                         std::to_string(field.components) + '\n';
            of.bytes += field.bytes();
        }
        files.push_back(std::move(of));
    }
    return std::make_unique<Overview>(std::move(files));
}

void Survey::forgetOverview() const noexcept
{
    try {
        if (const auto kept = overview()) kept->forget();
    } catch (const std::exception&) {
        // without memory for its name it stays
    }
}

/// The values of points that were read.
void Survey::keepOf(Overview& overview, std::size_t part, PointRange points) const
{
    const Member& member = *m_members[part];
    const PointCloud& from = many() ? *member.view : *m_cloud;
    const las::RecordLayout& layout = m_parts[part].source->layout;
    Overview::Piece piece{part, points, {}};
    for (std::size_t k = 0; k < layout.fields.size() + layout.derived.size(); ++k) {
        const std::uint32_t bytes = layout.field(std::int32_t(k)).bytes();
        const std::byte* const first = from.columns()[k]->data() + points.first * bytes;
        piece.values.insert(piece.values.end(), first, first + points.size() * bytes);
    }
    overview.add(std::move(piece));
}

/// Shows what was kept. The points are read like all others, and then take the place of these.
void Survey::show(const Overview& overview, const Ahead& ahead, ChangesOfThreads& changes, Progress& progress)
{
    std::vector<std::vector<const Overview::Piece*>> ofParts(m_parts.size());
    for (const Overview::Piece& piece : overview.pieces()) ofParts[piece.of].push_back(&piece);
    const std::vector<std::uint32_t> order = las::spreadOrder(std::uint32_t(m_parts.size()));
    las::forEachInOrder(m_parts.size(), [&](std::vector<std::byte>&, std::size_t turn) {
        const std::size_t k = order[turn];
        progress.check();
        if (ofParts[k].empty()) return;
        const las::RecordLayout& layout = m_parts[k].source->layout;
        Member& member = *m_members[k];
        std::optional<PartReading> reading;
        if (many()) reading.emplace(*this, k, changes);
        const PointCloud& to = many() ? reading->view() : *m_cloud;
        for (const Overview::Piece* const piece : ofParts[k]) {
            const PointRange& range = piece->points;
            const PointRange inSurvey{m_parts[k].points.first + range.first, m_parts[k].points.first + range.last};
            const std::byte* from = piece->values.data();
            for (std::size_t c = 0; c < layout.fields.size() + layout.derived.size(); ++c) {
                const std::uint32_t bytes = layout.field(std::int32_t(c)).bytes();
                std::memcpy(to.columns()[c]->data() + range.first * bytes, from, range.size() * bytes);
                from += range.size() * bytes;
            }
            if (reading) reading->arrivedAhead(range);
            ahead.sink(inSurvey);
            member.kept.push_back(range);
            member.firstBoxes[range.first] = m_cloud->coordinates().toWorld(boundsOf(*m_cloud, inSurvey));
        }
    });
}

/// Whether most of the files are out of sight: somebody waits for the others.
bool Survey::looksAtFew(const ReadingOrder& order) const
{
    const auto sight = order.sight();
    if (!sight) return false;
    std::size_t seen = 0;
    for (std::size_t k = 0; k < m_parts.size(); ++k) seen += !boxOf(k).empty() && (*sight)(boxOf(k)) > 0.0 ? 1 : 0;
    return double(seen) < kFew * double(m_parts.size());
}

/// The first points of chunks all over the survey, of each file some. What cannot be read is told of by read().
/// `overview` has those of one chunk of each file already, or gets them.
void Survey::readFirsts(const Ahead& ahead, Overview* overview, const ReadingOrder& order,
                        ChangesOfThreads& changes, Progress& progress)
{
    const PointIndex all = m_cloud->size();
    if (all == 0 || all < ahead.from) return;
    const bool known = overview != nullptr && !overview->pieces().empty();
    if (known) show(*overview, ahead, changes, progress);
    const bool beyond = all * (source()->layout.length + kDrawnBytes) > memoryBudget();
    const std::uint64_t points = beyond ? ahead.pointsBeyond : ahead.points;
    const std::vector<std::uint32_t> turns = las::spreadOrder(std::uint32_t(m_parts.size()));
    const std::uint64_t room = known || overview == nullptr ? 0 : overview->room(points);
    std::atomic<std::uint64_t> looks{0};
    std::atomic<bool> enough{false};
    // One chunk of each file, then the others: all of the survey is seen a little before any of it is seen better,
    // and then what somebody jumps to is more urgent.
    for (const bool one : {true, false}) {
        if (one && known) continue;
        las::forEachInOrder(m_parts.size(), [&](std::vector<std::byte>&, std::size_t turn) {
            const std::size_t k = turns[turn];
            Member& member = *m_members[k];
            progress.check();
            if (!one && looks.exchange(order.looks()) != order.looks()) enough = looksAtFew(order);
            if (!one && enough) return;
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
                for (const PointRange& range : found) {
                    if (one && room != 0)
                        keepOf(*overview, k, {range.first, std::min(range.last, range.first + room)});
                    member.firstBoxes[range.first] = m_cloud->coordinates().toWorld(boundsOf(
                        *m_cloud, {m_parts[k].points.first + range.first, m_parts[k].points.first + range.last}));
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
}

/// Where the points of each piece are likely to be, as far as first points tell.
std::vector<WorldBounds> Survey::likelyBoxes(std::size_t part) const
{
    const Member& member = *m_members[part];
    if (member.firstBoxes.empty()) return {};
    const las::Reader& reader = *member.reader;
    const WorldBounds whole = boxOf(part);
    std::vector<WorldBounds> boxes(reader.pieces());
    for (std::size_t k = 0; k + 1 < boxes.size(); ++k) {
        const auto here = member.firstBoxes.find(reader.pointsOf(k).first),
                   next = member.firstBoxes.find(reader.pointsOf(k + 1).first);
        if (here == member.firstBoxes.end() || next == member.firstBoxes.end()) continue;
        WorldBounds box = here->second;
        box.include(next->second);
        const glm::dvec3 size = box.max - box.min;
        const double margin = kBoxMargin * std::max(size.x, size.y);
        for (int axis = 0; axis < 2; ++axis) {
            box.min[axis] = std::max(whole.min[axis], box.min[axis] - margin);
            box.max[axis] = std::min(whole.max[axis], box.max[axis] + margin);
        }
        box.min.z = whole.min.z;
        box.max.z = whole.max.z;
        if (box.min.x <= box.max.x && box.min.y <= box.max.y) boxes[k] = box;
    }
    return boxes;
}

/// Where the points of each piece are, once all have been read, and all of the part is in `exact`; none where some
/// are nowhere.
std::vector<WorldBounds> Survey::readBoxes(std::size_t part, const RawBounds& exact) const
{
    const las::Reader& reader = *m_members[part]->reader;
    const auto blocks = m_cloud->boxes();
    if (!blocks || exact.empty()) return {};
    const WorldBounds whole = m_cloud->coordinates().toWorld(exact);
    std::vector<WorldBounds> boxes(reader.pieces());
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        const PointRange points = reader.pointsOf(k);
        const PointIndex first = m_parts[part].points.first + points.first,
                         last = m_parts[part].points.first + points.last;
        RawBounds box;
        for (PointIndex block = first / BlockBoxes::kPoints; block * BlockBoxes::kPoints < last; ++block)
            box.include((*blocks)[std::size_t(block)]);
        if (box.empty()) return {};
        boxes[k] = m_cloud->coordinates().toWorld(box);
        // a block may have points of the next file, too
        for (int axis = 0; axis < 3; ++axis) {
            boxes[k].min[axis] = std::max(boxes[k].min[axis], whole.min[axis]);
            boxes[k].max[axis] = std::min(boxes[k].max[axis], whole.max[axis]);
        }
    }
    return boxes;
}

/// All of a part is in it, as its header says.
WorldBounds Survey::boxOf(std::size_t part) const
{
    return m_parts[part].moved ? m_members[part]->movedBounds : m_parts[part].source->firstBounds;
}

/// The files of a survey while they are read, piece by piece, in any order: each is opened for its pieces, closed
/// meanwhile where too many would be open, and finished with its last one.
class Survey::FilesInReading
{
public:
    FilesInReading(Survey& survey, ChangesOfThreads& changes, Progress& progress,
                   const las::Reader::BatchSink& sink)
        : m_survey(survey), m_changes(changes), m_progress(progress), m_sink(sink), m_files(survey.m_parts.size())
    {
        for (std::size_t k = 0; k < m_files.size(); ++k)
            m_files[k].left = std::max<std::size_t>(1, survey.m_members[k]->reader->pieces());
    }

    /// What a thread keeps from piece to piece.
    struct Worker {
        std::size_t part = SIZE_MAX;
        std::optional<las::Reader::Worker> own;
    };

    /// Throws Error where the file cannot be read, Cancelled.
    void read(ReadingOrder::Unit unit, Worker& worker)
    {
        const std::size_t k = unit.part;
        if (!enter(k)) return;
        bool last = false;
        try {
            File& file = m_files[k];
            if (worker.part != k) {
                worker.own.emplace();
                worker.part = k;
            }
            if (!m_survey.m_parts[k].points.empty()) file.points->read(unit.piece, *worker.own);
            {
                const std::lock_guard lock(m_mutex);
                last = --file.left == 0;
            }
            if (last) finish(k);
        } catch (...) {
            leave(k, true);
            throw;
        }
        leave(k, last);
    }
    las::ReadResult& result(std::size_t part) noexcept { return m_files[part].result; }
    std::size_t opened() const noexcept { return m_opened.size(); }

private:
    struct File {
        std::optional<PartReading> part;             ///< of many
        std::optional<las::Reader::Reading> points;  ///< while it is read
        std::size_t left = 0;                        ///< pieces
        std::size_t users = 0;                       ///< threads that read it
        bool over = false;                           ///< read, or given up
        las::ReadResult result;
    };

    /// A thread is going to read the file; false where that was given up.
    bool enter(std::size_t k)
    {
        const std::lock_guard lock(m_mutex);
        File& file = m_files[k];
        if (file.over) return false;
        const auto known = std::find(m_opened.begin(), m_opened.end(), k);
        if (known != m_opened.end()) {
            m_opened.splice(m_opened.begin(), m_opened, known);
        } else {
            m_survey.m_members[k]->reader->reopen();
            m_opened.push_front(k);
            closeSome();
        }
        if (!file.points) begin(k);
        ++file.users;
        return true;
    }
    void begin(std::size_t k)
    {
        File& file = m_files[k];
        Member& member = *m_survey.m_members[k];
        if (!m_survey.many()) {
            file.points.emplace(*member.reader, *m_survey.m_cloud, m_progress, m_sink, member.firsts);
            return;
        }
        file.part.emplace(m_survey, k, m_changes);
        file.points.emplace(
            *member.reader, file.part->view(), m_progress,
            [this, &part = *file.part](PointRange range) {
                part.arrived(range);
                if (m_sink) m_sink(part.inSurvey(range));
                part.handedOn(range);
            },
            member.firsts);
    }
    /// All pieces of the file have been read.
    void finish(std::size_t k)
    {
        File& file = m_files[k];
        file.result = file.points->finish();
        emptyKept(k);
        if (!file.part) return;
        if (file.part->hasOwnGrid()) file.result.bounds = file.part->bounds();
        if (const std::size_t beyond = m_survey.m_members[k]->beyond; beyond != 0)
            file.result.warnings.push_back(
                grouped(beyond) +
                " coordinates lie too far away from the other files, and are shown at the edge of "
                "what one survey can hold; they are saved as they are.");
    }
    /// Points that an overview had of places that turned out to be damaged mean nothing.
    void emptyKept(std::size_t k)
    {
        const PointCloud& cloud = m_survey.many() ? m_files[k].part->view() : *m_survey.m_cloud;
        const las::RecordLayout& layout = m_survey.m_parts[k].source->layout;
        for (const PointRange& kept : m_survey.m_members[k]->kept)
            for (const PointRange& gone : m_files[k].result.missing) {
                const PointRange both{std::max(kept.first, gone.first), std::min(kept.last, gone.last)};
                if (both.first >= both.last) continue;
                for (std::size_t c = 0; c < layout.fields.size() + layout.derived.size(); ++c) {
                    const std::uint32_t bytes = layout.field(std::int32_t(c)).bytes();
                    std::memset(cloud.columns()[c]->data() + both.first * bytes, 0, both.size() * bytes);
                }
            }
    }
    /// A thread reads it no more; `over`: nobody will.
    void leave(std::size_t k, bool over) noexcept
    {
        const std::lock_guard lock(m_mutex);
        File& file = m_files[k];
        file.over = file.over || over;
        if (--file.users == 0 && file.over) {
            file.points.reset();
            file.part.reset();
            Member& member = *m_survey.m_members[k];
            member.view.reset();
            member.firsts.clear();
            member.firstBoxes.clear();
            member.kept.clear();
            member.reader->close();
            m_opened.remove(k);
        }
        closeSome();
    }
    /// The files that nobody reads now, and that were read longest ago.
    void closeSome() noexcept
    {
        for (auto one = m_opened.end(); m_opened.size() > kMostOpen && one != m_opened.begin();) {
            --one;
            if (m_files[*one].users != 0) continue;
            m_survey.m_members[*one]->reader->close();
            one = m_opened.erase(one);
        }
    }

    Survey& m_survey;
    ChangesOfThreads& m_changes;
    Progress& m_progress;
    const las::Reader::BatchSink& m_sink;
    std::mutex m_mutex;  ///< guards what follows, but for what a thread between enter() and leave() uses
    std::vector<File> m_files;
    std::list<std::size_t> m_opened;  ///< files, those read last first
};

las::ReadResult Survey::read(Progress& progress, const las::Reader::BatchSink& sink, const Ahead& ahead,
                             ReadingOrder* order)
{
    const Residency::Filling filling;
    ChangesOfThreads changes;
    const std::unique_ptr<Overview> overview =
        ahead.sink && m_cloud->size() >= ahead.keptFrom ? this->overview() : nullptr;
    const bool known = overview != nullptr && overview->find();
    ReadingOrder nobodys;
    ReadingOrder& units = order != nullptr ? *order : nobodys;
    if (ahead.sink) readFirsts(ahead, overview.get(), units, changes, progress);
    std::vector<ReadingOrder::Part> parts(m_parts.size());
    std::size_t count = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        parts[k] = {boxOf(k), m_members[k]->reader->order(!m_members[k]->firstBoxes.empty()), likelyBoxes(k)};
        if (known && !parts[k].turns.empty() && overview->boxes(k).size() == m_members[k]->reader->pieces()) {
            parts[k].boxes = overview->boxes(k);
            parts[k].sure = true;
        }
        if (parts[k].turns.empty()) parts[k].turns.push_back(0);  // a file without points is looked at, too
        count += parts[k].turns.size();
    }
    const Progress::Whole whole(progress, "Reading points", m_cloud->size());
    FilesInReading files(*this, changes, progress, sink);
    units.begin(std::move(parts), las::spreadOrder(std::uint32_t(m_parts.size())));
    std::vector<std::string> failures(m_parts.size());
    std::mutex failing;
    las::forEachInOrder<FilesInReading::Worker>(count, [&](FilesInReading::Worker& worker, std::size_t) {
        progress.check();
        const auto unit = units.take();
        if (!unit) return;
        try {
            files.read(*unit, worker);
        } catch (const Error& e) {
            if (!many()) throw;
            const std::lock_guard lock(failing);
            std::string& failure = failures[unit->part];
            if (failure.empty()) failure = e.what();
            units.drop(unit->part);
        }
        units.done(*unit);
    });
    progress.check();
    units.end();
    std::string notKept;
    try {
        if (overview != nullptr && !known && !overview->pieces().empty()) {
            for (std::size_t k = 0; k < m_parts.size(); ++k)
                overview->setBoxes(k, readBoxes(k, files.result(k).bounds));
            overview->keep();
        }
    } catch (const Error& e) {
        notKept = std::string("The next opening will show nothing before files are read: ") + e.what();
    }
    if (!many()) {
        m_members[0]->reader.reset();  // closes the file
        if (!notKept.empty()) files.result(0).warnings.push_back(notKept);
        return std::move(files.result(0));
    }
    las::ReadResult all;
    std::size_t failed = 0;
    for (std::size_t k = 0; k < m_parts.size(); ++k) {
        const Part& part = m_parts[k];
        las::ReadResult& one = files.result(k);
        if (!failures[k].empty()) {
            ++failed;
            one = {};
            one.missing.push_back({0, part.points.size()});
            all.warnings.push_back(failures[k] + " Its points are missing.");
            las::PointsAsRead read;
            read.missing = one.missing;
            part.source->asRead->set(read);
        }
        for (const std::string& w : one.warnings) all.warnings.push_back(partName(part.path) + ": " + w);
        for (const PointRange& gone : one.missing)
            if (!gone.empty())
                all.missing.push_back({part.points.first + gone.first, part.points.first + gone.last});
        if (!one.bounds.empty()) all.bounds.include(one.bounds);
        m_members[k]->reader.reset();
    }
    if (failed == m_parts.size()) throw Error(failures.front());
    if (!notKept.empty()) all.warnings.push_back(notKept);
    las::PointsAsRead read;
    read.missing = all.missing;
    source()->asRead->set(std::move(read));  // whoever writes all into one file leaves them out
    return all;
}

}  // namespace punctum
