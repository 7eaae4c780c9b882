// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace punctum
{

class Progress;

/// The LAS and LAZ files of some folders and virtual point clouds.
struct FoundFiles {
    std::vector<std::filesystem::path> files;  ///< of each folder in the order of their names
    std::uint64_t bytes = 0;                   ///< of all of them together
    std::uint64_t memory = 0;                  ///< likelyMemory() of all of them
    std::size_t closedFolders = 0;             ///< folders inside that could not be read
    std::size_t remote = 0;                    ///< named by a virtual point cloud, but on a server
};

/// About what a file needs in memory once it is read: LAZ unpacks to about 7 times its size.
std::uint64_t likelyMemory(const std::filesystem::path& file, std::uint64_t bytes);

/// Whether the name ends in .las or .laz, in any case.
bool isCloudName(const std::filesystem::path& path);

/// Adds the files of a folder, and of all folders in it, by the endings of their names. Links to folders are not
/// followed, so that no circle is walked; links to files are files. Any thread. Throws Error when `folder` itself
/// cannot be read, and Cancelled.
void findFiles(const std::filesystem::path& folder, FoundFiles& found, Progress& progress);

/// Whether this stands for several files: a folder, or a virtual point cloud (VirtualCloud.h).
bool standsForFiles(const std::filesystem::path& path);
/// findFiles() of a folder; of a virtual point cloud the files that it names. Throws likewise.
void addFilesOf(const std::filesystem::path& place, FoundFiles& found, Progress& progress);

}  // namespace punctum
