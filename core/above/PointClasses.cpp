// SPDX-License-Identifier: MIT
#include "core/above/PointClasses.h"

#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/task/Progress.h"

#include <algorithm>

namespace punctum
{

ClassReader::ClassReader(const PointCloud& cloud)
    : m_attribute(classAttribute(cloud, 0)),
      m_bytes(m_attribute.columns[0]->values<std::uint8_t>().data()),
      m_mask(unsigned(m_attribute.maxBits()))
{
}

PointSet pointsOfClasses(const PointCloud& cloud, const ClassSet& classes, Progress& progress)
{
    const ClassReader classOf(cloud);
    PointSet points(cloud.size());
    const auto deleted = deletedPoints(cloud);
    progress.begin("Looking at classes", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            const PointIndex first = PointIndex(w) * 64, last = std::min(cloud.size(), first + 64);
            std::uint64_t bits = 0;
            for (PointIndex i = first; i < last; ++i) bits |= std::uint64_t(classes[classOf(i)]) << (i - first);
            points.words()[w] = bits & shownBits(cloud.size(), deleted.get(), w);
        }
    });
    return points;
}

}  // namespace punctum
