// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/SaveManifest.h"

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace punctum::las
{

/// The manifests of one save on the disk, one in each folder. The first folder's decides, and is locked (flock) as
/// long as this is there, so that others see that the save goes on. Move-only; one thread.
class ManifestFiles
{
public:
    /// Writes and syncs them, the one that decides last: when this has been made, the save counts. `shown`: the
    /// file that errors name. Throws Error with nothing left.
    ManifestFiles(std::filesystem::path shown,
                  const std::map<std::filesystem::path, std::vector<ManifestEntry>>& folders);
    /// The manifests stay, and the lock is gone.
    ~ManifestFiles();
    ManifestFiles(const ManifestFiles&) = delete;
    ManifestFiles& operator=(const ManifestFiles&) = delete;

    void removeDone() noexcept;    ///< all files have their names
    void removeUndone() noexcept;  ///< none has: the save does not count any more

private:
    void createDecider(const std::filesystem::path& folder);
    void decide(const std::string& text);

    std::filesystem::path m_shown, m_decider;
    std::vector<std::filesystem::path> m_others;
    int m_descriptor = -1;
};

/// Removes those that do not decide, for good: false where one may still be there. The one that decides must stay
/// then, since without it they would say that the save never counted.
bool removeManifests(const std::vector<std::filesystem::path>& manifests) noexcept;

/// A manifest that was found, locked as long as this is there.
class FoundManifest
{
public:
    enum class Access {
        Locked,   ///< text() is what it says
        Gone,     ///< somebody else finished it
        InUse,    ///< still
        Refused,  ///< may not be read, is none, or is another user's in a folder for all
    };
    using Clock = std::chrono::steady_clock;
    /// Waits for others that have it locked, until then.
    FoundManifest(const std::filesystem::path& path, Clock::time_point waitUntil);
    ~FoundManifest();
    FoundManifest(const FoundManifest&) = delete;
    FoundManifest& operator=(const FoundManifest&) = delete;

    Access access() const noexcept { return m_access; }
    const std::string& text() const noexcept { return m_text; }

private:
    Access lock(const std::filesystem::path& path, Clock::time_point waitUntil);
    void close() noexcept;

    int m_descriptor = -1;
    std::string m_text;
    Access m_access;
};

}  // namespace punctum::las
