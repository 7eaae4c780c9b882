// SPDX-License-Identifier: MIT
#include "core/raster/Rasterize.h"

#include "core/Error.h"
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <mutex>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr std::size_t kRasterTile = 256;    ///< cells a side of what one task adds up; 16 bits name a cell of it
constexpr std::size_t kGroupStretches = 8;  ///< stretches that one task reads
constexpr std::size_t kRasterBatch = 1024;  ///< points read at a time
constexpr double kPiecePoints = 6'000'000;  ///< that are held at a time, 16 bytes each

/// A value on its way to its cell.
struct CellValue {
    double value;
    std::uint32_t place;  ///< tile of the piece << 16 | cell of the tile
};

/// What one task read, in the order of tiles, and of points within a tile.
struct ReadGroup {
    std::vector<CellValue> values;
    std::vector<std::uint32_t> starts;  ///< of each tile, and the end
};

/// Rows of tiles that are worked on together.
struct MapPiece {
    std::size_t firstTileRow, lastTileRow;
};

std::size_t tilesAcross(std::size_t cells)
{
    return (cells + kRasterTile - 1) / kRasterTile;
}

/// The rows of the frame that a box may touch; empty: last <= first.
std::pair<std::size_t, std::size_t> rowsOf(const RawBounds& box, const CoordinateScale& coordinates,
                                           const RasterFrame& frame)
{
    if (box.empty()) return {0, 0};
    const WorldBounds world = coordinates.toWorld(box);
    const double first = double(frame.top) - 1.0 - std::floor(RasterFrame::inCells(world.max.y, frame.cell)) - 1.0,
                 last = double(frame.top) - std::floor(RasterFrame::inCells(world.min.y, frame.cell)) + 1.0;
    const auto row = [&](double r) { return std::size_t(std::clamp(r, 0.0, double(frame.rows))); };
    return {row(first), row(last)};
}

/// Cuts the map into pieces that hold so many points, as far as boxes tell.
std::vector<MapPiece> cutPieces(const PointCloud& cloud, const BlockBoxes& boxes, const RasterFrame& frame)
{
    const std::size_t tileRows = tilesAcross(frame.rows);
    std::vector<double> density(tileRows + 1, 0.0);  // differences
    for (std::size_t s = 0; s < boxes.size(); ++s) {
        const auto [first, last] = rowsOf(boxes[s], cloud.coordinates(), frame);
        if (last <= first) continue;
        const std::size_t a = first / kRasterTile, b = (last - 1) / kRasterTile + 1;
        const double share = double(boxes.points(s).size()) / double(b - a);
        density[a] += share;
        density[b] -= share;
    }
    std::vector<MapPiece> pieces;
    double here = 0, held = 0;
    std::size_t begin = 0;
    for (std::size_t t = 0; t < tileRows; ++t) {
        here += density[t];
        if (t > begin && held + here > kPiecePoints) {
            pieces.push_back({begin, t});
            begin = t;
            held = 0;
        }
        held += here;
    }
    pieces.push_back({begin, tileRows});
    return pieces;
}

/// Reads points and tells their cells.
class CellReader
{
public:
    CellReader(const PointCloud& cloud, const Attribute& attribute, bool counting, const RasterFrame& frame,
               const PointSet* points)
        : m_cloud(cloud), m_attribute(attribute), m_counting(counting), m_frame(frame), m_points(points)
    {
    }

