// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkPlan.h"
#include "core/las/RecordMaker.h"
#include "core/las/SourceFile.h"
#include "core/las/Writer.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

/// All of a file that is to be written, but for the points themselves, which `maker` makes.
struct WritePlan {
    std::shared_ptr<const RecordMaker> maker;
    bool compressed = false;
    LazInfo laz;                            ///< when compressed: what LASzip writes for these records
    ChunkPlan chunks;                       ///< when compressed
    std::shared_ptr<const CopcIndex> copc;  ///< the octree that the file has, as it was read; null: none
    std::vector<std::byte> prefix;          ///< header, VLRs, gap: the file up to the points
    std::vector<Vlr> vlrs;                  ///< those in `prefix`
    std::size_t laszipAt = 0;               ///< of the laszip record's payload in the prefix
    std::vector<std::byte> userBytes;       ///< of the header, where the version allows none: before the gap
    std::vector<std::byte> gapAfterPoints;
    std::vector<Vlr> evlrs;
    std::vector<std::byte> tail;
    std::uint64_t sourcePointDataEnd = 0;  ///< 0 for clouds made here
    std::optional<std::size_t> waveformEvlr;
    std::vector<std::string> notes;
    std::vector<Loss> losses;  ///< rounded or left out, since the options allow it
    std::filesystem::path target;
    WriteOptions options;   ///< it was made for these
    bool upgraded = false;  ///< since the options allow it

    /// Whether a save with these arguments would make the same plan, as long as the cloud is the same.
    bool serves(const std::filesystem::path& path, const WriteOptions& wanted) const;

    /// Makes the records on compression and its index say what was written. `originVersions`: the chunks are coded
    /// as in the file they came from. `moved`: chunks or their places differ from those of the file that was read.
    void setCompression(bool originVersions, bool moved);
    /// Takes a record out, and keeps waveformEvlr on its record.
    void eraseEvlr(std::size_t k);
    /// Takes those VLRs and EVLRs out for which which(vlr) is true; how many there were.
    template <typename Which>
    std::size_t dropRecords(const Which& which)
    {
        std::size_t dropped = std::erase_if(vlrs, which);
        for (std::size_t k = evlrs.size(); k-- > 0;)
            if (which(evlrs[k])) {
                eraseEvlr(k);
                ++dropped;
            }
        return dropped;
    }
    void note(const std::string& sentence) { notes.push_back(sentence); }
    /// Fills in the header's positions of what comes after the points; call when the points' end is known.
    void setPointDataEnd(std::uint64_t end);
    /// Gap, EVLRs and tail as they are written after the points.
    std::vector<std::byte> suffix() const;
};

/// Decides how the cloud is written (las.md, "Writing"), a cloud in LASzip's compatibility mode in the form of the
/// format that is asked for: the source's own bytes wherever they still hold.
///
/// Header fields on the points (counts, by-return, bounds) are computed anew only when the points differ from those
/// read (coordinates, returns, number), when the cloud was made here, or when format or version ask for other
/// fields; creation date and software only when the record or the points change. Otherwise every byte stays.
/// Throws Error, with counts, when the target format cannot hold the values; WriteQuestion, when the source's
/// format cannot hold what was added or edited, and the options do not say that it may change; Cancelled. Hold
/// cloud.mutex().
WritePlan planWrite(const PointCloud& cloud, const std::filesystem::path& target, const WriteOptions& options,
                    Progress& progress);

}  // namespace punctum::las
