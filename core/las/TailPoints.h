// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

namespace punctum::las
{

class File;
struct SourceFile;

/// How many records of uncompressed points there are where the header's count leaves bytes over: `stated` of them,
/// or up to `held`, which is how many there is room for from `begin` on. The data decides: what follows the counted
/// points is points, too, where it looks like them (its coordinates lie where theirs do, or in the header's box;
/// where there is neither, its returns can be) and like nothing else (zeros, extended records). Otherwise it is a
/// tail that somebody left there, and `stated` is right.
std::uint64_t recordsAfterAll(const File& file, const SourceFile& source, std::uint64_t begin, std::uint64_t stated,
                              std::uint64_t held);

/// First byte behind `count` extended records that stand at `at`, one after the other; nothing when they do not.
std::optional<std::uint64_t> endOfEvlrs(const File& file, std::uint64_t at, std::uint32_t count);

/// Where `count` extended records are whose position the header has lost: at `from`, or after it if they are the
/// last thing in the file.
std::optional<std::uint64_t> findEvlrs(const File& file, std::uint64_t from, std::uint32_t count);

}  // namespace punctum::las
