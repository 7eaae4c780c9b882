// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"

#include <memory>

namespace punctum::render
{

/// Throws Error when this machine cannot run it. The others than Cpu need a current OpenGL 4.3 core context or
/// later.
std::unique_ptr<RasterBackend> makeBackend(BackendKind kind);

}  // namespace punctum::render
