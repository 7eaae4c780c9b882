// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ExtraBytesPlan.h"
#include "core/las/FormatPlan.h"
#include "core/las/RecordMaker.h"

namespace punctum::las
{

/// What fills the fields of the records that are written.
struct FieldPlan {
    RecordLayout layout;
    std::vector<std::shared_ptr<const Column>> columns;  ///< of the layout's fields; null: zeros, or converted
    RecordMaker::Conversion conversion = RecordMaker::Conversion::None;
    PackedColumns packed;  ///< what is converted
    ExtraBytesPlan extra;  ///< those of the fields that are no standard ones
};

/// Standard fields of the target from the columns of the same name, then the source's extra bytes as they are and
/// what came beside them. Throws Error when they do not fit a record, or the cloud lacks one; Cancelled.
FieldPlan planFields(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
                     const std::filesystem::path& target, Progress& progress, std::vector<std::string>& notes,
                     std::vector<Loss>& losses);

}  // namespace punctum::las
