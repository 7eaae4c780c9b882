// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Journal.h"

#include <string>

namespace punctum
{

class History;
class Progress;

/// What came of a journal.
struct Replayed {
    std::size_t entries = 0;  ///< that were followed
    std::string stopped;      ///< a sentence when one could not be, and the rest with it; else empty
};

/// Does what one entry tells, as replay() does. Throws Error and what a step throws, with nothing changed.
void follow(const JournalEntry& entry, const PointCloud& cloud, History& history, Progress& progress);

/// Does what a journal tells on the cloud that it was begun with, through its history, so that all of it can be
/// undone. Each entry must change as many points as it did then: if one does not, or fails, it stops before it.
/// Throws Error when the journal is about another cloud, and Cancelled, with what is done so far in force.
Replayed replay(const JournalContents& journal, const PointCloud& cloud, History& history, Progress& progress);

}  // namespace punctum
