// SPDX-License-Identifier: MIT
#include "core/cloud/PointFigures.h"

#include "core/cloud/BlockBoxes.h"
#include "core/cloud/PointSet.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

namespace punctum
{

namespace
{

constexpr std::size_t kBlock = 64;          ///< points of a word of a set
constexpr std::size_t kSamples = 100'000;   ///< by which the middle is found
constexpr double kMiddle = 0.005;           ///< share on each side that is not the middle
constexpr double kStrayExtents = 20.0;      ///< of the middle: what is farther away belongs to nothing
constexpr double kLeastHeightShare = 0.05;  ///< of the horizontal extent: flat ground has birds above it
constexpr double kPointsPerCell = 8.0;      ///< so that cells between points of one surface are not empty
constexpr std::size_t kMostCells = std::size_t(1) << 26;

/// The attributes that are counted, copied so that no list can change meanwhile.
struct Fields {
    explicit Fields(const PointCloud& cloud)
    {
        const std::shared_lock lock(cloud.mutex());
        const auto take = [&](const char* name) -> std::optional<Attribute> {
            const Attribute* const a = cloud.findAttribute(name);
            if (a == nullptr || a->components != 1 || !a->standard) return std::nullopt;
            return *a;
        };
        classes = take("Classification");
        returnNumber = take("ReturnNumber");
        numberOfReturns = take("NumberOfReturns");
        channel = take("ScannerChannel");
        const char* const flagNames[] = {"Synthetic", "KeyPoint",          "Withheld",
                                         "Overlap",   "ScanDirectionFlag", "EdgeOfFlightLine"};
        for (std::size_t k = 0; k < flags.size(); ++k) flags[k] = take(flagNames[k]);
        const char* const colorNames[] = {"Red", "Green", "Blue"};
        for (std::size_t k = 0; k < colors.size(); ++k) colors[k] = take(colorNames[k]);
        gpsTime = take("GpsTime");
        scanAngle = take("ScanAngle");
    }
    std::optional<Attribute> classes, returnNumber, numberOfReturns, channel, gpsTime, scanAngle;
    std::array<std::optional<Attribute>, 6> flags;
    std::array<std::optional<Attribute>, 3> colors;
};

/// The counts of some points.
struct Counts {
    PointFigures f;
    std::array<std::uint64_t, 6> flags{};
    double firstTime = std::numeric_limits<double>::infinity();
    double lastTime = -std::numeric_limits<double>::infinity();

