// SPDX-License-Identifier: MIT
#include "core/above/GroundHeights.h"

#include "core/Error.h"
#include "core/above/PointClasses.h"
#include "core/above/TriangulatedGround.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Units.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr std::size_t kHeightPiece = 4096;  ///< points between two looks at the cancel flag
constexpr double kHeightsDiffer = 0.05;     ///< meters: more than programs round heights by

/// "2, 9 and 10"
std::string classList(const ClassSet& classes)
{
    std::string text;
    for (unsigned code = 0; code < 256; ++code)
        if (classes[code]) text += (text.empty() ? "" : ", ") + std::to_string(code);
    return text;
}

/// The height of the ground at a place by its nearest points, in raw steps.
double heightByNearest(const std::vector<GroundTree::Near>& near)
{
    double weights = 0, sum = 0;
    // Where points of the ground are in the place itself, they alone count.
    const bool at = near.front().squared == 0;
    for (const GroundTree::Near& n : near) {
        if (at && n.squared > 0) break;
        const double weight = at ? 1.0 : 1.0 / std::sqrt(n.squared);
        weights += weight;
        sum += weight * double(n.place.z);
    }
    return sum / weights;
}

/// Calls each(point) for the points that are asked for, in parallel.
template <typename Each>
void forAsked(const PointCloud& cloud, const PointSet* within, Progress& progress, Each&& each)
{
    const auto deleted = deletedPoints(cloud);
    tbb::parallel_for(tbb::blocked_range<PointIndex>(0, cloud.size(), kHeightPiece), [&](const auto& range) {
        for (PointIndex first = range.begin(); first < range.end() && !progress.cancelled();
             first += kHeightPiece) {
            const PointIndex last = std::min(range.end(), first + kHeightPiece);
            for (PointIndex i = first; i < last; ++i) {
                if (deleted && deleted->contains(i)) continue;
                if (within != nullptr && !within->contains(i)) continue;
                each(i);
            }
            progress.add(last - first);
        }
    });
    progress.check();
}

/// The attribute's values, where every point that is not deleted has one.
std::vector<float> keptHeights(const PointCloud& cloud, Progress& progress)
{
    Attribute kept;
    {
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const found = cloud.findAttribute(kHeightName);
        if (found == nullptr || found->components != 1 || found->columns[0]->components() != 1) return {};
        kept = *found;
    }
    const auto deleted = deletedPoints(cloud);
    std::vector<float> heights(cloud.size());
    std::atomic<bool> whole = true;
    progress.begin("Reading heights", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        std::vector<double> values(range.size());
        kept.read(range, values.data());
        for (PointIndex i = range.first; i < range.last; ++i) {
            heights[i] = float(values[i - range.first]);
            if (std::isnan(heights[i]) && !(deleted && deleted->contains(i))) whole = false;
        }
    });
    if (!whole) heights.clear();
    return heights;
}

/// Whether heights are those above these points of the ground: hasHeightsAbove().
bool areHeightsAbove(const PointCloud& cloud, const std::vector<float>& heights, const ClassSet& ground,
                     Progress& progress)
{
    {
        const std::shared_lock lock(cloud.mutex());
        if (ground.none() || cloud.findAttribute("Classification") == nullptr) return true;
    }
    if (pointsOfClasses(cloud, ground, progress).count() == 0) return true;
    const double meters = trueLengths(cloud).meters;
    const double most = kHeightsDiffer / (meters > 0 ? meters : 1.0);
    const ClassReader classOf(cloud);
    const auto deleted = deletedPoints(cloud);
    PointSet doubtful(cloud.size());
    std::atomic<bool> differ = false;
    progress.begin("Comparing heights with the ground", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        for (PointIndex i = range.first; i < range.last; ++i) {
            const bool ofGround = ground[classOf(i)];
            if (deleted && deleted->contains(i)) {
                // those deleted before heights were measured have none
                if (ofGround && !std::isnan(heights[i])) differ = true;
            } else if (ofGround ? std::fabs(double(heights[i])) > most : heights[i] == 0.0f) {
                doubtful.insert(i);
            }
        }
    });
    if (differ || doubtful.count() == 0) return !differ;
    const GroundTree tree = groundOf(cloud, ground, kHeightName, progress);
    measureHeights(cloud, tree, GroundModel::Triangulated, kGroundNeighbors, &doubtful, progress,
                   [&](PointIndex i, double height) {
                       if (std::fabs(height - double(heights[i])) > most) differ = true;
                   });
    return !differ;
}

