// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/CrsChange.h"
#include "core/las/Reader.h"
#include "core/survey/Grid.h"
#include "core/survey/RecordUnion.h"
#include "core/survey/Survey.h"

#include <tbb/enumerable_thread_specific.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// Files that are open at a time.
constexpr std::size_t kMostOpen = 64;

inline std::string partName(const std::filesystem::path& path)
{
    return path.filename().string();
}

/// Changes from other coordinate systems into the survey's: PROJ takes milliseconds to make one, and thousands of
/// files may have the same.
class CrsChanges
{
public:
    /// Null: the points cannot be converted.
    const las::CrsChange* from(const std::string& crs, const std::string& to)
    {
        const auto [change, isNew] = m_changes.try_emplace(crs);
        if (isNew) change->second = las::CrsChange::between(crs, to);
        return change->second.get();
    }

private:
    std::map<std::string, std::unique_ptr<las::CrsChange>> m_changes;
};

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
    std::shared_ptr<PointCloud> view;              ///< what the reader fills
    std::vector<PointRange> firsts;                ///< points of the file that were read in advance, in order
    std::map<PointIndex, WorldBounds> firstBoxes;  ///< where they are, by the first of each
    std::vector<PointRange> kept;  ///< points that an Overview had of it, until they are read themselves
    std::size_t beyond = 0;        ///< coordinates that the survey's grid cannot hold
};

/// One changes coordinates for one thread.
struct Survey::ChangesOfThreads {
    tbb::enumerable_thread_specific<CrsChanges> own;
};

}  // namespace punctum
