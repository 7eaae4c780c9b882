// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <optional>

namespace punctum
{

/// The attributes that hold the three components of normals, under the names that programs give them: NormalX,
/// "normal x" (Metashape: whole numbers with a scale), nx, ...; capitals, blanks and marks between do not matter.
/// The caller holds cloud.mutex().
std::optional<std::array<const Attribute*, 3>> normalParts(const PointCloud& cloud);

/// Adds the vector Normal where they are there and have one type.
void addNormalVector(PointCloud& cloud);

}  // namespace punctum