/// Those of the attribute where they are of the ground as it is; else no values, and the sentence that says so.
PointHeights heightsOfAttribute(const PointCloud& cloud, const ClassSet& ground, Progress& progress)
{
    PointHeights heights{keptHeights(cloud, progress), {}};
    if (heights.values.empty() || areHeightsAbove(cloud, heights.values, ground, progress)) return heights;
    return {{},
            std::string(kHeightName) +
                " is not of the ground as it is now, so heights were measured anew; run height to renew it."};
}

}  // namespace

StepParameter groundParameter(std::string help)
{
    return {.key = "ground",
            .label = "Ground",
            .help = std::move(help),
            .type = StepParameter::Type::ClassCodes,
            .preset = "2",
            .advanced = true};
}

GroundTree groundOf(const PointCloud& cloud, const ClassSet& classes, const std::string& name, Progress& progress)
{
    const PointSet ground = pointsOfClasses(cloud, classes, progress);
    if (ground.count() == 0)
        throw Error(name + " needs the ground, and no point has class " + classList(classes) +
                    "; run the step ground first, or name the classes of the ground.");
    const TrueLengths lengths = trueLengths(cloud);
    std::array<double, 3> scale{};
    for (int a = 0; a < 3; ++a)
        scale[std::size_t(a)] = std::fabs(cloud.coordinates().scale[a]) * lengths.stretch[a];
    return GroundTree(cloud, ground, scale, progress);
}

void measureHeights(const PointCloud& cloud, const GroundTree& ground, GroundModel surface, std::size_t k,
                    const PointSet* within, Progress& progress, const HeightVisitor& visit)
{
    if (surface == GroundModel::Triangulated) {
        measureTriangulated(cloud, ground, within, progress, visit);
        return;
    }
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    progress.begin("Measuring heights", cloud.size());
    forAsked(cloud, within, progress, [&](PointIndex i) {
        thread_local std::vector<GroundTree::Near> near;
        ground.nearest(x[i], y[i], k, near);
        visit(i, (double(z[i]) - heightByNearest(near)) * ground.scale()[2]);
    });
}

bool hasHeightsAbove(const PointCloud& cloud, const ClassSet& ground, Progress& progress)
{
    const std::vector<float> heights = keptHeights(cloud, progress);
    return !heights.empty() && areHeightsAbove(cloud, heights, ground, progress);
}

PointHeights heightsAboveGround(const PointCloud& cloud, const ClassSet& ground, const std::string& name,
                                Progress& progress)
{
    PointHeights heights = heightsOfAttribute(cloud, ground, progress);
    if (!heights.values.empty()) return heights;
    const GroundTree tree = groundOf(cloud, ground, name, progress);
    heights.values.assign(cloud.size(), std::numeric_limits<float>::quiet_NaN());
    measureHeights(cloud, tree, GroundModel::Triangulated, kGroundNeighbors, nullptr, progress,
                   [&](PointIndex i, double height) { heights.values[i] = float(height); });
    return heights;
}

HighPoints highPoints(const PointCloud& cloud, const ClassSet& ground, std::span<const double> least,
                      const std::string& name, Progress& progress)
{
    HighPoints high{std::vector<PointSet>(least.size(), PointSet(cloud.size())), {}};
    // As a float, as heights are kept: whoever asks for the heights themselves gets the same points.
    const auto tell = [&](PointIndex i, float height) {
        for (std::size_t k = 0; k < least.size(); ++k)
            if (double(height) >= least[k]) high.atLeast[k].insertShared(i);
    };
    {
        const PointHeights known = heightsOfAttribute(cloud, ground, progress);
        high.finding = known.finding;
        if (!known.values.empty()) {
            progress.begin("Comparing heights", cloud.size());
            forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
                const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
                for (PointIndex i = range.first; i < range.last; ++i) tell(i, known.values[i]);
            });
            return high;
        }
    }
    const GroundTree tree = groundOf(cloud, ground, name, progress);
    measureHeights(cloud, tree, GroundModel::Triangulated, kGroundNeighbors, nullptr, progress,
                   [&](PointIndex i, double height) { tell(i, float(height)); });
    return high;
}

}  // namespace punctum
