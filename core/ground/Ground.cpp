// SPDX-License-Identifier: MIT
#include "core/ground/Ground.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/ground/GroundSurface.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>

namespace punctum
{

namespace
{

constexpr std::uint32_t kGroundClass = 2, kOtherClass = 1;  // LAS 1.4 R15, table 17
constexpr std::size_t kGroundPointsAtOnce = 4096;           ///< points whose attributes are gathered together

/// Bits of an attribute that a cloud need not have.
class OptionalFlags
{
public:
    OptionalFlags(const PointCloud& cloud, std::string_view name)
    {
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const found = cloud.findAttribute(name);
        if (found != nullptr && found->components == 1 && found->integral()) m_attribute = *found;
    }
    /// 0 where there is none.
    void gather(PointRange range, std::uint8_t* out) const
    {
        if (m_attribute)
            m_attribute->gatherBits(range, out);
        else
            std::fill(out, out + range.size(), std::uint8_t(0));
    }

private:
    std::optional<Attribute> m_attribute;
};

struct GroundScope {
    PointSet free;  ///< points that may get a class
    PointSet used;  ///< points that the surface is looked for in
    PointSet last;  ///< points that may be ground
};

GroundScope scopeOf(const PointCloud& cloud, const Attribute& classes, const ClassSet& noise, const ClassSet& keep,
                    Progress& progress)
{
    GroundScope scope{PointSet(cloud.size()), PointSet(cloud.size()), PointSet(cloud.size())};
    const OptionalFlags number(cloud, "ReturnNumber"), count(cloud, "NumberOfReturns"), withheld(cloud, "Withheld");
    const auto deleted = deletedPoints(cloud);
    progress.begin("Looking at returns", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        std::array<std::uint8_t, kGroundPointsAtOnce> code, n, of, gone;
        const PointRange all = pointsOfWords(cloud.size(), firstWord, lastWord);
        for (PointIndex first = all.first; first < all.last; first += kGroundPointsAtOnce) {
            const PointRange range{first, std::min<PointIndex>(all.last, first + kGroundPointsAtOnce)};
            classes.gatherBits(range, code.data());
            number.gather(range, n.data());
            count.gather(range, of.data());
            withheld.gather(range, gone.data());
            for (std::size_t w = std::size_t(range.first / 64); w * 64 < range.last; ++w) {
                std::uint64_t free = 0, used = 0, last = 0;
                const PointIndex stop = std::min<PointIndex>(range.last, PointIndex(w + 1) * 64);
                for (PointIndex i = PointIndex(w) * 64; i < stop; ++i) {
                    const std::size_t k = i - range.first;
                    const std::uint64_t bit = std::uint64_t(1) << (i % 64);
                    if (gone[k] != 0 || noise[code[k]]) continue;
                    const bool kept = keep[code[k]];
                    if (!kept) free |= bit;
                    if (n[k] < of[k]) continue;
                    // What is kept as ground tells where it is; what is kept as something else tells nothing.
                    if (!kept || code[k] == kGroundClass) used |= bit;
                    if (!kept) last |= bit;
                }
                const std::uint64_t shown = shownBits(cloud.size(), deleted.get(), w);
                scope.free.words()[w] = free & shown;
                scope.used.words()[w] = used & shown;
                scope.last.words()[w] = last & shown;
            }
        }
    });
    return scope;
}

}  // namespace

