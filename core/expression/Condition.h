// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

class Progress;

namespace expression
{

struct Node;

/// A condition over attributes, such as `NormalZ > 0.9 and Classification in (1, 2)`, for the points of one cloud.
/// The language is told in docs/user.md, "Rules". A value type; copies share what they read.
///
/// Example:
///     const Condition condition("Intensity > 2000", cloud);        // throws ExpressionError
///     const auto points = select(cloud, condition, progress);      // a PointSet
class Condition
{
public:
    /// Takes cloud.mutex() shared. Throws ExpressionError.
    Condition(std::string_view text, const PointCloud& cloud);
    /// Whether the text could be a condition of some cloud, to be known before there is one. Throws
    /// ExpressionError.
    static void check(std::string_view text);

    const std::string& text() const noexcept { return m_text; }
    /// Names of the attributes it reads: a notice of others cannot change the answer. When the list of attributes
    /// changes, make it anew: the one it reads may be gone.
    std::vector<std::string> attributes() const;
    bool concerns(const ChangeNotice& notice) const;

    /// Answers for points: bit k of the words is point firstWord * 64 + k. Writes words [firstWord, lastWord) of
    /// the cloud's set into `words`, which has room for so many. For any thread; hold cloud.mutex() shared, or
    /// evaluate only points that nobody writes.
    void evaluate(std::size_t firstWord, std::size_t lastWord, std::uint64_t* words) const;

private:
    std::string m_text;
    PointIndex m_size = 0;
    std::vector<Attribute> m_attributes;
    std::shared_ptr<const Node> m_root;
};

/// The points for which it holds. Parallel; takes cloud.mutex() shared for some 20 ms at a time. Throws Cancelled.
std::shared_ptr<PointSet> select(const PointCloud& cloud, const Condition& condition, Progress& progress);
/// Those for which it does not: what a filter hides.
std::shared_ptr<PointSet> selectOthers(const PointCloud& cloud, const Condition& condition, Progress& progress);

}  // namespace expression

}  // namespace punctum
