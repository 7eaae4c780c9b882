// SPDX-License-Identifier: MIT
#include "core/expression/Rule.h"

#include "core/Text.h"
#include "core/cloud/Slabs.h"
#include "core/edit/AttributeName.h"
#include "core/edit/ClassCommand.h"
#include "core/expression/ExpressionError.h"
#include "core/expression/RuleTask.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>
#include <optional>
#include <type_traits>

namespace punctum::expression
{

namespace
{

std::vector<BoundCase> bindCases(const Assignment& rule, bool classes, Bindings& bindings)
{
    std::vector<BoundCase> cases;
    for (const Assignment::Case& one : rule.cases) {
        BoundCase bound{bindValue(one.value, bindings, classes), {}};
        if (!one.condition.empty()) bound.condition = bindCondition(one.condition.front(), bindings);
        cases.push_back(std::move(bound));
    }
    return cases;
}

/// Puts the points whose flag is 1 into the set; how many these are.
std::size_t take(PointRange block, const std::uint8_t* chosen, PointSet& points)
{
    const auto first = std::size_t(block.first / 64), last = std::size_t((block.last + 63) / 64);
    std::size_t count = 0;
    for (std::size_t w = first; w < last; ++w) {
        const std::uint64_t bits = packFlags(chosen + (w - first) * 64);
        if (bits == 0) continue;  // nor had it any
        points.words()[w] = bits;
        count += std::size_t(std::popcount(bits));
    }
    return count;
}

/// Puts a block's changes into the set, and their elements behind those that are there.
template <typename T>
void append(PointRange block, const std::uint8_t* chosen, const T* raw, PointSet& points,
            std::vector<std::byte>& values)
{
    const std::size_t count = take(block, chosen, points);
    std::size_t at = values.size();
    if (values.capacity() < at + count * sizeof(T)) values.reserve(2 * (at + count * sizeof(T)));
    values.resize(at + count * sizeof(T));
    for (PointIndex first = block.first; first < block.last; first += 64) {
        const auto word = std::size_t(first / 64);
        const T* const from = raw + (first - block.first);
        if (points.words()[word] == ~std::uint64_t(0)) {
            std::memcpy(values.data() + at, from, 64 * sizeof(T));
            at += 64 * sizeof(T);
            continue;
        }
        points.forEachInWords(word, word + 1, [&](PointIndex i) {
            std::memcpy(values.data() + at, from + (i - first), sizeof(T));
            at += sizeof(T);
        });
    }
}

/// The element that some of the parts hold, so many times.
std::vector<std::byte> repeated(const std::vector<std::vector<std::byte>>& parts, PointIndex count)
{
    const auto holds = [](const auto& part) { return !part.empty(); };
    const std::vector<std::byte>& element = *std::find_if(parts.begin(), parts.end(), holds);
    if (element.size() == 1) return std::vector<std::byte>(count, element[0]);
    std::vector<std::byte> all(count * element.size());
    for (std::size_t at = 0; at < all.size(); at += element.size())
        std::memcpy(all.data() + at, element.data(), element.size());
    return all;
}

bool isCoordinate(const Attribute& a)
{
    return a.standard && (a.name == "X" || a.name == "Y" || a.name == "Z");
}

/// A rule bound to a cloud and to the points that may change.
class Bound
{
public:
    /// To change an attribute of the cloud, of its points within that were not deleted.
    Bound(const Assignment& rule, const std::string& text, const PointCloud& cloud, const PointSet* within)
        : m_bindings{text, &cloud, {}}, m_within(within)
    {
        const std::shared_lock lock(cloud.mutex());
        if (cloud.deleted()) {
            m_living = *cloud.deleted();
            m_living->invert();
            if (within) m_living->intersect(*within);
            m_within = &*m_living;
        }
        target = findScalar(rule.target, rule.targetByte, m_bindings);
        if (isCoordinate(target))
            throw ExpressionError(text, rule.targetByte, "coordinates stay as they are; set another attribute.");
        m_cases = bindCases(rule, target.kind == AttributeKind::Class, m_bindings);
    }
    /// To make a new attribute, whose column is there then, and holds 0.
    Bound(const Assignment& rule, const std::string& text, const PointCloud& cloud, const PointSet* within,
          ScalarType type)
        : m_bindings{text, &cloud, {}}, m_within(within)
    {
        const std::shared_lock lock(cloud.mutex());
        target.name = rule.target;
        checkNewName(cloud, target.name);
        m_cases = bindCases(rule, false, m_bindings);
        target.columns[0] = std::make_shared<Column>(target.name, type, cloud.size());
    }
    Bound(const Bound&) = delete;
    Bound& operator=(const Bound&) = delete;

