// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <string>

namespace punctum
{

/// Refuses names that a file could not keep as they are (LAS 1.4 R15, table 24: 32 bytes), or that the cloud or the
/// standard has already. Hold cloud.mutex() shared. Throws Error.
void checkNewName(const PointCloud& cloud, const std::string& name);

}  // namespace punctum
