// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"
#include "core/edit/Preview.h"

#include <memory>
#include <string>
#include <string_view>

namespace punctum
{

class Progress;

namespace expression
{

struct Assignment;

/// A rule that sets an attribute: `Classification = 2 if NormalZ > 0.9 and HeightAboveGround < 0.2`. The language
/// is told in docs/user.md, "Rules". Immutable, for any thread.
class Rule
{
public:
    /// Throws ExpressionError when the text is no rule, whatever the cloud.
    explicit Rule(std::string_view text);

    /// The rule `target = value if attribute in low..high`, both ends included, whatever the attribute's name and
    /// the numbers; infinite ones are no bounds. Its command is called `title`.
    static Rule inRange(std::string title, std::string target, Value value, std::string attribute, Value low,
                        Value high);

    const std::string& text() const noexcept { return m_text; }
    const std::string& target() const noexcept;

    /// The command that has the effect; null when nothing would change.
    ///
    /// Takes cloud.mutex() shared while reading, changes nothing. `within` (null: all) are the points that may
    /// change, but for deleted ones. A value that the attribute cannot hold is an Error; points whose value is none
    /// keep theirs, unless the attribute has a value for none. Throws ExpressionError, Error, Cancelled.
    std::unique_ptr<Command> run(const PointCloud& cloud, const PointSet* within, Progress& progress) const;
    /// What that command would do, null when nothing: takes a copy of the column, and changes nothing either.
    std::unique_ptr<Preview> preview(const PointCloud& cloud, const PointSet* within, Progress& progress) const;
    /// The command for an attribute that the cloud does not have yet: it adds it with this type; 0 where no case
    /// holds.
    std::unique_ptr<Command> add(const PointCloud& cloud, ScalarType type, const PointSet* within,
                                 Progress& progress) const;

private:
    Rule(std::string title, Assignment rule);

    std::string m_text;
    std::string m_title;  ///< of the command
    std::shared_ptr<const Assignment> m_rule;
};

}  // namespace expression

}  // namespace punctum
