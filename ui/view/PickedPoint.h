// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <QString>

#include <glm/vec3.hpp>

#include <memory>
#include <optional>

namespace punctum::ui
{

/// A point under the cursor.
struct PickedPoint {
    std::shared_ptr<const PointCloud> cloud;
    PointIndex index = 0;
    glm::dvec3 world{0.0};
    std::optional<unsigned> classCode;
    QString attribute;  ///< the one on screen, and the point's value of it
    QString value;
};

/// What the status bar says of the point under the cursor: its place, class, and value of what is shown.
QString readOutText(const PickedPoint& point);

}  // namespace punctum::ui
