// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

/// Finishes saves of several files (commitTogether()) that were cut off when they counted already, and removes what
/// those left that did not; to be called before files are opened for editing. `places`: files, there or not, or
/// folders; each folder is looked through once, for names alone, so that thousands of files cost some milliseconds.
///
/// Gives a sentence for the user on each such save: that it is finished, or why it cannot be. A file that somebody
/// changed since is left as it is. A save that another program is about to finish is waited for, some seconds at
/// most. What a manifest asks for is done only to plain names beside it, and only with what a save of ours wrote.
/// Any thread; throws nothing but bad_alloc.
std::vector<std::string> finishSaves(std::span<const std::filesystem::path> places);

}  // namespace punctum::las
