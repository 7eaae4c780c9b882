// SPDX-License-Identifier: MIT
#include "app/Files.h"

#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/FindFiles.h"
#include "core/Text.h"
#include "core/las/AtomicFile.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"
#include "render/store/CloudLoad.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

namespace punctum::app
{

namespace fs = std::filesystem;

namespace
{

std::string reason(int error)
{
    return std::string(": ") + std::strerror(error) + ".";
}

/// Of opening and of reading, each once.
std::vector<std::string> allWarnings(const Survey& survey, const las::ReadResult& result)
{
    std::vector<std::string> all = survey.warnings();
    for (const std::string& warning : result.warnings)
        if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
    return all;
}

/// Writes all bytes, or returns the errno of what stopped it.
int writeAll(int file, std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t n = ::write(file, bytes.data(), bytes.size());
        if (n < 0 && errno != EINTR) return errno;
        if (n > 0) bytes.remove_prefix(std::size_t(n));
    }
    return 0;
}

}  // namespace

void checkCloudName(const fs::path& path)
{
    if (!isCloudName(path)) throw UsageError("The file to write, " + path.string() + ", must end in .las or .laz.");
}

void checkFolder(const fs::path& path)
{
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error)) throw Error(path, "The folder " + folder.string() + " does not exist.");
    if (access(folder.c_str(), W_OK) != 0)
        throw Error(path, "Nothing can be written to the folder " + folder.string() + reason(errno));
}

std::vector<fs::path> inputFiles(const std::vector<std::string>& words, Progress& progress)
{
    std::vector<fs::path> files;
    for (const std::string& word : words) {
        if (!standsForFiles(word)) {
            files.emplace_back(word);
            continue;
        }
        FoundFiles found;
        addFilesOf(word, found, progress);
        if (found.files.empty()) throw Error(word, "There is no LAS or LAZ file in it.");
        if (found.closedFolders != 0)
            note(word + ": " + grouped(found.closedFolders) + " of its folders could not be read.");
        if (found.remote != 0)
            note(word + ": " +
                 (found.remote == 1 ? std::string("1 file on a server is")
                                    : grouped(found.remote) + " files on servers are") +
                 " left out.");
        files.insert(files.end(), found.files.begin(), found.files.end());
    }
    return files;
}

Output outputOf(const std::string& word, bool several)
{
    std::error_code error;
    if (word.ends_with('/') || fs::is_directory(word, error) || (several && !isCloudName(word))) {
        const fs::path path(word);
        return {path.has_filename() ? path : path.parent_path(), true};
    }
    checkCloudName(word);
    return {word, false};
}

std::shared_ptr<Session> loadForWriting(const std::vector<fs::path>& in, const Output& out, Progress& progress,
                                        bool undo)
{
    checkFolder(out.path);
    HistoryRoom room;
    room.undo = undo;
    auto session = Session::open(in, room, progress);
    const las::ReadResult result = session->read(progress);
    for (const std::string& warning : allWarnings(session->survey(), result)) note(warning);
    for (const SessionPart& part : session->parts())
        session->checkTarget(out.folder ? out.path / part.path.filename() : out.path);
    return session;
}

std::shared_ptr<Session> loadForReading(const std::vector<fs::path>& in, Progress& progress)
{
    auto session = Session::open(in, {}, progress);
    const las::ReadResult result = session->read(progress);
    for (const std::string& warning : allWarnings(session->survey(), result)) note(warning);
    return session;
}

