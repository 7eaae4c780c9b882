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

constexpr double kSameSize = 1e-7;     ///< of units, relative: a foot and a US survey foot differ by 2e-6
constexpr std::size_t kMostNamed = 3;  ///< files named in one sentence

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

/// "a.laz, b.laz, c.laz and 12 others".
std::string listOf(const std::vector<std::string>& names)
{
    std::string text;
    const std::size_t n = names.size() <= kMostNamed + 1 ? names.size() : kMostNamed;
    for (std::size_t k = 0; k < n; ++k) text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
    if (n < names.size()) text += " and " + std::to_string(names.size() - n) + " others";
    return text;
}

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
    // Of many the only chunk of a file is not decoded to prove the header's count either: milliseconds a file.
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
        for (const std::string& w : part.source->warnings) m_warnings.push_back(partName(part.path) + ": " + w);
        for (const std::string& w : part.source->losses) m_losses.push_back(partName(part.path) + ": " + w);
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
            if (!m_parts[k].moved) names.push_back(partName(m_parts[k].path));
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
            clocks.push_back(partName(part.path));
        if (crs == nullptr || part.points.empty()) continue;
        if (source.crs.empty()) {
            unknown.push_back(partName(part.path));
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
            others.push_back(partName(part.path));
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
            others.push_back(partName(part.path));
            continue;
        }
        part.moved = true;
        m_members[k]->movedBounds = bounds;
        m_members[k]->heights = heights;
        m_members[k]->from = source.crs;
        m_members[k]->to = *crs;
        moved.push_back(partName(part.path));
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

}  // namespace punctum
