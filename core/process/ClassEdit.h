// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"

#include <cstdint>
#include <memory>
#include <string>

namespace punctum {

/// What the steps that set classes share; private to them.

/// "6 Building": code and name of an ASPRS class (LAS 1.4 R15, table 17); the code alone where it has no name.
std::string classLabel(std::uint32_t code);

/// The cloud's Classification, which holds `code`. Takes cloud.mutex() shared. Throws Error when the cloud has no
/// classes, or when its field is too narrow for the code.
Attribute classAttribute(const PointCloud& cloud, std::uint32_t code);

/// The command that gives the points the class; null for an empty set.
std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::uint32_t code);

}  // namespace punctum
