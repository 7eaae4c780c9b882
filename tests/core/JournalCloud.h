// SPDX-License-Identifier: MIT
#pragma once

#include "tests/core/MadeCloud.h"

#include <memory>
#include <random>
#include <string>

namespace punctum
{

inline constexpr PointIndex kPoints = 20'011;

inline std::shared_ptr<PointCloud> makeCloud()
{
    const auto cloud = makeFrame(kPoints);
    const auto intensity = addScalar<std::uint16_t>(*cloud, "Intensity");
    addScalar<std::uint64_t>(*cloud, "Big id");
    std::mt19937_64 random(1);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int32_t& v : rawAxis(*cloud, axis)) v = std::int32_t(random() % 10'000);
    for (std::uint16_t& v : intensity) v = std::uint16_t(random());
    return cloud;
}

/// With A, B, C and a composite that shows them.
inline std::shared_ptr<PointCloud> makeCloudOfParts()
{
    auto cloud = makeCloud();
    Attribute composite;
    composite.name = "ABC";
    composite.kind = AttributeKind::Vector;
    composite.components = 3;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string name(1, char('A' + c));
        addScalar<std::uint8_t>(*cloud, name)[7] = std::uint8_t(c + 1);
        composite.columns[c] = cloud->findAttribute(name)->columns[0];
    }
    cloud->addAttribute(composite);
    return cloud;
}

}  // namespace punctum