las::WriteReport saveSession(Session& session, const Output& out, const las::WriteOptions& options,
                             Progress& progress)
{
    std::error_code error;
    bool made = false;
    if (out.folder) {
        if (fs::exists(out.path, error) && !fs::is_directory(out.path, error))
            throw Error(out.path, "This is a file; the files of a survey need a folder to go to.");
        made = fs::create_directory(out.path, error);
        if (error) throw Error(out.path, "The folder could not be made: " + error.message() + ".");
    }
    try {
        return withHints([&] {
            if (session.many() && !out.folder) return session.merge(out.path, options, progress);
            const bool named = out.folder && !session.many();
            const fs::path target = named ? out.path / session.path().filename() : out.path;
            return session.save({.target = target, .options = options, .compare = false}, progress).report;
        });
    } catch (...) {
        if (made) fs::remove(out.path, error);  // nothing is in it: all files are written, or none
        throw;
    }
}

las::WriteReport withHints(const std::function<las::WriteReport()>& write)
{
    try {
        return write();
    } catch (const las::WriteQuestion& question) {
        switch (question.kind()) {
            case las::WriteQuestion::Kind::TargetChanged:
                break;
            case las::WriteQuestion::Kind::TargetProtected:
                throw Error(std::string(question.what()) + " Add --replace-protected to replace it all the same.");
            case las::WriteQuestion::Kind::Upgrade:
                throw Error(std::string(question.what()) + " Add --upgrade to write " + question.becomes() + ".");
            case las::WriteQuestion::Kind::Lossy:
                throw Error(std::string(question.what()) + " Add --lossy to write " + question.becomes() +
                            " all the same.");
        }
        throw;
    }
}

void addUpgrade(CLI::App& command, bool& upgrade)
{
    command.add_flag("--upgrade", upgrade,
                     "Write a point format and LAS version that can hold everything, where those of IN cannot");
}

void addReplaceProtected(CLI::App& command, bool& replaceProtected)
{
    command.add_flag("--replace-protected", replaceProtected, "Replace a file that is write-protected");
}

void addNoVerify(CLI::App& command, bool& noVerify)
{
    command.add_flag("--no-verify", noVerify, "Do not read the written file back before it takes its name");
}

void reportWritten(const las::WriteReport& report, const fs::path& path, bool json, Json more)
{
    if (json) {
        Json all = std::move(more);
        all["file"] = path.string();
        all["points"] = report.points;
        all["bytes"] = report.bytes;
        if (report.chunksCopied + report.chunksEncoded != 0) {
            all["chunks_copied"] = report.chunksCopied;
            all["chunks_encoded"] = report.chunksEncoded;
        }
        all["notes"] = report.notes;
        if (!report.losses.empty()) {
            Json losses = Json::array();
            for (const las::Loss& loss : report.losses)
                losses.push_back({{"what", loss.what}, {"becomes", loss.becomes}, {"points", loss.points}});
            all["losses"] = std::move(losses);
        }
        printJson(all);
        return;
    }
    for (const std::string& text : report.notes) note(text);
    print(path.string() + ": " + pointsText(report.points) + ", " + grouped(report.bytes) + " bytes\n");
}

DrawableCloud loadDrawable(const std::vector<fs::path>& files, Progress& progress, render::OrderKind order)
{
    const render::CloudLoad load(Session::open(files, {}, progress), order);
    const las::ReadResult result = load.read(progress);
    return {load.session()->cloud(), load.store(), result.bounds, allWarnings(load.session()->survey(), result)};
}

DrawableCloud loadDrawable(const std::string& word, Progress& progress, render::OrderKind order)
{
    return loadDrawable(inputFiles({word}, progress), progress, order);
}

void writeWhole(const fs::path& path, std::string_view bytes)
{
    std::error_code code;
    const fs::file_status status = fs::status(path, code);
    if (!fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status)) {
        las::AtomicFile file(path, bytes.size());
        file.writeAt(0, std::as_bytes(std::span(bytes)));
        file.sync();
        file.commit();
        return;
    }
    // A device or a pipe cannot be replaced, only written to.
    const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) throw Error(path, "The file could not be written" + reason(errno));
    int error = writeAll(file, bytes);
    if (close(file) != 0 && error == 0) error = errno;
    if (error != 0) throw Error(path, "The file could not be written" + reason(error));
}

}  // namespace punctum::app
