// SPDX-License-Identifier: MIT
#include "render/raster/Backend.h"

namespace punctum::render
{

std::string_view nameOf(BackendKind kind)
{
    switch (kind) {
        case BackendKind::Cpu:
            return "cpu";
        case BackendKind::GlCompute:
            return "gl-compute";
        case BackendKind::GlPoints:
            break;
    }
    return "gl-points";
}

std::optional<BackendKind> backendFromName(std::string_view name)
{
    for (const BackendKind kind : kBackendKinds)
        if (name == nameOf(kind)) return kind;
    return std::nullopt;
}

}  // namespace punctum::render
