// SPDX-License-Identifier: MIT
#include "core/expression/Rule.h"

#include "core/Text.h"
#include "core/cloud/Slabs.h"
#include "core/edit/AttributeName.h"
#include "core/edit/ClassCommand.h"
#include "core/expression/ExpressionError.h"
#include "core/expression/Program.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>

namespace punctum::expression
{

namespace
{

/// A case of the rule, bound to a cloud.
struct BoundCase {
    Node value;
    std::optional<Node> condition;
};

/// A value that does not fit, and where.
struct Misfit {
    PointIndex point = std::numeric_limits<PointIndex>::max();
    std::string value;
};

/// Turns values into raw elements of the target.
template <typename T>
class Target
{
public:
    explicit Target(const Attribute& a) : m_scaled(a.scaled), m_scale(a.scale), m_offset(a.offset)
    {
        if constexpr (std::is_integral_v<T>) {
            m_low = a.bitWidth != 0 ? 0 : Int128(std::numeric_limits<T>::min());
            m_high = a.bitWidth != 0 ? Int128(a.maxBits()) : Int128(std::numeric_limits<T>::max());
        }
        if (!a.noData) return;
        std::visit(
            [&](auto v) {
                if constexpr (std::is_floating_point_v<T> || std::is_integral_v<decltype(v)>)
                    m_none = T(v);
                else if (v >= double(m_low) && v <= double(m_high) && v == std::floor(v))
                    m_none = T(v);
            },
            *a.noData);
    }

    enum class Fit { Yes, No, None };

    Fit convert(double v, T& raw) const
    {
        if (std::isnan(v)) return none(raw);
        if (m_scaled) v = (v - m_offset) / m_scale;
        if constexpr (std::is_floating_point_v<T>) {
            raw = T(v);
            return std::isfinite(v) && !std::isfinite(raw) ? Fit::No : Fit::Yes;
        } else {
            v = std::round(v);
            if (!(std::abs(v) < 0x1p100)) return Fit::No;
            return whole(Int128(v), raw);
        }
    }
    Fit convert(Int128 v, T& raw) const
    {
        if (v == kNone) return none(raw);
        if constexpr (std::is_integral_v<T>)
            if (!m_scaled) return whole(v, raw);
        return convert(double(v), raw);
    }

private:
    Fit none(T& raw) const
    {
        if (m_none) {
            raw = *m_none;
            return Fit::Yes;
        }
        if constexpr (std::is_floating_point_v<T>) {
            raw = std::numeric_limits<T>::quiet_NaN();
            return Fit::Yes;
        } else {
            return Fit::None;
        }
    }
    Fit whole(Int128 v, T& raw) const
    {
        if (v < m_low || v > m_high) return Fit::No;
        raw = T(v);
        return Fit::Yes;
    }

    bool m_scaled;
    double m_scale, m_offset;
    Int128 m_low = 0, m_high = 0;
    std::optional<T> m_none;
};

std::string textOf(double v)
{
    return toText(Value(v));
}
std::string textOf(Int128 v)
{
    if (v >= std::numeric_limits<std::int64_t>::min() && v <= std::numeric_limits<std::int64_t>::max())
        return toText(Value(std::int64_t(v)));
    return v > 0 && v <= std::numeric_limits<std::uint64_t>::max() ? toText(Value(std::uint64_t(v)))
                                                                   : toText(Value(double(v)));
}

/// What an attribute can hold: "holds 0 to 31".
std::string holdsText(const Attribute& a)
{
    if (a.bitWidth != 0) return "holds 0 to " + std::to_string(a.maxBits());
    return visitScalar(a.type(), [&](auto zero) {
        using T = decltype(zero);
        using Limits = std::numeric_limits<T>;
        double lo = double(Limits::lowest()), hi = double(Limits::max());
        if (!a.scaled && std::is_integral_v<T>)
            return "holds " + textOf(Int128(Limits::lowest())) + " to " + textOf(Int128(Limits::max()));
        if (a.scaled) {
            lo = lo * a.scale + a.offset;
            hi = hi * a.scale + a.offset;
        }
        return "holds " + textOf(std::min(lo, hi)) + " to " + textOf(std::max(lo, hi));
    });
}

/// Classes that makeClassCommand() gives: a byte each.
bool isClassByte(const Attribute& a)
{
    return a.kind == AttributeKind::Class && a.type() == ScalarType::U8 && a.bitShift == 0;
}

/// What the target's values are held against: a narrow field of classes (point formats 0-5) is widened if need be,
/// by makeClassCommand().
Attribute widest(Attribute target)
{
    if (isClassByte(target)) target.bitWidth = 0;
    return target;
}

/// Evaluates the cases over one task's words; T is the target column's type.
template <typename T>
class Task
{
public:
    Task(const std::vector<BoundCase>& cases, const std::vector<Attribute>& attributes, const Attribute& target,
         const PointSet* within)
        : m_cases(cases), m_target(target), m_convert(widest(target)), m_within(within), m_evaluator(attributes)
    {
    }

