// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ExtraBytes.h"
#include "core/las/PointFormat.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace punctum::las
{

struct SourceFile;

/// What follows the standard fields in the records that are written.
struct ExtraBytesPlan {
    std::vector<std::shared_ptr<const Column>> columns;  ///< in the order of the record
    std::vector<ExtraBytesDescriptor> descriptors;       ///< that describe all of it
    /// Where the source describes item k of its extra bytes, and where this plan does (nothing: not as a whole).
    struct SourceItem {
        std::size_t record = 0, place = 0;
        std::optional<std::size_t> descriptor;
    };
    std::vector<SourceItem> sourceItems;
    std::vector<std::string> added;    ///< columns that the source's record does not have
    std::vector<std::string> gone;     ///< columns of the source's record that are no more
    std::vector<std::string> renamed;  ///< "Old to New"
    /// The source's own records describe the columns as they are.
    bool unchanged() const { return added.empty() && gone.empty() && renamed.empty(); }
};

/// The source's extra bytes as they are, then whatever column of the cloud is neither one of `standard` (the
/// columns that fill standard fields, null among them) nor a standard field of the source.
ExtraBytesPlan planExtraBytes(const PointCloud& cloud, const SourceFile& source,
                              const std::vector<std::shared_ptr<const Column>>& standard);

}  // namespace punctum::las
