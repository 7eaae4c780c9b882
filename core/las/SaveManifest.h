// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/File.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace punctum::las
{

/// What tells a file's contents from others after a restart, too: devices and inodes may be others then.
struct ContentStamp {
    std::uint64_t size = 0;
    std::int64_t modified = 0;  ///< ns
    friend bool operator==(const ContentStamp&, const ContentStamp&) = default;
};

/// A file that is to get its name: temporary and target are plain names in the manifest's own folder.
struct ManifestEntry {
    std::string temporary, target;
    std::optional<ContentStamp> before;  ///< of the target; nothing: there is none
    ContentStamp written;                ///< of the temporary file
    std::uint32_t digest = 0;            ///< digestOfFile() of the temporary file
};

/// What a save of several files leaves in each of their folders while they get their names (las.md, "Several files
/// at once"). That of one folder decides: once it is whole, the save counts, and whoever finds it finishes it.
struct SaveManifest {
    std::filesystem::path decider;              ///< folder of the manifest that decides; empty: this one does
    std::vector<std::filesystem::path> others;  ///< folders of the others, when this one decides
    std::vector<ManifestEntry> files;
    std::size_t total = 0;  ///< files of all folders
};

/// How a manifest may be read.
enum class ManifestState {
    Whole,
    Incomplete,  ///< cut off or damaged: nothing was decided
    Foreign,     ///< whole, but of a later version, or asks for what no save of ours asks for
};

std::string manifestText(const SaveManifest& manifest);
/// A manifest is a file that anybody may have written: Whole ones name temporary files of ours, plain targets and
/// absolute folders alone.
ManifestState parseManifest(std::string_view text, SaveManifest& manifest);

/// A name for a new one; the same in each folder. Tells the process.
std::string manifestName();
bool isManifestName(std::string_view name);
/// The process that wrote a manifest of this name; 0: it is none.
long processOfManifest(std::string_view name);
/// A manifest that was being written when its program was killed.
bool isManifestLeftover(std::string_view name);
/// More bytes than any manifest has.
inline constexpr std::uint64_t kLargestManifest = std::uint64_t(64) << 20;

/// A sum over the file's size and its bytes in up to 16 places: cheap, and enough to know a file of ours that was
/// synced. Throws Error when it cannot be read.
std::uint32_t digestOfFile(const File& file);

}  // namespace punctum::las
