// SPDX-License-Identifier: MIT
#include "core/expression/FieldRange.h"
#include "core/expression/Program.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace punctum::expression
{

namespace
{

using Op = Node::Op;
using Type = Node::Type;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Int128 kWideLimit = Int128(1) << 120;  ///< what is beyond has no value

Int128 bounded(Int128 v)
{
    return v > -kWideLimit && v < kWideLimit ? v : kNone;
}

Int128 toWideInteger(double v)
{
    return std::abs(v) < 0x1p120 ? Int128(v) : kNone;  // false for NaN
}

double toNumber(Int128 v)
{
    return v == kNone ? kNan : double(v);
}

/// -1, 0 or 1 as a is below, at or above b, exactly; b is a number.
int order(Int128 a, double b)
{
    if (b >= 0x1p120) return -1;
    if (b <= -0x1p120) return 1;
    const double down = std::floor(b);
    const Int128 whole = Int128(down);
    if (a != whole) return a < whole ? -1 : 1;
    return b > down ? -1 : 0;
}

Int128 floorDivided(Int128 a, Int128 b)
{
    const Int128 q = a / b;
    return a % b != 0 && (a < 0) != (b < 0) ? q - 1 : q;
}

Int128 computed(Op op, Int128 a, Int128 b)
{
    if (a == kNone || b == kNone) return kNone;
    Int128 result = 0;
    switch (op) {
        case Op::Add:
            return bounded(a + b);  // both are within 2^120
        case Op::Subtract:
            return bounded(a - b);
        case Op::Multiply:
            return __builtin_mul_overflow(a, b, &result) ? kNone : bounded(result);
        case Op::FloorDivide:
            return b == 0 ? kNone : floorDivided(a, b);
        case Op::Modulo:
            return b == 0 ? kNone : a - floorDivided(a, b) * b;
        case Op::Minimum:
            return std::min(a, b);
        default:
            return std::max(a, b);
    }
}

/// The values of a 64-bit field.
template <typename T>
void loadWide(const Attribute& a, PointRange points, Int128* out)
{
    const T* const values = a.columns[0]->values<T>().data() + points.first;
    const auto n = std::size_t(points.size());
    for (std::size_t k = 0; k < n; ++k) out[k] = values[k];
    if (!a.columns[0]->absent().empty())
        for (std::size_t k = 0; k < n; ++k)
            if (a.lacks(points.first + k)) out[k] = kNone;
    if (!a.noData) return;
    const double real = toDouble(*a.noData);
    if (std::holds_alternative<double>(*a.noData) && real != std::floor(real)) return;
    const Int128 none = std::visit(
        [](auto v) {
            if constexpr (std::is_floating_point_v<decltype(v)>)
                return toWideInteger(v);
            else
                return Int128(v);
        },
        *a.noData);
    for (std::size_t k = 0; k < n; ++k)
        if (out[k] == none) out[k] = kNone;
}

template <typename T, typename F>
void combine(T* out, const T* other, F f)
{
    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = f(out[k], other[k]);
}

template <typename T, typename F>
void compareAll(const T* a, const T* b, std::uint8_t* out, F f)
{
    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = std::uint8_t(f(a[k], b[k]));
}

/// Calls f with the comparison as a function object, so that each loop is compiled for it.
template <typename F>
void withComparison(Op op, F f)
{
    switch (op) {
        case Op::Equal:
            return f(std::equal_to<>());
        case Op::Unequal:
            return f(std::not_equal_to<>());
        case Op::Less:
            return f(std::less<>());
        case Op::LessEqual:
            return f(std::less_equal<>());
        case Op::Greater:
            return f(std::greater<>());
        default:
            return f(std::greater_equal<>());
    }
}

bool isConstant(const Node& node)
{
    return node.op == Op::Constant;
}

template <typename T>
T constantOf(const Node& node)
{
    if constexpr (std::is_same_v<T, Int128>)
        return node.wide;
    else
        return node.number;
}

bool exists(double v)
{
    return v == v;
}

bool exists(Int128 v)
{
    return v != kNone;
}

}  // namespace

/// Memory of the intermediate values, used again and again.
struct Evaluator::Blocks {
    template <typename T>
    using Free = std::vector<std::unique_ptr<T[]>>;
    Free<double> numbers;
    Free<Int128> wides;
    Free<std::uint8_t> conditions;

    template <typename T>
    Free<T>& of()
    {
        if constexpr (std::is_same_v<T, double>)
            return numbers;
        else if constexpr (std::is_same_v<T, Int128>)
            return wides;
        else
            return conditions;
    }
};

/// kBlockPoints values for as long as it lives.
template <typename T>
class Evaluator::Block
{
public:
    explicit Block(Blocks& blocks) : m_free(blocks.of<T>())
    {
        if (m_free.empty()) {
            m_values = std::make_unique<T[]>(kBlockPoints);
        } else {
            m_values = std::move(m_free.back());
            m_free.pop_back();
        }
    }
    ~Block() { m_free.push_back(std::move(m_values)); }
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;
    T* get() const noexcept { return m_values.get(); }

private:
    Blocks::Free<T>& m_free;
    std::unique_ptr<T[]> m_values;
};

Evaluator::Evaluator(const std::vector<Attribute>& attributes)
    : m_attributes(attributes), m_blocks(std::make_unique<Blocks>())
{
}

Evaluator::~Evaluator() = default;

template <typename T>
void Evaluator::choose(const Node& node, PointRange points, T* out)
{
    value(node.children[0], points, out);
    const Block<std::uint8_t> decides(*m_blocks);
    condition(node.children[1], points, decides.get());
    const Block<T> other(*m_blocks);
    value(node.children[2], points, other.get());
    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = decides.get()[k] ? out[k] : other.get()[k];
}

void Evaluator::value(const Node& node, PointRange points, double* out)
{
    switch (node.op) {
        case Op::Constant:
            std::fill_n(out, kBlockPoints, node.number);
            return;
        case Op::Load:
            m_attributes[node.attribute].read(points, out);
            return;
        case Op::LoadRaw: {
            Attribute raw = m_attributes[node.attribute];
            raw.scaled = false;
            raw.read(points, out);
            return;
        }
        case Op::ToNumber: {
            const Block<Int128> child(*m_blocks);
            value(node.children[0], points, child.get());
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = toNumber(child.get()[k]);
            return;
        }
        case Op::Choose:
            return choose(node, points, out);
        default:
            arithmetic(node, points, out);
    }
}

void Evaluator::arithmetic(const Node& node, PointRange points, double* out)
{
    value(node.children[0], points, out);
    if (node.children.size() == 1) {
        if (node.op == Op::Negate)
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = -out[k];
        else if (node.op == Op::Absolute)
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = std::abs(out[k]);
        else
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = node.function(out[k], 0.0);
        return;
    }
    const Block<double> block(*m_blocks);
    double* const other = block.get();
    value(node.children[1], points, other);
    switch (node.op) {
        case Op::Add:
            return combine(out, other, [](double a, double b) { return a + b; });
        case Op::Subtract:
            return combine(out, other, [](double a, double b) { return a - b; });
        case Op::Multiply:
            return combine(out, other, [](double a, double b) { return a * b; });
        case Op::Divide:  // nothing can be divided by 0: no value, and not infinity
            return combine(out, other, [](double a, double b) { return b == 0.0 ? kNan : a / b; });
        case Op::FloorDivide:
            return combine(out, other, [](double a, double b) { return b == 0.0 ? kNan : std::floor(a / b); });
        case Op::Modulo:
            return combine(out, other, [](double a, double b) { return a - std::floor(a / b) * b; });
        case Op::Power:
            return combine(out, other, [](double a, double b) { return std::pow(a, b); });
        case Op::Minimum:  // of a value and none: none
            return combine(out, other, [](double a, double b) { return a < b || a != a ? a : b; });
        case Op::Maximum:
            return combine(out, other, [](double a, double b) { return a > b || a != a ? a : b; });
        default:
            return combine(out, other, node.function);
    }
}

void Evaluator::value(const Node& node, PointRange points, Int128* out)
{
    switch (node.op) {
        case Op::Constant:
            std::fill_n(out, kBlockPoints, node.wide);
            return;
        case Op::Load: {
            const Attribute& a = m_attributes[node.attribute];
            a.type() == ScalarType::I64 ? loadWide<std::int64_t>(a, points, out)
                                        : loadWide<std::uint64_t>(a, points, out);
            return;
        }
        case Op::ToWide: {
            const Block<double> child(*m_blocks);
            value(node.children[0], points, child.get());
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = toWideInteger(child.get()[k]);
            return;
        }
        case Op::Choose:
            return choose(node, points, out);
        default:
            break;
    }
    value(node.children[0], points, out);
    if (node.children.size() == 1) {
        for (std::size_t k = 0; k < kBlockPoints; ++k)
            if (out[k] != kNone && (node.op == Op::Negate || out[k] < 0)) out[k] = -out[k];
        return;
    }
    const Block<Int128> block(*m_blocks);
    value(node.children[1], points, block.get());
    combine(out, block.get(), [op = node.op](Int128 a, Int128 b) { return computed(op, a, b); });
}

/// The attribute whose stored values are the node's; null where they have to be computed.
const Attribute* Evaluator::stored(const Node& node) const
{
    if (node.op != Op::Load && node.op != Op::LoadRaw) return nullptr;
    const Attribute& a = m_attributes[node.attribute];
    // points whose file lacks the attribute have no value, whatever is stored
    const bool all = a.columns[0]->components() == 1 && a.columns[0]->absent().empty();
    return all && (node.op == Op::LoadRaw || !a.scaled) ? &a : nullptr;
}

void Evaluator::compare(const Node& node, PointRange points, std::uint8_t* out)
{
    const Node &left = node.children[0], &right = node.children[1];
    if (const Attribute* const field = stored(left); field != nullptr && isConstant(right)) {
        std::fill_n(out, kBlockPoints, std::uint8_t(0));
        if (right.type == Type::Wide)
            addInRange(*field, points, rangeOf(node.op, right.wide), out);
        else
            addInRange(*field, points, rangeOf(node.op, right.number), out);
        // no value is like NaN: it differs from everything
        if (node.op == Op::Unequal)
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] ^= 1;
        return;
    }
    if (left.type == Type::Number) {
        const Block<double> a(*m_blocks);
        value(left, points, a.get());
        if (isConstant(right)) {
            withComparison(node.op, [&](auto is) {
                const double* const values = a.get();
                for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = std::uint8_t(is(values[k], right.number));
            });
            return;
        }
        const Block<double> b(*m_blocks);
        value(right, points, b.get());
        withComparison(node.op, [&](auto is) { compareAll(a.get(), b.get(), out, is); });
        return;
    }
    // none is like NaN: it differs from everything, and no other comparison with it holds
    const auto none = std::uint8_t(node.op == Op::Unequal);
    const Block<Int128> a(*m_blocks);
    value(left, points, a.get());
    if (right.type == Type::Wide) {
        const Block<Int128> b(*m_blocks);
        value(right, points, b.get());
        withComparison(node.op, [&](auto is) {
            compareAll(a.get(), b.get(), out, [=](Int128 x, Int128 y) {
                return x == kNone || y == kNone ? none : std::uint8_t(is(x, y));
            });
        });
        return;
    }
    const Block<double> b(*m_blocks);
    value(right, points, b.get());
    withComparison(node.op, [&](auto is) {
        for (std::size_t k = 0; k < kBlockPoints; ++k) {
            const Int128 x = a.get()[k];
            const double y = b.get()[k];
            out[k] = x == kNone || y != y ? none : std::uint8_t(is(order(x, y), 0));
        }
    });
}

