// SPDX-License-Identifier: MIT
#include "core/raster/Contours.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/raster/Crossings.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace punctum
{

namespace
{

constexpr double kMostLevels = 100'000;
constexpr std::size_t kRowsAtOnce = 64;
constexpr double kInnermost = 1e-6;  ///< of an edge, that lines stay away from its ends, so that they do not meet

/// A piece of a line through a square, from edge to edge, with higher ground on the left. An edge is named by the
/// cell at its western or northern end: twice its number, and one more for those that go south.
struct LevelPiece {
    std::uint64_t from, to;
};
using ContourLevel = std::int64_t;
using LevelPieces = std::map<ContourLevel, std::vector<LevelPiece>>;

/// Finds the pieces of all levels in some rows of squares.
class SquareMarch
{
public:
    SquareMarch(const Raster& raster, double base, double step) : m_raster(raster), m_base(base), m_step(step) {}

    double height(ContourLevel level) const { return m_base + double(level) * m_step; }

    void rows(std::size_t first, std::size_t last, LevelPieces& out) const
    {
        for (std::size_t r = first; r < last; ++r)
            for (std::size_t c = 0; c + 1 < m_raster.columns(); ++c) {
                const std::array<double, 4> z = {double(m_raster.at(c, r)), double(m_raster.at(c + 1, r)),
                                                 double(m_raster.at(c + 1, r + 1)), double(m_raster.at(c, r + 1))};
                if (std::isnan(z[0] + z[1] + z[2] + z[3])) continue;
                const auto [low, high] = std::minmax_element(z.begin(), z.end());
                // levels with low < height <= high
                auto level = ContourLevel(std::floor((*low - m_base) / m_step));
                while (height(level) <= *low) ++level;
                for (; height(level) <= *high; ++level) square(c, r, z, level, out);
            }
    }

    glm::dvec2 place(std::uint64_t edge, double height) const
    {
        const std::size_t cell = edge / 2, c = cell % m_raster.columns(), r = cell / m_raster.columns();
        const bool south = edge % 2 != 0;
        const double a = double(m_raster.at(c, r)),
                     b = double(south ? m_raster.at(c, r + 1) : m_raster.at(c + 1, r));
        const double t = std::clamp((height - a) / (b - a), kInnermost, 1.0 - kInnermost);
        glm::dvec2 at = m_raster.frame().middle(c, r);
        (south ? at.y : at.x) += (south ? -t : t) * m_raster.frame().cell;
        return at;
    }

private:
    void square(std::size_t c, std::size_t r, const std::array<double, 4>& z, ContourLevel level,
                LevelPieces& out) const
    {
        const double at = height(level);
        const std::uint64_t cell = r * m_raster.columns() + c;
        // the square's edges: north, east, south, west; corners from north-west clockwise
        const std::uint64_t edges[4] = {2 * cell, 2 * (cell + 1) + 1, 2 * (cell + m_raster.columns()),
                                        2 * cell + 1};
        std::array<bool, 4> above{};
        for (std::size_t k = 0; k < 4; ++k) above[k] = z[k] >= at;
        std::vector<LevelPiece>& pieces = out[level];
        if (above[0] == above[2] && above[1] == above[3] && above[0] != above[1]) {
            // a saddle: the middle tells which corners are connected
            const bool middle = (z[0] + z[1] + z[2] + z[3]) / 4 >= at;
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t before = (k + 3) % 4;  // the edges of corner k are before and k
                if (above[k] == middle) continue;
                pieces.push_back(above[k] ? LevelPiece{edges[before], edges[k]}
                                          : LevelPiece{edges[k], edges[before]});
            }
            return;
        }
        // one edge goes from above to below, clockwise, and one back
        std::uint64_t down = 0, up = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const bool here = above[k], next = above[(k + 1) % 4];
            if (here && !next) down = edges[k];
            if (!here && next) up = edges[k];
        }
        pieces.push_back({up, down});
    }

    const Raster& m_raster;
    double m_base, m_step;
};

/// Joins pieces to lines: open ones first, in the order of their first edges.
std::vector<ContourLine> joinPieces(std::vector<LevelPiece> pieces, const SquareMarch& march, double height)
{
    std::sort(pieces.begin(), pieces.end(),
              [](const LevelPiece& a, const LevelPiece& b) { return a.from < b.from; });
    std::vector<std::uint64_t> ends;
    ends.reserve(pieces.size());
    for (const LevelPiece& p : pieces) ends.push_back(p.to);
    std::sort(ends.begin(), ends.end());
    std::vector<bool> used(pieces.size(), false);
    const auto next = [&](std::uint64_t edge) {
        const auto found = std::lower_bound(pieces.begin(), pieces.end(), edge,
                                            [](const LevelPiece& p, std::uint64_t e) { return p.from < e; });
        return found != pieces.end() && found->from == edge ? std::size_t(found - pieces.begin()) : pieces.size();
    };
    std::vector<ContourLine> lines;
    const auto follow = [&](std::size_t piece) {
        ContourLine line;
        line.height = height;
        const std::uint64_t begin = pieces[piece].from;
        line.points.push_back(march.place(begin, height));
        while (piece < pieces.size() && !used[piece]) {
            used[piece] = true;
            const std::uint64_t end = pieces[piece].to;
            if (end == begin) {
                line.closed = true;
                break;
            }
            line.points.push_back(march.place(end, height));
            piece = next(end);
        }
        lines.push_back(std::move(line));
    };
    for (std::size_t k = 0; k < pieces.size(); ++k)
        if (!used[k] && !std::binary_search(ends.begin(), ends.end(), pieces[k].from)) follow(k);
    for (std::size_t k = 0; k < pieces.size(); ++k)
        if (!used[k]) follow(k);
    return lines;
}

