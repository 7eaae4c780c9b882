// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/KeptPoints.h"
#include "core/las/FormatNeeds.h"
#include "core/las/PointFormat.h"

#include <cstddef>
#include <memory>
#include <vector>

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

}  // namespace punctum::las
