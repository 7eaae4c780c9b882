// SPDX-License-Identifier: MIT
#include "core/expression/Condition.h"

#include "core/cloud/Slabs.h"
#include "core/expression/Program.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <mutex>

namespace punctum::expression
{

Condition::Condition(std::string_view text, const PointCloud& cloud) : m_text(text), m_size(cloud.size())
{
    const Syntax syntax = parseExpression(text);
    const std::shared_lock lock(cloud.mutex());
    Bindings bindings{text, &cloud, {}};
    m_root = std::make_shared<const Node>(bindCondition(syntax, bindings));
    m_attributes = std::move(bindings.attributes);
}

void Condition::check(std::string_view text)
{
    parseExpression(text);
}

std::vector<std::string> Condition::attributes() const
{
    std::vector<std::string> names;
    for (const Attribute& a : m_attributes) names.push_back(a.name);
    return names;
}

bool Condition::concerns(const ChangeNotice& notice) const
{
    return std::any_of(m_attributes.begin(), m_attributes.end(), [&](const auto& a) { return notice.concerns(a); });
}

void Condition::evaluate(std::size_t firstWord, std::size_t lastWord, std::uint64_t* words) const
{
    constexpr std::size_t kBlockWords = kBlockPoints / 64;
    Evaluator evaluator(m_attributes);
    alignas(64) std::array<std::uint8_t, kBlockPoints> flags{};
    for (std::size_t w = firstWord; w < lastWord; w += kBlockWords) {
        const std::size_t end = std::min(lastWord, w + kBlockWords);
        const PointRange points{PointIndex(w) * 64, std::min(m_size, PointIndex(end) * 64)};
        evaluator.condition(*m_root, points, flags.data());
        if (points.size() < kBlockPoints) std::fill(flags.begin() + std::ptrdiff_t(points.size()), flags.end(), 0);
        // Words that are right stay untouched: a set takes memory where it is written to.
        for (std::size_t k = w; k < end; ++k, ++words)
            if (const std::uint64_t bits = packFlags(flags.data() + (k - w) * 64); *words != bits) *words = bits;
    }
}

std::shared_ptr<PointSet> select(const PointCloud& cloud, const Condition& condition, Progress& progress)
{
    auto points = std::make_shared<PointSet>(cloud.size());
    progress.begin("Looking for points", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
        condition.evaluate(first, last, points->words().data() + first);
    });
    return points;
}

std::shared_ptr<PointSet> selectOthers(const PointCloud& cloud, const Condition& condition, Progress& progress)
{
    auto points = select(cloud, condition, progress);
    points->invert();
    return points;
}

}  // namespace punctum::expression