double lengthOf(const ContourLine& line)
{
    double length = 0;
    for (std::size_t k = 1; k < line.points.size(); ++k) {
        const glm::dvec2 d = line.points[k] - line.points[k - 1];
        length += std::hypot(d.x, d.y);
    }
    return length;
}

std::vector<ContourLine> marchAll(const Raster& raster, const SquareMarch& march, Progress& progress)
{
    if (raster.rows() < 2 || raster.columns() < 2) return {};
    const std::size_t squares = raster.rows() - 1, tasks = (squares + kRowsAtOnce - 1) / kRowsAtOnce;
    progress.begin("Drawing contours", tasks);
    std::vector<LevelPieces> found(tasks);
    tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
        if (progress.cancelled()) return;
        march.rows(task * kRowsAtOnce, std::min(squares, (task + 1) * kRowsAtOnce), found[task]);
        progress.add(1);
    });
    progress.check();
    LevelPieces all;
    for (LevelPieces& part : found)
        for (auto& [level, pieces] : part) {
            auto& whole = all[level];
            whole.insert(whole.end(), pieces.begin(), pieces.end());
            pieces = {};
        }
    std::vector<std::pair<ContourLevel, std::vector<LevelPiece>*>> levels;
    for (auto& [level, pieces] : all) levels.emplace_back(level, &pieces);
    std::vector<std::vector<ContourLine>> joined(levels.size());
    progress.begin("Joining contours", levels.size());
    tbb::parallel_for(std::size_t(0), levels.size(), [&](std::size_t k) {
        if (progress.cancelled()) return;
        joined[k] = joinPieces(std::move(*levels[k].second), march, march.height(levels[k].first));
        progress.add(1);
    });
    progress.check();
    std::vector<ContourLine> lines;
    for (auto& part : joined)
        lines.insert(lines.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
    return lines;
}

}  // namespace

std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& points, bool closed, double tolerance)
{
    if (points.size() < 3 || tolerance <= 0.0) return points;
    std::vector<glm::dvec2> ring = points;
    if (closed) ring.push_back(points[0]);
    std::vector<bool> kept(ring.size(), false);
    kept.front() = kept.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open;
    if (closed) {
        // cut where it is furthest from its begin, and there again, so that what is left is an area
        const auto furthest = [&](std::size_t from) {
            std::size_t best = from;
            double most = -1;
            for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
                const glm::dvec2 d = ring[k] - ring[from];
                if (d.x * d.x + d.y * d.y > most) {
                    most = d.x * d.x + d.y * d.y;
                    best = k;
                }
            }
            return best;
        };
        const std::size_t far = furthest(0);
        kept[far] = true;
        open = {{0, far}, {far, ring.size() - 1}};
    } else {
        open = {{0, ring.size() - 1}};
    }
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const glm::dvec2 a = ring[first], along = ring[last] - a;
        const double length = std::hypot(along.x, along.y);
        double most = -1;
        std::size_t best = first;
        for (std::size_t k = first + 1; k < last; ++k) {
            const glm::dvec2 d = ring[k] - a;
            // beyond the ends the distance is to them
            const double t =
                length > 0 ? std::clamp((d.x * along.x + d.y * along.y) / (length * length), 0.0, 1.0) : 0.0;
            const double off = std::hypot(d.x - t * along.x, d.y - t * along.y);
            if (off > most) {
                most = off;
                best = k;
            }
        }
        if (most <= tolerance) continue;
        kept[best] = true;
        open.emplace_back(first, best);
        open.emplace_back(best, last);
    }
    std::vector<glm::dvec2> out;
    for (std::size_t k = 0; k < ring.size() - (closed ? 1 : 0); ++k)
        if (kept[k]) out.push_back(ring[k]);
    return closed && out.size() < 3 ? points : out;
}

std::vector<ContourLine> contoursOf(const Raster& heights, const ContourOptions& options, Progress& progress)
{
    if (!std::isfinite(options.step) || options.step <= 0.0)
        throw Error("The step between contours must be more than 0.");
    float low = Raster::kNone, high = Raster::kNone;
    for (const float v : heights.values()) {
        if (std::isnan(v)) continue;
        low = std::isnan(low) ? v : std::min(low, v);
        high = std::isnan(high) ? v : std::max(high, v);
    }
    if (std::isnan(low)) return {};
    if (double(high - low) / options.step > kMostLevels)
        throw Error("There would be more than " + grouped(std::uint64_t(kMostLevels)) +
                    " heights; take a larger step between contours.");
    const SquareMarch march(heights, options.base, options.step);
    std::vector<ContourLine> lines = marchAll(heights, march, progress);
    const double cell = heights.frame().cell;
    if (options.shortest > 0.0)
        std::erase_if(lines, [&](const ContourLine& line) {
            return line.closed && lengthOf(line) < options.shortest * cell;
        });
    if (options.indexEvery > 0)
        for (ContourLine& line : lines) {
            const auto level = std::llround((line.height - options.base) / options.step);
            line.index = level % options.indexEvery == 0;
        }
    if (options.simplify > 0.0) simplifyApart(lines, options.simplify * cell, cell, progress);
    return lines;
}

std::vector<ContourLine> levelLines(const Raster& raster, float level, Progress& progress)
{
    // a step so large that there is no other level
    return marchAll(raster, SquareMarch(raster, double(level), 1e30), progress);
}

}  // namespace punctum
