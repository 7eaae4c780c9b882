// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/FrameScene.h"
#include "render/scene/Image.h"
#include "render/scene/ResolveSettings.h"
#include "render/scene/TargetSize.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// Draws runs of slots and lists of ids into a visibility buffer (depth and point id per sample), and turns that
/// into a picture. Nothing else: what is drawn when is the business of ProgressiveRenderer.
///
/// The nearest point wins; at equal depth the smaller id does. All members: one thread (for OpenGL: the thread
/// whose current context the backend was made in). Members throw Error when the device fails.
class RasterBackend
{
public:
    virtual ~RasterBackend() = default;
    virtual BackendKind kind() const noexcept = 0;
    /// One line for the user: "CPU, AVX2, 2 threads", "llvmpipe (LLVM 15.0.6)".
    virtual std::string description() const = 0;

    /// A new, empty visibility buffer.
    virtual void setTarget(const TargetSize& size) = 0;
    virtual TargetSize target() const noexcept = 0;
    virtual void clear() = 0;

    /// Ids in the visibility buffer, each at least once (the same id may come again), in no order.
    virtual void visibleIds(std::vector<PointId>& out) = 0;
    /// Keeps what is visible, seen anew: clears, and draws the points that were in the buffer.
    virtual void reproject(const FrameScene& scene) = 0;
    /// Draws a run of slots of one layer.
    virtual void draw(const FrameScene& scene, std::size_t layer, SlotRange slots) = 0;
    /// Waits until everything asked for is in the buffer: makes clocks around draw() mean something.
    virtual void finish() = 0;

    /// Whether the device itself can find out how many slots it has time for: drawTimed().
    virtual bool keepsTime() const noexcept { return false; }
    /// What drawTimed() has time for counts from here.
    virtual void startClock() {}
    /// Slots of one layer; may end early at multiples of `step` from its first slot.
    struct Run {
        std::size_t layer = 0;
        SlotRange range;
        Slot step = 1;
    };
    /// Draws the first run whole, and of the others, one after the other, as many slots as the device will have
    /// done `seconds` after startClock(), going by what the first took (Schuetz et al. 2019, section 3.4.1). Waits
    /// for nothing: timed() tells afterwards. Where points have to be brought to the device first, that ends early.
    virtual void drawTimed(const FrameScene&, std::span<const Run>, double /*seconds*/) {}
    struct Timed {
        std::uint64_t drawn = 0;  ///< slots, of all runs
        double before = 0;        ///< seconds from startClock() to its beginning
        double seconds = 0;       ///< that took on the device ...
        double done = 0;          ///< ... and from startClock() to its end
    };
    /// What the last drawTimed() came to. Waits for it: to be asked when the picture is there.
    virtual Timed timed() { return {}; }

    /// Forgets what addColors() added, as clear(), reproject() and setTarget() do.
    virtual void clearColors() = 0;
    /// Adds the colors of a run of slots to the samples whose nearest point is at most 1 % nearer. Once all points
    /// have been drawn and then added, resolve() shows the means: high-quality shading (2022 paper, section 3.6).
    virtual void addColors(const FrameScene& scene, const ResolveSettings& settings, std::size_t layer,
                           SlotRange slots) = 0;

    /// Makes the picture: colors from each layer's store words, samples lit and averaged, holes closed.
    /// scene.layers as drawn.
    virtual void resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out) = 0;
    /// Whether there is a device that the picture can stay on; only then the three below do something.
    virtual bool keepsPicture() const noexcept { return false; }
    /// resolve() without bringing the picture over. Waits for nothing.
    virtual void resolveOnDevice(const FrameScene&, const ResolveSettings&) {}
    /// Brings the picture over that resolve() or resolveOnDevice() made last.
    virtual void readPicture(Image&) {}
    /// Copies it to a texture (OpenGL's name) of its size, RGBA8, row 0 at the top of the picture.
    virtual void copyPicture(unsigned /*texture*/) {}

    /// Bytes brought to the device and back since the backend was made.
    struct Traffic {
        std::uint64_t up = 0, down = 0;
    };
    virtual Traffic traffic() const noexcept { return {}; }

    /// Depth of each pixel's nearest sample, along the view direction in view units (Camera), rows from the top;
    /// infinity where there is no point.
    virtual void depths(std::vector<float>& out) = 0;

    /// Sample nearest to (x, y) px with a point within `radius` px.
    struct Hit {
        PointId id = kNoPoint;
        float depth = 0;  ///< along the view direction, view units
    };
    virtual std::optional<Hit> pick(int x, int y, int radius) = 0;
    /// Share of pixels with at least one point.
    virtual double coveredShare() = 0;
};

}  // namespace punctum::render
