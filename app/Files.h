// SPDX-License-Identifier: MIT
#pragma once

#include "app/Console.h"
#include "core/cloud/PointCloud.h"
#include "core/las/Writer.h"
#include "core/session/Session.h"
#include "render/store/PointStore.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI
{
class App;
}

namespace punctum::app
{

/// Throws UsageError unless the name ends in .las or .laz (any case): the ending decides what is written.
void checkCloudName(const std::filesystem::path& path);
/// Throws Error when the folder that is to hold `path` is not there, before any work is spent.
void checkFolder(const std::filesystem::path& path);

/// What the words of a command line name: files, and the files of folders and virtual point clouds, each once and
/// in the order of the words. Throws Error when a folder cannot be read or has no LAS or LAZ file.
std::vector<std::filesystem::path> inputFiles(const std::vector<std::string>& words, Progress& progress);

/// Where a command writes to: a file, or a folder, in which each file of a survey gets its own name.
struct Output {
    std::filesystem::path path;
    bool folder = false;
};
/// A folder where there is one, where the word ends in a slash, and for several files where it names no LAS or LAZ
/// file. Throws UsageError for any other word.
Output outputOf(const std::string& word, bool several);

/// A session with all points of the files, in order to write `out`: puts warnings on stderr, and throws Error when
/// that would replace a damaged original by what could be read of it. `undo`: the history is walked through. Throws
/// Error, Cancelled.
std::shared_ptr<Session> loadForWriting(const std::vector<std::filesystem::path>& in, const Output& out,
                                        Progress& progress, bool undo = false);

/// A session with all points of the files, for reading alone: puts warnings on stderr. Throws Error, Cancelled.
std::shared_ptr<Session> loadForReading(const std::vector<std::filesystem::path>& in, Progress& progress);

/// Session::save() without telling what changed, or merge() of several files into one, with a hint at the option
/// that says yes to its question. Makes the folder where there is none. Throws Error, Cancelled.
las::WriteReport saveSession(Session& session, const Output& out, const las::WriteOptions& options,
                             Progress& progress);
/// `write()`, with a hint at the option that says yes to its question.
las::WriteReport withHints(const std::function<las::WriteReport()>& write);
/// Adds --upgrade, for whatever writes a cloud.
void addUpgrade(CLI::App& command, bool& upgrade);
/// Adds --replace-protected, for whatever writes a cloud.
void addReplaceProtected(CLI::App& command, bool& replaceProtected);
/// Adds --no-verify, for whatever writes a cloud.
void addNoVerify(CLI::App& command, bool& noVerify);

/// Tells what was written: JSON with `more` keys in front, or a line, and the notes on stderr.
void reportWritten(const las::WriteReport& report, const std::filesystem::path& path, bool json,
                   Json more = Json::object());

/// A cloud, and what is drawn of it.
struct DrawableCloud {
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<render::PointStore> store;
    RawBounds bounds;
    std::vector<std::string> warnings;
};

/// Loads files as one survey and fills its store on the way. Throws Error, Cancelled.
DrawableCloud loadDrawable(const std::vector<std::filesystem::path>& files, Progress& progress,
                           render::OrderKind order = render::OrderKind::Stratified);
/// The same of what a word names: inputFiles().
DrawableCloud loadDrawable(const std::string& word, Progress& progress,
                           render::OrderKind order = render::OrderKind::Stratified);

/// Writes bytes to a file, whole or not at all, as las::AtomicFile does; to a pipe or a device straight. Throws
/// Error.
void writeWhole(const std::filesystem::path& path, std::string_view bytes);

}  // namespace punctum::app
