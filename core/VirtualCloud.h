// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace punctum
{

/// What a virtual point cloud names: a .vpc file, as QGIS writes it, that stands for the files of a survey. It is a
/// STAC feature collection (JSON), in which each feature's asset with the role "data", or of the name "data", is a
/// file; overviews are not.
struct VirtualCloud {
    std::vector<std::filesystem::path> files;  ///< as the .vpc has them, each once; relative ones beside it
    std::size_t remote = 0;                    ///< files that lie on servers, and are left out
};

/// Whether the name ends in .vpc, in any case.
bool isVirtualCloudName(const std::filesystem::path& path);

/// Any thread. Throws Error with one sentence where it is no virtual point cloud, or names no file.
VirtualCloud readVirtualCloud(const std::filesystem::path& path);

}  // namespace punctum
