// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/edit/Preview.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace punctum
{

class Command;
class Progress;

/// How a cloud would look on the other side of a command: after one that has been made and not done, or before one
/// that is done.
struct CommandPreview {
    /// Null where there is nothing to be seen: an attribute that is renamed or goes.
    std::shared_ptr<const Preview> preview;
    PointIndex changed = 0;  ///< points with other values, or that are deleted or restored
    bool deletes = false;    ///< they are deleted, or restored
    /// Of points whose class changes, most frequent first; of points that are deleted all, with no class after.
    struct ClassChange {
        std::uint8_t from = 0;
        std::optional<std::uint8_t> to;
        PointIndex points = 0;
        friend bool operator==(const ClassChange&, const ClassChange&) = default;
    };
    std::vector<ClassChange> classes;
};

/// Changes neither; nobody else may do or undo the command, or another one of the cloud, meanwhile. `shows`: the
/// attribute worth looking at where the command brings several. Memory: a copy of each column whose values the
/// command swaps (a byte a point for classes), and a bit a point; what it brings new is shared with it, so that the
/// preview has to end before the command is done. Takes cloud.mutex() shared, for some 20 ms at a time where all
/// points are looked at. Throws Cancelled, and Error when the command cannot be read back.
CommandPreview previewOf(const Command& command, const PointCloud& cloud, Progress& progress,
                         std::string_view shows = {});

}  // namespace punctum
