// SPDX-License-Identifier: MIT
#include "core/las/SaveTogether.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/Leftovers.h"
#include "core/las/ManifestFiles.h"
#include "core/las/SaveManifest.h"
#include "core/las/StagedWrite.h"

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <map>
#include <set>
#include <system_error>
#include <thread>

namespace punctum::las
{

namespace
{

namespace fs = std::filesystem;

constexpr int kTries = 5;  ///< of a rename that fails
constexpr std::chrono::milliseconds kBetweenTries{40};

/// One file that gets a name: that of a stage, or its waveforms.
struct Piece {
    AtomicFile* file = nullptr;
    const StagedWrite::State* stage = nullptr;
    fs::path folder{};  ///< canonical
    bool named = false;
};

/// Files that may be neither renamed nor replaced, whatever their mode: chattr +i and +a.
bool isImmutable(const fs::path& file)
{
    const int d = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (d < 0) return false;
    int flags = 0;
    const bool known = ::ioctl(d, FS_IOC_GETFLAGS, &flags) == 0;
    ::close(d);
    return known && (flags & (FS_IMMUTABLE_FL | FS_APPEND_FL)) != 0;
}

/// In folders like /tmp only its owner may replace a file.
bool belongsToAnother(const fs::path& folder, const fs::path& file)
{
    struct stat f {
    }, s{};
    if (::stat(folder.c_str(), &f) != 0 || ::stat(file.c_str(), &s) != 0) return false;
    const uid_t self = ::geteuid();
    return (f.st_mode & S_ISVTX) != 0 && self != 0 && self != s.st_uid && self != f.st_uid;
}

/// What would keep the rename from being done, as far as it can be seen before.
void check(const Piece& piece)
{
    const AtomicFile& file = *piece.file;
    file.checkTarget();
    if (FileStamp::of(file.temporary()) != file.stamp())
        throw Error(piece.stage->path, "What was written of it is gone from the disk; save again.");
    if (::faccessat(AT_FDCWD, piece.folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
        throw Error(piece.stage->path, "The folder is read-only; choose another place.");
    if (file.replaces() && (isImmutable(file.target()) || belongsToAnother(piece.folder, file.target())))
        throw Error(piece.stage->path, "The file may not be replaced; choose another name.");
}

std::vector<Piece> piecesOf(std::vector<StagedWrite>& stages)
{
    std::vector<Piece> pieces;
    std::set<fs::path> targets;
    for (StagedWrite& staged : stages) {
        StagedWrite::State& state = staged.state();
        for (AtomicFile* const file : {state.waveforms.get(), state.file.get()}) {
            if (file == nullptr) continue;
            std::error_code ec;
            Piece piece{file, &state, fs::canonical(folderOf(file->target()), ec)};
            if (ec) throw Error(state.path, "The folder does not exist; choose another place.");
            if (!targets.insert(piece.folder / file->target().filename()).second)
                throw Error(state.path, "Two parts would be saved under this name; choose another one.");
            pieces.push_back(std::move(piece));
        }
    }
    return pieces;
}

ManifestEntry entryOf(const AtomicFile& file)
{
    ManifestEntry entry;
    entry.temporary = file.temporary().filename().string();
    entry.target = file.target().filename().string();
    if (file.before()) entry.before = ContentStamp{file.before()->size, file.before()->modified};
    entry.written = {file.stamp().size, file.stamp().modified};
    entry.digest = digestOfFile(File(file.temporary()));
    return entry;
}

/// Gives all their names; of what fails, the system's word for the first.
int nameAll(std::vector<Piece>& pieces)
{
    int first = 0;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        if (attempt != 0) std::this_thread::sleep_for(kBetweenTries);
        first = 0;
        bool some = false;
        for (Piece& piece : pieces) {
            if (piece.named) continue;
            const int error = piece.file->takeName();
            piece.named = error == 0;
            some = some || piece.named;
            if (error != 0 && first == 0) first = error;
        }
        if (first == 0) break;
    }
    return first;
}

}  // namespace

std::vector<WriteReport> commitTogether(std::vector<StagedWrite> stages)
{
    std::vector<WriteReport> reports;
    if (stages.size() < 2) {
        for (StagedWrite& staged : stages) reports.push_back(staged.commit());
        return reports;
    }
    std::vector<Piece> pieces = piecesOf(stages);
    for (const Piece& piece : pieces) withName(piece.stage->path, [&] { check(piece); });
    std::map<fs::path, std::vector<ManifestEntry>> folders;
    for (const Piece& piece : pieces)
        withName(piece.stage->path, [&] { folders[piece.folder].push_back(entryOf(*piece.file)); });

    const fs::path first = stages.front().state().path;
    ManifestFiles manifests(first, folders);  // from here on the save counts
    const int error = nameAll(pieces);
    if (error != 0 && std::none_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.named; })) {
        manifests.removeUndone();
        throw Error(first, "The files cannot take their names: " + systemReason(error) + "; nothing was changed.");
    }
    for (const auto& [folder, entries] : folders) (void)syncFolder(folder);
    if (error == 0) manifests.removeDone();

    FolderLeftovers leftovers;
    std::vector<std::string> saved, missing;
    auto piece = pieces.begin();
    for (StagedWrite& staged : stages) {
        StagedWrite::State& state = staged.state();
        bool whole = true;
        for (; piece != pieces.end() && piece->stage == &state; ++piece) {
            if (!piece->named) piece->file->leave();
            whole = whole && piece->named;
        }
        (whole ? saved : missing).push_back(shownName(state.path));
        if (!whole) continue;
        reports.push_back(state.finish(state.file->stamp(), leftovers.of(state.file->target())));
    }
    if (error != 0)
        throw Error("Of " + grouped(stages.size()) + " files these are saved: " + listText(saved) +
                    ". The others cannot take their names (" + systemReason(error) + "): " + listText(missing) +
                    "; they follow when one of them is opened next.");
    return reports;
}

}  // namespace punctum::las
