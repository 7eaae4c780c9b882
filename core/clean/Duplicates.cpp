// SPDX-License-Identifier: MIT
#include "core/clean/Duplicates.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cells/CellOrder.h"
#include "core/measure/Spacing.h"
#include "core/process/Marking.h"
#include "core/process/Values.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <shared_mutex>
#include <vector>

namespace punctum
{

namespace
{

constexpr double kCellSpacings = 16;  ///< cells are only there to share the work out

/// What else has to agree: bytes of columns under a mask.
struct SameField {
    std::shared_ptr<const Column> column;
    std::size_t bytes = 0;
    std::uint8_t mask = 0xFF;  ///< of each byte

    int compare(std::uint32_t a, std::uint32_t b) const noexcept
    {
        const std::byte* const data = column->data();
        if (mask == 0xFF) return std::memcmp(data + a * bytes, data + b * bytes, bytes);
        return int(std::to_integer<std::uint8_t>(data[a]) & mask) -
               int(std::to_integer<std::uint8_t>(data[b]) & mask);
    }
};

std::vector<SameField> fieldsOf(const PointCloud& cloud, const std::string& same)
{
    std::vector<SameField> fields;
    const std::shared_lock lock(cloud.mutex());
    if (same == "all") {
        for (std::size_t c = 3; c < cloud.columns().size(); ++c)
            fields.push_back({cloud.columns()[c], cloud.columns()[c]->elementBytes()});
        return fields;
    }
    std::vector<std::string> names;
    if (same != "place") names.push_back("GpsTime");
    if (same == "return") names.insert(names.end(), {"ReturnNumber", "NumberOfReturns"});
    for (const std::string& name : names) {
        const Attribute* const found = cloud.findAttribute(name);
        if (found == nullptr || found->components != 1)
            throw Error("This cloud has no " + name + ", by which duplicates could be told.");
        SameField field{found->columns[0], found->columns[0]->elementBytes()};
        if (found->bitWidth != 0) field.mask = std::uint8_t(found->maxBits() << found->bitShift);
        fields.push_back(std::move(field));
    }
    return fields;
}

struct Placed {
    std::array<std::int32_t, 3> place;
    std::uint32_t point;
};

}  // namespace

const StepDescription& DuplicatesStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "duplicates",
        .title = "Duplicates",
        .group = StepGroup::Cleaning,
        .help =
            "Finds points that lie where another one does, exactly: all but the first of each place. Others that "
            "have to agree for that are the GPS time, the return, or all fields.",
        .source = "lasduplicate",
        .parameters = {
            {.key = "same",
             .label = "Same",
             .help = "What has to agree: the place; also the GPS time; also the number of the return and "
                     "of returns; all that is stored.",
             .type = Type::Choice,
             .preset = "place",
             .choices = {"place", "time", "return", "all"}},
            doParameter({"delete", "withheld", "class"}, "delete",
                        "Duplicates are deleted, or get a class or the flag Withheld."),
            doClassParameter("7", "The class duplicates get.")}};
    return about;
}

std::unique_ptr<Command> DuplicatesStep::make(const PointCloud& cloud, const StepValues& values,
                                              const PointSet* within, Progress& progress) const
{
    const std::vector<SameField> fields = fieldsOf(cloud, textValue(values, "same"));
    const double spacing = cloud.size() == 0 ? 0 : pointSpacing(cloud, trueLengths(cloud).stretch, progress);
    const WorldGrid grid(cloud, spacing > 0 ? kCellSpacings * spacing : 1.0);
    const auto leftOut = pointsLeftOut(cloud, false, progress);
    const CellOrder order(grid, leftOut.get(), progress);
    auto points = std::make_shared<PointSet>(cloud.size());
    const auto sameValues = [&](std::uint32_t a, std::uint32_t b) {
        return std::all_of(fields.begin(), fields.end(), [=](const auto& f) { return f.compare(a, b) == 0; });
    };
    const auto before = [&](const Placed& a, const Placed& b) {
        if (a.place != b.place) return a.place < b.place;
        for (const SameField& field : fields)
            if (const int difference = field.compare(a.point, b.point)) return difference < 0;
        return a.point < b.point;
    };
    progress.begin("Finding duplicates", order.size());
    tbb::parallel_for(std::size_t(0), order.buckets(), [&](std::size_t b) {
        if (progress.cancelled()) return;
        // Values must not change while they are sorted by.
        const std::shared_lock lock(cloud.mutex());
        std::vector<Placed> sorted;
        sorted.reserve(order.points(b).size());
        for (const std::uint32_t p : order.points(b)) sorted.push_back({grid.raw(p), p});
        std::sort(sorted.begin(), sorted.end(), before);
        for (std::size_t k = 1; k < sorted.size(); ++k)
            if (sorted[k].place == sorted[k - 1].place && sameValues(sorted[k].point, sorted[k - 1].point))
                points->insertShared(sorted[k].point);
        progress.add(sorted.size());
    });
    progress.check();
    if (within != nullptr) points->intersect(*within);
    const PointIndex found = points->count();
    auto command = markPoints("Duplicates", cloud, std::move(points), values, progress);
    if (command) command->setFinding("Found " + grouped(found) + (found == 1 ? " duplicate." : " duplicates."));
    return command;
}

}  // namespace punctum