    /// The values of a stretch that lie in a piece, appended.
    void read(PointRange range, const MapPiece& piece, std::vector<CellValue>& out) const
    {
        std::array<double, kRasterBatch> columns, rows, values;
        const CoordinateScale& coordinates = m_cloud.coordinates();
        const DecimalScale stepsX = coordinates.steps(0), stepsY = coordinates.steps(1);
        const double cell = m_frame.cell, left = double(m_frame.left), top = double(m_frame.top),
                     firstRow = double(piece.firstTileRow * kRasterTile),
                     lastRow = double(std::min(m_frame.rows, piece.lastTileRow * kRasterTile)),
                     width = double(m_frame.columns);
        const std::size_t across = tilesAcross(m_frame.columns);
        const std::shared_lock lock(m_cloud.mutex());
        const std::int32_t *const x = m_cloud.rawX().data(), *const y = m_cloud.rawY().data();
        const PointSet* const deleted = m_cloud.deleted().get();
        for (PointIndex first = range.first; first < range.last; first += kRasterBatch) {
            const PointRange batch{first, std::min(range.last, first + kRasterBatch)};
            const auto n = std::size_t(batch.size());
            for (std::size_t k = 0; k < n; ++k) {
                columns[k] = RasterFrame::inCells(stepsX(x[first + k]), cell) - left;
                rows[k] = RasterFrame::inCells(stepsY(y[first + k]), cell) - top;
            }
            if (!m_counting) m_attribute.read(batch, values.data());
            for (std::size_t k = 0; k < n; k += 64) {
                std::uint64_t bits = shownBits(m_cloud.size(), deleted, std::size_t(first + k) / 64);
                if (m_points != nullptr) bits &= m_points->words()[std::size_t(first + k) / 64];
                if (bits == 0) continue;
                const std::size_t end = std::min(n, k + 64);
                for (std::size_t i = k; i < end; ++i) {
                    if ((bits >> (i - k) & 1u) == 0) continue;
                    // rows[i] is in (-rows, 0): the row is that of its floor, from the top
                    const double up = -rows[i], whole = double(std::int64_t(up));
                    const double row = whole == up ? whole - 1.0 : whole;
                    const bool inside = columns[i] >= 0.0 && columns[i] < width && row >= firstRow && row < lastRow;
                    if (!inside || (!m_counting && std::isnan(values[i]))) continue;
                    const auto c = std::uint32_t(columns[i]), r = std::uint32_t(row - firstRow);
                    const auto tile = std::uint32_t(r / kRasterTile * across + c / kRasterTile);
                    out.push_back({m_counting ? 1.0 : values[i],
                                   std::uint32_t(tile << 16 | (r % kRasterTile) << 8 | c % kRasterTile)});
                }
            }
        }
    }

private:
    const PointCloud& m_cloud;
    const Attribute& m_attribute;
    bool m_counting;
    const RasterFrame& m_frame;
    const PointSet* m_points;
};

void sortByTile(const std::vector<CellValue>& values, std::size_t tiles, ReadGroup& group)
{
    group.starts.assign(tiles + 1, 0);
    for (const CellValue& v : values) ++group.starts[(v.place >> 16) + 1];
    for (std::size_t t = 0; t < tiles; ++t) group.starts[t + 1] += group.starts[t];
    group.values.resize(values.size());
    std::vector<std::uint32_t> next(group.starts.begin(), group.starts.end() - 1);
    for (const CellValue& v : values) group.values[next[v.place >> 16]++] = v;
}

/// The most frequent one of sorted values.
double majorityOf(std::span<const double> sorted)
{
    double best = sorted[0];
    std::size_t most = 0;
    for (std::size_t i = 0, j = 0; i < sorted.size(); i = j) {
        while (j < sorted.size() && sorted[j] == sorted[i]) ++j;
        if (j - i > most) {
            most = j - i;
            best = sorted[i];
        }
    }
    return best;
}

double statisticOf(std::span<const double> sorted, const Statistic& statistic)
{
    const auto n = double(sorted.size());
    switch (statistic.kind) {
        case Statistic::Kind::Percentile: {
            const double place = statistic.percent / 100.0 * (n - 1.0);
            const auto below = std::size_t(place);
            const std::size_t above = std::min(below + 1, sorted.size() - 1);
            return sorted[below] + (sorted[above] - sorted[below]) * (place - double(below));
        }
        case Statistic::Kind::Majority:
            return majorityOf(sorted);
        default:
            break;
    }
    // from the least value, so that large ones keep their digits; sorted, so that any order gives the same
    double sum = 0;
    for (const double v : sorted) sum += v - sorted[0];
    if (statistic.kind == Statistic::Kind::Sum) return sum + n * sorted[0];
    const double mean = sum / n;
    if (statistic.kind == Statistic::Kind::Mean) return mean + sorted[0];
    double squares = 0;
    for (const double v : sorted) squares += (v - sorted[0] - mean) * (v - sorted[0] - mean);
    return std::sqrt(squares / n);
}

