// SPDX-License-Identifier: MIT
#include "render/raster/Backend.h"

#include "core/Error.h"
#include "render/raster/cpu/CpuBackend.h"
#include "render/raster/gl_points/GlPointsBackend.h"

namespace punctum::render
{

std::string_view nameOf(BackendKind kind)
{
    return kind == BackendKind::Cpu ? "cpu" : "gl-points";
}

std::optional<BackendKind> backendFromName(std::string_view name)
{
    for (const BackendKind kind : {BackendKind::Cpu, BackendKind::GlPoints})
        if (name == nameOf(kind)) return kind;
    return std::nullopt;
}

std::unique_ptr<RasterBackend> makeBackend(BackendKind kind)
{
    if (kind == BackendKind::Cpu) return std::make_unique<CpuBackend>();
    return makeGlPointsBackend();
}

}  // namespace punctum::render
