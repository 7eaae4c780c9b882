// SPDX-License-Identifier: MIT
#include "render/raster/Backend.h"
#include "render/raster/cpu/CpuKernels.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

#include <bit>
#include <cmath>
#include <set>
#include <vector>

using namespace punctum;
using namespace punctum::render;

namespace
{

std::vector<KernelChoice> kernels()
{
    std::vector<KernelChoice> all{baselineKernel()};
    if (std::string_view(chooseKernel().name) != all[0].name) all.push_back(chooseKernel());
    return all;
}

/// Uniform in [low, high), the same on every machine.
float between(float low, float high, std::uint64_t seed)
{
    return low + (high - low) * float(test::hash(seed) >> 40) / float(1 << 24);
}

}  // namespace

/// The inner loops of the CPU backend, each version alone, against loops that say what they mean.
class CpuKernelsTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void splatsAreExact_data();
    void splatsAreExact();
    void projectsAsDefined_data();
    void projectsAsDefined();
};

void CpuKernelsTest::splatsAreExact_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<float>("size");
    QTest::addColumn<bool>("round");
    QTest::addColumn<float>("sizeOverDepth");
    for (const int samples : kSampleCounts) {
        for (const float size : {0.01f, 0.5f, 1.0f, 1.3f, 2.0f, 2.5f, 3.0f, 9.75f})
            for (const bool round : {false, true})
                QTest::addRow("%d samples, %g px%s", samples, double(size), round ? ", round" : "")
                    << samples << size << round << 0.0f;
        for (const bool round : {false, true})
            QTest::addRow("%d samples, 1.25 to 8 px by depth%s", samples, round ? ", round" : "")
                << samples << 1.25f << round << 12.0f;
    }
}

// Bit for bit: the cells after some blocks, among them many points in one place, equal depths, places on the grid
// of the samples and squares across every edge of the picture.
void CpuKernelsTest::splatsAreExact()
{
    QFETCH(int, samples);
    QFETCH(float, size);
    QFETCH(bool, round);
    QFETCH(float, sizeOverDepth);
    constexpr int kWidth = 37, kHeight = 23, kBlocks = 12;
    LayerProjection projection;
    projection.pointSize = size;
    projection.sizeOverDepth = sizeOverDepth;
    projection.round = round;
    const int least = projection.sizeInSteps(), most = 8 * kSampleSteps;
    const bool pixels = projection.singlePixels(samples);
    const float margin = pixels ? 0.0f : 5;
    for (const KernelChoice& kernel : kernels()) {
        std::vector<std::uint64_t> cells(std::size_t(kWidth * kHeight * samples) + 1, ~std::uint64_t(0));
        cells.back() = 0;
        std::vector<std::uint64_t> expected = cells;
        const SplatTarget target{
            cells.data(), kWidth, kHeight, samples, least, samplePlaces(samples), sizeOverDepth * kSampleSteps,
            most,         round};
        for (std::uint64_t b = 0; b < kBlocks; ++b) {
            ProjectedBlock block;
            const std::size_t count = b == 0 ? kProjectBlock : test::hash(b) % kProjectBlock;
            for (std::size_t k = 0; k < count; ++k) {
                const std::uint64_t seed = (b * kProjectBlock + k) * 4;
                block.x[k] = between(-margin, kWidth + margin, seed);
                block.y[k] = between(-margin, kHeight + margin, seed + 1);
                if (k % 3 == 0) {
                    block.x[k] = std::floor(block.x[k] * 16) / 16;
                    block.y[k] = std::floor(block.y[k] * 16) / 16;
                }
                block.x[k] = std::clamp(block.x[k], -margin, std::nextafter(kWidth + margin, 0.0f));
                block.y[k] = std::clamp(block.y[k], -margin, std::nextafter(kHeight + margin, 0.0f));
                const float depth = std::floor(between(1, 9, seed + 2));
                block.depth[k] = std::bit_cast<std::uint32_t>(depth);
                const int steps = sizeOverDepth > 0
                                      ? std::clamp(int(sizeOverDepth * kSampleSteps / depth + 0.5f), least, most)
                                      : least;
                block.id[k] = std::uint32_t(test::hash(seed + 3));
                const std::uint64_t key = std::uint64_t(block.depth[k]) << 32 | block.id[k];
                const double left = std::floor((double(block.x[k]) - steps / 32.0) * 16),
                             top = std::floor((double(block.y[k]) - steps / 32.0) * 16);
                std::size_t at = 0;
                for (int y = 0; y < kHeight; ++y)
                    for (int x = 0; x < kWidth; ++x)
                        for (int s = 0; s < samples; ++s, ++at) {
                            const int sx = x * 16 + samplePlaces(samples)[s][0],
                                      sy = y * 16 + samplePlaces(samples)[s][1];
                            // from the middle of the samples that the square covers
                            const double dx = sx - left - (steps + 1) / 2.0, dy = sy - top - (steps + 1) / 2.0;
                            const bool inside = !round || steps < kLeastRoundSteps ||
                                                4 * (dx * dx + dy * dy) <= double(steps) * steps;
                            if (sx > left && sx <= left + steps && sy > top && sy <= top + steps && inside)
                                expected[at] = std::min(expected[at], key);
                        }
            }
            std::vector<std::uint32_t> hidden(count + 1);
            const std::vector<std::uint64_t> before = cells;
            hidden.resize(kernel.splat(target, block, count, b % 2 == 0 ? hidden.data() : nullptr));
            if (!pixels || b % 2 != 0) {
                QVERIFY(hidden.empty());
                continue;
            }
            // Every point that was there or came is either visible or named as hidden, and none is both.
            std::multiset<std::uint32_t> all(block.id, block.id + count), found(hidden.begin(), hidden.end());
            for (std::size_t k = 0; k + 1 < cells.size(); ++k) {
                if (before[k] != ~std::uint64_t(0)) all.insert(std::uint32_t(before[k]));
                if (cells[k] != ~std::uint64_t(0)) found.insert(std::uint32_t(cells[k]));
            }
            QVERIFY(all == found);
        }
        std::size_t different = 0;
        for (std::size_t k = 0; k < cells.size(); ++k) different += cells[k] != expected[k];
        QVERIFY2(different == 0, qPrintable(QString("%1: %2 cells differ").arg(kernel.name).arg(different)));
    }
}

