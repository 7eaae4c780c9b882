// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/KeptPoints.h"
#include "core/cloud/PointCloud.h"

#include <cstdint>
#include <string>

namespace punctum
{

class Progress;

/// What a journal is about: the points as they were when it was begun. Equal for equal files; headers and other
/// records do not count.
struct CloudKey {
    PointIndex points = 0;
    std::uint64_t digest = 0;  ///< of scale, offset, and each column's name, type and bytes

    std::string text() const;  ///< "20000000-0123456789abcdef"
    std::string digestText() const;
    friend bool operator==(const CloudKey&, const CloudKey&) = default;
};

/// Reads all points once, in parallel: some GB a second. `kept` (null: all): those of a file that lacks others, the
/// key is that file's; a column is copied at a time then. Takes cloud.mutex() shared. Throws Cancelled, Error.
CloudKey keyOf(const PointCloud& cloud, Progress& progress, const KeptPoints* kept = nullptr);

/// The key that the file will have when it is opened which holds the cloud at present (SourceFile::current); the
/// cloud must not have been edited since it was read or saved. Where saving gave the file another point format, its
/// fields are no longer the cloud's columns, and the file itself is read. Throws Cancelled, and Error when it
/// cannot be read, or was changed by somebody else.
CloudKey keyOfFile(const PointCloud& cloud, Progress& progress);

/// Whether the columns of a cloud that was read from files are those that `cloud` has, in grid, order, name and
/// type, so that keyOf() of the one with the points that the files hold is keyOf() of the other.
bool hasColumnsOf(const PointCloud& cloud, const PointCloud& read);

}  // namespace punctum
