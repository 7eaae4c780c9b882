// SPDX-License-Identifier: MIT
#include "core/cloud/ClassNames.h"
#include "core/cloud/DecimalScale.h"
#include "core/cloud/ValueText.h"
#include "core/expression/ExpressionError.h"
#include "core/expression/Functions.h"
#include "core/expression/Program.h"
#include "core/expression/Words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace punctum::expression
{

namespace
{

using Op = Node::Op;
using Type = Node::Type;
using Kind = Syntax::Kind;

struct Arithmetic {
    std::string_view sign;
    Op op;
};

constexpr auto kArithmetic = std::to_array<Arithmetic>({
    {"+", Op::Add},
    {"-", Op::Subtract},
    {"*", Op::Multiply},
    {"/", Op::Divide},
    {"//", Op::FloorDivide},
    {"%", Op::Modulo},
    {"**", Op::Power},
});

struct Comparison {
    std::string_view sign;
    Op op;
    Op mirrored;  ///< the same with its sides exchanged
};

constexpr auto kComparisons = std::to_array<Comparison>({
    {"==", Op::Equal, Op::Equal},
    {"!=", Op::Unequal, Op::Unequal},
    {"<", Op::Less, Op::Greater},
    {"<=", Op::LessEqual, Op::GreaterEqual},
    {">", Op::Greater, Op::Less},
    {">=", Op::GreaterEqual, Op::LessEqual},
});

/// The row of the sign; the parser knows no others.
template <typename Table>
const auto& rowOf(const Table& table, std::string_view sign)
{
    return *std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.sign == sign; });
}

bool isWide(const Attribute& a)
{
    return !a.scaled && a.bitWidth == 0 && (a.type() == ScalarType::I64 || a.type() == ScalarType::U64);
}

Node makeNode(Op op, Type type, std::size_t byte, std::vector<Node> children)
{
    Node node;
    node.op = op;
    node.type = type;
    node.byte = byte;
    node.children = std::move(children);
    return node;
}

template <typename... Children>
std::vector<Node> list(Children&&... children)
{
    std::vector<Node> all;
    all.reserve(sizeof...(children));
    (all.push_back(std::move(children)), ...);
    return all;
}

Node numberNode(double number, std::size_t byte)
{
    Node node;
    node.byte = byte;
    node.number = number;
    node.integral = number == std::floor(number) && std::abs(number) <= 0x1p53;
    return node;
}

/// What does not depend on a point is computed once.
Node folded(Node node)
{
    const auto constant = [](const Node& n) { return n.op == Op::Constant; };
    if (node.type == Type::Condition || node.children.empty() ||
        !std::all_of(node.children.begin(), node.children.end(), constant))
        return node;
    Evaluator evaluator({});
    Node result;
    result.type = node.type;
    result.byte = node.byte;
    result.integral = node.integral;
    const auto evaluate = [&](auto& value) {
        std::vector<std::decay_t<decltype(value)>> out(kBlockPoints);
        evaluator.value(node, {0, 1}, out.data());
        value = out[0];
    };
    if (node.type == Type::Wide)
        evaluate(result.wide);
    else
        evaluate(result.number);
    return result;
}

Node computed(Op op, Type type, std::size_t byte, bool integral, std::vector<Node> children)
{
    Node node = makeNode(op, type, byte, std::move(children));
    node.integral = integral;
    return folded(std::move(node));
}

Node toNumber(Node node)
{
    if (node.type != Type::Wide) return node;
    const std::size_t byte = node.byte;
    return computed(Op::ToNumber, Type::Number, byte, true, list(std::move(node)));
}

Node toWide(Node node)
{
    if (node.type == Type::Wide) return node;
    const std::size_t byte = node.byte;
    return computed(Op::ToWide, Type::Wide, byte, true, list(std::move(node)));
}

class Binder
{
public:
    explicit Binder(Bindings& bindings) : m_bindings(bindings) {}

    Node condition(const Syntax& s)
    {
        Node node = any(s, false);
        if (node.type == Type::Condition) return node;
        // a flag is a condition by itself; of other numbers a comparison was forgotten
        if (node.op == Op::Load && m_bindings.attributes[node.attribute].bitWidth == 1) {
            const std::size_t byte = node.byte;
            return makeNode(Op::Equal, Type::Condition, byte, list(std::move(node), numberNode(1, byte)));
        }
        fail(s.byte, "this is a number, where a condition is needed, such as Classification == 2.");
    }

    Node value(const Syntax& s, bool classes)
    {
        Node node = any(s, classes);
        if (node.type == Type::Condition) fail(s.byte, "this is a condition, where a number is needed.");
        return node;
    }

private:
    [[noreturn]] void fail(std::size_t byte, const std::string& sentence) const
    {
        throw ExpressionError(m_bindings.text, byte, sentence);
    }

