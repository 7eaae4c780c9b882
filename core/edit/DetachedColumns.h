// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/edit/SpillFile.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace punctum
{

/// The columns that a command keeps while the cloud does not have them: in memory, or in a file.
///
/// Others may hold such a column, too, and read it at any time: what is spilled stays at its address, and the
/// system reads it from the file when it is touched. Nobody writes to it meanwhile. Whoever owns this declares it
/// before what else it keeps of the columns: those that nobody else has are not read back when it is destroyed.
class DetachedColumns
{
public:
    DetachedColumns() = default;
    ~DetachedColumns() { clear(); }
    DetachedColumns(const DetachedColumns&) = delete;
    DetachedColumns& operator=(const DetachedColumns&) = delete;

    void clear() noexcept;
    /// Not null; one that is here already is left out.
    void add(std::shared_ptr<Column> column);

    /// Both throw Error; what has not been moved by then stays where it is.
    void spill(SpillFile& file);
    void fetch();

    std::size_t memory() const noexcept;
    std::size_t spilled() const noexcept;

private:
    struct Detached {
        std::shared_ptr<Column> column;
        std::optional<SpillFile::Piece> piece;  ///< its whole pages
    };
    static void fetch(Detached& one);

    std::vector<Detached> m_all;
};

}  // namespace punctum
