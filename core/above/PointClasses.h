// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/ClassNames.h"
#include "core/cloud/PointCloud.h"
#include "core/process/Values.h"

#include <cstdint>

namespace punctum
{

class Progress;

/// Reads the class of points. The columns are shared; hold cloud.mutex() shared while reading.
class ClassReader
{
public:
    /// Takes cloud.mutex() shared. Throws Error when the cloud has no classes.
    explicit ClassReader(const PointCloud& cloud);
    unsigned operator()(PointIndex point) const noexcept
    {
        return unsigned(m_bytes[point] >> m_attribute.bitShift) & m_mask;
    }
    const Attribute& attribute() const noexcept { return m_attribute; }

private:
    Attribute m_attribute;
    const std::uint8_t* m_bytes = nullptr;
    unsigned m_mask = 0xFF;
};

/// The points of some classes that are not deleted. Takes cloud.mutex() shared for some 20 ms at a time. Throws
/// Cancelled, and Error when the cloud has no classes.
PointSet pointsOfClasses(const PointCloud& cloud, const ClassSet& classes, Progress& progress);

}  // namespace punctum
