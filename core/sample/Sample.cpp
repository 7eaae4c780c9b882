// SPDX-License-Identifier: MIT
#include "core/sample/Sample.h"

#include "core/Error.h"
#include "core/las/ExtraBytes.h"
#include "core/las/PointFormat.h"
#include "core/las/SourceFile.h"
#include "core/sample/Survey.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace punctum
{

namespace sample
{

namespace
{

constexpr double kDensity = 10.0;           ///< points a square metre, overlaps included
constexpr double kSpeed = 60.0;             ///< of the aircraft, m/s
constexpr double kTurn = 150.0;             ///< seconds from the end of a line to the start of the next
constexpr double kStartTime = 417'312'000;  ///< GPS time less 1e9 s: a morning in December 2024
constexpr double kBlockPoints = 50'000;
constexpr double kWest = 457'000.0, kSouth = 5'552'000.0;  ///< of the scene's corner, zone 33 north
constexpr double kUp = 180.0;                              ///< z of the scene's zero

constexpr const char* kWkt =
    "PROJCS[\"WGS 84 / UTM zone 33N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
    "84\",6378137,298.257223563,"
    "AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\","
    "\"8901\"]],"
    "UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]],"
    "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",15],"
    "PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],"
    "UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH],"
    "AUTHORITY[\"EPSG\",\"32633\"]]";

/// Degrees; the series of atan, exact enough (1e-6) below 0.45.
double angleOf(double slope)
{
    const double s = slope * slope;
    const double series =
        1 + s * (-1.0 / 3 + s * (1.0 / 5 + s * (-1.0 / 7 + s * (1.0 / 9 + s * (-1.0 / 11 + s * (1.0 / 13))))));
    return slope * series * 57.29577951308232;
}

/// 10 log10 of a positive number, from its exponent and a series of the rest: the same bits on every machine.
double decibels(double v)
{
    const auto bits = std::bit_cast<std::uint64_t>(v);
    const double exponent = double(int((bits >> 52) & 0x7FF) - 1023);
    const double m = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFu) | 0x3FF0000000000000u);
    const double t = (m - 1.0) / (m + 1.0), t2 = t * t;  // ln m = 2 atanh t
    const double ln = 2.0 * t * (1.0 + t2 * (1.0 / 3 + t2 * (1.0 / 5 + t2 * (1.0 / 7 + t2 * (1.0 / 9)))));
    return (exponent * 0.6931471805599453 + ln) * 4.3429448190325175;
}

std::uint16_t sixteenBit(double v)
{
    return std::uint16_t(std::clamp(v, 0.0, 1.0) * 65535.0);
}

/// The columns that a point is written to.
struct Columns {
    std::int32_t *x, *y, *z;
    std::uint16_t *intensity, *source, *red, *green, *blue, *deviation;
    std::uint8_t *returns, *flags, *code;
    std::int16_t* angle;
    double* time;
    float* reflectance;

    explicit Columns(PointCloud& cloud)
    {
        const auto column = [&](const char* name, auto*& data) {
            for (const auto& c : cloud.columns())
                if (c->name() == name) data = c->values<std::remove_reference_t<decltype(*data)>>().data();
        };
        column("X", x), column("Y", y), column("Z", z);
        column("Intensity", intensity), column("PointSourceId", source);
        column("Red", red), column("Green", green), column("Blue", blue);
        column("Returns", returns), column("Flags", flags), column("Classification", code);
        column("ScanAngle", angle), column("GpsTime", time);
        column("Reflectance", reflectance), column("Deviation", deviation);
    }
};

FlightPlan makePlan(PointIndex points)
{
    FlightPlan plan;
    plan.side = std::max(12.0, std::sqrt(double(points) / kDensity));
    const double count = std::max(2.0, double(floorOf(plan.side / 300.0 + 0.5)));
    const double spacing = plan.side / count;
    plan.halfSpacing = spacing / 2;
    plan.halfSwath = plan.halfSpacing * 1.3;
    plan.height = plan.halfSwath / 0.36;  // 20 degrees to each side
    double flown = 0;
    for (double k = 0; k < count; ++k) {
        const double middle = (k + 0.5) * spacing;
        plan.lines.push_back(
            {middle, std::max(0.0, middle - plan.halfSwath), std::min(plan.side, middle + plan.halfSwath)});
        flown += (plan.lines.back().east - plan.lines.back().west) * plan.side;
    }
    plan.pulseGap = std::sqrt(flown * 1.3 / double(std::max<PointIndex>(points, 1)));
    for (std::uint32_t l = 0; l < plan.lines.size(); ++l) {
        const double width = plan.lines[l].east - plan.lines[l].west;
        const double perMetre = width * double(points) / flown;
        const double blocks = std::max(1.0, std::floor(plan.side * perMetre / kBlockPoints + 0.5));
        for (double k = 0; k < blocks; ++k)
            plan.blocks.push_back({l, k * plan.side / blocks, plan.side / blocks, 0, 0});
    }
    return plan;
}

