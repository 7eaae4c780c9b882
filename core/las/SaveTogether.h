// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Writer.h"

#include <vector>

namespace punctum::las
{

/// Gives staged files their names, all or none: the second step of saving several files.
///
/// Whatever can be looked at is looked at first (changed by others, protected, no right to the folder); then it is
/// noted down, synced, in a hidden manifest beside the files which of them are to get their names; from there on
/// the save counts, and a program that is killed leaves it to finishSaves() (FinishSaves.h). See docs/dev/las.md.
///
/// Gives the reports in the order of `stages`, whose sources are brought up to date as by StagedWrite::commit().
/// Throws Error: before the save counts, with nothing changed and nothing left; after it, only where the system
/// keeps one of several files from getting its name after another has got it. The sentence then says which are
/// saved, and which follow when one of them is opened next. Any thread; programs that open the files meanwhile wait
/// for it in finishSaves().
std::vector<WriteReport> commitTogether(std::vector<StagedWrite> stages);

}  // namespace punctum::las
