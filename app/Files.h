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

/// A session with all points of `in`, in order to write `out`: puts warnings on stderr, and throws Error when that
/// would replace a damaged original by what could be read of it. `undo`: the history is walked through. Throws
/// Error, Cancelled.
std::shared_ptr<Session> loadForWriting(const std::filesystem::path& in, const std::filesystem::path& out,
                                        Progress& progress, bool undo = false);

/// Session::save() without telling what changed, with a hint at the option that says yes to its question. Throws
/// Error, Cancelled.
las::WriteReport saveSession(Session& session, const std::filesystem::path& path, const las::WriteOptions& options,
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

/// Loads a file and fills its store on the way. Throws Error, Cancelled.
DrawableCloud loadDrawable(const std::filesystem::path& path, Progress& progress,
                           render::OrderKind order = render::OrderKind::Stratified);

/// Writes bytes to a file, whole or not at all, as las::AtomicFile does; to a pipe or a device straight. Throws
/// Error.
void writeWhole(const std::filesystem::path& path, std::string_view bytes);

}  // namespace punctum::app