/// Shares the points among the blocks by what a test flight over each brings: woods send more back than meadows.
void sharePoints(FlightPlan& plan, const Scene& scene, PointIndex points, std::uint64_t seed, Progress& progress)
{
    std::vector<double> expected(plan.blocks.size());
    tbb::parallel_for(std::size_t(0), plan.blocks.size(), [&](std::size_t b) {
        if (progress.cancelled()) return;
        const auto& block = plan.blocks[b];
        const auto& line = plan.lines[block.line];
        Random random(hash(seed + 7, std::int64_t(b)));
        constexpr int kTestPulses = 1200;
        int returns = 0;
        for (int k = 0; k < kTestPulses; ++k) {
            const double x = random.between(line.west, line.east);
            const double along = block.start + block.length * random.unit();
            returns += sendPulse(scene, x, plan.northing(block, along), plan.slope(line, x), random).count;
        }
        expected[b] = double(returns) * block.length * (line.east - line.west) + 1e-9;
    });
    progress.check();
    double sum = 0;
    for (const double e : expected) sum += e;
    double before = 0;
    std::uint64_t first = 0;
    for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
        before += expected[b];
        const auto last = b + 1 == plan.blocks.size()
                              ? points
                              : std::min<std::uint64_t>(points, std::uint64_t(before / sum * double(points)));
        plan.blocks[b].first = first;
        plan.blocks[b].points = last - first;
        first = last;
    }
}

/// Flies one block: scan lines, to and fro, whose distance is steered so that the points are used up at its end.
class BlockFlight
{
public:
    BlockFlight(const FlightPlan& plan, const FlightPlan::Block& block, const Scene& scene, const Columns& columns,
                std::uint64_t seed)
        : m_plan(plan),
          m_block(block),
          m_line(plan.lines[block.line]),
          m_scene(scene),
          m_columns(columns),
          m_random(hash(seed + 8, std::int64_t(block.first), block.line))
    {
    }

    void fly(const Progress& progress)
    {
        const double width = m_line.east - m_line.west;
        const auto pulses = std::max<std::int64_t>(1, std::int64_t(width / m_plan.pulseGap));
        const double end = m_block.start + m_block.length;
        double perLine = std::max(1.0, double(m_block.points) / std::max(1.0, m_block.length / m_plan.pulseGap));
        double along = m_block.start;
        bool forth = (std::int64_t(along / m_plan.pulseGap) & 1) == 0;
        while (m_done < m_block.points && !progress.cancelled()) {
            const double left = double(m_block.points - m_done);
            // Never all of the way: whatever is left over finds room, and time goes on rising.
            const double step = (end - along) / std::max(1.1, left / perLine);
            const auto before = m_done;
            const auto used =
                left < perLine ? std::max<std::int64_t>(1, std::int64_t(double(pulses) * left / perLine)) : pulses;
            scanLine(along, step, used, forth);
            perLine = std::max(1.0, lerp(perLine, double(m_done - before) * double(pulses) / double(used), 0.3));
            along += step;
            forth = !forth;
        }
    }

private:
    void scanLine(double along, double step, std::int64_t pulses, bool forth)
    {
        const double width = m_line.east - m_line.west;
        const double gap = width / double(pulses);
        const double startTime = kStartTime + double(m_block.line) * (std::ceil(m_plan.side / kSpeed) + kTurn);
        for (std::int64_t k = 0; k < pulses && m_done < m_block.points; ++k) {
            const double fraction = (double(k) + 0.5) / double(pulses);
            const double across =
                (forth ? fraction : 1.0 - fraction) * width + gap * 0.35 * (m_random.unit() - 0.5);
            const double x = m_line.west + std::clamp(across, 0.0, width);
            const double at = along + step * fraction;
            const double y = m_plan.northing(m_block, at) + m_plan.pulseGap * 0.3 * (m_random.unit() - 0.5);
            const double slope = m_plan.slope(m_line, x);
            const Echo echo = sendPulse(m_scene, x, y, slope, m_random);
            write(echo, slope, startTime + at / kSpeed, forth, k + 1 == pulses, x);
        }
    }

