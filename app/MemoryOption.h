// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace punctum::app
{

/// Takes what follows --memory, such as "2G", "512M" or "1.5 GB" (powers of 1000, as all sizes are told; "2 GiB":
/// of 1024), as the memory budget of the program. A sentence where it is none; else empty.
std::string takeMemoryBudget(const std::string& text);

}  // namespace punctum::app
