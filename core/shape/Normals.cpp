// SPDX-License-Identifier: MIT
#include "core/shape/Normals.h"

#include "core/Error.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Values.h"
#include "core/shape/KOrRadius.h"
#include "core/shape/NormalColumns.h"
#include "core/shape/Orientation.h"
#include "core/shape/Spread.h"
#include "core/task/Progress.h"

#include <array>
#include <optional>

namespace punctum
{

namespace
{

/// "x,y,z" in the coordinates of the file -> raw ones.
std::optional<KdOrder::Place> viewpointOf(const PointCloud& cloud, std::string_view text)
{
    if (text.empty()) return {};
    KdOrder::Place place{};
    for (int a = 0; a < 3; ++a) {
        const std::size_t end = a < 2 ? text.find(',') : text.size();
        const auto number = end == std::string_view::npos ? std::nullopt : parseNumber(text.substr(0, end));
        if (!number) throw Error("normals: viewpoint must be three numbers such as 457000,5552000,120.");
        text.remove_prefix(std::min(end + 1, text.size()));
        const auto& grid = cloud.coordinates();
        place[std::size_t(a)] = (toDouble(*number) - grid.offset[a]) / grid.scale[a];
    }
    return place;
}

/// Whether it looks away from the viewpoint.
bool looksAway(const KdOrder& order, std::uint32_t point, const KdOrder::Place& viewpoint, const Spread::Vector& n)
{
    const KdOrder::Raw raw = order.raw(point);
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += (viewpoint[a] - double(raw[a])) * order.scale()[a] * n[a];
    return sum < 0;
}

}  // namespace

const StepDescription& NormalsStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "normals",
        .title = "Normals",
        .group = StepGroup::Shape,
        .help =
            "Fits a plane to the neighbors of each point (least squares) and keeps its normal as NormalX, NormalY, "
            "NormalZ, or in the normals that the file has. Points without a plane get (0, 0, 0).",
        .source = "Hoppe et al. 1992",
        .parameters = kOrRadiusParameters(
            "How many nearest points the plane is fitted to, the point itself among them.",
            "Use all points within this distance instead of k nearest ones.",
            {{.key = "orientation",
              .label = "Orientation",
              .help = "With up none looks down; with viewpoint all look to a place, such as a scanner's; with "
                      "tree neighbors agree (a spanning tree), also around walls and below roofs.",
              .type = Type::Choice,
              .preset = "up",
              .choices = {"up", "viewpoint", "tree"}},
             {.key = "viewpoint",
              .label = "Viewpoint",
              .help = "Where they look, x,y,z in the file's coordinates.",
              .type = Type::Text,
              .optional = true,
              .when = {"orientation", "viewpoint"}},
             {.key = "curvature",
              .label = "Curvature",
              .help = "Also keeps how much the surface bends, as Curvature: the least spread of the neighbors "
                      "as a share of the whole, 0 on planes, a third at most.",
              .type = Type::Choice,
              .preset = "no",
              .advanced = true,
              .choices = {"no", "yes"}}}),
        .shows = "Normal"};
    return about;
}

std::unique_ptr<Command> NormalsStep::make(const PointCloud& cloud, const StepValues& values,
                                           const PointSet* within, Progress& progress) const
{
    const std::string orientation = textValue(values, "orientation");
    const auto viewpoint = viewpointOf(cloud, textValue(values, "viewpoint"));
    if (orientation == "viewpoint" && !viewpoint)
        throw Error("normals: give the viewpoint as viewpoint=x,y,z, to which the normals turn.");
    if (cloud.size() == 0) return nullptr;
    NormalColumns normals(cloud);
    std::optional<FilledAttribute> curvature;
    if (textValue(values, "curvature") == "yes")
        curvature.emplace(cloud, FilledAttribute::Description{"Curvature", "surface variation, 0 to 1/3"});
    const auto places = KdOrder::of(cloud, progress);
    const KdOrder& order = *places;
    const bool up = orientation == "up", view = orientation == "viewpoint";
    const auto visit = [&](const Neighborhood& n) {
        const Spread spread = spreadOf(n.offsets);
        Spread::Vector normal = spread.least;
        if ((up && normal[2] < 0) || (view && looksAway(order, n.point, *viewpoint, normal)))
            for (double& c : normal) c = -c;
        // no negative zeros
        normals.set(n.point, {float(normal[0]) + 0.0f, float(normal[1]) + 0.0f, float(normal[2]) + 0.0f});
        if (curvature) curvature->set(n.point, spread.sum() > 0 ? spread.l3() / spread.sum() : 0.0);
    };
    forEachByKOrRadius(order, values, "Fitting normals", progress, visit, within);
    if (orientation == "tree") orientBySpanningTree(order, normals, cloud.size(), within, progress);
    std::vector<Attribute> attributes = normals.attributes();
    if (curvature) attributes.push_back(curvature->attribute());
    return std::make_unique<AttributesCommand>("Normals", std::move(attributes));
}

}  // namespace punctum
