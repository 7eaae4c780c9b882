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
    alignas(64) std::uint32_t index[kProjectBlock + 8];  ///< place in the block of input positions
};

/// Projects `count` (at most kProjectBlock) positions, readable 96 bytes past their end; returns how many were
/// kept. All kernels of one machine are used alone, never mixed: they may differ in the last bit of a float.
using ProjectKernel = std::size_t (*)(const std::int32_t* positions, std::size_t count, const ProjectArguments&,
                                      ProjectedBlock&);

std::size_t projectBaseline(const std::int32_t* positions, std::size_t count, const ProjectArguments& arguments,
                            ProjectedBlock& out);
std::size_t projectAvx2(const std::int32_t* positions, std::size_t count, const ProjectArguments& arguments,
                        ProjectedBlock& out);

struct KernelChoice {
    ProjectKernel project;
    const char* name;  ///< "AVX2", "SSE2"
};
/// The fastest kernel that this processor can run.
KernelChoice chooseKernel() noexcept;

}  // namespace punctum::render
