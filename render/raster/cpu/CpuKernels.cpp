// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuKernels.h"

#include <bit>

namespace punctum::render
{

std::size_t projectBaseline(const std::int32_t* positions, std::size_t count, const ProjectArguments& a,
                            ProjectedBlock& out)
{
    // First loop: straight arithmetic that the compiler turns into SSE2; second: what is kept, packed.
    alignas(64) float x[kProjectBlock], y[kProjectBlock], depth[kProjectBlock];
    alignas(64) std::int32_t lx[kProjectBlock], ly[kProjectBlock], lz[kProjectBlock];
    for (std::size_t i = 0; i < count; ++i) {
        lx[i] = positions[3 * i];
        ly[i] = positions[3 * i + 1];
        lz[i] = positions[3 * i + 2];
    }
    const float divide = a.perspective ? 1.0f : 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        const float qx = float(lx[i] - a.reference[0]), qy = float(ly[i] - a.reference[1]),
                    qz = float(lz[i] - a.reference[2]);
        const float d = a.rowD[0] * qx + (a.rowD[1] * qy + (a.rowD[2] * qz + a.rowD[3]));
        const float w = divide * d + (1.0f - divide);
        x[i] = (a.rowX[0] * qx + (a.rowX[1] * qy + (a.rowX[2] * qz + a.rowX[3]))) / w;
        y[i] = (a.rowY[0] * qx + (a.rowY[1] * qy + (a.rowY[2] * qz + a.rowY[3]))) / w;
        depth[i] = d;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        out.x[kept] = x[i];
        out.y[kept] = y[i];
        out.depth[kept] = std::bit_cast<std::uint32_t>(depth[i]);
        out.index[kept] = std::uint32_t(i);
        kept += std::size_t((lx[i] != 0) & (depth[i] >= a.nearDepth) & (x[i] >= a.lowX) & (x[i] < a.highX) &
                            (y[i] >= a.lowY) & (y[i] < a.highY));
    }
    return kept;
}

KernelChoice chooseKernel() noexcept
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {projectAvx2, "AVX2"};
    return {projectBaseline, "SSE2"};
#else
    return {projectBaseline, "baseline"};
#endif
}

}  // namespace punctum::render