/// Adds up the values of one tile.
class TileSums
{
public:
    TileSums(const Statistic& statistic, const std::vector<ReadGroup>& groups)
        : m_statistic(statistic), m_groups(groups)
    {
    }

    /// `tile`: of the piece; its cells [0, columns) x [0, rows) go to `out` by `write(cell column, row, value)`.
    template <typename Write>
    void sum(std::size_t tile, Write write)
    {
        switch (m_statistic.kind) {
            case Statistic::Kind::Min:
            case Statistic::Kind::Max:
            case Statistic::Kind::Range:
            case Statistic::Kind::Count:
                extremes(tile, write);
                return;
            default:
                sorted(tile, write);
        }
    }

private:
    template <typename F>
    void forValues(std::size_t tile, F&& f) const
    {
        for (const ReadGroup& group : m_groups) {
            if (group.values.empty()) continue;
            for (std::uint32_t i = group.starts[tile]; i < group.starts[tile + 1]; ++i)
                f(group.values[i].place & 0xFFFFu, group.values[i].value);
        }
    }

    template <typename Write>
    void extremes(std::size_t tile, Write write)
    {
        constexpr double kFar = std::numeric_limits<double>::infinity();
        m_low.assign(kRasterTile * kRasterTile, kFar);
        m_high.assign(kRasterTile * kRasterTile, -kFar);
        m_count.assign(kRasterTile * kRasterTile, 0);
        forValues(tile, [&](std::uint32_t cell, double value) {
            m_low[cell] = std::min(m_low[cell], value);
            m_high[cell] = std::max(m_high[cell], value);
            ++m_count[cell];
        });
        for (std::size_t cell = 0; cell < m_count.size(); ++cell) {
            if (m_count[cell] == 0) continue;
            double value = m_low[cell];
            if (m_statistic.kind == Statistic::Kind::Max) value = m_high[cell];
            if (m_statistic.kind == Statistic::Kind::Range) value = m_high[cell] - m_low[cell];
            if (m_statistic.kind == Statistic::Kind::Count) value = double(m_count[cell]);
            write(cell % kRasterTile, cell / kRasterTile, value);
        }
    }

    template <typename Write>
    void sorted(std::size_t tile, Write write)
    {
        m_count.assign(kRasterTile * kRasterTile + 1, 0);
        std::size_t all = 0;
        forValues(tile, [&](std::uint32_t cell, double) {
            ++m_count[cell + 1];
            ++all;
        });
        for (std::size_t cell = 0; cell < kRasterTile * kRasterTile; ++cell) m_count[cell + 1] += m_count[cell];
        m_low.resize(all);
        std::vector<std::uint32_t> next(m_count.begin(), m_count.end() - 1);
        forValues(tile, [&](std::uint32_t cell, double value) { m_low[next[cell]++] = value; });
        for (std::size_t cell = 0; cell < kRasterTile * kRasterTile; ++cell) {
            const std::size_t first = m_count[cell], n = m_count[cell + 1] - first;
            if (n == 0) continue;
            std::sort(m_low.begin() + std::ptrdiff_t(first), m_low.begin() + std::ptrdiff_t(first + n));
            write(cell % kRasterTile, cell / kRasterTile, statisticOf({&m_low[first], n}, m_statistic));
        }
    }

    const Statistic& m_statistic;
    const std::vector<ReadGroup>& m_groups;
    std::vector<double> m_low, m_high;
    std::vector<std::uint32_t> m_count;
};

}  // namespace

std::optional<Statistic> parseStatistic(std::string_view word)
{
    using Kind = Statistic::Kind;
    constexpr std::pair<std::string_view, Statistic> kWords[] = {{"min", {Kind::Min}},
                                                                 {"max", {Kind::Max}},
                                                                 {"mean", {Kind::Mean}},
                                                                 {"median", {Kind::Percentile, 50.0}},
                                                                 {"stddev", {Kind::StandardDeviation}},
                                                                 {"range", {Kind::Range}},
                                                                 {"sum", {Kind::Sum}},
                                                                 {"count", {Kind::Count}},
                                                                 {"majority", {Kind::Majority}}};
    for (const auto& [name, statistic] : kWords)
        if (name == word) return statistic;
    double percent = 0;
    if (word.size() < 2 || word[0] != 'p') return std::nullopt;
    const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), percent);
    if (error != std::errc() || end != word.data() + word.size() || !(percent >= 0.0 && percent <= 100.0))
        return std::nullopt;
    return Statistic{Kind::Percentile, percent};
}

