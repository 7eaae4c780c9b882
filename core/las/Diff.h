// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/AttributeChange.h"
#include "core/las/Difference.h"
#include "core/las/Writer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace punctum::las
{

struct DiffOptions {
    bool bytes = false;  ///< also find the first byte in which the files differ (Difference::firstByte)
};

/// Compares two files, point k of one with point k of the other, in parallel. Where one lacks points of the other,
/// and has the others in their order, each is compared with itself (partOf()). Memory: nothing where one of them is
/// LAS, else the records of one. Warnings of both files come in `warnings`. Throws Error (a file cannot be opened
/// or read) or Cancelled.
Difference diffFiles(const std::filesystem::path& a, const std::filesystem::path& b, const DiffOptions& options,
                     Progress& progress, std::vector<std::string>* warnings = nullptr);

/// What saving would change.
struct SavePreview {
    Difference difference;                  ///< A: the file; B: what write() would make of the cloud now
    std::vector<std::string> notes;         ///< what is left out or upgraded, one sentence each
    std::shared_ptr<const WritePlan> plan;  ///< by which write() can write it, as long as the cloud is the same
};

/// Whether something of A is not in B, or B has another LAS version or point format: what people want to be asked
/// about before they save.
bool dropsOrUpgrades(const Difference& difference);

/// Compares the cloud with the file at `original`, from which it was read or to which it was saved last, as
/// write() with the same arguments would write it. Reads the original once; no memory. Holds cloud.mutex() shared
/// meanwhile. With `changes` (of the cloud's history) it believes these and reads no points, so that it is quick;
/// the attributes then lack first points and values. `known`: a plan of before, for the same arguments. Throws
/// Error (the original is gone or changed, or the cloud cannot be written so) or Cancelled.
SavePreview previewSave(const PointCloud& cloud, const std::filesystem::path& original,
                        const std::filesystem::path& target, const WriteOptions& options, Progress& progress,
                        const std::vector<AttributeChange>* changes = nullptr, const KnownPlan& known = {});

}  // namespace punctum::las