    void add(const Counts& o)
    {
        f.points += o.f.points;
        f.bounds.include(o.f.bounds);
        for (std::size_t k = 0; k < f.classes.size(); ++k) f.classes[k] += o.f.classes[k];
        for (std::size_t k = 0; k < f.returns.size(); ++k) f.returns[k] += o.f.returns[k];
        for (std::size_t k = 0; k < f.pulses.size(); ++k) f.pulses[k] += o.f.pulses[k];
        for (std::size_t k = 0; k < f.channels.size(); ++k) f.channels[k] += o.f.channels[k];
        f.lastReturns += o.f.lastReturns;
        f.returnsAbove += o.f.returnsAbove;
        f.noReturns += o.f.noReturns;
        f.colorBits |= o.f.colorBits;
        f.scanAngleMost = std::max(f.scanAngleMost, o.f.scanAngleMost);
        for (std::size_t k = 0; k < flags.size(); ++k) flags[k] += o.flags[k];
        firstTime = std::min(firstTime, o.firstTime);
        lastTime = std::max(lastTime, o.lastTime);
    }
};

/// Calls f(k) for each set bit k.
template <typename F>
void forBits(std::uint64_t bits, F f)
{
    if (bits == ~std::uint64_t(0)) {
        for (std::size_t k = 0; k < kBlock; ++k) f(k);
        return;
    }
    for (; bits != 0; bits &= bits - 1) f(std::size_t(std::countr_zero(bits)));
}

/// Includes the coordinates of a word's points.
void includeWord(const PointCloud& cloud, std::size_t word, std::uint64_t bits, RawBounds& bounds)
{
    const std::int32_t* const axes[3] = {cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data()};
    for (int axis = 0; axis < 3; ++axis) {
        std::int32_t low = INT32_MAX, high = INT32_MIN;
        const std::int32_t* const raw = axes[axis] + word * kBlock;
        forBits(bits, [&](std::size_t k) {
            low = std::min(low, raw[k]);
            high = std::max(high, raw[k]);
        });
        bounds.min[axis] = std::min<std::int64_t>(bounds.min[axis], low);
        bounds.max[axis] = std::max<std::int64_t>(bounds.max[axis], high);
    }
}

/// Counts a word's points, but for where they are.
void countWord(const PointCloud& cloud, const Fields& fields, std::size_t word, std::uint64_t bits, Counts& c)
{
    const PointRange range{word * kBlock, std::min<PointIndex>(cloud.size(), word * kBlock + kBlock)};
    std::uint8_t a[kBlock] = {}, b[kBlock] = {};
    std::uint32_t wide[kBlock] = {};
    double numbers[kBlock] = {};
    c.f.points += std::uint64_t(std::popcount(bits));
    if (fields.classes) {
        fields.classes->gatherBits(range, a);
        forBits(bits, [&](std::size_t k) { ++c.f.classes[a[k]]; });
    }
    if (fields.returnNumber && fields.numberOfReturns) {
        fields.returnNumber->gatherBits(range, a);
        fields.numberOfReturns->gatherBits(range, b);
        forBits(bits, [&](std::size_t k) {
            ++c.f.returns[a[k] & 15u];
            ++c.f.pulses[b[k] & 15u];
            c.f.lastReturns += a[k] == b[k] && b[k] != 0;
            c.f.returnsAbove += a[k] > b[k] && b[k] != 0;
            c.f.noReturns += b[k] == 0;
        });
    }
    if (fields.channel) {
        fields.channel->gatherBits(range, a);
        forBits(bits, [&](std::size_t k) { ++c.f.channels[a[k] & 3u]; });
    }
    for (std::size_t flag = 0; flag < fields.flags.size(); ++flag) {
        if (!fields.flags[flag]) continue;
        fields.flags[flag]->gatherBits(range, a);
        std::uint64_t n = 0;
        forBits(bits, [&](std::size_t k) { n += a[k]; });
        c.flags[flag] += n;
    }
    for (const auto& color : fields.colors) {
        if (!color) continue;
        color->gatherBits(range, wide);
        forBits(bits, [&](std::size_t k) { c.f.colorBits |= wide[k]; });
    }
    if (fields.gpsTime) {
        fields.gpsTime->read(range, numbers);
        forBits(bits, [&](std::size_t k) {
            c.firstTime = std::min(c.firstTime, numbers[k]);  // NaN changes nothing
            c.lastTime = std::max(c.lastTime, numbers[k]);
        });
    }
    if (fields.scanAngle) {
        fields.scanAngle->read(range, numbers);
        forBits(bits,
                [&](std::size_t k) { c.f.scanAngleMost = std::max(c.f.scanAngleMost, std::abs(numbers[k])); });
    }
}

/// The middle of a sample: lower and upper bound of all but kMiddle of it on each side, axis by axis.
WorldBounds middleOf(const PointCloud& cloud, const PointSet* leftOut)
{
    const std::shared_lock lock(cloud.mutex());
    const PointIndex step = std::max<PointIndex>(1, cloud.size() / kSamples);
    std::array<std::vector<std::int32_t>, 3> values;
    for (PointIndex i = 0; i < cloud.size(); i += step) {
        if (leftOut != nullptr && leftOut->contains(i)) continue;
        values[0].push_back(cloud.rawX()[i]);
        values[1].push_back(cloud.rawY()[i]);
        values[2].push_back(cloud.rawZ()[i]);
    }
    if (values[0].empty()) return {};
    RawBounds raw;
    for (int axis = 0; axis < 3; ++axis) {
        auto& v = values[std::size_t(axis)];
        const auto below = std::size_t(double(v.size() - 1) * kMiddle);
        std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(below), v.end());
        raw.min[axis] = v[below];
        const std::size_t above = v.size() - 1 - below;
        std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(above), v.end());
        raw.max[axis] = v[above];
    }
    return cloud.coordinates().toWorld(raw);
}

WorldBounds widened(const WorldBounds& box, const glm::dvec3& by)
{
    return {box.min - by, box.max + by};
}

/// Which cells of a grid over the ground have points.
class Cells
{
public:
    Cells(const WorldBounds& box, std::uint64_t points)
    {
        const glm::dvec3 size = box.max - box.min;
        if (!(size.x > 0) || !(size.y > 0) || points == 0) return;
        m_box = box;
        m_side = std::sqrt(size.x * size.y / std::max(1.0, double(points) / kPointsPerCell));
        m_side = std::max(m_side, std::sqrt(size.x * size.y / (double(kMostCells) / 4)));
        const double columns = std::floor(size.x / m_side) + 1, rows = std::floor(size.y / m_side) + 1;
        if (!(columns * rows <= double(kMostCells))) return;  // a line of points: it has no area to speak of
        m_columns = std::size_t(columns);
        m_rows = std::size_t(rows);
        m_words = std::vector<std::atomic<std::uint64_t>>(m_columns * m_rows / 64 + 1);
    }
    bool any() const { return m_columns != 0; }
    void mark(double x, double y)
    {
        const auto cell =
            std::size_t((y - m_box.min.y) / m_side) * m_columns + std::size_t((x - m_box.min.x) / m_side);
        std::atomic<std::uint64_t>& word = m_words[cell / 64];
        const std::uint64_t bit = std::uint64_t(1) << cell % 64;
        if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
    }
    double area() const
    {
        std::uint64_t cells = 0;
        for (const auto& word : m_words)
            cells += std::uint64_t(std::popcount(word.load(std::memory_order_relaxed)));
        return double(cells) * m_side * m_side;
    }

private:
    WorldBounds m_box;
    double m_side = 1.0;
    std::size_t m_columns = 0, m_rows = 0;
    std::vector<std::atomic<std::uint64_t>> m_words;
};