template <typename T>
void Evaluator::within(const Node& node, PointRange points, std::uint8_t* out)
{
    std::fill_n(out, kBlockPoints, std::uint8_t(0));
    const Attribute* const field = stored(node.children[0]);
    if (field != nullptr && std::all_of(node.children.begin() + 1, node.children.end(), isConstant)) {
        for (std::size_t c = 1; c + 1 < node.children.size(); c += 2)
            addInRange(*field, points,
                       Range<T>{constantOf<T>(node.children[c]), constantOf<T>(node.children[c + 1])}, out);
        return;
    }
    const Block<T> subject(*m_blocks), low(*m_blocks), high(*m_blocks);
    const T* const values = subject.get();
    value(node.children[0], points, subject.get());
    for (std::size_t c = 1; c + 1 < node.children.size(); c += 2) {
        const Node &from = node.children[c], &to = node.children[c + 1];
        if (isConstant(from) && isConstant(to)) {
            const T lo = constantOf<T>(from), hi = constantOf<T>(to);
            for (std::size_t k = 0; k < kBlockPoints; ++k)
                out[k] |= std::uint8_t(std::uint8_t(values[k] >= lo) & std::uint8_t(values[k] <= hi));
            continue;
        }
        value(from, points, low.get());
        value(to, points, high.get());
        for (std::size_t k = 0; k < kBlockPoints; ++k)
            out[k] |=
                std::uint8_t(std::uint8_t(values[k] >= low.get()[k]) & std::uint8_t(values[k] <= high.get()[k]));
    }
    if constexpr (std::is_same_v<T, Int128>)
        for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] &= std::uint8_t(exists(values[k]));
}