const StepDescription& GroundStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    static const StepDescription about{
        .name = "ground",
        .title = "Ground",
        .group = StepGroup::Ground,
        .help =
            "Finds the ground among last returns: what larger and larger openings of the lowest points leave, "
            "and what lies close to it. Gives it class 2, and class 1 to other points that had it.",
        .source = "after Pingel et al. 2013 (SMRF)",
        .parameters = {{.key = "cell",
                        .label = "Cell",
                        .help = "Side of the cells whose lowest points are looked at.",
                        .fit = {.meters = 1},
                        .min = 1e-4,
                        .max = 1e6,
                        .unit = Unit::Length},
                       {.key = "slope",
                        .label = "Slope",
                        .help = "Rise over run that is still ground between neighboring cells of gentle terrain.",
                        .preset = "0.15",
                        .min = 0,
                        .max = 100},
                       {.key = "window",
                        .label = "Window",
                        .help = "Half the width of the largest buildings; larger roofs are told by their edges.",
                        .fit = {.meters = 18},
                        .min = 1e-3,
                        .max = 1e6,
                        .unit = Unit::Length},
                       {.key = "threshold",
                        .label = "Threshold",
                        .help = "How far from the bare surface ground may be where it is flat.",
                        .fit = {.meters = 0.45},
                        .min = 0,
                        .max = 1e6,
                        .unit = Unit::Length},
                       {.key = "steepness",
                        .label = "Steepness",
                        .help = "By how many meters more ground may be away on a slope of 1 (45 degrees).",
                        .preset = "1",
                        .min = 0,
                        .max = 100,
                        .advanced = true},
                       {.key = "keep",
                        .label = "Keep",
                        .help = "Classes that stay as they are.",
                        .type = Type::ClassCodes,
                        .preset = "none"},
                       {.key = "noise",
                        .label = "Noise",
                        .help = "Classes that are left out and stay as they are.",
                        .type = Type::ClassCodes,
                        .preset = "7,18",
                        .advanced = true}},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> GroundStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    const Attribute classes = classAttribute(cloud, kGroundClass);
    const TrueLengths lengths = trueLengths(cloud);
    BareSurfaceSettings settings;
    settings.cell = float(*realValue(values, "cell"));
    settings.slope = float(*realValue(values, "slope"));
    settings.window = float(*realValue(values, "window"));
    settings.threshold = float(*realValue(values, "threshold"));
    settings.steepness = float(*realValue(values, "steepness"));
    settings.meter = lengths.meters > 0 ? float(1 / lengths.meters) : 1.0f;
    constexpr int kMostCells = 1024;  // larger windows would take longer than anybody waits
    if (reachInCells(settings) > 4 * kMostCells)
        throw Error("The cells are too small for a window of this size; give larger cells or a smaller window.");

    GroundScope scope =
        scopeOf(cloud, classes, classesValue(values, "noise"), classesValue(values, "keep"), progress);
    const LowestPoints lowest(cloud, scope.used, lengths, double(settings.cell), progress);
    scope.used = PointSet();
    const GroundSurface surface(lowest, settings, progress);
    if (within != nullptr) scope.free.intersect(*within);

    auto changed = std::make_shared<PointSet>(cloud.size());
    PointSet ground(cloud.size());  // those of `changed` that become ground
    std::atomic<PointIndex> found{0};
    progress.begin("Telling ground", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        GroundSurface::Asker asker(surface);
        std::array<std::uint8_t, kGroundPointsAtOnce> code;
        PointIndex here = 0;
        for (std::size_t first = firstWord; first < lastWord; first += kGroundPointsAtOnce / 64) {
            const std::size_t last = std::min(lastWord, first + kGroundPointsAtOnce / 64);
            const PointRange range = pointsOfWords(cloud.size(), first, last);
            classes.gatherBits(range, code.data());
            scope.free.forEachInWords(first, last, [&](PointIndex i) {
                const bool is = scope.last.contains(i) && asker.isGround(i),
                           was = code[i - range.first] == kGroundClass;
                here += is ? 1 : 0;
                if (is == was) return;
                changed->insert(i);
                if (is) ground.insert(i);
            });
        }
        found.fetch_add(here, std::memory_order_relaxed);
    });
    std::vector<std::byte> codes;
    codes.reserve(std::size_t(changed->count()));
    changed->forEach(
        [&](PointIndex i) { codes.push_back(std::byte(ground.contains(i) ? kGroundClass : kOtherClass)); });
    auto command = makeClassCommand("Ground", classes, std::move(changed), std::move(codes));
    if (command != nullptr)
        command->setFinding(grouped(found.load()) + (found.load() == 1 ? " point" : " points") + " of ground.");
    return command;
}

}  // namespace punctum