    Attribute target;

    /// All points that change get the same value.
    bool oneValue() const { return m_cases.size() == 1 && m_cases.front().value.op == Node::Op::Constant; }

    template <typename T>
    std::unique_ptr<Task<T>> makeTask() const
    {
        return std::make_unique<Task<T>>(m_cases, m_bindings.attributes, target, m_within);
    }

private:
    Bindings m_bindings;
    std::vector<BoundCase> m_cases;
    const PointSet* m_within;
    std::optional<PointSet> m_living;
};

/// Calls each(task, firstWord, lastWord) for all words of the cloud's sets, in parallel: Task::run() is to be
/// called there. Throws when a value does not fit.
template <typename Each>
void evaluate(const Bound& bound, const PointCloud& cloud, Progress& progress, Each each)
{
    std::mutex mutex;
    Misfit misfit;
    visitScalar(bound.target.type(), [&](auto zero) {
        forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
            const auto task = bound.makeTask<decltype(zero)>();
            each(*task, first, last);
            const std::lock_guard lock(mutex);
            if (task->misfit.point < misfit.point) misfit = task->misfit;
        });
    });
    refuse(misfit, bound.target);
}

std::string commandName(const std::string& text)
{
    constexpr std::size_t kLongest = 60;  // of what a menu shows
    if (text.size() <= kLongest) return "Set " + text;
    std::size_t n = kLongest;
    while (n > 0 && (static_cast<unsigned char>(text[n]) & 0xC0u) == 0x80u) --n;  // whole characters
    return "Set " + text.substr(0, n) + "\u2026";
}

}  // namespace

Rule::Rule(std::string_view text)
    : m_text(text), m_title(commandName(m_text)), m_rule(std::make_shared<const Assignment>(parseAssignment(text)))
{
}

Rule::Rule(std::string title, Assignment rule)
    : m_text(title), m_title(std::move(title)), m_rule(std::make_shared<const Assignment>(std::move(rule)))
{
}

Rule Rule::inRange(std::string title, std::string target, Value value, std::string attribute, Value low, Value high)
{
    const auto number = [](Value v) { return Syntax{.kind = Syntax::Kind::Number, .number = v}; };
    Syntax range{.kind = Syntax::Kind::In};
    range.children.push_back({.kind = Syntax::Kind::Name, .text = std::move(attribute), .quoted = true});
    range.children.push_back(number(low));
    range.children.push_back(number(high));
    Assignment rule;
    rule.target = std::move(target);
    rule.cases.push_back({.value = number(value), .condition = {std::move(range)}});
    return {std::move(title), std::move(rule)};
}

const std::string& Rule::target() const noexcept
{
    return m_rule->target;
}