    /// Calls change(points, flags, raws) for each block: of the points whose flag is 1 the target gets the raw
    /// element. `current`: the column's values, which leaves out the points that have the value already; or null.
    template <typename Change>
    void run(std::size_t firstWord, std::size_t lastWord, PointIndex size, const T* current, Change change)
    {
        constexpr std::size_t kBlockWords = kBlockPoints / 64;
        for (std::size_t w = firstWord; w < lastWord; w += kBlockWords) {
            const PointRange points{PointIndex(w) * 64,
                                    std::min(size, PointIndex(std::min(lastWord, w + kBlockWords)) * 64)};
            if (block(points, current)) change(points, m_chosen.data(), m_raw.data());
        }
    }

    Misfit misfit;

private:
    /// Fills m_chosen and m_raw; false when no point changes.
    bool block(PointRange points, const T* current)
    {
        if (!begin(points)) return false;
        for (const BoundCase& one : m_cases) {
            if (one.condition)
                m_evaluator.condition(*one.condition, points, m_flags.data());
            else
                m_flags.fill(1);
            unsigned any = 0;
            for (std::size_t k = 0; k < kBlockPoints; ++k) {
                m_flags[k] &= m_left[k];
                m_left[k] ^= m_flags[k];
                any |= m_flags[k];
            }
            if (any != 0) assign(one.value, points);
        }
        const T mask = bits();
        if (current != nullptr)
            for (std::size_t k = 0; k < points.size(); ++k)
                m_chosen[k] &= std::uint8_t(differs(current[points.first + k], m_raw[k], mask));
        return std::find(m_chosen.begin(), m_chosen.end(), std::uint8_t(1)) != m_chosen.end();
    }

    /// No point has been decided; only those within may be. False when there are none.
    bool begin(PointRange points)
    {
        m_chosen.fill(0);
        if (m_within == nullptr) {
            m_left.fill(1);
        } else {
            m_left.fill(0);
            const std::size_t word = std::size_t(points.first / 64);
            m_within->forEachInWords(word, word + std::size_t((points.size() + 63) / 64),
                                     [&](PointIndex i) { m_left[std::size_t(i - points.first)] = 1; });
        }
        std::fill(m_left.begin() + std::ptrdiff_t(points.size()), m_left.end(), std::uint8_t(0));
        return std::find(m_left.begin(), m_left.end(), std::uint8_t(1)) != m_left.end();
    }

    void assign(const Node& value, PointRange points)
    {
        if (value.type == Node::Type::Wide) {
            m_evaluator.wide(value, points, m_wides.data());
            take(value, points, m_wides.data());
        } else {
            m_evaluator.number(value, points, m_numbers.data());
            take(value, points, m_numbers.data());
        }
    }

    /// Takes the values of the points whose flag is set.
    template <typename V>
    void take(const Node& value, PointRange points, const V* values)
    {
        if (T raw{}; value.op == Node::Op::Constant && convert(values[0], raw) == Target<T>::Fit::Yes) {
            for (std::size_t k = 0; k < kBlockPoints; ++k) {
                m_raw[k] = m_flags[k] ? raw : m_raw[k];
                m_chosen[k] |= m_flags[k];
            }
            return;
        }
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (!m_flags[k]) continue;
            switch (convert(values[k], m_raw[k])) {
                case Target<T>::Fit::Yes:
                    m_chosen[k] = 1;
                    break;
                case Target<T>::Fit::No:
                    if (points.first + k < misfit.point) misfit = {points.first + k, textOf(values[k])};
                    break;
                case Target<T>::Fit::None:
                    break;
            }
        }
    }

    template <typename V>
    typename Target<T>::Fit convert(V value, T& raw) const
    {
        const auto fit = m_convert.convert(value, raw);
        if constexpr (std::is_integral_v<T>) raw = T(raw << m_target.bitShift);
        return fit;
    }

    T bits() const
    {
        if constexpr (std::is_integral_v<T>)
            return m_target.bitWidth == 0 ? T(~T(0)) : T(m_target.maxBits() << m_target.bitShift);
        else
            return T(0);
    }
    static bool differs(T a, T b, T mask)
    {
        if constexpr (std::is_integral_v<T>)
            return T(a & mask) != b;
        else
            return std::memcmp(&a, &b, sizeof a) != 0;  // one NaN is as good as the same one
    }