template <typename T>
void Evaluator::existing(const Node& node, PointRange points, std::uint8_t* out)
{
    const Block<T> values(*m_blocks);
    value(node.children[0], points, values.get());
    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] = std::uint8_t(exists(values.get()[k]));
}

void Evaluator::condition(const Node& node, PointRange points, std::uint8_t* out)
{
    const bool wide = node.children[0].type == Type::Wide;
    switch (node.op) {
        case Op::And:
        case Op::Or: {
            condition(node.children[0], points, out);
            const Block<std::uint8_t> block(*m_blocks);
            std::uint8_t* const other = block.get();
            const bool both = node.op == Op::And;
            for (std::size_t c = 1; c < node.children.size(); ++c) {
                // decided already for all points: the rest need not be looked at
                if (std::find(out, out + kBlockPoints, std::uint8_t(both)) == out + kBlockPoints) return;
                condition(node.children[c], points, other);
                if (both)
                    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] &= other[k];
                else
                    for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] |= other[k];
            }
            return;
        }
        case Op::Not:
            condition(node.children[0], points, out);
            for (std::size_t k = 0; k < kBlockPoints; ++k) out[k] ^= 1;
            return;
        case Op::Exists:
            return wide ? existing<Int128>(node, points, out) : existing<double>(node, points, out);
        case Op::Within:
            return wide ? within<Int128>(node, points, out) : within<double>(node, points, out);
        default:
            compare(node, points, out);
    }
}

}  // namespace punctum::expression
