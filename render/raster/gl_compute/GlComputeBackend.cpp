// SPDX-License-Identifier: MIT
#include "render/raster/gl_compute/GlComputeBackend.h"

#include "core/Error.h"
#include "render/raster/gl_compute/GlBufferVisibility.h"
#include "resources.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>

namespace punctum::render
{
namespace
{

constexpr std::uint32_t kGroupSize = 128;
/// Points of a work group that draws a run. Long enough to spend little on starting groups; a run of a frame still
/// has hundreds of groups, for devices with many cores.
constexpr std::uint32_t kRunPoints = 32 * kGroupSize;
/// Points of a work group that draws a list: lists are shorter.
constexpr std::uint32_t kListPoints = 8 * kGroupSize;
/// Points that an invocation asks memory for before it draws the first of them (2022 paper, section 3: so that the
/// wait for one is the wait for all). llvmpipe, which is a processor, has no such wait and only copies more.
constexpr std::uint32_t kMostLoads = 4;
static_assert(kRunPoints % (kMostLoads * kGroupSize) == 0 && kListPoints % (kMostLoads * kGroupSize) == 0);

std::uint32_t loadsOf(const GlInfo& info)
{
    return info.renderer.starts_with("llvmpipe") ? 1 : kMostLoads;
}

constexpr int kAdding = 3;

/// What a program is made for.
struct Variant {
    int pass = 0;           ///< see points.comp.glsl; kAdding: the last
    bool wide = false;      ///< cells are 64-bit words
    bool commands = false;  ///< which points is said by a command on the device ...
    bool list = false;      ///< ... and by a list
    bool filter = false;
    bool stretches = false;  ///< points out of sight are left out by stretches
    bool pixels = false;
    int samples = 1;
    std::uint32_t loads = kMostLoads;
    friend auto operator<=>(const Variant&, const Variant&) = default;  // NOLINT(modernize-use-nullptr)
};

GlProgram makeProgram(const Variant& v)
{
    std::string text(kShaderHead);
    if (v.pass == 2)
        text += "#extension GL_ARB_gpu_shader_int64 : require\n#extension GL_NV_shader_atomic_int64 : require\n";
    const auto define = [&](const std::string& name, const std::string& value) {
        text += "#define " + name + " " + value + "\n";
    };
    define("PASS", std::to_string(v.pass));
    define("SAMPLES", std::to_string(v.samples));
    define("GROUP_SIZE", std::to_string(kGroupSize));
    define("LOADS", std::to_string(v.loads));
    define("GROUP_POINTS", std::to_string(v.list ? kListPoints : kRunPoints));
    if (v.wide) define("WIDE", "");
    if (v.commands) define("COMMANDS", "");
    if (v.list) define("LIST", "");
    if (v.filter) define("FILTER", "");
    if (v.stretches) define("STRETCHES", "");
    if (v.pixels) define("PIXELS", "");
    std::string places;
    for (int s = 0; s < v.samples; ++s) {
        const SamplePlace& place = samplePlaces(v.samples)[s];
        places +=
            (s > 0 ? ", " : "") + ("ivec2(" + std::to_string(place[0])) + ", " + std::to_string(place[1]) + ")";
    }
    define("SAMPLE_PLACES", places);
    if (v.pass == kAdding) text += resource("shaders/gl/color.glsl");
    for (const char* const part : {"gl/command.glsl", "gl/projection.glsl", "gl/size.glsl", "gl/clip.glsl",
                                   "gl/group.glsl", "gl_compute/points.comp.glsl"})
        text += resource("shaders/" + std::string(part));
    return GlProgram::compute("points.comp", {text});
}

/// Whether the driver says that it has 64-bit atomic operations, and its compiler takes them.
bool hasWideAtomics()
{
    if (!epoxy_has_gl_extension("GL_ARB_gpu_shader_int64") || !epoxy_has_gl_extension("GL_NV_shader_atomic_int64"))
        return false;
    try {
        makeProgram({.pass = 2, .pixels = true});
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// Whether runs of slots are drawn by what is in sight.
bool byStretches(const Layer& layer)
{
    return layer.visible && !layer.visible->all();
}

class GlComputeBackend final : public GlBackend
{
public:
    explicit GlComputeBackend(const GlComputeOptions& options)
        : GlBackend(options.limits, {kListPoints, kRunPoints}),
          m_wide(options.allowWide && hasWideAtomics()),
          m_loads(options.allLoads ? kMostLoads : loadsOf(info()))
    {
        const auto fits = std::size_t(info().maxStorageBlock) / (m_wide ? 8 : 4);
        auto visibility =
            std::make_unique<GlBufferVisibility>(std::min(options.limits.bandSamples, fits), counted(), m_wide);
        m_target = visibility.get();
        setVisibility(std::move(visibility));
        checkGlErrors("starting");
    }

    BackendKind kind() const noexcept override { return BackendKind::GlCompute; }
    std::string description() const override
    {
        return GlBackend::description() + (m_wide ? ", compute, 64-bit atomics" : ", compute, two passes");
    }

protected:
    void drawSlots(const FrameScene& scene, const Layer& layer, SlotRange slots) override;
    void addSlots(const FrameScene& scene, const Layer& layer, const LayerColors& colors, SlotRange slots) override;
    void drawCommands(const FrameScene& scene, std::span<const ChunkPlace> places,
                      std::span<const GlVisibility::Band> bands) override;

private:
    /// Calls f(band) for each pass and band, with the band bound.
    template <class F>
    void forEachPass(F&& f);
    /// The program for this pass, in use, with everything set but the points.
    void use(Variant variant, const FrameScene& scene, const Layer& layer, const GlVisibility::Band& band);
    /// Runs the program that is in use over these slots; `each` binds more of a chunk.
    template <class F>
    void dispatch(const FrameScene& scene, const Layer& layer, SlotRange slots, F&& each);
    /// What is in sight of the layer, for the shader.
    void bindInSight(const Layer& layer);
    void bindChunk(const FrameScene& scene, const Layer& layer, const GlPointCopy::Chunk& chunk);

    bool m_wide;
    std::uint32_t m_loads;
    bool m_stretches = false;      ///< of the program in use
    GlBufferVisibility* m_target;  ///< the visibility buffer, which GlBackend owns
    std::map<Variant, GlProgram> m_programs;
};

template <class F>
void GlComputeBackend::forEachPass(F&& f)
{
    for (int pass = m_wide ? 2 : 0; pass <= (m_wide ? 2 : 1); ++pass) {
        for (const GlVisibility::Band& band : m_target->bands()) {
            m_target->bindForDrawing(band);
            f(pass, band);
        }
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

void GlComputeBackend::use(Variant variant, const FrameScene& scene, const Layer& layer,
                           const GlVisibility::Band& band)
{
    const LayerProjection& p = layer.projection;
    const TargetSize size = target();
    variant.filter = scene.filters();
    variant.stretches = !variant.list && variant.pass != kAdding && byStretches(layer);
    m_stretches = variant.stretches;
    variant.pixels = p.singlePixels(size.samples);
    variant.samples = size.samples;
    variant.loads = m_loads;
    GlProgram& program = m_programs[variant];
    if (!program) program = makeProgram(variant);
    program.use();
    useProjection(p);
    useClip(layer.clip);
    usePointSize(p, 1, std::numeric_limits<int>::max());
    const float margin = variant.pixels ? 0.0f : p.margin();
    glUniform4f(at::kKept, -margin, float(size.width) + margin, -margin, float(size.height) + margin);
    glUniform4i(at::kBand, band.firstRow, band.lastRow, size.width, 0);
    if (scene.filters()) glUniform4uiv(at::kShownClasses, 2, shownClasses(scene).data());
    if (variant.stretches) bindInSight(layer);
}

void GlComputeBackend::bindInSight(const Layer& layer)
{
    GlPointCopy& copy = copyOf(layer);
    if (copy.visible != layer.visible) {
        const auto list = layer.visible->list();
        copy.inSight.reserve(std::max(list.size_bytes(), sizeof(std::uint32_t)));
        if (!list.empty()) copy.inSight.write(0, list.data(), list.size_bytes(), counted());
        copy.visible = layer.visible;
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, copy.inSight.id());
}

void GlComputeBackend::bindChunk(const FrameScene& scene, const Layer& layer, const GlPointCopy::Chunk& chunk)
{
    glUniform1ui(at::kFirstId, layer.firstId + chunk.first);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, chunk.positions.id());
    if (scene.filters()) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, chunk.groups.id());
    if (!m_stretches) return;
    const PointStore& store = *layer.store;
    glUniform4ui(at::kStretches, store.order().windowSize(), GLuint(std::countr_zero(store.stretchPlaces())),
                 chunk.first, GLuint(layer.visible->list().size()));
}

template <class F>
void GlComputeBackend::dispatch(const FrameScene& scene, const Layer& layer, SlotRange slots, F&& each)
{
    const GlPointCopy& copy = copyOf(layer);
    for (Slot at = slots.first; at < slots.last;) {
        const GlPointCopy::Chunk& chunk = copy.chunks()[at / copy.chunkSlots()];
        const Slot end = std::min(slots.last, chunk.first + chunk.slots);
        bindChunk(scene, layer, chunk);
        each(chunk);
        glUniform2ui(at::kSlots, at - chunk.first, end - chunk.first);
        std::uint64_t points = end - at;
        if (m_stretches) {  // of each window, what is in sight
            const Slot window = layer.store->order().windowSize();
            points = ((end - 1) / window + 1 - at / window) * std::uint64_t(layer.visible->list().size()) *
                     layer.store->stretchPlaces();
        }
        if (points > 0) glDispatchCompute(GLuint((points + kRunPoints - 1) / kRunPoints), 1, 1);
        at = end;
    }
}

void GlComputeBackend::drawSlots(const FrameScene& scene, const Layer& layer, SlotRange slots)
{
    forEachPass([&](int pass, const GlVisibility::Band& band) {
        use({.pass = pass}, scene, layer, band);
        dispatch(scene, layer, slots, [](const GlPointCopy::Chunk&) {});
    });
}

void GlComputeBackend::addSlots(const FrameScene& scene, const Layer& layer, const LayerColors& colors,
                                SlotRange slots)
{
    for (const GlVisibility::Band& band : m_target->bands()) {
        use({.pass = kAdding, .wide = m_wide}, scene, layer, band);
        useColors();
        useLayerColors(colors);
        m_target->bindForAdding(band);
        dispatch(scene, layer, slots, [](const GlPointCopy::Chunk& chunk) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, chunk.words.id());
        });
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void GlComputeBackend::drawCommands(const FrameScene& scene, std::span<const ChunkPlace> places,
                                    std::span<const GlVisibility::Band> bands)
{
    forEachPass([&](int pass, const GlVisibility::Band& target) {
        std::size_t layer = scene.layers.size();
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Layer& l = scene.layers[places[i].layer];
            const GlPointCopy::Chunk& chunk = copyOf(l).chunks()[places[i].chunk];
            if (!chunk.positions) continue;
            if (layer != places[i].layer)
                use({.pass = pass, .commands = true, .list = bool(bands.front().list)}, scene, l, target);
            layer = places[i].layer;
            bindChunk(scene, l, chunk);
            glUniform1ui(at::kChunk, GLuint(i));
            for (const GlVisibility::Band& list : bands) {
                if (list.list) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, list.list.id());
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, list.commands.id());
                glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list.commands.id());
                glDispatchComputeIndirect(
                    GLintptr(i * sizeof(GlVisibility::Command) + offsetof(GlVisibility::Command, groups)));
            }
        }
    });
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
}

}  // namespace

std::unique_ptr<RasterBackend> makeGlComputeBackend(const GlComputeOptions& options)
{
    return std::make_unique<GlComputeBackend>(options);
}

}  // namespace punctum::render
