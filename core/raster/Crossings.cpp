// SPDX-License-Identifier: MIT
#include "core/raster/Crossings.h"

#include "core/raster/Contours.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace punctum
{

namespace
{

constexpr double kCrossingBin = 4.0;  ///< side of a square in which segments are compared, in cells

/// A segment in one of the squares that its box meets.
struct BinnedSegment {
    std::int32_t x, y;
    std::uint32_t line, segment;
};

std::size_t segmentsOf(const ContourLine& line)
{
    return line.points.size() < 2 ? 0 : line.points.size() - (line.closed ? 0 : 1);
}

std::pair<glm::dvec2, glm::dvec2> segmentOf(const ContourLine& line, std::size_t k)
{
    return {line.points[k], line.points[(k + 1) % line.points.size()]};
}

/// Twice the area of the triangle, positive when it turns left.
double turnOf(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool segmentsMeet(const std::pair<glm::dvec2, glm::dvec2>& s, const std::pair<glm::dvec2, glm::dvec2>& t)
{
    if (std::max(s.first.x, s.second.x) < std::min(t.first.x, t.second.x) ||
        std::max(t.first.x, t.second.x) < std::min(s.first.x, s.second.x) ||
        std::max(s.first.y, s.second.y) < std::min(t.first.y, t.second.y) ||
        std::max(t.first.y, t.second.y) < std::min(s.first.y, s.second.y))
        return false;
    const double a = turnOf(s.first, s.second, t.first), b = turnOf(s.first, s.second, t.second),
                 c = turnOf(t.first, t.second, s.first), d = turnOf(t.first, t.second, s.second);
    return ((a >= 0 && b <= 0) || (a <= 0 && b >= 0)) && ((c >= 0 && d <= 0) || (c <= 0 && d >= 0));
}

}  // namespace

std::vector<bool> crossingLines(const std::vector<ContourLine>& lines, double cell, Progress& progress)
{
    const double side = kCrossingBin * cell;
    // from a corner of their own, so that the numbers of squares are small
    glm::dvec2 corner(INFINITY);
    for (const ContourLine& line : lines)
        for (const glm::dvec2& p : line.points)
            corner = glm::dvec2(std::min(corner.x, p.x), std::min(corner.y, p.y));
    std::vector<BinnedSegment> binned;
    for (std::size_t l = 0; l < lines.size(); ++l) {
        progress.check();
        for (std::size_t k = 0; k < segmentsOf(lines[l]); ++k) {
            const auto [a, b] = segmentOf(lines[l], k);
            const auto bin = [&](double v, double from) { return std::int32_t((v - from) / side); };
            for (std::int32_t y = bin(std::min(a.y, b.y), corner.y); y <= bin(std::max(a.y, b.y), corner.y); ++y)
                for (std::int32_t x = bin(std::min(a.x, b.x), corner.x); x <= bin(std::max(a.x, b.x), corner.x);
                     ++x)
                    binned.push_back({x, y, std::uint32_t(l), std::uint32_t(k)});
        }
    }
    tbb::parallel_sort(binned.begin(), binned.end(), [](const BinnedSegment& a, const BinnedSegment& b) {
        return std::tie(a.y, a.x, a.line, a.segment) < std::tie(b.y, b.x, b.line, b.segment);
    });
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < binned.size(); ++i)
        if (i == 0 || binned[i].x != binned[i - 1].x || binned[i].y != binned[i - 1].y) starts.push_back(i);
    starts.push_back(binned.size());
    std::vector<std::uint8_t> crossing(lines.size(), 0);
    const auto mark = [&](std::uint32_t line) {
        std::atomic_ref(crossing[line]).store(1, std::memory_order_relaxed);
    };
    tbb::parallel_for(std::size_t(0), starts.size() - 1, [&](std::size_t b) {
        if (progress.cancelled()) return;
        for (std::size_t i = starts[b]; i < starts[b + 1]; ++i)
            for (std::size_t j = i + 1; j < starts[b + 1]; ++j) {
                const BinnedSegment &s = binned[i], &t = binned[j];
                const std::size_t n = segmentsOf(lines[s.line]);
                // neighbors share a point
                if (s.line == t.line &&
                    (t.segment - s.segment <= 1 || (lines[s.line].closed && t.segment - s.segment == n - 1)))
                    continue;
                if (!segmentsMeet(segmentOf(lines[s.line], s.segment), segmentOf(lines[t.line], t.segment)))
                    continue;
                mark(s.line);
                mark(t.line);
            }
    });
    progress.check();
    return {crossing.begin(), crossing.end()};
}

void simplifyApart(std::vector<ContourLine>& lines, double tolerance, double cell, Progress& progress)
{
    std::vector<std::vector<glm::dvec2>> whole(lines.size());
    progress.begin("Simplifying contours", lines.size());
    tbb::parallel_for(std::size_t(0), lines.size(), [&](std::size_t k) {
        if (progress.cancelled()) return;
        whole[k] = simplified(lines[k].points, lines[k].closed, tolerance);
        whole[k].swap(lines[k].points);
        progress.add(1);
    });
    progress.check();
    // whole lines never cross each other, so this ends: each round gives some their points back
    for (bool again = true; again;) {
        again = false;
        const std::vector<bool> crossing = crossingLines(lines, cell, progress);
        for (std::size_t k = 0; k < lines.size(); ++k) {
            if (!crossing[k] || whole[k].empty()) continue;
            lines[k].points = std::move(whole[k]);
            whole[k].clear();
            again = true;
        }
    }
}

}  // namespace punctum
