// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/PointDrawing.h"
#include "render/raster/Shading.h"
#include "render/raster/VisibilityBuffer.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace punctum::render
{

enum class BackendKind { Cpu, GlCompute, GlPoints };
inline constexpr std::array kBackendKinds{BackendKind::Cpu, BackendKind::GlCompute, BackendKind::GlPoints};
/// Whether it draws into a current OpenGL context.
constexpr bool needsGl(BackendKind kind) noexcept
{
    return kind != BackendKind::Cpu;
}

/// "cpu", "gl-compute", "gl-points": names on the command line.
std::string_view nameOf(BackendKind kind);
std::optional<BackendKind> backendFromName(std::string_view name);

/// What draws: a visibility buffer, the drawing into it and the picture of it, each of which callers know by its
/// own interface.
///
/// All members: one thread (for OpenGL: the thread whose current context the backend was made in). Members throw
/// Error when the device fails.
class RasterBackend : public VisibilityBuffer, public PointDrawing, public Shading
{
public:
    virtual BackendKind kind() const noexcept = 0;
    /// One line for the user: "CPU, AVX2, 2 threads", "llvmpipe (LLVM 15.0.6)".
    virtual std::string description() const = 0;
    /// Waits until everything asked for is done, drawing and pictures alike.
    void finish() override = 0;

    /// Bytes brought to the device and back since the backend was made.
    struct Traffic {
        std::uint64_t up = 0, down = 0;
    };
    virtual Traffic traffic() const noexcept { return {}; }
};

}  // namespace punctum::render
