// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/SourceFile.h"
#include "core/las/Writer.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum::las
{

/// What waits for its name, and what is to be said of it then. Only core/las includes this.
struct StagedWrite::State {
    std::filesystem::path path;             ///< as the user named it
    std::unique_ptr<AtomicFile> file;       ///< sealed
    std::unique_ptr<AtomicFile> waveforms;  ///< sealed; null: none are copied
    std::shared_ptr<const SourceFile> source;
    std::shared_ptr<const KeptPoints> kept;  ///< points of the cloud that are in the file; null: all
    bool pristine = false;                   ///< see CurrentFile
    bool copc = false;                       ///< it is a COPC file
    WriteReport report;                      ///< complete but for what the last step notes

    /// After the rename: notes it down in the source, sets an index of before aside, and completes the report.
    /// `stamp`: of the file. `leftovers`: sentences on what killed saves left beside it.
    WriteReport finish(const FileStamp& stamp, std::vector<std::string> leftovers);
};

/// Runs work; an Error of it is thrown with the file's name that the user knows.
template <typename Work>
auto withName(const std::filesystem::path& path, const Work& work)
{
    try {
        return work();
    } catch (const Error& e) {
        if (e.file() == path) throw;
        throw Error(path, e.file().empty() ? e.what() : std::string("The file could not be saved: ") + e.what());
    }
}

}  // namespace punctum::las
