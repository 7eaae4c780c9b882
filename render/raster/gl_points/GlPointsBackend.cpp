// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlPointsBackend.h"

#include "render/raster/gl_points/GlTextureVisibility.h"
#include "resources.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <compare>
#include <map>
#include <vector>

namespace punctum::render
{
namespace
{

/// Of a run drawn at once: so many draws of the pieces in sight at most.
constexpr std::size_t kMostDraws = 4096;
/// Slots out of sight between two pieces that are drawn rather than left out: a draw of its own costs about as
/// much.
constexpr std::uint64_t kLeastGap = 256;

/// Joins pieces, rising and apart, over small gaps; over larger ones until there are at most `most`.
void join(std::vector<SlotRange>& pieces, std::size_t most)
{
    std::uint64_t gap = kLeastGap;
    do {
        std::size_t kept = 0;
        for (const SlotRange& piece : pieces) {
            if (kept > 0 && piece.first - pieces[kept - 1].last <= gap)
                pieces[kept - 1].last = piece.last;
            else
                pieces[kept++] = piece;
        }
        pieces.resize(kept);
        gap *= 2;
    } while (pieces.size() > most);
}

std::string_view pointsShader(std::string_view name)
{
    return resource("shaders/gl_points/" + std::string(name));
}

class GlPointsBackend final : public GlBackend
{
public:
    explicit GlPointsBackend(const GlLimits& limits);

    BackendKind kind() const noexcept override { return BackendKind::GlPoints; }
    std::string description() const override
    {
        return GlBackend::description() + (m_otherSamples ? ", sample places of its own" : "");
    }

protected:
    void targetChanged() override;
    void drawSlots(const FrameScene& scene, const Layer& layer, SlotRange slots) override;
    void addSlots(const FrameScene& scene, const Layer& layer, const LayerColors& colors, SlotRange slots) override;
    void drawCommands(const FrameScene& scene, std::span<const ChunkPlace> places,
                      std::span<const GlVisibility::Band> bands) override;
    void pieces(const Layer& layer, SlotRange slots, std::size_t most, std::vector<SlotRange>& out) const override;

private:
    /// What a program is made for.
    struct Variant {
        bool filter = false, circles = false;
        int averageOf = 0;  ///< samples, where it adds colors; else 0
        friend auto operator<=>(const Variant&, const Variant&) = default;  // NOLINT(modernize-use-nullptr)
    };
    GlProgram makeProgram(const Variant& variant) const;
    /// Sets all but the layer; `adding`: colors to the sums, else points to the visibility buffer.
    void beginDrawing(const FrameScene& scene, bool adding = false);
    void useLayer(const Layer& layer);
    void drawChunks(const Layer& layer, SlotRange slots);