/// Strays, area and density: a second pass, once the middle is known.
void measureExtent(const PointCloud& cloud, const PointSet* leftOut, PointFigures& f, Progress& progress)
{
    const WorldBounds middle = middleOf(cloud, leftOut);
    if (middle.empty()) return;
    const glm::dvec3 size = middle.max - middle.min;
    const double across = std::max(size.x, size.y);
    glm::dvec3 reach(size.x, size.y, std::max(size.z, across * kLeastHeightShare));
    reach.x = std::max(reach.x, across * kLeastHeightShare);
    reach.y = std::max(reach.y, across * kLeastHeightShare);
    const WorldBounds all = cloud.coordinates().toWorld(f.bounds);
    f.common = widened(middle, reach);
    f.common.min = glm::max(f.common.min, all.min);
    f.common.max = glm::min(f.common.max, all.max);
    const WorldBounds near = widened(middle, reach * kStrayExtents);
    Cells cells(f.common, f.points);
    std::atomic<std::uint64_t> strays{0}, within{0};
    progress.begin("Measuring the density", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
        const CoordinateScale grid = cloud.coordinates();
        std::uint64_t far = 0, inside = 0;
        for (std::size_t w = first; w != last; ++w)
            forBits(shownBits(cloud.size(), leftOut, w), [&](std::size_t k) {
                const PointIndex i = PointIndex(w) * kBlock + k;
                const glm::dvec3 p = grid.toWorld(glm::dvec3(cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i]));
                far += p.x < near.min.x || p.x > near.max.x || p.y < near.min.y || p.y > near.max.y ||
                       p.z < near.min.z || p.z > near.max.z;
                if (!cells.any() || p.x < f.common.min.x || p.x > f.common.max.x || p.y < f.common.min.y ||
                    p.y > f.common.max.y)
                    return;
                ++inside;
                cells.mark(p.x, p.y);
            });
        strays += far;
        within += inside;
    });
    if (across > 0) f.strays = strays;
    if (!cells.any()) return;
    f.area = cells.area();
    if (!(f.area > 0)) return;
    f.density = double(within.load()) / f.area;
    f.pulseDensity = f.points == 0 ? 0.0 : f.density * (double(f.lastReturns) / double(f.points));
    f.spacing = f.density > 0 ? 1.0 / std::sqrt(f.density) : 0.0;
}

}  // namespace

PointFigures computePointFigures(const PointCloud& cloud, const PointSet* leftOut, Progress& progress)
{
    const Fields fields(cloud);
    const auto boxes = cloud.boxes();
    progress.begin("Counting points", cloud.size());
    std::mutex mutex;
    Counts all;
    forEachSlab(cloud, progress, [&](std::size_t first, std::size_t last) {
        const auto counts = std::make_unique<Counts>();
        forStretches(first, last, [&](std::size_t stretch, std::size_t begin, std::size_t end) {
            const RawBounds box = (*boxes)[stretch];
            if (shownIn(cloud.size(), leftOut, begin, end) == boxes->points(stretch).size())
                counts->f.bounds.include(box);
            const bool known = counts->f.bounds.holds(box);
            for (std::size_t w = begin; w != end; ++w) {
                const std::uint64_t bits = shownBits(cloud.size(), leftOut, w);
                if (bits == 0) continue;
                if (!known) includeWord(cloud, w, bits, counts->f.bounds);
                countWord(cloud, fields, w, bits, *counts);
            }
        });
        const std::lock_guard lock(mutex);
        all.add(*counts);
    });
    PointFigures& f = all.f;
    std::uint64_t* const flags[] = {&f.synthetic, &f.keyPoint,      &f.withheld,
                                    &f.overlap,   &f.scanDirection, &f.edgeOfFlightLine};
    for (std::size_t k = 0; k < all.flags.size(); ++k) *flags[k] = all.flags[k];
    if (all.firstTime <= all.lastTime) f.gpsTime = {all.firstTime, all.lastTime};
    if (f.points != 0) measureExtent(cloud, leftOut, f, progress);
    return f;
}

}  // namespace punctum
