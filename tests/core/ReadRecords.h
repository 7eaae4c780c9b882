// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"

#include <stdexcept>

namespace lasfiles
{

/// All records of the file, as our reader gives them. Throws when some are missing.
inline Bytes recordsByUs(const std::filesystem::path& path)
{
    const auto reader = punctum::las::Reader::open(path);
    const std::size_t length = reader->source()->layout.length;
    Bytes all(std::size_t(reader->source()->pointCount) * length);
    punctum::Progress progress;
    const auto result =
        reader->visitRecords(progress, [&](punctum::PointRange r, std::span<const std::byte> bytes) {
            std::memcpy(all.data() + r.first * length, bytes.data(), bytes.size());
        });
    if (!result.missing.empty()) throw std::runtime_error("points are missing: " + result.warnings.front());
    return all;
}

}  // namespace lasfiles
