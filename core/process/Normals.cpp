// SPDX-License-Identifier: MIT
#include "core/process/Normals.h"

#include "core/Error.h"
#include "core/process/Neighbors.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

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

/// The attributes to fill: of the type that the cloud has under these names, if any.
std::vector<Attribute> makeAttributes(const PointCloud& cloud)
{
    std::vector<Attribute> attributes;
    const std::shared_lock lock(cloud.mutex());
    for (const char* name : kNames) {
        Attribute a;
        a.name = name;
        a.description = "normal, upward";
        ScalarType type = ScalarType::F32;
        if (const Attribute* there = cloud.findAttribute(name)) {
            if (!isFloating(there->type()) || there->scaled || there->components != 1 ||
                there->columns[0]->components() != 1)
                throw Error(std::string("normals: the cloud's attribute ") + name +
                            " does not hold plain decimal numbers, so normals cannot be kept in it.");
            type = there->type();
        }
        a.columns[0] = std::make_shared<Column>(name, type, cloud.size());
        attributes.push_back(std::move(a));
    }
    const bool oneType =
        attributes[0].type() == attributes[1].type() && attributes[0].type() == attributes[2].type();
    if (oneType) {
        Attribute vector = attributes[0];
        vector.name = "Normal";
        vector.kind = AttributeKind::Vector;
        vector.components = 3;
        for (std::size_t c = 0; c < 3; ++c) vector.columns[c] = attributes[c].columns[0];
        attributes.push_back(std::move(vector));
    }
    return attributes;
}

}  // namespace

std::string NormalsStep::help() const
{
    return "Fits a plane to the neighbors of each point (PCL, least squares) and keeps its normal, turned upward, "
           "as NormalX, NormalY, NormalZ. Points without a plane get (0, 0, 0).";
}

std::vector<StepParameter> NormalsStep::parameters() const
{
    return {{.key = "k",
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
             .unit = StepParameter::Unit::Length}};
}

std::unique_ptr<Command> NormalsStep::run(const PointCloud& cloud, const StepValues& values,
                                          Progress& progress) const
{
    const StepValues complete = completeValues(*this, values);
    if (cloud.size() == 0) return nullptr;
    auto attributes = makeAttributes(cloud);
    std::array<Column*, 3> columns{};
    for (std::size_t c = 0; c < 3; ++c) columns[c] = attributes[c].columns[0].get();
    const auto visit = [&columns](const Neighborhood& n) {
        const auto normal = normalOf(n);
        for (std::size_t c = 0; c < 3; ++c) {
            if (columns[c]->type() == ScalarType::F32)
                reinterpret_cast<float*>(columns[c]->data())[n.point] = normal[c];
            else
                reinterpret_cast<double*>(columns[c]->data())[n.point] = double(normal[c]);
        }
    };
    const auto places = KdOrder::of(cloud, progress);
    const KdOrder& order = *places;
    if (const auto radius = realValue(complete, "radius"))
        forEachWithin(order, *radius, "Fitting normals", progress, visit);
    else
        forEachNearest(order, std::size_t(*integerValue(complete, "k")), "Fitting normals", progress, visit);
    return std::make_unique<AttributesCommand>("Normals", std::move(attributes));
}

}  // namespace punctum
