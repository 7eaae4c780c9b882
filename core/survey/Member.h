// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Reader.h"
#include "core/survey/Grid.h"
#include "core/survey/RecordUnion.h"
#include "core/survey/Survey.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// How a part of a survey is kept in it.
struct Survey::Member {
    RecordLinks links;
    GridChange grid;
    std::string from, to;     ///< coordinate systems, where the points are moved
    double heights = 1.0;     ///< likewise: what heights are multiplied with then, for the unit of the others
    WorldBounds movedBounds;  ///< likewise: where they are then, as the header says
    /// Columns of its own, by field; null: the survey's are the field's, or are converted.
    std::vector<std::shared_ptr<Column>> own;
    std::unique_ptr<las::Reader> reader;  ///< until it is read; its file is closed where too many would be open
    // until it is read:
    std::shared_ptr<PointCloud> view;  ///< what the reader fills
    std::vector<PointRange> firsts;    ///< points of the file that were read in advance
    std::size_t beyond = 0;            ///< coordinates that the survey's grid cannot hold
};

}  // namespace punctum
