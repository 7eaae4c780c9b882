// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/CloudKey.h"
#include "core/edit/Extract.h"
#include "core/sample/Sample.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <array>
#include <memory>
#include <random>

/// The clouds that journals and expressions are tried on: always the same.
namespace fuzz
{

inline constexpr punctum::PointIndex kPoints = 150;  ///< two words of a set, and a part of one

/// With narrow classes, a wide id, scaled integers with one that stands for none, a composite, and bytes that
/// nobody described.
inline std::shared_ptr<punctum::PointCloud> oddCloud()
{
    auto cloud = punctum::makeFrame(kPoints, {glm::dvec3(0.01), glm::dvec3(100.0)}, true);
    const auto ids = punctum::addScalar<std::uint64_t>(*cloud, "Big id", punctum::AttributeKind::Category);
    const auto time = punctum::addScalar<double>(*cloud, "GpsTime");
    const auto height = punctum::addScalar<std::int16_t>(*cloud, "Height");
    std::mt19937_64 random(7);
    for (punctum::PointIndex i = 0; i < kPoints; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            punctum::rawAxis(*cloud, axis)[i] = std::int32_t(random() % 2000);
        cloud->columns()[3]->values<std::uint8_t>()[i] = std::uint8_t(random());
        ids[i] = random();
        time[i] = double(random() % 100000) / 64.0;
        height[i] = std::int16_t(random());
    }
    punctum::Attribute scaled = *cloud->findAttribute("Height");
    scaled.scaled = true;
    scaled.scale = 0.01;
    scaled.noData = std::int64_t(-32768);
    scaled.unit = "m";
    cloud->replaceAttribute(scaled);
    for (const char* name : {"A", "B", "C"}) {
        const auto values = punctum::addScalar<float>(*cloud, name);
        for (float& v : values) v = float(random() % 1000);
    }
    punctum::addComposite(*cloud, "ABC", punctum::AttributeKind::Vector, {"A", "B", "C"});
    punctum::Attribute bytes;
    bytes.name = "Undescribed";
    bytes.kind = punctum::AttributeKind::Opaque;
    bytes.columns[0] =
        cloud->addColumn(std::make_shared<punctum::Column>("Undescribed", punctum::ScalarType::U8, kPoints, 5));
    cloud->addAttribute(bytes);
    return cloud;
}

struct Fixed {
    std::shared_ptr<punctum::PointCloud> cloud{};
    punctum::CloudKey key{};
};

/// The odd one, or a sample of point format 7. Neither is changed by anybody.
inline const Fixed& fixedCloud(bool odd)
{
    static const std::array<Fixed, 2> both = [] {
        punctum::Progress progress;
        std::array<Fixed, 2> made;
        made[0].cloud = punctum::makeSample(kPoints, 1, progress);
        made[1].cloud = oddCloud();
        for (Fixed& one : made) one.key = punctum::keyOf(*one.cloud, progress);
        return made;
    }();
    return both[odd ? 1 : 0];
}

inline std::shared_ptr<punctum::PointCloud> copyOf(const punctum::PointCloud& cloud)
{
    punctum::Progress progress;
    punctum::PointSet all(cloud.size());
    all.invert();
    return punctum::extracted(cloud, all, progress);
}

}  // namespace fuzz
