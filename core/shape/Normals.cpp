// SPDX-License-Identifier: MIT
#include "core/shape/Normals.h"

#include "core/neighbors/Neighbors.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace punctum
{

namespace
{

constexpr std::array<const char*, 3> kNames = {"NormalX", "NormalY", "NormalZ"};

/// The plane's normal, turned upward; zero when there is no plane.
std::array<float, 3> normalOf(const Neighborhood& n)
{
    // PCL's versions differ in what they make of points that are all in one place.
    const auto samePlace = [&](const auto& offset) { return offset == n.offsets[0]; };
    if (n.offsets.size() < 3 || std::all_of(n.offsets.begin(), n.offsets.end(), samePlace)) return {0, 0, 0};
    thread_local pcl::PointCloud<pcl::PointXYZ> patch;  // keeps its memory from point to point
    patch.resize(n.offsets.size());
    for (std::size_t k = 0; k < n.offsets.size(); ++k)
        patch[k].getVector3fMap() = Eigen::Vector3f(n.offsets[k][0], n.offsets[k][1], n.offsets[k][2]);
    Eigen::Vector4f plane;
    float curvature = 0;
    if (!pcl::computePointNormal(patch, plane, curvature)) return {0, 0, 0};
    const float length = plane.head<3>().norm();
    if (!std::isfinite(length) || length < 0.5f) return {0, 0, 0};
    const float turn = (plane[2] < 0 ? -1.0f : 1.0f) / length;
    return {plane[0] * turn, plane[1] * turn, plane[2] * turn + 0.0f};
}

}  // namespace

const StepDescription& NormalsStep::description() const
{
    static const StepDescription about{
        .name = "normals",
        .title = "Normals",
        .group = StepGroup::Shape,
        .help =
            "Fits a plane to the neighbors of each point (PCL, least squares) and keeps its normal, turned "
            "upward, as NormalX, NormalY, NormalZ. Points without a plane get (0, 0, 0).",
        .parameters = {{.key = "k",
                        .label = "Neighbors",
                        .help = "How many nearest points the plane is fitted to, the point itself among them.",
                        .type = StepParameter::Type::Integer,
                        .preset = "16",
                        .min = 3,
                        .max = 1000},
                       {.key = "radius",
                        .label = "Radius",
                        .help = "Use all points within this distance instead of k nearest ones.",
                        .min = 1e-9,
                        .max = 1e9,
                        .optional = true,
                        .unit = StepParameter::Unit::Length}},
        .shows = "Normal"};
    return about;
}

std::unique_ptr<Command> NormalsStep::make(const PointCloud& cloud, const StepValues& values,
                                           const PointSet* within, Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    std::vector<FilledAttribute> filled;
    for (const char* name : kNames)
        filled.emplace_back(cloud, FilledAttribute::Description{name, "normal, upward"});
    const auto visit = [&](const Neighborhood& n) {
        if (within != nullptr && !within->contains(n.point)) return;
        const auto normal = normalOf(n);
        for (std::size_t c = 0; c < 3; ++c) filled[c].set(n.point, double(normal[c]));
    };
    const auto places = KdOrder::of(cloud, progress);
    const KdOrder& order = *places;
    if (const auto radius = realValue(values, "radius"))
        forEachWithin(order, *radius, "Fitting normals", progress, visit);
    else
        forEachNearest(order, std::size_t(*integerValue(values, "k")), "Fitting normals", progress, visit);
    std::vector<Attribute> attributes;
    for (const FilledAttribute& f : filled) attributes.push_back(f.attribute());
    if (attributes[0].type() == attributes[1].type() && attributes[0].type() == attributes[2].type())
        attributes.push_back(composedOf("Normal", AttributeKind::Vector, filled[0], filled[1], filled[2]));
    return std::make_unique<AttributesCommand>("Normals", std::move(attributes));
}

}  // namespace punctum
