// SPDX-License-Identifier: MIT
#include "core/process/StepScope.h"

#include "core/Error.h"
#include "core/cloud/PointCloud.h"
#include "core/cloud/Slabs.h"
#include "core/expression/Condition.h"
#include "core/task/Progress.h"

#include <array>
#include <optional>
#include <shared_mutex>

namespace punctum
{

namespace
{

std::optional<Attribute> classesOf(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute("Classification");
    return found != nullptr && found->type() == ScalarType::U8 ? std::optional(*found) : std::nullopt;
}

std::shared_ptr<PointSet> withClasses(const PointCloud& cloud, const Attribute& classes,
                                      const std::bitset<256>& wanted, Progress& progress)
{
    auto points = std::make_shared<PointSet>(cloud.size());
    progress.begin("Looking at classes", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        std::array<std::uint8_t, 64> codes{};
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            const PointRange range{PointIndex(w) * 64, std::min<PointIndex>(cloud.size(), PointIndex(w + 1) * 64)};
            classes.gatherBits(range, codes.data());
            std::uint64_t bits = 0;
            for (std::size_t k = 0; k < range.size(); ++k) bits |= std::uint64_t(wanted[codes[k]]) << k;
            points->words()[w] = bits;
        }
    });
    return points;
}

std::shared_ptr<PointSet> allOf(const PointCloud& cloud)
{
    auto points = std::make_shared<PointSet>(cloud.size());
    points->insert(PointRange{0, cloud.size()});
    return points;
}

}  // namespace

std::shared_ptr<const PointSet> pointsOf(const StepScope& scope, const PointCloud& cloud, Progress& progress)
{
    const std::optional<Attribute> classes = classesOf(cloud);
    std::shared_ptr<PointSet> points;  // null: all
    switch (scope.kind) {
        case StepScope::Kind::All:
            break;
        case StepScope::Kind::Selection:
            points = scope.selection ? std::make_shared<PointSet>(*scope.selection)
                                     : std::make_shared<PointSet>(cloud.size());
            break;
        case StepScope::Kind::Classes:
            if (!classes) throw Error("This cloud has no classes.");
            points = withClasses(cloud, *classes, scope.classes, progress);
            break;
        case StepScope::Kind::Condition:
            points = expression::select(cloud, expression::Condition(scope.condition, cloud), progress);
            break;
        case StepScope::Kind::Shown:
            points = hiddenPoints(cloud, scope.visibility, progress);
            if (points) points->invert();
            break;
    }
    if (classes && scope.locked.any()) {
        if (!points) points = allOf(cloud);
        points->remove(*withClasses(cloud, *classes, scope.locked, progress));
    }
    if (const auto deleted = deletedPoints(cloud); deleted && points) points->remove(*deleted);
    return points;
}

std::string conditionOf(const StepScope& scope)
{
    std::string text;
    switch (scope.kind) {
        case StepScope::Kind::All:
            return {};
        case StepScope::Kind::Condition:
            return scope.condition;
        case StepScope::Kind::Classes:
            for (std::size_t code = 0; code < scope.classes.size(); ++code)
                if (scope.classes[code]) text += (text.empty() ? "" : ", ") + std::to_string(code);
            if (text.empty()) throw Error("No class is chosen.");
            return "Classification in (" + text + ")";
        case StepScope::Kind::Selection:
        case StepScope::Kind::Shown:
            break;
    }
    throw Error("What is selected or shown now means nothing in another file; choose classes or a condition.");
}

}  // namespace punctum
