// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace punctum
{

/// Opens a new file for reading and writing in this folder, which is made where it is missing, and takes its name
/// away at once: nothing of it is left however the program ends. `kind`: what its name begins with meanwhile.
/// The file descriptor; -1, and errno, where it cannot be made. Any thread.
int openNameless(const std::filesystem::path& folder, const std::string& kind);

}  // namespace punctum
