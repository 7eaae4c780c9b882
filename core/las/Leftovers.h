// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace punctum::las
{

/// The name under which a file called `name` is written before it is whole: it tells the process, so that what a
/// killed one left behind can be known.
std::string temporaryName(const std::string& name);

/// One sentence for each temporary file beside `target` of a save of it that never ended, because its process was
/// killed or the power failed. They are named and never deleted: they may hold work that is nowhere else.
std::vector<std::string> unfinishedSaves(const std::filesystem::path& target);

}  // namespace punctum::las
