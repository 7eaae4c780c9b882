// SPDX-License-Identifier: MIT
#include "core/cells/CellOrder.h"
#include "core/cells/JoinedLists.h"
#include "core/thin/Choices.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

namespace punctum
{

namespace
{

constexpr std::uint32_t kSide = 16;  ///< cells of a tile's side; with one of its neighbors at both ends:
constexpr std::uint32_t kWide = kSide + 2;
constexpr double kRoomier = 1 + 1e-6;  ///< a cell than the radius, so that rounding cannot skip one
constexpr std::size_t kDartsOfAPass = 1
                                      << 14;  ///< sorted at a time, and thrown between two looks at the cancel flag

struct DiskTile {
    CellKey key{};
    std::uint32_t kept = 0;           ///< of the points, the first ones, once the tile is done
    std::span<std::uint32_t> points;  ///< where they lie in the order by cells
};

/// Rows of cells along x, by their numbers on the board, in and around a row: the nearest first, since most points
/// are dropped by what is in their own cell.
constexpr std::array<int, 9> kRowsAround{
    0, 1, -1, int(kWide), -int(kWide), int(kWide) + 1, int(kWide) - 1, 1 - int(kWide), -1 - int(kWide)};

/// What a thread needs to throw the darts of one tile after another.
class DartBoard
{
public:
    DartBoard(const WorldGrid& grid, double radius)
        : m_grid(grid), m_squared(radius * radius), m_heads(kWide * kWide * kWide, kNone)
    {
    }

    void begin(const CellKey& key)
    {
        for (const Kept& k : m_kept) {
            m_heads[k.cell] = kNone;
            m_rows[k.cell / kWide] = 0;
        }
        m_kept.clear();
        m_key = key;
    }
    /// A kept point of a tile beside.
    void add(std::uint32_t point)
    {
        const auto cell = cellOf(point);
        if (cell < m_heads.size()) keep(m_grid.raw(point), cell);
    }
    /// Whether the point is kept.
    bool take(std::uint32_t point)
    {
        const auto cell = cellOf(point);
        const auto raw = m_grid.raw(point);
        const std::uint32_t row = cell / kWide, column = cell % kWide;
        for (const int beside : kRowsAround) {
            const auto there = std::uint32_t(int(row) + beside);
            // Of the three cells of the row, those that have something.
            for (std::uint32_t bits = m_rows[there] >> (column - 1) & 7u; bits != 0; bits &= bits - 1) {
                const std::uint32_t at = there * kWide + column - 1 + std::uint32_t(std::countr_zero(bits));
                for (std::uint32_t k = m_heads[at]; k != kNone; k = m_kept[k].next)
                    if (m_grid.squaredDistance(raw, m_kept[k].raw) < m_squared) return false;
            }
        }
        keep(raw, cell);
        return true;
    }

private:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    struct Kept {
        std::array<std::int32_t, 3> raw;
        std::uint32_t cell, next;
    };
    /// Beyond the board: the number of its cells.
    std::uint32_t cellOf(std::uint32_t point) const
    {
        std::uint32_t cell = 0;
        const auto place = m_grid.placeIn(point, m_key);
        for (std::size_t a = 3; a-- > 0;) {
            const double at = place[a] * kSide + 1;
            if (!(at >= 0 && at < kWide)) return std::uint32_t(m_heads.size());
            cell = cell * kWide + std::uint32_t(at);
        }
        return cell;
    }
    void keep(const std::array<std::int32_t, 3>& raw, std::uint32_t cell)
    {
        m_kept.push_back({raw, cell, m_heads[cell]});
        m_heads[cell] = std::uint32_t(m_kept.size() - 1);
        m_rows[cell / kWide] |= 1u << cell % kWide;
    }