    const std::vector<BoundCase>& m_cases;
    const Attribute& m_target;
    Target<T> m_convert;
    const PointSet* m_within;
    Evaluator m_evaluator;
    std::array<std::uint8_t, kBlockPoints> m_left{}, m_flags{}, m_chosen{};
    std::array<double, kBlockPoints> m_numbers{};
    std::array<Int128, kBlockPoints> m_wides{};
    std::array<T, kBlockPoints> m_raw{};
};

void refuse(const Misfit& misfit, const Attribute& target)
{
    if (misfit.value.empty()) return;
    throw Error(target.name + " " + holdsText(widest(target)) + "; the value " + misfit.value + " of point " +
                grouped(misfit.point) + " does not fit.");
}

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

/// Puts a block's changes into the set, and their elements behind those that are there.
template <typename T>
void append(PointRange block, const std::uint8_t* chosen, const T* raw, PointSet& points,
            std::vector<std::byte>& values)
{
    const auto first = std::size_t(block.first / 64), last = std::size_t((block.last + 63) / 64);
    std::size_t count = 0;
    for (std::size_t w = first; w < last; ++w) {
        points.words()[w] = packFlags(chosen + (w - first) * 64);
        count += std::size_t(std::popcount(points.words()[w]));
    }
    std::size_t at = values.size();
    if (values.capacity() < at + count * sizeof(T)) values.reserve(2 * (at + count * sizeof(T)));
    values.resize(at + count * sizeof(T));
    points.forEachInWords(first, last, [&](PointIndex i) {
        std::memcpy(values.data() + at, raw + (i - block.first), sizeof(T));
        at += sizeof(T);
    });
}

bool isCoordinate(const Attribute& a)
{
    return a.standard && (a.name == "X" || a.name == "Y" || a.name == "Z");
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

Rule::Rule(std::string_view text) : m_text(text), m_rule(std::make_shared<const Assignment>(parseAssignment(text)))
{
}

const std::string& Rule::target() const noexcept
{
    return m_rule->target;
}

std::unique_ptr<Command> Rule::run(const PointCloud& cloud, const PointSet* within, Progress& progress) const
{
    Bindings bindings{m_text, &cloud, {}};
    Attribute target;
    std::vector<BoundCase> cases;
    std::optional<PointSet> living;
    {
        const std::shared_lock lock(cloud.mutex());
        if (cloud.deleted()) {
            living = *cloud.deleted();
            living->invert();
            if (within) living->intersect(*within);
            within = &*living;
        }
        target = findScalar(m_rule->target, m_rule->targetByte, bindings);
        if (isCoordinate(target))
            throw ExpressionError(m_text, m_rule->targetByte,
                                  "coordinates stay as they are; set another attribute.");
        cases = bindCases(*m_rule, target.kind == AttributeKind::Class, bindings);
    }
    progress.begin("Setting " + target.name, cloud.size());
    auto points = std::make_shared<PointSet>(cloud.size());
    const std::size_t tasks = (points->words().size() + kTaskWords - 1) / kTaskWords;
    std::vector<std::vector<std::byte>> values(tasks);
    std::mutex misfitMutex;
    Misfit misfit;
    visitScalar(target.type(), [&](auto zero) {
        using T = decltype(zero);
        forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
            const auto task = std::make_unique<Task<T>>(cases, bindings.attributes, target, within);
            std::vector<std::byte>& mine = values[first / kTaskWords];
            const T* const current = target.columns[0]->template values<T>().data();
            task->run(first, last, cloud.size(), current,
                      [&](PointRange block, const std::uint8_t* chosen, const T* raw) {
                          append(block, chosen, raw, *points, mine);
                      });
            const std::lock_guard lock(misfitMutex);
            if (task->misfit.point < misfit.point) misfit = task->misfit;
        });
    });
    refuse(misfit, target);
    std::size_t bytes = 0;
    for (const auto& part : values) bytes += part.size();
    if (bytes == 0) return nullptr;
    std::vector<std::byte> all;
    all.reserve(bytes);
    for (auto& part : values) {
        all.insert(all.end(), part.begin(), part.end());
        part = {};
    }
    if (isClassByte(target))
        return makeClassCommand(commandName(m_text), target, std::move(points), std::move(all));
    return std::make_unique<ValueCommand>(commandName(m_text), target, std::move(points), std::move(all));
}

std::unique_ptr<Command> Rule::add(const PointCloud& cloud, ScalarType type, const PointSet* within,
                                   Progress& progress) const
{
    Bindings bindings{m_text, &cloud, {}};
    Attribute target;
    target.name = m_rule->target;
    std::vector<BoundCase> cases;
    {
        const std::shared_lock lock(cloud.mutex());
        checkNewName(cloud, target.name);
        cases = bindCases(*m_rule, false, bindings);
    }
    progress.begin("Computing " + target.name, cloud.size());
    target.columns[0] = std::make_shared<Column>(target.name, type, cloud.size());
    std::mutex misfitMutex;
    Misfit misfit;
    visitScalar(type, [&](auto zero) {
        using T = decltype(zero);
        T* const out = target.columns[0]->template values<T>().data();
        forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
            const auto task = std::make_unique<Task<T>>(cases, bindings.attributes, target, within);
            task->run(first, last, cloud.size(), static_cast<const T*>(nullptr),
                      [&](PointRange block, const std::uint8_t* chosen, const T* raw) {
                          for (std::size_t k = 0; k < block.size(); ++k)
                              if (chosen[k]) out[block.first + k] = raw[k];
                      });
            const std::lock_guard lock(misfitMutex);
            if (task->misfit.point < misfit.point) misfit = task->misfit;
        });
    });
    refuse(misfit, target);
    return std::make_unique<AttributesCommand>("Add " + target.name, std::vector<Attribute>{target});
}

}  // namespace punctum::expression
