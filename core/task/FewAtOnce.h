// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace punctum
{

/// Calls task(0) to task(count - 1), begun in this order, up to `atOnce` at a time, each in one of that many
/// threads: for work that waits for something else than the processor, such as a disk. Returns when all have ended.
/// Once one has thrown no further ones begin, and what the first by number threw is thrown on: the same that one
/// after the other would have, if tasks do not depend on each other.
void fewAtOnce(std::size_t count, std::size_t atOnce, const std::function<void(std::size_t)>& task);

}  // namespace punctum
