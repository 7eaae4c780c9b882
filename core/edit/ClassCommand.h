// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/ClassNames.h"
#include "core/edit/Command.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

/// What steps and tools that set classes share.

/// The cloud's Classification. Takes cloud.mutex() shared. Throws Error when the cloud has no classes, or when
/// `code` is no class.
Attribute classAttribute(const PointCloud& cloud, std::uint32_t code);

/// The command that gives the points the class; null for an empty set. Where the field is too narrow for the code
/// (point formats 0-5 hold classes up to 31) the command first widens it: Classification becomes a column of its
/// own, with what the field holds when the command is done first. Saving then asks for a point format that can hold
/// it. Throws Error (memory).
std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::uint32_t code);
/// The same for points of several classes: a code of each point, in rising index order.
std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::vector<std::byte> codes);

/// Takes the points out of the set whose field, a byte or bits of one, has the value already: a class, a flag.
/// Counts points in a stage of `progress` that the caller has begun. Throws Cancelled.
void leaveOutValue(PointSet& points, const PointCloud& cloud, const Attribute& field, std::uint32_t value,
                   Progress& progress);

}  // namespace punctum