    const WorldGrid& m_grid;
    double m_squared;
    std::array<std::uint32_t, kWide * kWide> m_rows{};  ///< a bit for each cell that has a kept point
    std::vector<std::uint32_t> m_heads;
    std::vector<Kept> m_kept;
    CellKey m_key{};
};

/// A tile's points in random order. Which it is goes by places; points of one place by their order in the survey.
class DartOrder
{
public:
    /// False when cancelled meanwhile.
    bool sort(const WorldGrid& grid, std::span<std::uint32_t> points, const Progress& progress)
    {
        const std::size_t passes = points.size() / kDartsOfAPass + 1;
        m_darts.resize(points.size());
        m_first.assign(passes + 1, 0);
        const auto passOf = [passes](std::uint64_t bits) { return std::size_t((bits >> 32) * passes >> 32); };
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (k % kDartsOfAPass == 0 && progress.cancelled()) return false;
            m_darts[k] = {mixedBits(grid.worldSteps(points[k])), points[k]};
            ++m_first[passOf(m_darts[k].bits) + 1];
        }
        if (passes > 1) {
            for (std::size_t p = 1; p <= passes; ++p) m_first[p] += m_first[p - 1];
            std::vector<Dart> sorted(m_darts.size());
            std::vector<std::size_t> at(m_first.begin(), m_first.end() - 1);
            for (const Dart& dart : m_darts) sorted[at[passOf(dart.bits)]++] = dart;
            m_darts.swap(sorted);
        }
        for (std::size_t p = 0; p < passes; ++p) {
            if (progress.cancelled()) return false;
            std::sort(m_darts.begin() + std::ptrdiff_t(m_first[p]),
                      m_darts.begin() + std::ptrdiff_t(m_first[p + 1]));
        }
        for (std::size_t k = 0; k < points.size(); ++k) points[k] = m_darts[k].point;
        return true;
    }

private:
    struct Dart {
        std::uint64_t bits;
        std::uint32_t point;
        bool operator<(const Dart& other) const
        {
            return bits < other.bits || (bits == other.bits && point < other.point);
        }
    };
    std::vector<Dart> m_darts;
    std::vector<std::size_t> m_first;
};

/// The tiles of a cloud, and the darts that are thrown at them.
class DiskTiles
{
public:
    DiskTiles(const PointCloud& cloud, double radius, const PointSet* leftOut, Progress& progress)
        : m_grid(cloud, radius * kSide * kRoomier), m_radius(radius), m_order(m_grid, leftOut, progress)
    {
        std::vector<std::vector<DiskTile>> tiles(m_order.buckets());
        m_order.sortByCells("Sorting points into tiles", progress,
                            [&](std::size_t b, const CellKey& key, std::span<std::uint32_t> points) {
                                tiles[b].push_back({key, 0, points});
                            });
        m_tiles = joinedLists(std::move(tiles));
    }

    std::shared_ptr<PointSet> choose(PointIndex size, Progress& progress)
    {
        auto kept = std::make_shared<PointSet>(size);
        CellTable<std::uint32_t> places(m_tiles.size());
        std::array<std::vector<std::uint32_t>, 8> groups;
        for (std::uint32_t t = 0; t < m_tiles.size(); ++t) {
            places[m_tiles[t].key] = t;
            const auto cell = m_grid.absolute(m_tiles[t].key);
            groups[std::size_t((cell[0] & 1) | (cell[1] & 1) << 1 | (cell[2] & 1) << 2)].push_back(t);
        }
        progress.begin("Choosing points", m_order.size());
        for (const auto& group : groups)
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, group.size(), 8), [&](const auto& range) {
                DartBoard board(m_grid, m_radius);
                DartOrder darts;
                for (std::size_t k = range.begin(); k != range.end() && !progress.cancelled(); ++k)
                    throwDarts(m_tiles[group[k]], places, board, darts, *kept, progress);
            });
        progress.check();
        return kept;
    }

private:
    void throwDarts(DiskTile& tile, const CellTable<std::uint32_t>& places, DartBoard& board, DartOrder& darts,
                    PointSet& kept, Progress& progress)
    {
        const std::span<std::uint32_t> points = tile.points;
        if (!darts.sort(m_grid, points, progress)) return;
        board.begin(tile.key);
        for (std::uint32_t k = 0; k < 27; ++k) {
            const std::uint32_t* const beside =
                places.find({tile.key[0] + k % 3 - 1, tile.key[1] + k / 3 % 3 - 1, tile.key[2] + k / 9 - 1});
            if (beside == nullptr || k == 13) continue;
            const DiskTile& other = m_tiles[*beside];
            for (const std::uint32_t p : other.points.first(other.kept)) board.add(p);
        }
        std::uint32_t count = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (k % kDartsOfAPass == kDartsOfAPass - 1 && progress.cancelled()) return;
            if (!board.take(points[k])) continue;
            kept.insertShared(points[k]);
            std::swap(points[count++], points[k]);  // what was there is dropped, and not looked at any more
        }
        tile.kept = count;
        progress.add(points.size());
    }

    WorldGrid m_grid;
    double m_radius;
    CellOrder m_order;  ///< by tiles, in the tiles that are done those that are kept first
    std::vector<DiskTile> m_tiles;
};

}  // namespace

std::shared_ptr<PointSet> chooseByDistance(const PointCloud& cloud, double radius, const PointSet* leftOut,
                                           Progress& progress)
{
    return DiskTiles(cloud, radius, leftOut, progress).choose(cloud.size(), progress);
}

}  // namespace punctum
