// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/las/File.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace punctum
{

/// Some points of each file of a survey, kept in the user's cache folder when it is read, so that the next opening
/// shows all of it before any file's points are decoded: an overview that LidarScout (Erler et al. 2025) takes from
/// the files each time.
///
/// It is a cache: it may be deleted at any time, no more than kMostInAll bytes of them are kept, those that were
/// not used for longest go first, and one that is cut off, damaged, of another version of the program or of files
/// that are not what they were is as good as none. Whoever shows it reads the files all the same, whose points take
/// the place of what was shown: one that lies is believed until then, and never saved. With it is
/// kept where the points of each piece of a file are, so that what is in sight is read first and nothing else.
///
/// Threads: add() by any; everything else by one, when nobody adds.
class Overview
{
public:
    /// A file as it lies on the disk, and what its points are.
    struct Of {
        std::filesystem::path path;
        las::FileStamp stamp;      ///< size and time count; numbers of devices change from start to start
        std::uint64_t points = 0;  ///< in the file
        std::string layout;        ///< names and types of its columns: what values of a piece are
        std::uint64_t bytes = 0;   ///< of all columns, a point
    };
    /// Points of a file that follow one another.
    struct Piece {
        std::size_t of = 0;             ///< which of the files
        PointRange points;              ///< in the file
        std::vector<std::byte> values;  ///< of column after column
    };

    static constexpr std::uint64_t kMostBytes = 32u << 20;   ///< of values, of one survey
    static constexpr std::uint64_t kMostInAll = 256u << 20;  ///< of all that are kept

    explicit Overview(std::vector<Of> of) : m_of(std::move(of)), m_boxes(m_of.size()) {}

    /// Where the points of each piece of a file are that its reader reads at once (las::Reader::pieces()), world.
    void setBoxes(std::size_t of, std::vector<WorldBounds> boxes) { m_boxes[of] = std::move(boxes); }
    /// None: not known.
    const std::vector<WorldBounds>& boxes(std::size_t of) const noexcept { return m_boxes[of]; }

    /// How many points of a piece there is room for, where each file has one: at most `most`.
    std::uint64_t room(std::uint64_t most) const noexcept;
    void add(Piece piece);
    const std::vector<Piece>& pieces() const noexcept { return m_pieces; }

    /// Takes the pieces that were kept of these very files; false where there are none.
    bool find();
    /// Keeps the pieces in place of what was kept of these files, and lets go of what is too much. Throws Error.
    void keep() const;
    /// Lets go of what is kept of these files.
    void forget() const noexcept;

    /// Where they are: in Residency::folder().
    static std::filesystem::path folder();
    /// The file in which that of these files is.
    std::filesystem::path place() const;

private:
    bool parse(const std::string& bytes);

    std::vector<Of> m_of;
    std::mutex m_mutex;
    std::vector<Piece> m_pieces;
    std::vector<std::vector<WorldBounds>> m_boxes;  ///< by file
};

}  // namespace punctum
