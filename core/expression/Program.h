// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/expression/Syntax.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace punctum::expression
{

/// Holds every int64 and uint64, and sums of many of them.
__extension__ typedef __int128 Int128;

/// What a wide integer is that has no value.
inline constexpr Int128 kNone = Int128(1) << 126;

/// Points that are evaluated at a time: small enough for the processor's first cache, and always the same, so that
/// the compiler makes vectors of each loop.
inline constexpr std::size_t kBlockPoints = 1024;

/// A node bound to the attributes of a cloud, its types found and checked.
///
/// Numbers are doubles, NaN where there is no value: fields of up to 32 bits are exact in them. Fields of 64 bits
/// are wide integers, kNone where there is no value, and stay so through + - * // % and comparisons.
struct Node {
    enum class Type : std::uint8_t { Number, Wide, Condition };
    enum class Op : std::uint8_t {
        Constant,  // a number, or a wide integer
        Load,      // the attribute's value
        LoadRaw,   // the stored integer of a scaled attribute
        ToNumber,  // of a wide child
        ToWide,    // of a child that is a number, whole ones alone
        Negate,
        Add,
        Subtract,
        Multiply,
        Divide,
        FloorDivide,
        Modulo,
        Power,
        Function,  // `function` of one or two numbers
        Absolute,
        Minimum,
        Maximum,
        Choose,  // child 0 if child 1 else child 2
        Equal,   // of two numbers, two wides, or a wide and a number
        Unequal,
        Less,
        LessEqual,
        Greater,
        GreaterEqual,
        Within,  // the first child in one of the ranges [1, 2], [3, 4], ...
        Exists,  // whether the child has a value
        Not,
        And,
        Or,
    };
    Op op = Op::Constant;
    Type type = Type::Number;
    bool integral = false;  ///< always a whole number (or none)
    std::size_t byte = 0;   ///< where in the text
    double number = 0.0;
    Int128 wide = 0;
    std::uint32_t attribute = 0;  ///< of the Bindings
    double (*function)(double, double) = nullptr;
    std::vector<Node> children;
};

/// The attributes that an expression reads: copies, which keep their columns alive.
struct Bindings {
    std::string_view text;  ///< for errors; valid while binding
    const PointCloud* cloud = nullptr;
    std::vector<Attribute> attributes;
};

/// What was written -> what can be evaluated. Hold cloud->mutex() shared. Throw ExpressionError.
/// `classes`: names of classes stand for their codes.
Node bindValue(const Syntax& syntax, Bindings& bindings, bool classes = false);
Node bindCondition(const Syntax& syntax, Bindings& bindings);

/// The scalar attribute of this name. Throws ExpressionError, which names a similar one.
const Attribute& findScalar(const std::string& name, std::size_t byte, const Bindings& bindings);

/// Evaluates nodes over runs of up to kBlockPoints points. One for each thread; hold the cloud's mutex shared.
class Evaluator
{
public:
    explicit Evaluator(const std::vector<Attribute>& attributes);
    ~Evaluator();
    Evaluator(const Evaluator&) = delete;
    Evaluator& operator=(const Evaluator&) = delete;

    /// Each fills kBlockPoints values; those from points.size() on mean nothing.
    void value(const Node& node, PointRange points, double* out);
    void value(const Node& node, PointRange points, Int128* out);            ///< of Type::Wide
    void condition(const Node& node, PointRange points, std::uint8_t* out);  ///< 0 or 1

private:
    template <typename T>
    class Block;
    struct Blocks;

    const Attribute* stored(const Node& node) const;
    void arithmetic(const Node& node, PointRange points, double* out);
    void compare(const Node& node, PointRange points, std::uint8_t* out);
    template <typename T>
    void choose(const Node& node, PointRange points, T* out);
    template <typename T>
    void within(const Node& node, PointRange points, std::uint8_t* out);
    template <typename T>
    void existing(const Node& node, PointRange points, std::uint8_t* out);

    const std::vector<Attribute>& m_attributes;
    std::unique_ptr<Blocks> m_blocks;
};

}  // namespace punctum::expression
