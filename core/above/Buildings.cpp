// SPDX-License-Identifier: MIT
#include "core/above/Buildings.h"

#include "core/Text.h"
#include "core/above/GroundHeights.h"
#include "core/above/PointClasses.h"
#include "core/above/RoofAreas.h"
#include "core/above/RoofPieces.h"
#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/task/Progress.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr double kRoofDegree = std::numbers::pi / 180;
constexpr double kSteepestRoof = 65 * kRoofDegree;
constexpr double kRoofBend = 12 * kRoofDegree;
constexpr double kLowShare = 0.25;   ///< of the least height of a roof: points so high are looked at, to tell decks
constexpr double kWallShare = 0.1;   ///< of the least height of a roof: so high are points of walls
constexpr double kDeckShare = 0.03;  ///< of a level piece: so much of it lower than a roof makes it a deck
constexpr double kPieceShare = 0.4;  ///< of the least area: so large is a piece at least
constexpr std::int32_t kEaves = 1;   ///< cells about a roof whose walls and edges are of the building

/// A field of small numbers; none where the cloud lacks it.
std::optional<Attribute> returnField(const PointCloud& cloud, const char* name)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute(name);
    return found == nullptr ? std::nullopt : std::optional(*found);
}

/// Those that are last returns.
PointSet lastReturnsOf(const PointCloud& cloud, PointSet points, Progress& progress)
{
    const auto number = returnField(cloud, "ReturnNumber"), count = returnField(cloud, "NumberOfReturns");
    if (!number || !count) return points;
    progress.begin("Looking at returns", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        std::vector<std::uint8_t> numbers(range.size()), counts(range.size());
        number->gatherBits(range, numbers.data());
        count->gatherBits(range, counts.data());
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            std::uint64_t bits = points.words()[w];
            for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1) {
                const auto bit = std::uint64_t(std::countr_zero(rest));
                const PointIndex at = PointIndex(w) * 64 + bit - range.first;
                if (numbers[at] < counts[at]) bits &= ~(std::uint64_t(1) << bit);
            }
            points.words()[w] = bits;
        }
    });
    return points;
}

/// For each point of a piece, from high to low bits: the piece, the cell, whether it is level, whether it is lower
/// than a roof. Sorted.
std::vector<std::uint64_t> keysOfPieces(const CellGrid& grid, const PointSet& points, const PointRanks& ranks,
                                        const RoofPieces& pieces, const PointSet& high, const Progress& progress)
{
    static_assert(CellGrid::kMostCells <= std::size_t(1) << 30);
    std::vector<std::uint64_t> keys;
    keys.reserve(std::size_t(
        std::count_if(pieces.pieceOf.begin(), pieces.pieceOf.end(), [](auto p) { return p != kNoPiece; })));
    for (std::size_t word = 0; word < points.words().size(); ++word) {
        if (word % kTaskWords == 0) progress.check();
        points.forEachInWords(word, word + 1, [&](PointIndex i) {
            const std::uint32_t rank = ranks(i);
            if (pieces.pieceOf[rank] == kNoPiece) return;
            keys.push_back(std::uint64_t(pieces.pieceOf[rank]) << 32 | std::uint64_t(grid.cellOf(i)) << 2 |
                           std::uint64_t(pieces.level[rank]) << 1 | std::uint64_t(!high.contains(i)));
        });
    }
    // A long sorting has to stop when it is asked to: by way of the comparison.
    tbb::parallel_sort(keys.begin(), keys.end(), [&](std::uint64_t a, std::uint64_t b) {
        if (progress.cancelled()) throw Cancelled();
        return a < b;
    });
    return keys;
}

/// What roofs are made of: pieces that are large enough, and no decks.
struct Roofs {
    PointSet points;
    std::vector<std::uint8_t> cells;
};

