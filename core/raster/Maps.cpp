// SPDX-License-Identifier: MIT
#include "core/raster/Maps.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/above/GroundHeights.h"
#include "core/measure/Spacing.h"
#include "core/raster/MapPoints.h"
#include "core/raster/Terrain.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr std::pair<std::string_view, MapKind> kMapKinds[] = {{"dtm", MapKind::Dtm},
                                                              {"dsm", MapKind::Dsm},
                                                              {"chm", MapKind::Chm},
                                                              {"density", MapKind::Density},
                                                              {"hillshade", MapKind::Hillshade},
                                                              {"slope", MapKind::Slope},
                                                              {"aspect", MapKind::Aspect}};

constexpr double kPointsApart = 2.5;  ///< spacings of points a cell is wide by preset: some six points a cell
constexpr double kBridgeCells = 100.0;
constexpr int kFillCells = 3;

/// The attribute, which a copy keeps alive. Throws Error when there is none of that name, or no number.
Attribute mappedAttribute(const PointCloud& cloud, const std::string& name)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute(name);
    if (found == nullptr) throw Error("There is no attribute " + name + ".");
    if (found->kind == AttributeKind::Opaque || found->columns[0]->components() != 1)
        throw Error("The attribute " + name + " is no number.");
    if (found->components != 1)
        throw Error("The attribute " + name + " has several parts; name one of them, such as Red.");
    return *found;
}

bool isCodes(const Attribute& attribute)
{
    return attribute.kind == AttributeKind::Class || attribute.kind == AttributeKind::Category;
}

/// "Classification in (2, 9)" of "2,9".
std::string classCondition(const std::string& classes)
{
    std::string list, number, from;
    const auto close = [&] {
        if (number.empty()) throw Error("\"" + classes + "\" is no list of classes, such as 2,9.");
        if (from.empty())
            list += (list.empty() ? "Classification == " : " or Classification == ") + number;
        else
            list += (list.empty() ? "(" : " or (") + std::string("Classification >= ") + from +
                    " and Classification <= " + number + ")";
        number.clear();
        from.clear();
    };
    for (const char c : classes) {
        if (std::isdigit(static_cast<unsigned char>(c)) != 0 && number.size() < 3) {
            number += c;
        } else if (c == ',') {
            close();
        } else if (c == '-' && from.empty() && !number.empty()) {
            from.swap(number);
        } else if (c != ' ') {
            throw Error("\"" + classes + "\" is no list of classes, such as 2,9.");
        }
    }
    close();
    return list;
}

class MapMaker
{
public:
    MapMaker(const PointCloud& cloud, const MapRequest& request, Progress& progress)
        : m_cloud(cloud), m_request(request), m_progress(progress), m_lengths(trueLengths(cloud))
    {
    }

    MapOutcome make()
    {
        checkMapped(m_cloud);
        m_cell = m_request.cell > 0.0 || std::isnan(m_request.cell) ? m_request.cell : mapCell(m_cloud, m_progress);
        if (!std::isfinite(m_cell)) throw Error("The size of a cell must be more than 0.");
        MapOutcome map;
        switch (m_request.kind) {
            case MapKind::Attribute:
                return statisticMap();
            case MapKind::Density: {
                const auto points = pointsWhere(m_cloud, {m_request.where}, m_progress);
                map.raster = rasterize(m_cloud, mappedAttribute(m_cloud, "Z"), {Statistic::Kind::Count},
                                       frameOf(points.get()), points.get(), m_progress);
                const auto area = float(m_cell * m_lengths.stretch.x * m_cell * m_lengths.stretch.y);
                for (float& v : map.raster.values()) v /= area;
                return map;
            }
            case MapKind::Dtm:
                map.raster = dtm();
                return map;
            case MapKind::Dsm:
                map.raster = dsm();
                return map;
            case MapKind::Chm:
                map.raster = chm(map.finding);
                return map;
            default:
                break;
        }
        const Raster heights = m_request.reliefOfDsm ? dsm() : dtm();
        if (m_request.kind == MapKind::Slope) map.raster = slopeOf(heights, m_lengths.stretch, m_progress);
        if (m_request.kind == MapKind::Aspect) {
            map.raster = aspectOf(heights, m_lengths.stretch, m_progress);
            map.options.overview = GeoTiffOptions::Overview::Nearest;  // 359 and 1 have no mean of 180
        }
        if (m_request.kind == MapKind::Hillshade) {
            map.raster = hillshadeOf(heights, m_request.sun, m_lengths.stretch, m_progress);
            map.options.sample = GeoTiffOptions::Sample::Byte;
        }
        return map;
    }

private:
    RasterFrame frameOf(const PointSet* points) const
    {
        return rasterFrame(boundsOfPoints(m_cloud, points, m_progress), m_cell);
    }

