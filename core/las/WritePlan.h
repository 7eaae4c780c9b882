// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkPlan.h"
#include "core/las/FormatNeeds.h"
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

/// Makes records of the target format from the columns of a cloud, block by block. Keeps the columns alive.
class RecordMaker
{
public:
    /// How bytes 14 to 19 change between the formats 0-5 and 6-10. FoldClasses: only the class, from a column of
    /// its own back into the byte of formats 0-5.
    enum class Conversion { None, ToExtended, ToClassic, FoldClasses };

    /// `columns[k]` fills field k of `layout`; null: zeros. `packed`: what a conversion takes its fields from.
    /// `kept`: the points that are written, in order.
    RecordMaker(RecordLayout layout, std::vector<std::shared_ptr<const Column>> columns, Conversion conversion,
                PackedColumns packed, KeptPoints kept);

    const RecordLayout& layout() const noexcept { return m_layout; }
    PointIndex points() const noexcept { return m_kept.count(); }
    /// The points of the cloud that are written.
    const KeptPoints& kept() const noexcept { return m_kept; }
    /// Writes the records of `range` (of the written points) to `records`. May be called from several threads.
    void make(PointRange range, std::byte* records) const;

private:
    void makePiece(PointIndex first, std::size_t count, std::byte* records) const;

    RecordLayout m_layout;
    std::vector<std::shared_ptr<const Column>> m_columns;
    Conversion m_conversion;
    PackedColumns m_packed;
    int m_returns, m_flags, m_classes,
        m_angle;  ///< fields of m_layout: Returns, Classes or Flags and so on; -1: none
    KeptPoints m_kept;
};

/// All of a file that is to be written, but for the points themselves, which `maker` makes.
struct WritePlan {
    std::unique_ptr<RecordMaker> maker;
    bool compressed = false;
    LazInfo laz;                       ///< when compressed: what LASzip writes for these records
    ChunkPlan chunks;                  ///< when compressed
    std::vector<std::byte> prefix;     ///< header, VLRs, gap: the file up to the points
    std::vector<Vlr> vlrs;             ///< those in `prefix`
    std::size_t laszipAt = 0;          ///< of the laszip record's payload in the prefix
    std::vector<std::byte> userBytes;  ///< of the header, where the version allows none: before the gap
    std::vector<std::byte> gapAfterPoints;
    std::vector<Vlr> evlrs;
    std::vector<std::byte> tail;
    std::uint64_t sourcePointDataEnd = 0;  ///< 0 for clouds made here
    std::optional<std::size_t> waveformEvlr;
    std::vector<std::string> notes;
    std::vector<Loss> losses;  ///< rounded or left out, since the options allow it

    /// Makes the records on compression and its index say what was written. `originVersions`: the chunks are coded
    /// as in the file they came from. `moved`: chunks or their places differ from those of the file that was read.
    void setCompression(bool originVersions, bool moved);
    /// Takes a record out, and keeps waveformEvlr on its record.
    void eraseEvlr(std::size_t k);
    /// Takes those out of `list`, the VLRs to be, and of the EVLRs for which which(vlr) is true; how many there
    /// were.
    template <typename Which>
    std::size_t dropRecords(std::vector<Vlr>& list, const Which& which)
    {
        std::size_t dropped = std::erase_if(list, which);
        for (std::size_t k = evlrs.size(); k-- > 0;)
            if (which(evlrs[k])) {
                eraseEvlr(k);
                ++dropped;
            }
        return dropped;
    }
    /// Fills in the header's positions of what comes after the points; call when the points' end is known.
    void setPointDataEnd(std::uint64_t end);
    /// Gap, EVLRs and tail as they are written after the points.
    std::vector<std::byte> suffix() const;
};

/// Decides how the cloud is written (las.md, "Writing"): the source's own bytes wherever they still hold.
///
/// Header fields on the points (counts, by-return, bounds) are computed anew only when the points differ from those
/// read (coordinates, returns, number), when the cloud was made here, or when format or version ask for other
/// fields; creation date and software only when the record or the points change. Otherwise every byte stays.
/// Throws Error, with counts, when the target format cannot hold the values; WriteQuestion, when the source's
/// format cannot hold what was added or edited, and the options do not say that it may change; Cancelled.
WritePlan planWrite(const PointCloud& cloud, const std::filesystem::path& target, const WriteOptions& options,
                    Progress& progress);

}  // namespace punctum::las