Roofs roofsOf(const CellGrid& grid, const PointSet& points, const PointRanks& ranks, const RoofPieces& pieces,
              const PointSet& high, double leastArea, const Progress& progress)
{
    const std::vector<std::uint64_t> keys = keysOfPieces(grid, points, ranks, pieces, high, progress);
    Roofs roofs{PointSet(points.size()), std::vector<std::uint8_t>(grid.cells(), 0)};
    PointSet taken(ranks.count());
    for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
        progress.check();
        double cells = 0, level = 0, deep = 0;
        for (; last < keys.size() && keys[last] >> 32 == keys[first] >> 32; ++last) {
            cells += double(last == first || keys[last] >> 2 != keys[last - 1] >> 2);
            level += double(keys[last] >> 1 & 1);
            deep += double(keys[last] & 1);
        }
        const auto count = double(last - first);
        const bool deck = level > count / 2 && deep > kDeckShare * count;
        if (cells * grid.size() * grid.size() < kPieceShare * leastArea || deck || deep > count / 2) continue;
        taken.insert(keys[first] >> 32);
        for (std::size_t k = first; k < last; ++k) roofs.cells[keys[k] >> 2 & (CellGrid::kMostCells - 1)] = 1;
    }
    for (std::size_t word = 0; word < points.words().size(); ++word) {
        if (word % kTaskWords == 0) progress.check();
        points.forEachInWords(word, word + 1, [&](PointIndex i) {
            const std::uint32_t piece = pieces.pieceOf[ranks(i)];
            if (piece != kNoPiece && taken.contains(piece) && high.contains(i)) roofs.points.insert(i);
        });
    }
    return roofs;
}

}  // namespace