    MapOutcome statisticMap()
    {
        const Attribute attribute = mappedAttribute(m_cloud, m_request.attribute);
        const bool heights =
            m_request.attribute == "Z" && !m_request.noise && m_request.statistic.kind != Statistic::Kind::Count;
        const auto points =
            pointsWhere(m_cloud, {m_request.where, heights ? noNoise(m_cloud) : std::string()}, m_progress);
        MapOutcome map;
        map.raster =
            rasterize(m_cloud, attribute, m_request.statistic, frameOf(points.get()), points.get(), m_progress);
        if (isCodes(attribute)) map.options.overview = GeoTiffOptions::Overview::Nearest;
        if (m_request.fill.value_or(0) > 0)
            map.raster = holesFilled(map.raster, std::size_t(*m_request.fill), m_progress);
        return map;
    }

    /// All points that heights are taken of, but for single returns: the extent of maps of heights.
    const PointSet* heightPoints()
    {
        if (!m_haveHeightPoints)
            m_heightPoints = pointsWhere(
                m_cloud, {m_request.where, m_request.noise ? std::string() : noNoise(m_cloud)}, m_progress);
        m_haveHeightPoints = true;
        return m_heightPoints.get();
    }

    Raster dtm()
    {
        if (noNoise(m_cloud).empty()) throw Error("The points have no classes, so that none is ground.");
        std::shared_ptr<const PointSet> found =
            pointsWhere(m_cloud, {m_request.where, classCondition(m_request.ground)}, m_progress);
        PointSet ground = *found;
        found.reset();
        if (const auto deleted = deletedPoints(m_cloud)) ground.remove(*deleted);
        const PointIndex count = ground.count();
        if (count == 0)
            throw Error("No point is of class " + m_request.ground +
                        ", the ground; classify the ground first, or name other classes.");
        if (count < 3) throw Error("A surface needs three points of the ground at least.");
        const double bridge = m_request.bridge > 0.0
                                  ? m_request.bridge
                                  : kBridgeCells * m_cell * std::max(m_lengths.stretch.x, m_lengths.stretch.y);
        return surfaceHeights(m_cloud, ground, frameOf(heightPoints()), bridge, m_progress);
    }

    Raster highest(const Attribute& attribute)
    {
        const RasterFrame frame = frameOf(heightPoints());
        const auto points = pointsWhere(
            m_cloud, {m_request.where, m_request.noise ? std::string() : noNoise(m_cloud), firstReturns(m_cloud)},
            m_progress);
        Raster raster = rasterize(m_cloud, attribute, {Statistic::Kind::Max}, frame, points.get(), m_progress);
        const int fill = m_request.fill.value_or(kFillCells);
        return fill > 0 ? holesFilled(raster, std::size_t(fill), m_progress) : raster;
    }

    Raster dsm() { return highest(mappedAttribute(m_cloud, "Z")); }

    Raster chm(std::string& finding)
    {
        Raster heights;
        bool known = false;
        {
            const std::shared_lock lock(m_cloud.mutex());
            known = m_cloud.findAttribute(kHeightName) != nullptr;
        }
        const ClassSet ground = parseClasses(m_request.ground).value_or(ClassSet());
        if (known && hasHeightsAbove(m_cloud, ground, m_progress)) {
            heights = highest(mappedAttribute(m_cloud, kHeightName));
            finding = "Heights are those of the attribute HeightAboveGround.";
        } else {
            if (known)
                finding =
                    "HeightAboveGround is not of the ground as it is now, so heights are the surface less the "
                    "terrain.";
            heights = dsm();
            const Raster terrain = dtm();
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, heights.values().size(), 1 << 14),
                              [&](const auto& range) {
                                  for (std::size_t i = range.begin(); i != range.end(); ++i)
                                      heights.values()[i] -= terrain.values()[i];
                              });
        }
        for (float& v : heights.values()) v = v < 0.0f ? 0.0f : v;  // NaN stays
        return m_request.pits > 0.0 ? pitsFilled(heights, m_request.pits, m_progress) : heights;
    }

    const PointCloud& m_cloud;
    const MapRequest& m_request;
    Progress& m_progress;
    TrueLengths m_lengths;
    double m_cell = 0;
    std::shared_ptr<const PointSet> m_heightPoints;
    bool m_haveHeightPoints = false;
};

}  // namespace

std::optional<MapKind> parseMapKind(std::string_view word)
{
    for (const auto& [name, kind] : kMapKinds)
        if (name == word) return kind;
    return std::nullopt;
}

std::string_view nameOf(MapKind kind) noexcept
{
    for (const auto& [name, known] : kMapKinds)
        if (known == kind) return name;
    return "attribute";
}

double mapCell(const PointCloud& cloud, Progress& progress)
{
    const glm::dvec3 stretch = trueLengths(cloud).stretch;
    const double spacing = pointSpacing(cloud, stretch, progress);
    return spacing > 0.0 ? roundLength(kPointsApart * spacing / std::max(stretch.x, stretch.y)) : 1.0;
}

MapOutcome makeMap(const PointCloud& cloud, const MapRequest& request, Progress& progress)
{
    return MapMaker(cloud, request, progress).make();
}

}  // namespace punctum
