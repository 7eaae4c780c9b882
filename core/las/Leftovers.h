// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace punctum::las
{

/// The name under which a file called `name` is written before it is whole: it tells the process, so that what a
/// killed one left behind can be known.
std::string temporaryName(const std::string& name);

/// The process that wrote a temporary file of `name`; 0: it is none of these.
long temporaryProcess(std::string_view temporary, const std::string& name);

/// "PROCESS-NUMBER" of this process, with a random number of eight digits: how names of our own files end.
std::string processSuffix();
/// The process of such an ending; 0: it is none.
long processOfSuffix(std::string_view text);
/// Whether there is such a process on this machine now.
bool isRunning(long process);

/// What killed saves left in a folder, which is looked through once, when this is made.
class Leftovers
{
public:
    explicit Leftovers(const std::filesystem::path& folder);

    /// One sentence for each temporary file beside `target`, a file in this folder, of a save of it that never
    /// ended, because its process was killed or the power failed. They are named and never deleted: they may hold
    /// work that is nowhere else.
    std::vector<std::string> of(const std::filesystem::path& target) const;

private:
    std::vector<std::string> m_names;
    bool m_several = false;  ///< a save of several files waits to be finished (FinishSaves.h)
};

/// Likewise in any number of folders, each looked through when it is first asked for. Any thread.
class FolderLeftovers
{
public:
    std::vector<std::string> of(const std::filesystem::path& target);

private:
    std::mutex m_mutex;
    std::map<std::filesystem::path, Leftovers> m_folders;
};

}  // namespace punctum::las