std::unique_ptr<Command> Rule::run(const PointCloud& cloud, const PointSet* within, Progress& progress) const
{
    const Bound bound(*m_rule, m_text, cloud, within);
    const Attribute& target = bound.target;
    progress.begin("Setting " + target.name, cloud.size());
    auto points = std::make_shared<PointSet>(cloud.size());
    const std::size_t tasks = (points->words().size() + kTaskWords - 1) / kTaskWords;
    std::vector<std::vector<std::byte>> values(tasks);  // of one value: an element at most
    const bool one = bound.oneValue();
    evaluate(bound, cloud, progress, [&](auto& task, std::size_t first, std::size_t last) {
        using T = typename std::decay_t<decltype(task)>::Value;
        std::vector<std::byte>& mine = values[first / kTaskWords];
        task.run(first, last, cloud.size(), target.columns[0]->template values<T>().data(),
                 [&](PointRange block, const std::uint8_t* chosen, const T* raw) {
                     if (!one) return append(block, chosen, raw, *points, mine);
                     take(block, chosen, *points);
                     if (!mine.empty()) return;
                     const auto* const at = std::find(chosen, chosen + block.size(), std::uint8_t(1));
                     mine.resize(sizeof(T));
                     std::memcpy(mine.data(), raw + (at - chosen), sizeof(T));
                 });
    });
    std::size_t bytes = 0;
    for (const auto& part : values) bytes += part.size();
    if (bytes == 0) return nullptr;
    if (one && isClassByte(target)) {
        const auto code = std::uint32_t(repeated(values, 1).front());
        return makeClassCommand(m_title, target, std::move(points), code);
    }
    std::vector<std::byte> all = one ? repeated(values, points->count()) : std::vector<std::byte>();
    if (!one) all.reserve(bytes);
    for (auto& part : values) {
        if (!one) all.insert(all.end(), part.begin(), part.end());
        part = {};
    }
    if (isClassByte(target)) return makeClassCommand(m_title, target, std::move(points), std::move(all));
    return std::make_unique<ValueCommand>(m_title, target, std::move(points), std::move(all));
}

std::unique_ptr<Preview> Rule::preview(const PointCloud& cloud, const PointSet* within, Progress& progress) const
{
    const Bound bound(*m_rule, m_text, cloud, within);
    const Attribute& target = bound.target;
    progress.begin("Preview of " + target.name, cloud.size());
    auto points = std::make_shared<PointSet>(cloud.size());
    auto preview = std::make_unique<Preview>();
    preview->attributes.push_back(widest(target));
    const auto column = std::make_shared<Column>(target.name, target.type(), cloud.size());
    column->setAbsent(target.columns[0]->absent());  // what stays without a value is shown without one
    preview->attributes[0].columns[0] = column;
    evaluate(bound, cloud, progress, [&](auto& task, std::size_t first, std::size_t last) {
        using T = typename std::decay_t<decltype(task)>::Value;
        const T* const now = target.columns[0]->template values<T>().data();
        T* const after = column->template values<T>().data();
        const PointIndex end = std::min<PointIndex>(cloud.size(), last * 64);
        const bool widened = isClassByte(target) && target.bitWidth != 0;
        for (PointIndex i = first * 64; i < end; ++i) after[i] = widened ? task.ownBits(now[i]) : now[i];
        task.run(first, last, cloud.size(), now, [&](PointRange block, const std::uint8_t* chosen, const T* raw) {
            take(block, chosen, *points);
            for (std::size_t k = 0; k < block.size(); ++k) {
                T& value = after[block.first + k];
                if (chosen[k]) value = widened ? raw[k] : task.replaced(value, raw[k]);
            }
        });
    });
    if (points->extent().empty()) return nullptr;
    preview->points = std::move(points);
    const std::shared_lock lock(cloud.mutex());
    for (Attribute together : cloud.attributes()) {
        const auto shown = std::find(together.columns.begin(), together.columns.end(), target.columns[0]);
        if (together.components < 2 || shown == together.columns.end()) continue;
        *shown = column;
        preview->attributes.push_back(std::move(together));
    }
    return preview;
}

std::unique_ptr<Command> Rule::add(const PointCloud& cloud, ScalarType type, const PointSet* within,
                                   Progress& progress) const
{
    const Bound bound(*m_rule, m_text, cloud, within, type);
    const Attribute& target = bound.target;
    progress.begin("Computing " + target.name, cloud.size());
    evaluate(bound, cloud, progress, [&](auto& task, std::size_t first, std::size_t last) {
        using T = typename std::decay_t<decltype(task)>::Value;
        T* const out = target.columns[0]->template values<T>().data();
        task.run(first, last, cloud.size(), static_cast<const T*>(nullptr),
                 [&](PointRange block, const std::uint8_t* chosen, const T* raw) {
                     for (std::size_t k = 0; k < block.size(); ++k)
                         if (chosen[k]) out[block.first + k] = raw[k];
                 });
    });
    return std::make_unique<AttributesCommand>("Add " + target.name, std::vector<Attribute>{target});
}

}  // namespace punctum::expression