    /// Calls itself for each level of the tree, and so keeps nothing on the stack: what it calls is not put into
    /// it.
    Node any(const Syntax& s, bool classes)
    {
        switch (s.kind) {
            case Kind::Number:
                return literal(s);
            case Kind::Name:
                return name(s, classes);
            case Kind::Call:
                return call(s);
            case Kind::Negate:
                return negation(s);
            case Kind::Arithmetic:
                return arithmetic(s);
            case Kind::Compare:
                return comparison(s);
            case Kind::In:
                return within(s);
            case Kind::Not:
            case Kind::And:
            case Kind::Or:
                return joined(s);
            case Kind::Conditional:
                break;
        }
        return choice(s, classes);
    }

    [[gnu::noinline]] Node negation(const Syntax& s)
    {
        return same(Op::Negate, s.byte, value(s.children[0], false));
    }

    [[gnu::noinline]] Node joined(const Syntax& s)
    {
        const Op op = s.kind == Kind::Not ? Op::Not : s.kind == Kind::And ? Op::And : Op::Or;
        Node node = makeNode(op, Type::Condition, s.byte, {});
        for (const Syntax& child : s.children) node.children.push_back(condition(child));
        return node;
    }

    [[gnu::noinline]] Node choice(const Syntax& s, bool classes)
    {
        Node yes = value(s.children[0], classes), no = value(s.children[2], classes);
        Node decides = condition(s.children[1]);
        alike(yes, no);
        const Type type = yes.type;
        const bool integral = yes.integral && no.integral;
        Node node = makeNode(Op::Choose, type, s.byte, list(std::move(yes), std::move(decides), std::move(no)));
        node.integral = integral;
        return node;
    }

    [[gnu::noinline]] Node literal(const Syntax& s)
    {
        Node node = numberNode(toDouble(s.number), s.byte);
        if (std::holds_alternative<double>(s.number)) return node;
        const Int128 exact = std::visit([](auto v) { return Int128(v); }, s.number);
        if (exact > (Int128(1) << 53) || exact < -(Int128(1) << 53)) {
            node.type = Type::Wide;
            node.wide = exact;
        }
        node.integral = true;
        return node;
    }

    /// No attribute has that name. Says what is wrong with it as the name of a class, where that can be said.
    void failAsClass(const Syntax& s, bool classes) const
    {
        if (!classes) {
            if (classOfName(s.text))
                fail(s.byte,
                     "\"" + s.text + "\" is a class; it can be compared with, and set for, Classification alone.");
            return;
        }
        std::vector<std::string> names;
        for (const Attribute& a : m_bindings.cloud->attributes()) names.push_back(a.name);
        for (std::uint32_t code = 0; code < 256; ++code)
            if (!classNameOf(code).empty()) names.emplace_back(classNameOf(code));
        fail(s.byte, "there is no class and no attribute \"" + s.text + "\"" + suggestion(s.text, names));
    }

