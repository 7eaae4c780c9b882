// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <vector>

namespace punctum
{

/// The three attributes that a cloud's normals are in, to be filled and put into an AttributesCommand.
///
/// Those that the cloud has are taken (normalParts(): under other programs' names, too), with their types: decimal
/// numbers, or whole ones with a scale; and the values of points that are not set. A cloud without any gets
/// NormalX, NormalY, NormalZ (float32).
class NormalColumns
{
public:
    /// Takes cloud.mutex() shared. Throws Error where an attribute of these names cannot hold the values.
    explicit NormalColumns(const PointCloud& cloud);

    /// Any thread, each point by one.
    void set(PointIndex point, const std::array<float, 3>& normal) noexcept;
    std::array<float, 3> normal(PointIndex point) const noexcept;
    /// The three, and the vector Normal where they have one type.
    std::vector<Attribute> attributes() const;

private:
    std::array<Attribute, 3> m_parts;
};

}  // namespace punctum