    float m_minPointSize = 1, m_maxPointSize = 1;
    bool m_otherSamples = false;    ///< the driver's samples are not where samplePlaces() has them
    GlTextureVisibility* m_target;  ///< the visibility buffer, which GlBackend owns
    std::map<Variant, GlProgram> m_programs;
    std::vector<SlotRange> m_inSight;  ///< of a run; kept, so that memory is not asked for each frame
    std::vector<GLint> m_firsts;       ///< likewise, of the draws of a chunk
    std::vector<GLsizei> m_counts;
    std::array<GLint, 32> m_places{};    ///< of the driver's samples, steps
    float m_margin = 0, m_perPixel = 0;  ///< of the viewport, see points.vert
};

GlPointsBackend::GlPointsBackend(const GlLimits& limits) : GlBackend(limits, {})
{
    auto visibility = std::make_unique<GlTextureVisibility>(limits.bandSamples, counted());
    m_target = visibility.get();
    setVisibility(std::move(visibility));
    GLfloat range[2]{1, 1};
    glGetFloatv(GL_POINT_SIZE_RANGE, range);
    m_minPointSize = std::max(1.0f, range[0]);
    m_maxPointSize = std::max(m_minPointSize, std::floor(range[1]));
    checkGlErrors("starting");
}

GlProgram GlPointsBackend::makeProgram(const Variant& variant) const
{
    std::string head(kShaderHead);
    if (!info().clipControl && variant.averageOf == 0) head += "#define FRAGMENT_DEPTH\n";
    if (variant.filter) head += "#define FILTER\n";
    if (variant.circles) head += "#define CIRCLES\n";
    if (variant.averageOf > 0)
        head += "#define AVERAGE\n#define SAMPLES " + std::to_string(variant.averageOf) + "\n";
    const auto size = resource("shaders/gl/size.glsl");
    const std::initializer_list<std::string_view> vertex{head,
                                                         resource("shaders/gl/projection.glsl"),
                                                         size,
                                                         resource("shaders/gl/clip.glsl"),
                                                         resource("shaders/gl/group.glsl"),
                                                         pointsShader("points.vert.glsl")};
    if (variant.averageOf == 0)
        return GlProgram::graphics("points.vert", vertex, {head, size, pointsShader("points.frag.glsl")});
    return GlProgram::graphics("average.frag", vertex,
                               {head, pointsShader("visibility.glsl"), resource("shaders/gl/color.glsl"), size,
                                pointsShader("average.frag.glsl")});
}

void GlPointsBackend::targetChanged()
{
    m_target->bindFramebuffer();
    m_otherSamples = false;
    m_places.fill(kSampleSteps / 2);
    const int samples = target().samples;
    const SamplePlace* const places = samplePlaces(samples);
    for (int s = 0; s < samples && samples > 1; ++s) {
        // The picture's top is row 0 of the buffer, so both count from the same corner.
        GLfloat place[2]{};
        glGetMultisamplefv(GL_SAMPLE_POSITION, GLuint(s), place);
        m_places[2 * std::size_t(s)] = GLint(place[0] * kSampleSteps);
        m_places[2 * std::size_t(s) + 1] = GLint(place[1] * kSampleSteps);
        m_otherSamples = m_otherSamples || place[0] * kSampleSteps != float(places[s][0]) ||
                         place[1] * kSampleSteps != float(places[s][1]);
    }
}

void GlPointsBackend::beginDrawing(const FrameScene& scene, bool adding)
{
    // OpenGL drops points whose middle lies outside the viewport, even where the square reaches into the picture:
    // so the viewport reaches beyond the picture. Its side is a power of two, so that scaling to it is exact.
    const TargetSize size = target();
    float largest = 1;
    for (const Layer& layer : scene.layers) largest = std::max(largest, layer.projection.margin());
    const int wish = int(std::ceil(std::min(largest, m_maxPointSize / 2 + 1)));
    const int longest = std::max(size.width, size.height);
    const int side = std::min(info().maxViewport, int(std::bit_ceil(unsigned(longest + 2 * wish))));
    const int margin = std::clamp((side - longest) / 2, 0, wish);
    m_margin = float(margin);
    m_perPixel = 2.0f / float(side);

    if (adding)
        m_target->bindSums();
    else
        m_target->bindFramebuffer();
    glViewport(-margin, -margin, side, side);
    if (info().clipControl) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    (adding ? glDisable : glEnable)(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_MULTISAMPLE);
    for (const GLenum cap : {GL_SCISSOR_TEST, GL_STENCIL_TEST}) glDisable(cap);
    (adding ? glEnable : glDisable)(GL_BLEND);
    if (adding) {
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE, GL_ONE);
    }
    const bool circles =
        std::any_of(scene.layers.begin(), scene.layers.end(), [](const Layer& l) { return l.projection.round; });
    const Variant variant{scene.filters(), circles, adding ? size.samples : 0};
    GlProgram& program = m_programs[variant];
    if (!program) program = makeProgram(variant);
    program.use();
    if (circles) {
        if (!adding) glUniform1i(at::kSamples, size.samples);
        glUniform2iv(at::kPlaces, kSampleCounts.back(), m_places.data());
    }
    glUniform2f(at::kPictureSize, float(size.width), float(size.height));
    glUniform1f(at::kMargin, m_margin);
    glUniform1f(at::kPerPixel, m_perPixel);
    if (scene.filters()) glUniform4uiv(at::kShownClasses, 2, shownClasses(scene).data());
}

void GlPointsBackend::useLayer(const Layer& layer)
{
    const LayerProjection& p = layer.projection;
    useProjection(p);
    useClip(layer.clip);
    usePointSize(p, int(std::ceil(m_minPointSize * kSampleSteps)), int(m_maxPointSize) * kSampleSteps);
}

void GlPointsBackend::drawSlots(const FrameScene& scene, const Layer& layer, SlotRange slots)
{
    beginDrawing(scene);
    useLayer(layer);
    drawChunks(layer, slots);
}

void GlPointsBackend::addSlots(const FrameScene& scene, const Layer& layer, const LayerColors& colors,
                               SlotRange slots)
{
    beginDrawing(scene, true);
    useLayer(layer);
    useColors();
    useLayerColors(colors);
    m_target->bindForReading(m_target->bands().front());
    drawChunks(layer, slots);
}

void GlPointsBackend::pieces(const Layer& layer, SlotRange slots, std::size_t most,
                             std::vector<SlotRange>& out) const
{
    if (!layer.visible) return out.push_back(slots);
    layer.visible->pieces(slots, slots.size(), out);
    join(out, most);
}

void GlPointsBackend::drawChunks(const Layer& layer, SlotRange slots)
{
    const GlPointCopy& copy = copyOf(layer);
    for (Slot at = slots.first; at < slots.last;) {
        const GlPointCopy::Chunk& chunk = copy.chunks()[at / copy.chunkSlots()];
        const Slot end = std::min(slots.last, chunk.first + chunk.slots);
        m_inSight.clear();
        pieces(layer, {at, end}, kMostDraws, m_inSight);
        m_firsts.clear();
        m_counts.clear();
        for (const SlotRange& piece : m_inSight) {
            m_firsts.push_back(GLint(piece.first - chunk.first));
            m_counts.push_back(GLsizei(piece.size()));
        }
        glUniform1ui(at::kFirstId, layer.firstId + chunk.first);
        glBindVertexArray(chunk.points.id());
        glMultiDrawArrays(GL_POINTS, m_firsts.data(), m_counts.data(), GLsizei(m_firsts.size()));
        at = end;
    }
}

void GlPointsBackend::drawCommands(const FrameScene& scene, std::span<const ChunkPlace> places,
                                   std::span<const GlVisibility::Band> bands)
{
    beginDrawing(scene);
    std::size_t layer = scene.layers.size();
    for (std::size_t first = 0, next = 0; first < places.size(); first = next) {
        const ChunkPlace& place = places[first];
        while (next < places.size() && places[next].layer == place.layer && places[next].chunk == place.chunk)
            ++next;
        const Layer& l = scene.layers[place.layer];
        const GlPointCopy::Chunk& chunk = copyOf(l).chunks()[place.chunk];
        if (!chunk.points) continue;
        if (layer != place.layer) useLayer(l);
        layer = place.layer;
        glUniform1ui(at::kFirstId, l.firstId + chunk.first);
        glBindVertexArray(chunk.points.id());
        constexpr auto kBytes = GLsizei(sizeof(GlVisibility::Command));
        const auto count = GLsizei(next - first);
        for (const GlVisibility::Band& band : bands) {
            glBindBuffer(GL_DRAW_INDIRECT_BUFFER, band.commands.id());
            const auto* const command = reinterpret_cast<const void*>(first * sizeof(GlVisibility::Command));
            if (!band.list) {
                // reads baseVertex, which is 0, as the base instance
                glMultiDrawArraysIndirect(GL_POINTS, command, count, kBytes);
                continue;
            }
            glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, band.list.id());
            glMultiDrawElementsIndirect(GL_POINTS, GL_UNSIGNED_INT, command, count, kBytes);
        }
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
    }
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

}  // namespace

std::unique_ptr<RasterBackend> makeGlPointsBackend(const GlLimits& limits)
{
    return std::make_unique<GlPointsBackend>(limits);
}

}  // namespace punctum::render
