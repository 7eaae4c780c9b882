// SPDX-License-Identifier: MIT
#include "render/backends/Backends.h"

#include "render/raster/cpu/CpuBackend.h"
#include "render/raster/gl_compute/GlComputeBackend.h"
#include "render/raster/gl_points/GlPointsBackend.h"

namespace punctum::render
{

std::unique_ptr<RasterBackend> makeBackend(BackendKind kind)
{
    switch (kind) {
        case BackendKind::Cpu:
            return std::make_unique<CpuBackend>();
        case BackendKind::GlCompute:
            return makeGlComputeBackend();
        case BackendKind::GlPoints:
            break;
    }
    return makeGlPointsBackend();
}

}  // namespace punctum::render
