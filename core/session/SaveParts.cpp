// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/Text.h"
#include "core/edit/CloudKey.h"
#include "core/edit/Journal.h"
#include "core/las/SaveTogether.h"
#include "core/las/SourceFile.h"
#include "core/session/Session.h"
#include "core/session/SurveyFiles.h"
#include "core/task/FewAtOnce.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <map>
#include <optional>
#include <shared_mutex>
#include <utility>

namespace punctum
{

namespace fs = std::filesystem;

namespace
{

/// Files that are written at the same time: each waits for the disk when it is whole, which small files do most of
/// the time. Few, as each takes memory and room on the disk while it is written.
constexpr std::size_t kStagedAtOnce = 4;

}  // namespace

// What a session does otherwise where it has several files (Session.h).

std::vector<bool> Session::changedParts(Progress& progress) const
{
    const std::vector<SessionPart> files = parts();
    std::vector<PointRange> ranges;
    ranges.reserve(files.size());
    for (const SessionPart& part : files) ranges.push_back(part.points);
    if (const auto changed = m_history->changedIn(ranges, progress)) return *changed;
    // The saved state can no longer be reached: the files tell.
    std::vector<bool> changed(files.size(), true);
    if (!many()) return changed;
    const Progress::Whole whole(progress, "Comparing with the files", m_cloud->size());
    const std::shared_lock lock(m_cloud->mutex());
    runLocked(lock, [&] {
        for (std::size_t k = 0; k < files.size(); ++k) {
            progress.check();
            try {
                las::WriteOptions options;
                options.upgrade = true;
                options.compressed = las::isCompressedName(files[k].path);
                const auto cloud = m_survey->partCloud(k, progress);
                const las::SavePreview preview =
                    las::previewSave(*cloud, files[k].path, files[k].path, options, progress);
                changed[k] = preview.difference.differing != 0 || preview.difference.onlyA != 0 ||
                             preview.difference.onlyB != 0 || !preview.difference.attributes.empty();
            } catch (const Error&) {
                continue;  // what cannot be compared is written
            }
        }
    });
    return changed;
}

/// Where each part goes; empty for those that go nowhere.
std::vector<fs::path> Session::targetsOf(const SaveRequest& request) const
{
    std::vector<fs::path> targets;
    std::map<fs::path, fs::path> taken;
    for (const SessionPart& part : parts()) {
        if (request.target.empty()) {
            targets.push_back(part.path);
            continue;
        }
        targets.push_back(request.target / part.path.filename());
        const auto [other, isNew] = taken.emplace(targets.back(), part.path);
        if (!isNew)
            throw Error(request.target, "Two files of the survey have the same name and cannot both go there: " +
                                            other->second.string() + " and " + part.path.string() + ".");
    }
    return targets;
}

Forecast Session::foreseeParts(std::span<const std::size_t> which, std::span<const fs::path> targets,
                               Progress& progress) const
{
    Forecast forecast;
    forecast.edits = edits();
    const std::vector<SessionPart> files = parts();
    forecast.plans.resize(files.size());
    const Progress::Whole whole(progress, "Comparing with the files", m_cloud->size());
    const std::shared_lock lock(m_cloud->mutex());
    runLocked(lock, [&] {
        for (const std::size_t k : which) {
            progress.check();
            las::WriteOptions options;
            options.upgrade = true;
            options.compressed = las::isCompressedName(targets[k]);
            const auto cloud = m_survey->partCloud(k, progress);
            las::SavePreview one = las::previewSave(*cloud, files[k].path, targets[k], options, progress);
            forecast.plans[k] = std::move(one.plan);
            addDifference(one.difference, forecast.preview.difference);
            for (std::string& note : one.notes)
                forecast.preview.notes.push_back(files[k].path.filename().string() + ": " + std::move(note));
        }
    });
    return forecast;
}

SaveOutcome Session::saveParts(SaveRequest request, Progress& progress)
{
    const std::vector<fs::path> targets = targetsOf(request);
    const std::uint64_t before = edits();
    std::vector<std::size_t> which = request.parts;
    if (which.empty() && !request.target.empty())
        for (std::size_t k = 0; k < targets.size(); ++k) which.push_back(k);
    // of no interest where all files are written
    const std::vector<bool> changed =
        which.size() < targets.size() ? changedParts(progress) : std::vector<bool>(targets.size(), true);
    if (which.empty()) which = changedNumbers(changed);
    for (const std::size_t k : which) checkTarget(targets[k]);

    SaveOutcome outcome;
    if (request.compare && (!request.forecast || request.forecast->edits != before)) {
        try {
            request.forecast = foreseeParts(which, targets, progress);
        } catch (const Error&) {
            request.forecast.reset();  // what cannot be written either is told below
        }
    }
    std::vector<las::StagedWrite> staged;
    {
        PointIndex points = 0;
        for (const std::size_t k : which) points += m_survey->parts()[k].points.size();
        const Progress::Whole whole(progress, "Writing files", 2 * points);
        const std::shared_lock lock(m_cloud->mutex());
        runLocked(lock, [&] {
            std::vector<std::optional<las::StagedWrite>> made(which.size());
            fewAtOnce(which.size(), kStagedAtOnce, [&](std::size_t n) {
                progress.check();
                const std::size_t k = which[n];
                las::WriteOptions options = request.options;
                options.compressed = las::isCompressedName(targets[k]);
                const auto& forecast = request.forecast;
                const las::KnownPlan plan = forecast && k < forecast->plans.size()
                                                ? known(forecast->plans[k], forecast->edits)
                                                : las::KnownPlan();
                runLocked(lock, [&] {
                    const auto part = m_survey->partCloud(k, progress);
                    made[n].emplace(las::stage(*part, targets[k], options, progress, plan));
                });
            });
            for (auto& one : made) staged.push_back(std::move(*one));
        });
    }
    const std::vector<las::WriteReport> reports = las::commitTogether(std::move(staged));
    for (std::size_t n = 0; n < reports.size(); ++n) {
        const las::WriteReport& one = reports[n];
        las::WriteReport& all = outcome.report;
        all.points += one.points;
        all.bytes += one.bytes;
        all.chunksCopied += one.chunksCopied;
        all.chunksEncoded += one.chunksEncoded;
        all.writeSeconds += one.writeSeconds;
        const std::string name = targets[which[n]].filename().string() + ": ";
        for (const std::string& note : one.notes) all.notes.push_back(name + note);
        all.losses.insert(all.losses.end(), one.losses.begin(), one.losses.end());
    }
    outcome.parts = which;

    const std::lock_guard gate(m_gate);
    outcome.disturbed = m_edits != before;
    std::vector<bool> waiting = changed;  // files that changed and were not written
    for (const std::size_t k : which) waiting[k] = false;
    const bool rest = std::find(waiting.begin(), waiting.end(), true) != waiting.end();
    if (outcome.disturbed || (rest && !which.empty()))
        m_history->forgetSaved();
    else if (!rest)
        m_history->markSaved();
    if (!which.empty() || !rest) dropJournal();
    outcome.others = rest && !which.empty();
    m_unnotedTold = outcome.disturbed || outcome.others;  // whoever saves tells it
    outcome.compared =
        request.compare && !outcome.disturbed && request.forecast && request.forecast->edits == before;
    if (outcome.compared) outcome.preview = std::move(request.forecast->preview);
    std::vector<fs::path> now;
    for (const SessionPart& part : parts()) now.push_back(part.path);
    const std::lock_guard lock(m_mutex);
    m_path = commonFolder(now);
    return outcome;
}

las::WriteReport Session::merge(const fs::path& target, las::WriteOptions options, Progress& progress) const
{
    for (const SessionPart& part : parts()) {
        std::error_code ignored;
        if (part.path == target || fs::equivalent(part.path, target, ignored))
            throw Error(target, "This is one of the files that are open; choose another name.");
    }
    options.compressed = las::isCompressedName(target);
    options.copyChunks = false;
    las::WriteReport report = las::write(*m_cloud, target, options, progress);
    addOneFileNotes(parts(), report.notes);
    return report;
}

/// The points that the files hold which hold the cloud; null: all.
std::shared_ptr<const KeptPoints> Session::keptPoints() const
{
    if (!many()) return source()->current->get().kept;
    std::vector<PointRange> ranges;
    bool all = true;
    for (const SessionPart& part : parts()) {
        const auto kept = part.source->current->get().kept;
        all = all && !kept;
        const KeptPoints whole = KeptPoints::all(part.points.size());
        for (const PointRange& range : (kept ? *kept : whole).ranges()) {
            const PointIndex first = part.points.first + range.first;
            if (!ranges.empty() && ranges.back().last == first)
                ranges.back().last += range.size();
            else if (!range.empty())
                ranges.push_back({first, part.points.first + range.last});
        }
    }
    return all ? nullptr : std::make_shared<const KeptPoints>(std::move(ranges));
}

/// The key that the files will have when they are opened next. Points were not edited since they were read or
/// saved.
CloudKey Session::fileKey(Progress& progress) const
{
    if (!many()) return keyOfFile(*m_cloud, progress);
    const std::vector<SessionPart> files = parts();
    std::vector<fs::path> paths;
    bool saved = false;
    for (const SessionPart& part : files) {
        const las::CurrentFile current = part.source->current->get();
        paths.push_back(current.path);
        saved = saved || current.saved;
        if (current.saved && las::FileStamp::of(current.path) != current.stamp)
            throw Error(current.path, "another program changed the file since it was saved.");
    }
    if (!saved) return keyOf(*m_cloud, progress);
    // whoever opens them has them in the order of their paths, and their points in it
    if (!std::is_sorted(paths.begin(), paths.end()))
        throw Error(
            "the files come in another order where they were saved than where they were opened. Open them there.");
    const auto again = Survey::open(paths, progress);
    if (hasColumnsOf(*m_cloud, *again->cloud())) return keyOf(*m_cloud, progress, keptPoints().get());
    again->read(progress, {});
    return keyOf(*again->cloud(), progress);
}

}  // namespace punctum