Raster rasterize(const PointCloud& cloud, const Attribute& attribute, const Statistic& statistic,
                 const RasterFrame& frame, const PointSet* points, Progress& progress)
{
    const bool counting = statistic.kind == Statistic::Kind::Count;
    Raster raster(frame, counting ? 0.0f : Raster::kNone);
    progress.begin("Filling cells", cloud.size());
    if (cloud.size() == 0 || frame.cells() == 0) return raster;
    const auto boxes = cloud.boxes();
    const CellReader reader(cloud, attribute, counting, frame, points);
    const std::size_t across = tilesAcross(frame.columns);
    for (const MapPiece& piece : cutPieces(cloud, *boxes, frame)) {
        const std::size_t firstRow = piece.firstTileRow * kRasterTile,
                          lastRow = std::min(frame.rows, piece.lastTileRow * kRasterTile),
                          tiles = (piece.lastTileRow - piece.firstTileRow) * across;
        if (tiles >= std::size_t(1) << 16) throw Error("The map is too wide for its cells; take larger ones.");
        std::vector<std::size_t> stretches;
        for (std::size_t s = 0; s < boxes->size(); ++s) {
            const auto [first, last] = rowsOf((*boxes)[s], cloud.coordinates(), frame);
            if (first < lastRow && last > firstRow) stretches.push_back(s);
        }
        std::vector<ReadGroup> groups((stretches.size() + kGroupStretches - 1) / kGroupStretches);
        tbb::parallel_for(std::size_t(0), groups.size(), [&](std::size_t g) {
            std::vector<CellValue> values;
            for (std::size_t k = g * kGroupStretches; k < std::min(stretches.size(), (g + 1) * kGroupStretches);
                 ++k) {
                if (progress.cancelled()) return;
                const PointRange range = boxes->points(stretches[k]);
                reader.read(range, piece, values);
                // a stretch is counted in the piece where its box begins
                if (rowsOf((*boxes)[stretches[k]], cloud.coordinates(), frame).first >= firstRow)
                    progress.add(range.size());
            }
            sortByTile(values, tiles, groups[g]);
        });
        progress.check();
        tbb::parallel_for(std::size_t(0), tiles, [&](std::size_t tile) {
            if (progress.cancelled()) return;
            const std::size_t row = firstRow + tile / across * kRasterTile, column = tile % across * kRasterTile;
            TileSums(statistic, groups).sum(tile, [&](std::size_t c, std::size_t r, double value) {
                raster.at(column + c, row + r) = float(value);
            });
        });
        progress.check();
    }
    return raster;
}

WorldBounds boundsOfPoints(const PointCloud& cloud, const PointSet* points, Progress& progress)
{
    const auto boxes = cloud.boxes();
    if (points == nullptr && deletedPoints(cloud) == nullptr) {
        const RawBounds all = boxes->bounds();
        return all.empty() ? WorldBounds() : cloud.coordinates().toWorld(all);
    }
    progress.begin("Looking at the extent", cloud.size());
    std::mutex mutex;
    RawBounds bounds;
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        RawBounds mine;
        const PointSet* const deleted = cloud.deleted().get();
        const std::int32_t *const x = cloud.rawX().data(), *const y = cloud.rawY().data(),
                                  *const z = cloud.rawZ().data();
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            std::uint64_t bits = shownBits(cloud.size(), deleted, w);
            if (points != nullptr) bits &= points->words()[w];
            for (; bits != 0; bits &= bits - 1) {
                const std::size_t i = w * 64 + std::size_t(std::countr_zero(bits));
                mine.include(x[i], y[i], z[i]);
            }
        }
        const std::lock_guard lock(mutex);
        bounds.include(mine);
    });
    return bounds.empty() ? WorldBounds() : cloud.coordinates().toWorld(bounds);
}

}  // namespace punctum