const StepDescription& BuildingsStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    static const StepDescription about{
        .name = "buildings",
        .title = "Buildings",
        .group = StepGroup::Objects,
        .help =
            "Classifies what has a roof: flat pieces above the ground that are large and wide enough, what is "
            "below them, and what stands on them. Decks that come down to the ground, such as bridges, are none. "
            "Heights are those of "
            "HeightAboveGround, or measured from the ground.",
        .source = "Rabbani, van den Heuvel and Vosselman 2006",
        .parameters = {{.key = "height",
                        .label = "Least height",
                        .help = "Roofs are at least so high above the ground.",
                        .fit = {.meters = 2},
                        .min = 0,
                        .max = 1e6,
                        .unit = Unit::Length},
                       {.key = "area",
                        .label = "Least area",
                        .help = "Of a building, seen from above.",
                        .fit = {.meters = 3},
                        .min = 0,
                        .max = 1e9,
                        .unit = Unit::Area},
                       {.key = "width",
                        .label = "Least width",
                        .help = "A square of this side has room in the roof of a building.",
                        .fit = {.spacings = 3.5, .meters = 2},
                        .min = 0,
                        .max = 1e6,
                        .unit = Unit::Length},
                       {.key = "walls",
                        .label = "Walls",
                        .help = "Whether what is below a roof or beside its edge is of the building, too.",
                        .type = Type::Choice,
                        .preset = "yes",
                        .choices = {"yes", "no"}},
                       {.key = "rooftop",
                        .label = "On roofs",
                        .help =
                            "With walls, what rises above a roof by no more than this, such as parapets, chimneys "
                            "and dormers, is of the building, too.",
                        .fit = {.meters = 1.5},
                        .min = 0,
                        .max = 1e6,
                        .advanced = true,
                        .unit = Unit::Length},
                       {.key = "roughness",
                        .label = "Roughness",
                        .help =
                            "The most by which points leave the plane of their neighbors, as a standard deviation.",
                        .fit = {.spacings = 0.15, .meters = 0.1},
                        .min = 0,
                        .max = 1e6,
                        .advanced = true,
                        .unit = Unit::Length},
                       {.key = "neighbors",
                        .label = "Neighbors",
                        .help = "How many points a plane is fitted to.",
                        .type = Type::Integer,
                        .preset = "10",
                        .min = 6,
                        .max = 200,
                        .advanced = true},
                       {.key = "class",
                        .label = "Class",
                        .help = "The class that buildings get.",
                        .type = Type::ClassCode,
                        .preset = "6",
                        .advanced = true},
                       {.key = "from",
                        .label = "Of classes",
                        .help = "The classes whose points may be of buildings.",
                        .type = Type::ClassCodes,
                        .preset = "0-1,3-6",
                        .advanced = true},
                       groundParameter("The classes that are ground, where heights are to be measured.")},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> BuildingsStep::make(const PointCloud& cloud, const StepValues& values,
                                             const PointSet* within, Progress& progress) const
{
    const auto code = std::uint32_t(*integerValue(values, "class"));
    const Attribute classes = classAttribute(cloud, code);
    if (cloud.size() == 0) return nullptr;
    const double least = *realValue(values, "height"), leastArea = *realValue(values, "area"),
                 leastWidth = *realValue(values, "width");
    const bool walls = textValue(values, "walls") == "yes";
    const std::array bounds{least, kLowShare * least, kWallShare * least};
    const HighPoints known = highPoints(cloud, classesValue(values, "ground"), bounds, "buildings", progress);
    const auto &high = known.atLeast[0], &highForWalls = known.atLeast[2];
    const PointSet mayBe = pointsOfClasses(cloud, classesValue(values, "from"), progress);
    PointSet low = mayBe;
    low.intersect(known.atLeast[1]);
    low = lastReturnsOf(cloud, std::move(low), progress);
    const PointRanks ranks(low);

    RoofOptions options;
    options.neighbors = std::size_t(*integerValue(values, "neighbors"));
    options.roughness = *realValue(values, "roughness");
    options.steepest = kSteepestRoof;
    options.bend = kRoofBend;
    RoofPieces pieces;
    {
        const KdOrder order(cloud, progress, &low);
        pieces = findRoofPieces(order, ranks, options, progress);
    }

    // Cells of some points each, so that a roof has no holes.
    const double side = std::max(leastWidth / 4, 1e-6);
    const CellGrid grid(cloud, mayBe, side, "buildings", progress);
    if (grid.cells() == 0) return nullptr;
    Roofs roofs = roofsOf(grid, low, ranks, pieces, high, leastArea, progress);
    pieces = {};
    const RoofAreas areas = findRoofAreas(grid, std::move(roofs.cells),
                                          std::max<std::size_t>(1, std::size_t(leastArea / (side * side))),
                                          std::max(1, std::int32_t(std::lround(leastWidth / side))), progress);

    // How high the roofs are, cell by cell.
    const auto z = cloud.rawZ();
    std::vector<std::int32_t> tops(grid.cells(), INT32_MIN);
    for (std::size_t word = 0; word < roofs.points.words().size(); ++word) {
        if (word % kTaskWords == 0) progress.check();
        roofs.points.forEachInWords(word, word + 1, [&](PointIndex i) {
            std::int32_t& top = tops[grid.cellOf(i)];
            top = std::max(top, z[i]);
        });
    }
    const TrueLengths lengths = trueLengths(cloud);
    const double stepZ = std::fabs(cloud.coordinates().scale[2]) * lengths.stretch[2];
    const double above = 3 * options.roughness, onRoof = std::max(above, *realValue(values, "rooftop"));

    auto found = std::make_shared<PointSet>(cloud.size());
    const ClassReader classOf(cloud);
    progress.begin("Classifying buildings", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        mayBe.forEachInWords(firstWord, lastWord, [&](PointIndex i) {
            if (classOf(i) == code) return;
            const std::size_t cell = grid.cellOf(i);
            if (roofs.points.contains(i) && areas.inside[cell] != 0) {
                found->insert(i);
                return;
            }
            if (!walls || !highForWalls.contains(i)) return;
            std::int32_t most = INT32_MIN;
            for (std::int32_t dy = -kEaves; dy <= kEaves; ++dy)
                for (std::int32_t dx = -kEaves; dx <= kEaves; ++dx) {
                    const std::size_t other = grid.beside(cell, dx, dy);
                    if (other != CellGrid::kNone && areas.inside[other] != 0) most = std::max(most, tops[other]);
                }
            const double room = areas.inside[cell] != 0 ? onRoof : above;
            if (most != INT32_MIN && (double(z[i]) - double(most)) * stepZ <= room) found->insert(i);
        });
    });
    if (within != nullptr) found->intersect(*within);
    auto command = makeClassCommand("Buildings to " + classLabel(code), classes, std::move(found), code);
    const std::string count = areas.count == 1 ? "1 building." : grouped(areas.count) + " buildings.";
    if (command) command->setFinding(known.finding.empty() ? count : count + " " + known.finding);
    return command;
}

}  // namespace punctum
