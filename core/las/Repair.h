// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Doctor.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace punctum::las
{

/// What repair() did.
struct RepairReport {
    std::vector<Finding> mended;  ///< put right in the new file
    std::vector<Finding> left;    ///< that cannot be mended without guessing
    bool written = false;         ///< false: there was nothing to mend, and no file was made
    std::uint64_t points = 0;     ///< of the new file: those that could be read
    std::uint64_t bytes = 0;
    std::vector<std::string> notes;  ///< one sentence each
};

/// Writes `out`: the bytes of `in` behind a header with all that is repairable put right (counts, points by return,
/// bounds, number and position of records, encoding bits), so that points, records and all other bytes are those of
/// `in`. Before it takes its name the new file is read: its points and records must be those of `in`, and the
/// doctor must find nothing more that is repairable. LAS stays LAS, and LAZ stays LAZ. Nothing is written where
/// nothing can be mended. Throws Error (nothing is left behind, an existing `out` is untouched) or Cancelled.
RepairReport repair(const std::filesystem::path& in, const std::filesystem::path& out, Progress& progress);

}  // namespace punctum::las
