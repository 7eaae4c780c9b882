// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuKernels.h"

#include "render/raster/cpu/splat.inl"

#include <bit>

namespace punctum::render
{

namespace
{

constexpr std::size_t kAheadBytes = 1536;  // as in CpuKernelsAvx2.cpp

std::size_t project(const std::int32_t* positions, std::size_t count, std::uint32_t firstId,
                    const ProjectArguments& a, ProjectedBlock& out)
{
    const auto* const bytes = reinterpret_cast<const char*>(positions);
    for (std::size_t at = 0; at < count * 12; at += 64) __builtin_prefetch(bytes + at + kAheadBytes);
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
        out.id[kept] = firstId + std::uint32_t(i);
        kept += std::size_t((lx[i] != 0) & (depth[i] >= a.nearDepth) & (x[i] >= a.lowX) & (x[i] < a.highX) &
                            (y[i] >= a.lowY) & (y[i] < a.highY));
    }
    return kept;
}

std::size_t splat(const SplatTarget& target, const ProjectedBlock& block, std::size_t count, std::uint32_t* hidden)
{
    return splatBlock(target, block, count, hidden);
}

}  // namespace

KernelChoice baselineKernel() noexcept
{
#if defined(__x86_64__)
    return {project, splat, "SSE2"};
#else
    return {project, splat, "baseline"};
#endif
}

KernelChoice chooseKernel() noexcept
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {projectAvx2, splatAvx2, "AVX2"};
#endif
    return baselineKernel();
}

}  // namespace punctum::render
