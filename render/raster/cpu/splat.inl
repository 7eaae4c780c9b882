// SPDX-License-Identifier: MIT
// SplatKernel, written once and compiled by each file of kernels for its own instructions. Internal linkage
// throughout: no version may stand in for another.
//
// Measured (20 M points of a tiled airborne file, 1280x800, two cores, Xeon with AVX2, processor time):
// - one atomic minimum after another, 16 cells asked for ahead:                                     58 ms
// - all cells of a block asked for first, then those points sorted out that are hidden already:     47 ms
// - and positions asked for 1.5 KiB ahead (CpuKernelsAvx2.cpp):                                     35 ms
// Nine points in ten are hidden by what was drawn before them. A comparison of depths that appends to a list
// without a branch finds them; the locked instruction, and the wrong guesses of a branch, are left to the rest.

#include <cstddef>
#include <cstdint>

namespace punctum::render
{

namespace
{

/// Points whose cells are asked for together, when squares cover several.
constexpr std::size_t kSquareBlock = 64;

inline std::uint32_t highHalf(const std::uint64_t* cell)
{
    return __atomic_load_n(reinterpret_cast<const std::uint32_t*>(cell) + 1, __ATOMIC_RELAXED);
}
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);

/// Returns the key that was there or came to be there: `key` itself, when it is not nearer.
inline std::uint64_t atomicMin(std::uint64_t* cell, std::uint64_t key)
{
    std::uint64_t seen = __atomic_load_n(cell, __ATOMIC_RELAXED);
    while (key < seen && !__atomic_compare_exchange_n(cell, &seen, key, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
    return key < seen ? seen : key;
}

/// Draws point k into cell at[k], for all k.
template <bool kKeepHidden>
inline std::size_t drawAt(std::uint64_t* cells, const std::uint32_t* at, const std::uint32_t* depth,
                          const std::uint32_t* id, std::size_t count, std::uint32_t* hidden)
{
    std::uint32_t nearer[kProjectBlock];
    std::size_t n = 0, h = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const bool maybe = depth[k] <= highHalf(cells + at[k]);
        nearer[n] = std::uint32_t(k);
        n += maybe;
        if constexpr (kKeepHidden) {
            hidden[h] = id[k];
            h += !maybe;
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t k = nearer[i];
        const std::uint64_t farther = atomicMin(cells + at[k], std::uint64_t(depth[k]) << 32 | id[k]);
        if constexpr (kKeepHidden) {
            hidden[h] = std::uint32_t(farther);
            h += farther != ~std::uint64_t(0);
        }
    }
    return h;
}

/// Squares of one pixel at one sample a pixel, by far the commonest: x and y lie inside the picture.
inline std::size_t splatPixels(const SplatTarget& t, const ProjectedBlock& block, std::size_t count,
                               std::uint32_t* hidden)
{
    std::uint32_t at[kProjectBlock];
    for (std::size_t k = 0; k < count; ++k)
        at[k] = std::uint32_t(std::int32_t(block.y[k])) * std::uint32_t(t.width) +
                std::uint32_t(std::int32_t(block.x[k]));
    for (std::size_t k = 0; k < count; ++k) __builtin_prefetch(t.cells + at[k]);
    if (hidden != nullptr) return drawAt<true>(t.cells, at, block.depth, block.id, count, hidden);
    return drawAt<false>(t.cells, at, block.depth, block.id, count, nullptr);
}

/// Rounds down.
inline std::int32_t floorOf(float v)
{
    const auto towardsZero = std::int32_t(v);
    return towardsZero - std::int32_t(float(towardsZero) > v);
}

/// Squares of any size at any number of samples. A square covers the samples whose place p, in steps, has
/// low < p <= low + size; so for a sample at `place` in its pixel, pixels (low - place) / steps + 1, rounded down,
/// to (low + size - place) / steps.
inline void splatSquares(const SplatTarget& t, const ProjectedBlock& block, std::size_t count)
{
    constexpr int kShift = 4;  // of kSampleSteps
    const auto width = std::uint32_t(t.width), height = std::uint32_t(t.height), samples = std::uint32_t(t.samples);
    const std::uint32_t sink = width * height * samples;
    const float half = float(t.size) / (2 << kShift);
    const std::int32_t most = ((t.size - 1) >> kShift) + 1;  // pixels a side that one sample can be covered in
    for (std::size_t begin = 0; begin < count; begin += kSquareBlock) {
        const std::size_t n = count - begin < kSquareBlock ? count - begin : kSquareBlock;
        const float* const x = block.x + begin;
        const float* const y = block.y + begin;
        std::int32_t lowX[kSquareBlock], lowY[kSquareBlock];
        std::uint32_t at[kSquareBlock];
        for (std::size_t k = 0; k < n; ++k) {
            lowX[k] = floorOf((x[k] - half) * (1 << kShift));
            lowY[k] = floorOf((y[k] - half) * (1 << kShift));
        }
        for (std::int32_t row = 0; row <= most && row < 4; ++row) {
            for (std::size_t k = 0; k < n; ++k) {
                const auto px = std::uint32_t(lowX[k] >> kShift), py = std::uint32_t((lowY[k] >> kShift) + row);
                at[k] = (px < width) & (py < height) ? (py * width + px) * samples : sink;
            }
            for (std::size_t k = 0; k < n; ++k) __builtin_prefetch(t.cells + at[k]);
        }
        for (std::uint32_t s = 0; s < samples; ++s) {
            const std::int32_t placeX = t.places[s][0], placeY = t.places[s][1];
            for (std::int32_t dy = 0; dy < most; ++dy) {
                for (std::int32_t dx = 0; dx < most; ++dx) {
                    for (std::size_t k = 0; k < n; ++k) {
                        const std::int32_t px = ((lowX[k] - placeX) >> kShift) + 1 + dx;
                        const std::int32_t py = ((lowY[k] - placeY) >> kShift) + 1 + dy;
                        const bool covers = (px <= ((lowX[k] + t.size - placeX) >> kShift)) &
                                            (py <= ((lowY[k] + t.size - placeY) >> kShift)) &
                                            (std::uint32_t(px) < width) & (std::uint32_t(py) < height);
                        at[k] = covers ? (std::uint32_t(py) * width + std::uint32_t(px)) * samples + s : sink;
                    }
                    drawAt<false>(t.cells, at, block.depth + begin, block.id + begin, n, nullptr);
                }
            }
        }
    }
}

/// Size of a point, steps.
inline std::int32_t sizeAt(const SplatTarget& t, float depth)
{
    if (!(t.sizeOverDepth > 0.0f)) return t.size;
    const float grown = t.sizeOverDepth / depth + 0.5f;
    return grown < float(t.size) ? t.size : grown > float(t.mostSize) ? t.mostSize : std::int32_t(grown);
}

/// Whether each point is the square of one pixel at one sample.
inline bool isSinglePixels(const SplatTarget& t)
{
    return t.samples == 1 && t.size == 16 && !(t.sizeOverDepth > 0.0f);
}

/// Calls use(cell) for each sample that a point at (x, y) px covers.
template <class Use>
inline void forEachCovered(const SplatTarget& t, float x, float y, float depth, const Use& use)
{
    const std::int32_t size = sizeAt(t, depth);
    const float half = float(size) / 32.0f;
    const std::int32_t lowX = floorOf((x - half) * 16.0f), lowY = floorOf((y - half) * 16.0f);
    const auto clipped = [](std::int32_t v, std::int32_t end) { return v < 0 ? 0 : v < end ? v : end - 1; };
    const std::int32_t firstX = clipped((lowX + 1) >> 4, t.width), lastX = clipped((lowX + size) >> 4, t.width);
    const std::int32_t firstY = clipped((lowY + 1) >> 4, t.height), lastY = clipped((lowY + size) >> 4, t.height);
    const bool round = t.round && size >= 24;  // kLeastRoundSteps
    for (std::int32_t py = firstY; py <= lastY; ++py)
        for (std::int32_t px = firstX; px <= lastX; ++px)
            for (std::int32_t s = 0; s < t.samples; ++s) {
                const std::int32_t fromX = px * 16 + t.places[s][0] - lowX, fromY = py * 16 + t.places[s][1] - lowY;
                if ((fromX <= 0) | (fromX > size) | (fromY <= 0) | (fromY > size)) continue;
                if (round) {
                    const std::int32_t dx = 2 * fromX - (size + 1), dy = 2 * fromY - (size + 1);
                    if (dx * dx + dy * dy > size * size) continue;
                }
                use((std::size_t(py) * std::size_t(t.width) + std::size_t(px)) * std::size_t(t.samples) +
                    std::size_t(s));
            }
}

inline float depthOf(std::uint32_t bits)
{
    float depth;
    __builtin_memcpy(&depth, &bits, sizeof depth);
    return depth;
}

/// Circles, and squares of different sizes.
inline void splatShapes(const SplatTarget& t, const ProjectedBlock& block, std::size_t count)
{
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint64_t key = std::uint64_t(block.depth[k]) << 32 | block.id[k];
        forEachCovered(t, block.x[k], block.y[k], depthOf(block.depth[k]), [&](std::size_t cell) {
            if (block.depth[k] <= highHalf(t.cells + cell)) atomicMin(t.cells + cell, key);
        });
    }
}

inline std::size_t splatBlock(const SplatTarget& target, const ProjectedBlock& block, std::size_t count,
                              std::uint32_t* hidden)
{
    if (target.sizeOverDepth > 0.0f || (target.round && target.size >= 24)) {
        splatShapes(target, block, count);
        return 0;
    }
    if (isSinglePixels(target)) return splatPixels(target, block, count, hidden);
    splatSquares(target, block, count);
    return 0;
}

}  // namespace

}  // namespace punctum::render
