// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointFigures.h"
#include "core/cloud/Units.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace punctum
{

class Progress;
class Session;
namespace las
{
struct SourceFile;
}

/// What a LAS or LAZ file says of itself beside its points, in words and figures for people: a copy, with nothing
/// of the file's bytes. Texts are UTF-8; empty ones stand for what the file does not say.
struct FileFacts {
    std::uint64_t bytes = 0;    ///< of the whole file
    std::string version;        ///< "1.4"
    unsigned format = 0;        ///< point data record format
    unsigned shownFormat = 0;   ///< that its records stand for: another one in compatibility mode
    unsigned recordLength = 0;  ///< bytes
    bool compressed = false;    ///< LAZ
    std::string units;          ///< of the coordinates, in words
    std::string crs;            ///< its name
    std::string created;        ///< day
    std::string software, system, projectId;
    std::vector<std::string> encoding;  ///< what each bit of the global encoding says
    /// First and last as the header has them; from LAS 1.5 on.
    std::optional<std::pair<double, double>> gpsTimes;
    /// A record that is no point.
    struct Record {
        std::string name;  ///< "LASF_Projection / 34735"
        std::uint64_t bytes = 0;
        bool extended = false;  ///< behind the points
        std::string words;      ///< what it is for
    };
    std::vector<Record> records;
    std::vector<std::string>
        warnings;  ///< what is odd about it, a sentence each, but for what is missing or damaged
};

FileFacts factsOf(const las::SourceFile& source);
/// A name of its coordinate system in a few words, "RGF93 v1 / Lambert-93"; empty when none is stated.
std::string crsNameOf(const las::SourceFile& source);

/// Something that is wrong with a file.
struct FileFault {
    std::string fault;        ///< a sentence, with the figures
    std::string mend;         ///< a sentence: what would mend it, or that nothing can
    bool repairable = false;  ///< repairFile() mends it
};

/// What a look through all points of a file tells.
struct Inspection {
    FileFacts facts;  ///< of the file that holds the points: after a save, the one that was written
    PointFigures figures;
    /// Days of figures.gpsTime, "2012-07-11"; empty where they are not known.
    std::string firstDay, lastDay;
    std::vector<FileFault> faults;
    bool repairable() const;  ///< one of them is
};

/// Of a survey figures alone. Nothing where the points are no longer those of the file, since an edit came first or
/// meanwhile. Any thread, long. Throws Error (the file cannot be read, or changed) or Cancelled.
std::optional<Inspection> inspect(const Session& session, Progress& progress);

/// What repairFile() did.
struct RepairOutcome {
    bool written = false;            ///< false: there was nothing to mend, and no file was made
    std::vector<FileFault> mended;   ///< put right in the new file
    std::vector<FileFault> left;     ///< that cannot be mended without guessing
    std::vector<std::string> notes;  ///< one sentence each
};

/// las::repair(): writes `out` as `in` with a header that fits its data, or nothing. Any thread, long. Throws Error
/// (an existing `out` is untouched) or Cancelled.
RepairOutcome repairFile(const std::filesystem::path& in, const std::filesystem::path& out, Progress& progress);

}  // namespace punctum
