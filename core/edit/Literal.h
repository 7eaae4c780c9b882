// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"
#include "core/edit/Recipe.h"

#include <memory>
#include <string>
#include <string_view>

namespace punctum
{

class KeptPoints;

/// What doing or undoing a command does, told by the values that come of it instead of a step: which attributes go,
/// come or get another name, which points get which values, and which are deleted or restored. A journal notes so
/// what was made before the file was saved that it is about. Form: docs/dev/journal.md.
///
/// It is a Recipe of this step's name, which stands for no processing step.
inline constexpr std::string_view kLiteralStep = "literal";

/// `command`: ready for apply(), which is about to do it (`forward`) or to undo it; its name is told as well.
/// `kept` (null: all): the points of the cloud that the reader will have; `within` of the result tells indices of
/// the cloud, values are those of kept points alone. Takes cloud.mutex() shared; memory: a column, and the text.
/// Throws Error.
Recipe literalOf(const Command& command, const PointCloud& cloud, bool forward, const KeptPoints* kept);

/// What the history calls it.
std::string literalName(const Recipe& literal);

/// The command that has the effect, on a cloud of the kept points alone. Throws Error where it does not fit the
/// cloud.
std::unique_ptr<Command> makeLiteral(const Recipe& literal, const PointCloud& cloud);

}  // namespace punctum
