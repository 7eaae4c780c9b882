// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/VisibleStretches.h"
#include "render/resolve/Image.h"
#include "render/resolve/ResolveSettings.h"
#include "render/store/PointStore.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
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

/// Slot of one layer, in the numbering of the whole view: Layer::firstId + slot.
using PointId = std::uint32_t;
constexpr PointId kNoPoint = 0xFFFFFFFFu;

/// Picture size in px, and samples a pixel: one of kSampleCounts.
struct TargetSize {
    int width = 0;
    int height = 0;
    int samples = 1;
    friend bool operator==(const TargetSize&, const TargetSize&) = default;
};

constexpr std::array<int, 4> kSampleCounts{1, 4, 8, 16};
/// Which of kSampleCounts it is; 0 for another number.
std::size_t sampleCountIndex(int samples) noexcept;
/// Throws Error when it is none of kSampleCounts.
void checkSampleCount(int samples);

/// Samples lie on a grid of so many steps a px.
constexpr int kSampleSteps = 16;
/// Where in its pixel a sample lies, in steps from the pixel's top left corner.
using SamplePlace = std::uint8_t[2];
/// The places of one pixel's samples, `samples` of them: the standard patterns of Direct3D, which most OpenGL
/// drivers have too. `samples` is one of kSampleCounts.
const SamplePlace* samplePlaces(int samples) noexcept;

/// Widest point whose size follows its depth: nearer ones would be all of the picture.
constexpr float kMostGrownSize = 64.0f;  // px
/// 1.5 px: the narrowest circle that holds a sample wherever it lies.
constexpr int kLeastRoundSteps = 24;

/// Maps a store's local integers to the picture, in float, exact near the eye:
///     q = float(local - reference)
///     depth = dot(rowD.xyz, q) + rowD.w        along the view direction, > 0 in front
///     w     = perspective ? depth : 1
///     x_px  = (dot(rowX.xyz, q) + rowX.w) / w  from the left edge
///     y_px  = (dot(rowY.xyz, q) + rowY.w) / w  from the top edge
/// A point is drawn when depth >= nearDepth, as a square around (x_px, y_px). Its size and its left and top edge
/// are put on the grid of the samples (size = round(width * kSampleSteps), at least 1; left = floor((x_px - size /
/// 2) * kSampleSteps)): it covers each sample in (left, left + size], and so for y. Its width is pointSize px;
/// where sizeOverDepth is not 0, sizeOverDepth / depth px, but at least pointSize and at most mostSize.
///
/// Round points cover of their square the samples in the circle that touches its edges. Those narrower than
/// kLeastRoundSteps stay squares, because a circle would miss all samples at times.
struct LayerProjection {
    glm::ivec3 reference{0};
    glm::vec4 rowX{0}, rowY{0}, rowD{0};
    bool perspective = true;
    float nearDepth = 1e-6f;
    float pointSize = 1.0f;
    float sizeOverDepth = 0.0f;
    float mostSize = kMostGrownSize;
    bool round = false;
    /// Of the square (the least where it grows), in steps of 1/kSampleSteps px.
    int sizeInSteps() const noexcept
    {
        const float steps = pointSize * float(kSampleSteps) + 0.5f;
        return steps >= 1.0f ? int(std::min(steps, 1e6f)) : 1;
    }
    /// Likewise, of the widest point where the width follows the depth.
    int mostInSteps() const noexcept { return std::max(sizeInSteps(), int(mostSize * float(kSampleSteps))); }
    bool grows() const noexcept { return sizeOverDepth > 0.0f; }
    /// px that a point can reach beyond its middle to each side, and one more.
    float margin() const noexcept { return std::max(pointSize, grows() ? mostSize : 0.0f) / 2 + 1; }
    /// Whether every point is one sample's square, which is drawn fastest.
    bool singlePixels(int samples) const noexcept
    {
        return samples == 1 && !grows() && sizeInSteps() == kSampleSteps;
    }
};

/// The most planes that cut a view: kMostCuts that the user may place, and the four sides of a section.
constexpr std::size_t kMostClipPlanes = 10;
constexpr std::size_t kMostCuts = 6;

/// Which part of a cloud is drawn, in its store's local integers: points with low <= local <= high, and for each
/// plane dot(plane.xyz, q) + plane.w >= 0, where q = float(local - reference) of the layer's projection.
struct LayerClip {
    bool on = false;
    glm::ivec3 low{INT32_MIN}, high{INT32_MAX};
    std::size_t planeCount = 0;
    std::array<glm::vec4, kMostClipPlanes> planes{};
};

/// One cloud of the view. The store is borrowed and must outlive its use by the backend.
struct Layer {
    const PointStore* store = nullptr;
    PointId firstId = 0;
    LayerProjection projection;
    LayerClip clip{};
    /// Runs of slots are drawn where it says that something is in sight; null: everywhere.
    std::shared_ptr<const VisibleStretches> visible{};
};

/// What a frame draws: all layers as one camera sees them, and which classes are shown. Points that a store hides
/// are not drawn.
struct FrameScene {
    std::vector<Layer> layers;
    std::array<bool, 256> classVisible{};
    bool allClassesVisible = true;
    /// Whether points have to be asked for their class or whether they are hidden.
    bool filters() const noexcept
    {
        return !allClassesVisible ||
               std::any_of(layers.begin(), layers.end(), [](const Layer& l) { return l.store->hidesAny(); });
    }
};

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

/// Throws Error when this machine cannot run it. The others than Cpu need a current OpenGL 4.3 core context or
/// later.
std::unique_ptr<RasterBackend> makeBackend(BackendKind kind);

}  // namespace punctum::render
