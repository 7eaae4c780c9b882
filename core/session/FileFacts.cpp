// SPDX-License-Identifier: MIT
#include "core/session/FileFacts.h"

#include "core/Text.h"
#include "core/cloud/PointCloud.h"
#include "core/las/CrsChange.h"
#include "core/las/Doctor.h"
#include "core/las/HeaderWords.h"
#include "core/las/Repair.h"
#include "core/session/Session.h"

#include <algorithm>

namespace punctum
{

namespace
{

std::vector<FileFault> faultsOf(const std::vector<las::Finding>& findings)
{
    std::vector<FileFault> faults;
    faults.reserve(findings.size());
    for (const las::Finding& f : findings) faults.push_back({f.fault, f.mend, f.repairable});
    return faults;
}

}  // namespace

FileFacts factsOf(const las::SourceFile& source)
{
    const las::Header& header = source.header;
    FileFacts facts;
    facts.bytes = source.fileSize;
    facts.version = header.version();
    facts.format = source.layout.format;
    facts.shownFormat = source.layout.shownFormat();
    facts.recordLength = source.layout.length;
    facts.compressed = source.compressed;
    facts.units = las::unitsText(source.units);
    facts.crs = source.crs;
    facts.created = las::creationText(header);
    facts.software = las::headerText(header, las::at::kSoftware);
    facts.system = las::headerText(header, las::at::kSystemId);
    facts.projectId = las::guidText(header);
    facts.encoding = las::encodingWords(header);
    if (header.versionMinor() >= 5)
        facts.gpsTimes.emplace(header.get(las::at::kMinGpsTime), header.get(las::at::kMaxGpsTime));
    for (const auto* const list : {&source.vlrs, &source.evlrs})
        for (const las::Vlr& vlr : *list)
            facts.records.push_back({printable(vlr.user()) + " / " + std::to_string(vlr.recordId), vlr.data.size(),
                                     vlr.extended, las::recordWords(vlr)});
    for (const std::string& warning : source.warnings)
        if (std::find(source.losses.begin(), source.losses.end(), warning) == source.losses.end())
            facts.warnings.push_back(warning);
    return facts;
}

std::string crsNameOf(const las::SourceFile& source)
{
    return source.crs.empty() ? std::string() : las::crsName(source.crs);
}

bool Inspection::repairable() const
{
    return std::any_of(faults.begin(), faults.end(), [](const FileFault& f) { return f.repairable; });
}

std::optional<Inspection> inspect(const Session& session, Progress& progress)
{
    const auto edits = session.editsInFile();
    if (!edits) return std::nullopt;
    if (session.many()) {
        // Of a survey there is no one header to hold against the points.
        Inspection inspection;
        inspection.facts = factsOf(*session.source());
        inspection.figures = computePointFigures(*session.cloud(), deletedPoints(*session.cloud()).get(), progress);
        return session.editsInFile() == edits ? std::optional(std::move(inspection)) : std::nullopt;
    }
    const las::Examination found = las::examine(*session.cloud(), progress);
    if (session.editsInFile() != edits) return std::nullopt;
    Inspection inspection{factsOf(*found.source), found.figures, {}, {}, faultsOf(found.diagnosis.findings)};
    if (const auto& time = found.figures.gpsTime) {
        inspection.firstDay = las::gpsDay(found.source->header, time->first);
        inspection.lastDay = las::gpsDay(found.source->header, time->second);
    }
    return inspection;
}

RepairOutcome repairFile(const std::filesystem::path& in, const std::filesystem::path& out, Progress& progress)
{
    const las::RepairReport report = las::repair(in, out, progress);
    return {report.written, faultsOf(report.mended), faultsOf(report.left), report.notes};
}

}  // namespace punctum
