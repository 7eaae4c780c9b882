// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace punctum::render
{

/// Points projected together; a multiple of every vector width.
constexpr std::size_t kProjectBlock = 256;

/// LayerProjection as the kernels want it, with the picture's edges. Plain floats: also seen by the file that is
/// compiled for AVX2, which must not instantiate any inline function of a shared header.
struct ProjectArguments {
    std::int32_t reference[3];
    float rowX[4], rowY[4], rowD[4];
    float nearDepth;
    float lowX, highX, lowY, highY;  ///< a point is kept when lowX <= x_px < highX, and so for y
    bool perspective;
};

/// The points of a block that are in the picture, packed.
struct ProjectedBlock {
    alignas(64) float x[kProjectBlock + 8];
    alignas(64) float y[kProjectBlock + 8];
    alignas(64) std::uint32_t depth[kProjectBlock + 8];  ///< float bits: as integers they order like the depths
    alignas(64) std::uint32_t id[kProjectBlock + 8];
};

/// Projects `count` (at most kProjectBlock) positions, readable 96 bytes past their end; returns how many were
/// kept. The i-th position gets id firstId + i. All kernels of one machine are used alone, never mixed: they may
/// differ in the last bit of a float.
using ProjectKernel = std::size_t (*)(const std::int32_t* positions, std::size_t count, std::uint32_t firstId,
                                      const ProjectArguments&, ProjectedBlock&);

/// Where points are drawn.
struct SplatTarget {
    /// For each sample of each pixel depth bits in the high half and id in the low half; behind the last one a
    /// cell that holds 0, nearer than all points: what lies outside of the picture is sent there, without a branch.
    std::uint64_t* cells;
    std::int32_t width, height, samples;
    std::int32_t size;                ///< of the square, steps of 1/kSampleSteps px
    const std::uint8_t (*places)[2];  ///< x, y of each sample in its pixel, same steps
    float sizeOverDepth = 0;          ///< steps: 0, or a point's size is this over its depth, from `size` ...
    std::int32_t mostSize = 0;        ///< ... to this
    bool round = false;
};

/// Draws the first `count` points of a block: a square or circle each, as LayerProjection defines it, by an atomic
/// minimum of (depth, id) in each sample's cell. Any number of threads may draw into one target.
///
/// `hidden`, when not null and points are single pixels of one sample: gets the ids of those points, drawn now or
/// before, that are hidden for the sake of another one, at most `count`; returns how many. Otherwise returns 0.
using SplatKernel = std::size_t (*)(const SplatTarget&, const ProjectedBlock&, std::size_t count,
                                    std::uint32_t* hidden);

/// Depth of a point to the nearest one of its sample, up to which their colors are averaged (CpuSums).
constexpr float kAverageDepth = 1.01f;

struct KernelChoice {
    ProjectKernel project;
    SplatKernel splat;
    const char* name;  ///< "AVX2", "SSE2"
};
/// The kernels that every processor runs.
KernelChoice baselineKernel() noexcept;
/// The fastest kernels that this processor runs.
KernelChoice chooseKernel() noexcept;

std::size_t projectAvx2(const std::int32_t* positions, std::size_t count, std::uint32_t firstId,
                        const ProjectArguments& arguments, ProjectedBlock& out);
std::size_t splatAvx2(const SplatTarget& target, const ProjectedBlock& block, std::size_t count,
                      std::uint32_t* hidden);

}  // namespace punctum::render