    [[gnu::noinline]] Node name(const Syntax& s, bool classes)
    {
        if (m_bindings.cloud->findAttribute(s.text) == nullptr) {
            if (classes)
                if (const auto code = classOfName(s.text)) return numberNode(double(*code), s.byte);
            if (!s.quoted && sameWord(s.text, "pi")) return numberNode(std::numbers::pi, s.byte);
            failAsClass(s, classes);
        }
        const Attribute& attribute = findScalar(s.text, s.byte, m_bindings);
        auto& all = m_bindings.attributes;
        const auto it = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == s.text; });
        Node node;
        node.op = Op::Load;
        node.byte = s.byte;
        node.attribute = std::uint32_t(it - all.begin());
        node.integral = attribute.integral();
        if (isWide(attribute)) node.type = Type::Wide;
        if (it == all.end()) all.push_back(attribute);
        return node;
    }

    /// Two values that are to be put together: both wide integers, or both numbers.
    static void alike(Node& a, Node& b)
    {
        if (a.type == b.type) return;
        if (a.integral && b.integral) {
            a = toWide(std::move(a));
            b = toWide(std::move(b));
        } else {
            a = toNumber(std::move(a));
            b = toNumber(std::move(b));
        }
    }

    [[gnu::noinline]] Node arithmetic(const Syntax& s)
    {
        Node a = value(s.children[0], false), b = value(s.children[1], false);
        const Op op = rowOf(kArithmetic, s.text).op;
        const bool real = op == Op::Divide || op == Op::Power;
        if (real) {
            a = toNumber(std::move(a));
            b = toNumber(std::move(b));
        } else {
            alike(a, b);
        }
        const Type type = a.type;
        const bool integral = op == Op::FloorDivide || (!real && a.integral && b.integral);
        return computed(op, type, s.byte, integral, list(std::move(a), std::move(b)));
    }

    bool isClass(const Syntax& s) const
    {
        const Attribute* const a = s.kind == Kind::Name ? m_bindings.cloud->findAttribute(s.text) : nullptr;
        return a != nullptr && a->kind == AttributeKind::Class;
    }

    [[gnu::noinline]] Node comparison(const Syntax& s)
    {
        const bool classes = isClass(s.children[0]) || isClass(s.children[1]);
        Node a = value(s.children[0], classes), b = value(s.children[1], classes);
        Op op = rowOf(kComparisons, s.text).op;
        Op other = rowOf(kComparisons, s.text).mirrored;
        const auto mirrored = [&] {
            std::swap(a, b);
            std::swap(op, other);
        };
        if (a.op == Op::Constant && b.op == Op::Load) mirrored();
        takeAsTyped(a, b);
        if (const Attribute* const scaled = scaledLoad(a); scaled != nullptr && b.op == Op::Constant) {
            const double raw = unscaled(*scaled, toNumber(b).number);
            a.op = Op::LoadRaw;
            b = numberNode(raw, b.byte);
            if (scaled->scale < 0) {  // the order of the stored integers is the other one
                mirrored();
                std::swap(a, b);
            }
        } else if (a.type != b.type) {
            if (a.integral && b.integral)
                alike(a, b);
            else if (a.type == Type::Number)
                mirrored();
        }
        return makeNode(op, Type::Condition, s.byte, list(std::move(a), std::move(b)));
    }

    [[gnu::noinline]] Node within(const Syntax& s)
    {
        const bool classes = isClass(s.children[0]);
        Node node = makeNode(Op::Within, Type::Condition, s.byte, list(value(s.children[0], classes)));
        for (std::size_t k = 1; k < s.children.size(); ++k) node.children.push_back(value(s.children[k], classes));
        for (std::size_t k = 1; k + 1 < node.children.size(); k += 2) {
            const Node &low = node.children[k], &high = node.children[k + 1];
            if (low.op == Op::Constant && high.op == Op::Constant && toNumber(low).number > toNumber(high).number)
                fail(low.byte, "the range begins above its end.");
        }
        const auto constant = [](const Node& n) { return n.op == Op::Constant; };
        for (std::size_t k = 1; k < node.children.size(); ++k) takeAsTyped(node.children[0], node.children[k]);
        const Attribute* const scaled = scaledLoad(node.children[0]);
        if (scaled != nullptr && std::all_of(node.children.begin() + 1, node.children.end(), constant)) {
            node.children[0].op = Op::LoadRaw;
            for (std::size_t k = 1; k < node.children.size(); ++k)
                node.children[k] =
                    numberNode(unscaled(*scaled, toNumber(node.children[k]).number), node.children[k].byte);
            if (scaled->scale < 0)
                for (std::size_t k = 1; k < node.children.size(); k += 2)
                    std::swap(node.children[k], node.children[k + 1]);
            return node;
        }
        // one wide integer makes all of them wide, one number that is none makes all of them numbers
        const auto wide = [](const Node& n) { return n.type == Type::Wide; };
        const auto whole = [](const Node& n) { return n.integral; };
        if (std::any_of(node.children.begin(), node.children.end(), wide)) {
            if (std::all_of(node.children.begin(), node.children.end(), whole)) {
                for (Node& child : node.children) child = toWide(std::move(child));
            } else if (wide(node.children[0])) {
                for (std::size_t k = 1; k < node.children.size(); ++k) bound(node.children[k], k % 2 == 1);
            } else {
                for (Node& child : node.children) child = toNumber(std::move(child));
            }
        }
        return node;
    }

    /// A bound of a range of wide integers: the first whole number inside it.
    void bound(Node& node, bool low)
    {
        if (node.integral) {
            node = toWide(std::move(node));
            return;
        }
        const std::size_t byte = node.byte;
        node = applied(*findFunction(low ? "ceil" : "floor"), byte, list(std::move(node)));
        // What is larger than any wide integer, infinity as well, is a bound all the same.
        node = extreme(Op::Maximum, byte, std::move(node), numberNode(-0x1p100, byte));
        node = toWide(extreme(Op::Minimum, byte, std::move(node), numberNode(0x1p100, byte)));
    }

    /// The attribute when the node is one of scaled integers, whose steps are taken for what is displayed.
    const Attribute* scaledLoad(const Node& node) const
    {
        if (node.op != Op::Load) return nullptr;
        const Attribute& a = m_bindings.attributes[node.attribute];
        const bool sound = std::isfinite(a.scale) && a.scale != 0.0 && std::isfinite(a.offset);
        return a.scaled && sound && !isFloating(a.type()) ? &a : nullptr;
    }

    static double unscaled(const Attribute& a, double v) { return DecimalScale(a.scale, a.offset).raw(v); }

    /// A constant beside values of a float attribute: the float that is written so.
    void takeAsTyped(const Node& subject, Node& constant) const
    {
        if (subject.op == Op::Load && constant.op == Op::Constant && constant.type == Type::Number)
            constant.number = typedValue(m_bindings.attributes[subject.attribute], constant.number);
    }

    [[gnu::noinline]] Node call(const Syntax& s)
    {
        std::string key;
        for (const char c : s.text) key += smallLetter(c);
        const auto demand = [&](std::size_t least, std::size_t most) {
            const std::size_t n = s.children.size();
            if (n >= least && n <= most) return;
            const std::string wanted = most > 3     ? "two or more values"
                                       : least == 1 ? "one value"
                                       : least == 2 ? "two values"
                                                    : "three values";
            fail(s.byte, s.text + "() takes " + wanted + ".");
        };
        if (key == "exists") {
            demand(1, 1);
            return makeNode(Op::Exists, Type::Condition, s.byte, list(value(s.children[0], false)));
        }
        if (key == "abs") {
            demand(1, 1);
            return same(Op::Absolute, s.byte, value(s.children[0], false));
        }
        if (key == "min" || key == "max") {
            demand(2, kMostArguments);
            Node node = value(s.children[0], false);
            for (std::size_t k = 1; k < s.children.size(); ++k)
                node = extreme(key == "min" ? Op::Minimum : Op::Maximum, s.byte, std::move(node),
                               value(s.children[k], false));
            return node;
        }
        if (key == "clamp") {
            demand(3, 3);
            Node node = extreme(Op::Maximum, s.byte, value(s.children[0], false), value(s.children[1], false));
            return extreme(Op::Minimum, s.byte, std::move(node), value(s.children[2], false));
        }
        const Function* const function = findFunction(key);
        if (function == nullptr)
            fail(s.byte, "there is no function \"" + s.text + "\"" + suggestion(s.text, functionNames()));
        demand(function->arguments, function->arguments);
        Node first = value(s.children[0], false);
        if (function->integral && first.integral && key != "sign") return first;  // floor of a whole number
        std::vector<Node> arguments = list(toNumber(std::move(first)));
        for (std::size_t k = 1; k < s.children.size(); ++k)
            arguments.push_back(toNumber(value(s.children[k], false)));
        return applied(*function, s.byte, std::move(arguments));
    }

    static Node applied(const Function& function, std::size_t byte, std::vector<Node> arguments)
    {
        Node node = makeNode(Op::Function, Type::Number, byte, std::move(arguments));
        node.function = function.call;
        node.integral = function.integral;
        return folded(std::move(node));
    }

    static Node same(Op op, std::size_t byte, Node child)
    {
        const Type type = child.type;
        const bool integral = child.integral;
        return computed(op, type, byte, integral, list(std::move(child)));
    }

    static Node extreme(Op op, std::size_t byte, Node a, Node b)
    {
        alike(a, b);
        const Type type = a.type;
        const bool integral = a.integral && b.integral;
        return computed(op, type, byte, integral, list(std::move(a), std::move(b)));
    }

    static constexpr std::size_t kMostArguments = 100;
    Bindings& m_bindings;
};

}  // namespace

Node bindValue(const Syntax& syntax, Bindings& bindings, bool classes)
{
    return Binder(bindings).value(syntax, classes);
}

Node bindCondition(const Syntax& syntax, Bindings& bindings)
{
    return Binder(bindings).condition(syntax);
}

const Attribute& findScalar(const std::string& name, std::size_t byte, const Bindings& bindings)
{
    const auto fail = [&](const std::string& sentence) { throw ExpressionError(bindings.text, byte, sentence); };
    const Attribute* const found = bindings.cloud->findAttribute(name);
    if (found == nullptr) {
        std::vector<std::string> names;
        for (const Attribute& a : bindings.cloud->attributes()) names.push_back(a.name);
        fail("there is no attribute \"" + name + "\"" + suggestion(name, names));
    }
    if (found->components != 1)
        fail(name + " has three components; name one of them, such as " + found->columns[0]->name() + ".");
    if (found->kind == AttributeKind::Opaque || found->columns[0]->components() != 1)
        fail(name + " holds bytes that the file does not describe.");
    return *found;
}

}  // namespace punctum::expression
