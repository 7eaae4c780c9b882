// SPDX-License-Identifier: MIT
#include "core/FindFiles.h"

#include "core/Error.h"
#include "core/VirtualCloud.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>

namespace punctum
{

namespace
{

/// Adds the files of this folder alone, and the folders in it to `inside`. False: it cannot be read.
bool look(const std::filesystem::path& folder, FoundFiles& found, std::vector<std::filesystem::path>& inside,
          std::error_code& error, Progress& progress)
{
    std::filesystem::directory_iterator entry(folder, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
        progress.check();
        std::error_code gone;  // what vanishes meanwhile is not there
        if (entry->is_directory(gone) && !entry->is_symlink(gone)) {
            inside.push_back(entry->path());
        } else if (isCloudName(entry->path()) && entry->is_regular_file(gone)) {
            const std::uintmax_t size = entry->file_size(gone);
            if (gone) continue;
            found.files.push_back(entry->path());
            found.bytes += size;
            found.memory += likelyMemory(entry->path(), size);
            progress.add(1);
        }
    }
    return !error;
}

std::string endingOf(const std::filesystem::path& path)
{
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return ending;
}

}  // namespace

std::uint64_t likelyMemory(const std::filesystem::path& file, std::uint64_t bytes)
{
    constexpr std::uint64_t kUnpacked = 7;
    return endingOf(file) == ".laz" ? kUnpacked * bytes : bytes;
}

bool isCloudName(const std::filesystem::path& path)
{
    const std::string ending = endingOf(path);
    return ending == ".las" || ending == ".laz";
}

void findFiles(const std::filesystem::path& folder, FoundFiles& found, Progress& progress)
{
    progress.begin("Looking into folders", 0);
    const auto first = std::ptrdiff_t(found.files.size());
    std::vector<std::filesystem::path> folders{folder};
    while (!folders.empty()) {
        progress.check();
        const std::filesystem::path next = std::move(folders.back());
        folders.pop_back();
        std::error_code error;
        if (look(next, found, folders, error, progress)) continue;
        if (next == folder) throw Error(folder, "The folder cannot be read: " + error.message() + ".");
        ++found.closedFolders;
    }
    std::sort(found.files.begin() + first, found.files.end());
}

bool standsForFiles(const std::filesystem::path& path)
{
    std::error_code unknown;  // what cannot be looked at is opened, which says why
    return std::filesystem::is_directory(path, unknown) ||
           (isVirtualCloudName(path) && std::filesystem::is_regular_file(path, unknown));
}

void addFilesOf(const std::filesystem::path& place, FoundFiles& found, Progress& progress)
{
    std::error_code unknown;
    if (std::filesystem::is_directory(place, unknown)) return findFiles(place, found, progress);
    const VirtualCloud cloud = readVirtualCloud(place);
    for (const std::filesystem::path& file : cloud.files) {
        progress.check();
        const std::uintmax_t size = std::filesystem::file_size(file, unknown);
        found.files.push_back(file);
        if (unknown) continue;  // what is not there is said when it is opened
        found.bytes += size;
        found.memory += likelyMemory(file, size);
    }
    found.remote += cloud.remote;
}

}  // namespace punctum