void CpuKernelsTest::projectsAsDefined_data()
{
    QTest::addColumn<bool>("perspective");
    QTest::addRow("perspective") << true;
    QTest::addRow("parallel") << false;
}

// Which points are kept, in order and with their ids; x, y and depth to some last bits of float, because products
// and sums may be rounded together or one by one.
void CpuKernelsTest::projectsAsDefined()
{
    QFETCH(bool, perspective);
    const ProjectArguments a{{1000, 2000, 3000},
                             {0.3f, 0.05f, -0.02f, 70},
                             {0.01f, -0.2f, 0.1f, 60},
                             {0.1f, 0.2f, 0.3f, 2},
                             1.5f,
                             -2,
                             128,
                             -2,
                             96,
                             perspective};
    for (const KernelChoice& kernel : kernels())
        for (const std::size_t count : {0, 1, 7, 8, 9, 100, 255, 256}) {
            std::vector<std::int32_t> positions(3 * kProjectBlock + 512);
            std::vector<std::size_t> expected;
            std::vector<std::array<double, 3>> values;
            bool edge = false;
            for (std::size_t k = 0; k < count; ++k) {
                double q[3];
                for (std::size_t c = 0; c < 3; ++c) {
                    positions[3 * k + c] = a.reference[c] + int(between(-400, 400, (count * 999 + k) * 3 + c));
                    q[c] = positions[3 * k + c] - a.reference[c];
                }
                const auto along = [&](const float* r) { return r[0] * q[0] + r[1] * q[1] + r[2] * q[2] + r[3]; };
                const double depth = along(a.rowD), w = perspective ? depth : 1.0;
                const double x = along(a.rowX) / w, y = along(a.rowY) / w;
                const bool empty = k % 5 == 2;
                if (empty) positions[3 * k] = 0;
                const auto near = [](double v, double to) { return std::abs(v - to) < 1e-3; };
                edge = edge || near(depth, 1.5) || near(x, -2) || near(x, 128) || near(y, -2) || near(y, 96);
                if (empty || depth < 1.5 || x < -2 || x >= 128 || y < -2 || y >= 96) continue;
                expected.push_back(k);
                values.push_back({x, y, depth});
            }
            QVERIFY2(!edge, "a point lies on an edge: choose others");
            ProjectedBlock block;
            const std::size_t kept = kernel.project(positions.data(), count, 77, a, block);
            QCOMPARE(kept, expected.size());
            for (std::size_t k = 0; k < kept; ++k) {
                QCOMPARE(block.id[k], std::uint32_t(77 + expected[k]));
                QVERIFY(std::abs(block.x[k] - values[k][0]) < 1e-3);
                QVERIFY(std::abs(block.y[k] - values[k][1]) < 1e-3);
                QVERIFY(std::abs(std::bit_cast<float>(block.depth[k]) - values[k][2]) < 1e-4);
            }
        }
}

QTEST_APPLESS_MAIN(CpuKernelsTest)
#include "CpuKernelsTest.moc"