    void write(const Echo& echo, double slope, double time, bool forth, bool edge, double x)
    {
        const int count = int(std::min<std::uint64_t>(std::uint64_t(echo.count), m_block.points - m_done));
        const bool overlap = std::fabs(x - m_line.middle) > m_plan.halfSpacing;
        const auto angle = std::int16_t(std::floor(angleOf(slope) / 0.006 + 0.5));
        for (int k = 0; k < count; ++k) {
            const Return& r = echo.returns[std::size_t(k)];
            const std::uint64_t i = m_block.first + m_done++;
            const auto raw = [](double metres) { return std::int32_t(std::floor(metres * 1000.0 + 0.5)); };
            m_columns.x[i] = raw(r.x);
            m_columns.y[i] = raw(r.y);
            m_columns.z[i] = raw(r.z);
            const double received = std::max(1e-4, r.reflectance * (1.0 + 0.08 * m_random.bell()));
            m_columns.intensity[i] = std::uint16_t(std::min(65535.0, received * 90000.0));
            m_columns.returns[i] = std::uint8_t((k + 1) | (count << 4));
            m_columns.flags[i] = std::uint8_t((overlap ? 8 : 0) | (forth ? 64 : 0) | (edge ? 128 : 0));
            m_columns.code[i] = r.code;
            m_columns.angle[i] = angle;
            m_columns.source[i] = std::uint16_t(m_block.line + 1);
            m_columns.time[i] = time;
            m_columns.red[i] = sixteenBit(r.color.r);
            m_columns.green[i] = sixteenBit(r.color.g);
            m_columns.blue[i] = sixteenBit(r.color.b);
            m_columns.reflectance[i] = float(decibels(received));
            m_columns.deviation[i] = std::uint16_t(
                std::clamp(6.0 + 4.0 * m_random.unit() + 260.0 * r.spread * m_random.unit(), 0.0, 65535.0));
        }
    }

    const FlightPlan& m_plan;
    const FlightPlan::Block& m_block;
    const FlightPlan::Line& m_line;
    const Scene& m_scene;
    const Columns& m_columns;
    Random m_random;
    std::uint64_t m_done = 0;
};

}  // namespace

}  // namespace sample

std::shared_ptr<PointCloud> makeSample(PointIndex points, std::uint64_t seed, Progress& progress)
{
    using namespace sample;
    const CoordinateScale coordinates{glm::dvec3(0.001), glm::dvec3(kWest, kSouth, kUp)};
    const las::ExtraBytesField extra[2] = {{"Reflectance", ScalarType::F32, "echo strength, dB", {}, {}},
                                           {"Deviation", ScalarType::U16, "pulse shape deviation", {}, {}}};
    if (points > 1'000'000'000'000) throw Error("A sample of more than 1,000,000,000,000 points cannot be made.");
    auto source = las::makeSource(7, extra, coordinates, kWkt, points);
    auto cloud = std::make_shared<PointCloud>(points, coordinates);
    las::makeColumns(*cloud, source->layout);
    cloud->setUnits(source->units);
    cloud->setSource(std::move(source));
    if (points == 0) return cloud;

    const std::uint64_t key = mix(seed + 0x50554E4354554Du);
    FlightPlan plan = makePlan(points);
    const Scene scene(plan.side, key, progress);
    sharePoints(plan, scene, points, key, progress);

    progress.begin("Flying the survey", points);
    const Columns columns(*cloud);
    tbb::parallel_for(std::size_t(0), plan.blocks.size(), [&](std::size_t b) {
        if (progress.cancelled()) return;
        BlockFlight(plan, plan.blocks[b], scene, columns, key).fly(progress);
        progress.add(plan.blocks[b].points);
    });
    progress.check();
    return cloud;
}

}  // namespace punctum
