// SPDX-License-Identifier: MIT
#include "core/session/SurveyFiles.h"

#include "core/las/GpsTime.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <system_error>

namespace punctum
{

namespace fs = std::filesystem;

fs::path commonFolder(const std::vector<fs::path>& files)
{
    fs::path common;
    for (std::size_t k = 0; k < files.size(); ++k) {
        std::error_code error;
        const fs::path whole = fs::absolute(files[k], error);
        const fs::path folder = (error ? files[k] : whole.lexically_normal()).parent_path();
        if (k == 0) {
            common = folder;
            continue;
        }
        fs::path shared;
        for (auto a = common.begin(), b = folder.begin(); a != common.end() && b != folder.end() && *a == *b;
             ++a, ++b)
            shared /= *a;
        common = shared;
    }
    return common.empty() ? fs::path(".") : common;
}

std::vector<std::size_t> changedNumbers(const std::vector<bool>& parts)
{
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k]) numbers.push_back(k);
    return numbers;
}

void addDifference(const las::Difference& part, las::Difference& all)
{
    all.pointsA += part.pointsA;
    all.pointsB += part.pointsB;
    all.onlyA += part.onlyA;
    all.onlyB += part.onlyB;
    all.compared += part.compared;
    all.differing += part.differing;
    all.unreadableA += part.unreadableA;
    all.unreadableB += part.unreadableB;
    all.recordsReordered = all.recordsReordered || part.recordsReordered;
    for (const las::AttributeDifference& a : part.attributes) {
        const auto same = std::find_if(all.attributes.begin(), all.attributes.end(), [&](const auto& known) {
            return known.name == a.name && known.change == a.change && known.typeA == a.typeA &&
                   known.typeB == a.typeB;
        });
        if (same == all.attributes.end())
            all.attributes.push_back(a);
        else
            same->points += a.points;
    }
    const auto isNew = [](const auto& list, const auto& equal) {
        return std::none_of(list.begin(), list.end(), equal);
    };
    for (const las::FieldDifference& f : part.header)
        if (isNew(all.header, [&](const auto& known) { return known.name == f.name; })) all.header.push_back(f);
    for (const las::RecordDifference& r : part.records)
        if (isNew(all.records, [&](const auto& known) {
                return known.user == r.user && known.id == r.id && known.change == r.change;
            }))
            all.records.push_back(r);
    for (const las::BytesDifference& b : part.bytes)
        if (isNew(all.bytes, [&](const auto& known) { return known.what == b.what; })) all.bytes.push_back(b);
    for (const las::FieldDifference& f : part.container)
        if (isNew(all.container, [&](const auto& known) { return known.name == f.name; }))
            all.container.push_back(f);
    all.storedA = part.storedA;
    all.storedB = part.storedB;
}

std::string unsavedInSurvey(const std::optional<std::vector<AttributeChange>>& changes,
                            const std::vector<bool>& changedParts)
{
    const std::size_t files = changedNumbers(changedParts).size();
    if (files == 0) return {};
    las::Difference difference;
    if (changes)
        for (const AttributeChange& change : *changes) {
            las::AttributeDifference a;
            a.name = change.attribute;
            a.points = change.points;
            difference.attributes.push_back(std::move(a));
        }
    const std::string what = las::summary(difference);
    const std::string where = std::to_string(files) + " of " + std::to_string(changedParts.size()) + " files";
    return what.empty() ? "edits in " + where : what + ", in " + where;
}

void addOneFileNotes(const std::vector<SessionPart>& files, std::vector<std::string>& notes)
{
    const SessionPart* timed = nullptr;
    bool clocks = false, waveforms = false;
    for (const SessionPart& part : files) {
        const las::SourceFile& source = *part.source;
        waveforms = waveforms || las::hasWaveform(source.layout.format);
        if (part.points.empty() || !las::hasGpsTime(source.layout.shownFormat())) continue;
        if (timed == nullptr) timed = &part;
        clocks = clocks || las::gpsClock(source.header) != las::gpsClock(timed->source->header);
    }
    if (clocks)
        notes.emplace_back(
            "The files count GPS times in different ways; in the one file each number is as it was.");
    if (waveforms)
        notes.emplace_back("The waveforms stay with the files that they came with; the one file has none.");
}

}  // namespace punctum
