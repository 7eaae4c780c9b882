// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"

#include <filesystem>
#include <memory>

/// As the program loads and saves with no options: LAS or LAZ by the name.
namespace lasfiles
{

inline std::shared_ptr<punctum::PointCloud> load(const std::filesystem::path& path)
{
    punctum::Progress progress;
    return punctum::las::load(path, progress);
}

inline punctum::las::WriteReport save(const punctum::PointCloud& cloud, const std::filesystem::path& path)
{
    punctum::Progress progress;
    punctum::las::WriteOptions options;
    options.compressed = punctum::las::isCompressedName(path);
    return punctum::las::write(cloud, path, options, progress);
}

}  // namespace lasfiles
