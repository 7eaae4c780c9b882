// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlPointsBackend.h"

#include "render/raster/gl_points/GlPointCopy.h"
#include "render/raster/gl_points/GlVisibility.h"
#include "render/resolve/CpuResolve.h"
#include "resources.h"

#include <epoxy/gl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace punctum::render
{
namespace
{

using Part = GlPointCopy::Part;

/// Entries of one run of scatter.comp: 48 MiB.
constexpr std::size_t kScatterEntries = std::size_t(1) << 22;
/// Chunks of words that one run of resolve.comp sees.
constexpr std::size_t kResolveChunks = 4;

/// As scatter.comp reads it.
struct ScatterEntry {
    std::uint32_t slot, word, pointClass;
};
static_assert(sizeof(ScatterEntry) == 12);

std::string_view shader(std::string_view name)
{
    return resource("shaders/gl_points/" + std::string(name));
}

/// A chunk of the scene, in the numbering of the view.
struct ChunkPlace {
    PointId firstId;
    std::size_t layer;
    std::size_t chunk;
};

class GlPointsBackend final : public RasterBackend
{
public:
    explicit GlPointsBackend(const GlPointsLimits& limits);

    BackendKind kind() const noexcept override { return BackendKind::GlPoints; }
    std::string description() const override;
    void setTarget(const TargetSize& size) override;
    TargetSize target() const noexcept override { return m_visibility.size(); }
    void clear() override;
    void visibleIds(std::vector<PointId>& out) override;
    void reproject(const FrameScene& scene) override;
    void draw(const FrameScene& scene, std::size_t layer, SlotRange slots) override;
    void finish() override { GlSync::insert().wait(); }
    void resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out) override;
    void depths(std::vector<float>& out) override;
    std::optional<Hit> pick(int x, int y, int radius) override;
    double coveredShare() override;

private:
    /// Copies of the scene's stores, and of no others; makes them anew where a store is not what it was.
    void updateCopies(const FrameScene& scene);
    GlPointCopy& copyOf(const Layer& layer) { return m_copies.at(layer.store); }
    /// All chunks of the scene, by rising first id.
    std::vector<ChunkPlace> places(const FrameScene& scene) const;
    void beginDrawing(const FrameScene& scene);
    void useLayer(const Layer& layer);
    /// Brings words (or classes) of visible points up to date, and some of the others.
    void updateVisible(const FrameScene& scene, Part part);
    void scatter(const FrameScene& scene, const std::vector<bool>& layers);
    void runResolve(const FrameScene& scene, const ResolveSettings& settings);

    GlInfo m_info;
    Slot m_chunkSlots;
    std::size_t m_blocksAFrame;
    float m_minPointSize = 1, m_maxPointSize = 1;
    bool m_otherSamples = false;  ///< the driver's samples are not where samplePlaces() has them
    GlVisibility m_visibility;
    std::unordered_map<const PointStore*, GlPointCopy> m_copies;
    std::array<GlProgram, 2> m_points;   ///< without and with the filter of classes
    std::array<GlProgram, 2> m_scatter;  ///< words; words and classes
    std::array<GlProgram, kSampleCounts.size()> m_resolve;
    GlBuffer m_entries, m_tables;
    GlTexture m_picture, m_sums;
    float m_margin = 0, m_perPixel = 0;  ///< of the viewport, see points.vert
};

GlPointsBackend::GlPointsBackend(const GlPointsLimits& limits)
    : m_info(requireGl43()),
      m_chunkSlots(limits.chunkSlots),
      m_blocksAFrame(limits.blocksAFrame),
      m_visibility(limits.bandSamples)
{
    constexpr Slot kBlock = PointStore::kBlockSlots;
    if (m_chunkSlots == 0) {
        const std::int64_t fits = m_info.maxStorageBlock / std::int64_t(sizeof(LocalPosition));
        m_chunkSlots = Slot(std::clamp<std::int64_t>(fits / kBlock * kBlock, kBlock, GlPointCopy::kMostChunkSlots));
    }
    GLfloat range[2]{1, 1};
    glGetFloatv(GL_POINT_SIZE_RANGE, range);
    m_minPointSize = std::max(1.0f, range[0]);
    m_maxPointSize = std::max(m_minPointSize, range[1]);
    checkGlErrors("starting");

    const std::string_view depth = m_info.clipControl ? "" : "#define FRAGMENT_DEPTH\n";
    for (const bool filter : {false, true}) {
        const std::string head = "#version 430 core\n" + std::string(depth);
        m_points[filter] = GlProgram::graphics(
            "points.vert", {head, filter ? "#define CLASS_FILTER\n" : "", shader("points.vert.glsl")},
            {head, shader("points.frag.glsl")});
        m_scatter[filter] = GlProgram::compute(
            "scatter.comp",
            {"#version 430 core\n", filter ? "#define CLASSES\n" : "", shader("scatter.comp.glsl")});
    }
}

std::string GlPointsBackend::description() const
{
    return m_info.renderer + ", OpenGL " + std::to_string(m_info.major) + "." + std::to_string(m_info.minor) +
           (m_otherSamples ? ", sample places of its own" : "");
}

void GlPointsBackend::setTarget(const TargetSize& size)
{
    const GlStateGuard guard;
    m_visibility.setSize(size, m_info);
    m_picture.reset();
    m_sums.reset();
    for (auto& [store, copy] : m_copies) copy.rebuilt = false;
    if (m_visibility.empty()) return;
    m_visibility.bindFramebuffer();
    m_otherSamples = false;
    const SamplePlace* const places = samplePlaces(size.samples);
    for (int s = 0; s < size.samples && size.samples > 1; ++s) {
        // The picture's top is row 0 of the buffer, so both count from the same corner.
        GLfloat place[2]{};
        glGetMultisamplefv(GL_SAMPLE_POSITION, GLuint(s), place);
        m_otherSamples = m_otherSamples || place[0] * kSampleSteps != float(places[s][0]) ||
                         place[1] * kSampleSteps != float(places[s][1]);
    }
    checkGlErrors("making the picture's buffers");
}

void GlPointsBackend::clear()
{
    const GlStateGuard guard;
    m_visibility.clear();
    for (auto& [store, copy] : m_copies) copy.rebuilt = false;
}

void GlPointsBackend::visibleIds(std::vector<PointId>& out)
{
    out.clear();
    const GlStateGuard guard;
    // One chunk that begins at id 0: ids come back as they are.
    const PointId zero = 0;
    std::vector<std::uint32_t> list;
    for (const GlVisibility::Band& band : m_visibility.collect({&zero, 1})) {
        GlVisibility::readBack(band, 1, list);
        out.insert(out.end(), list.begin(), list.end());
    }
    checkGlErrors("reading what is visible");
}

void GlPointsBackend::updateCopies(const FrameScene& scene)
{
    const auto wanted = [&](const PointStore* store) {
        return std::any_of(scene.layers.begin(), scene.layers.end(),
                           [&](const Layer& l) { return l.store == store; });
    };
    std::erase_if(m_copies, [&](const auto& entry) { return !wanted(entry.first); });
    for (const Layer& layer : scene.layers) {
        const PointStore& store = *layer.store;
        const auto it = m_copies.find(&store);
        const bool known = it != m_copies.end();
        if (known && it->second.matches(store)) continue;
        if (known) m_copies.erase(it);
        GlPointCopy copy(store, m_chunkSlots);
        copy.rebuilt = known;
        copy.encoder = store.encoder();
        m_copies.emplace(&store, std::move(copy));
    }
}

std::vector<ChunkPlace> GlPointsBackend::places(const FrameScene& scene) const
{
    std::vector<ChunkPlace> all;
    for (std::size_t layer = 0; layer < scene.layers.size(); ++layer) {
        const auto chunks = m_copies.at(scene.layers[layer].store).chunks();
        for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk)
            all.push_back({scene.layers[layer].firstId + chunks[chunk].first, layer, chunk});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.firstId < b.firstId; });
    return all;
}

void GlPointsBackend::beginDrawing(const FrameScene& scene)
{
    // OpenGL drops points whose middle lies outside the viewport, even where the square reaches into the picture:
    // so the viewport reaches beyond the picture. Its side is a power of two, so that scaling to it is exact.
    const TargetSize size = m_visibility.size();
    float largest = 1;
    for (const Layer& layer : scene.layers) largest = std::max(largest, layer.projection.pointSize);
    const int wish = int(std::ceil(std::min(largest, m_maxPointSize) / 2)) + 1;
    const int longest = std::max(size.width, size.height);
    const int side = std::min(m_info.maxViewport, int(std::bit_ceil(unsigned(longest + 2 * wish))));
    const int margin = std::clamp((side - longest) / 2, 0, wish);
    m_margin = float(margin);
    m_perPixel = 2.0f / float(side);

    m_visibility.bindFramebuffer();
    glViewport(-margin, -margin, side, side);
    if (m_info.clipControl) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_MULTISAMPLE);
    for (const GLenum cap : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST}) glDisable(cap);
    m_points[!scene.allClassesVisible].use();
    glUniform2f(8, float(size.width), float(size.height));
    glUniform1f(9, m_margin);
    glUniform1f(10, m_perPixel);
    if (!scene.allClassesVisible) {
        GLuint shown[8]{};
        for (std::size_t c = 0; c < scene.classVisible.size(); ++c)
            shown[c / 32] |= GLuint(scene.classVisible[c]) << (c % 32);
        glUniform4uiv(14, 2, shown);
    }
}

void GlPointsBackend::useLayer(const Layer& layer)
{
    const LayerProjection& p = layer.projection;
    const float pointSize =
        std::clamp(float(p.sizeInSteps()) / kSampleSteps, m_minPointSize, std::floor(m_maxPointSize));
    glUniform3i(0, p.reference.x, p.reference.y, p.reference.z);
    glUniform4f(1, p.rowX.x, p.rowX.y, p.rowX.z, p.rowX.w);
    glUniform4f(2, p.rowY.x, p.rowY.y, p.rowY.z, p.rowY.w);
    glUniform4f(3, p.rowD.x, p.rowD.y, p.rowD.z, p.rowD.w);
    glUniform1i(4, p.perspective);
    glUniform1f(5, p.nearDepth);
    glUniform1f(6, pointSize);
}

void GlPointsBackend::draw(const FrameScene& scene, std::size_t layer, SlotRange slots)
{
    if (m_visibility.empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    const Layer& l = scene.layers[layer];
    GlPointCopy& copy = copyOf(l);
    slots.last = std::min(slots.last, l.store->slotCount());
    if (slots.first >= slots.last) return;
    // Words before positions, as a point that was not there before shall not come with an older word.
    copy.update(*l.store, Part::Words, slots);
    if (!scene.allClassesVisible) copy.update(*l.store, Part::Classes, slots);
    copy.update(*l.store, Part::Positions, slots);

    beginDrawing(scene);
    useLayer(l);
    for (Slot at = slots.first; at < slots.last;) {
        const GlPointCopy::Chunk& chunk = copy.chunks()[at / copy.chunkSlots()];
        const Slot end = std::min(slots.last, chunk.first + chunk.slots);
        glUniform1ui(11, l.firstId + chunk.first);
        glBindVertexArray(chunk.points.id());
        glDrawArrays(GL_POINTS, GLint(at - chunk.first), GLsizei(end - at));
        at = end;
    }
    checkGlErrors("drawing points");
}

void GlPointsBackend::reproject(const FrameScene& scene)
{
    if (m_visibility.empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    for (const Layer& layer : scene.layers) {
        GlPointCopy& copy = copyOf(layer);
        if (std::exchange(copy.rebuilt, false))
            copy.update(*layer.store, Part::Positions, {0, layer.store->slotCount()});
    }
    if (!scene.allClassesVisible) updateVisible(scene, Part::Classes);

    const std::vector<ChunkPlace> all = places(scene);
    std::vector<PointId> firstIds;
    for (const ChunkPlace& place : all) firstIds.push_back(place.firstId);
    const auto bands = m_visibility.collect(firstIds);
    m_visibility.clear();

    beginDrawing(scene);
    std::size_t layer = scene.layers.size();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Layer& l = scene.layers[all[i].layer];
        const GlPointCopy::Chunk& chunk = copyOf(l).chunks()[all[i].chunk];
        if (!chunk.points) continue;
        if (layer != all[i].layer) useLayer(l);
        layer = all[i].layer;
        glUniform1ui(11, l.firstId + chunk.first);
        glBindVertexArray(chunk.points.id());
        for (const GlVisibility::Band& band : bands) {
            glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, band.list.id());
            glBindBuffer(GL_DRAW_INDIRECT_BUFFER, band.commands.id());
            glDrawElementsIndirect(GL_POINTS, GL_UNSIGNED_INT,
                                   reinterpret_cast<const void*>(i * sizeof(GlVisibility::Command)));
        }
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
    }
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
    checkGlErrors("drawing points");
}

void GlPointsBackend::updateVisible(const FrameScene& scene, Part part)
{
    // The stratified order spreads what is visible over all blocks. So when many blocks have changed, the visible
    // points' words alone are picked out and sent (Schuetz et al. 2019, section 3.5, with the visible first), and
    // whole blocks follow, some each frame.
    std::vector<bool> layers(scene.layers.size());
    bool any = false;
    for (std::size_t i = 0; i < scene.layers.size(); ++i) {
        const PointStore& store = *scene.layers[i].store;
        GlPointCopy& copy = copyOf(scene.layers[i]);
        const auto encoder = store.encoder();
        if (!copy.encoder) copy.encoder = encoder;
        if (copy.encoder != encoder || store.stale()) copy.wordsOutdated = true;
        const bool loading = store.filled() < store.cloud().size();
        if (part == Part::Classes) copy.requireClasses();

        const std::size_t stale = copy.staleBlocks(store, part);
        copy.updateSome(store, part, m_blocksAFrame);
        if (stale <= m_blocksAFrame) {
            if (part == Part::Words && !store.stale()) {
                copy.wordsOutdated = false;
                copy.encoder = encoder;
            }
        } else if (!loading || copy.wordsOutdated) {
            // While a file loads all blocks change, but not the points that were drawn: draw() brought those.
            layers[i] = any = true;
        }
    }
    if (any) scatter(scene, layers);
}

void GlPointsBackend::scatter(const FrameScene& scene, const std::vector<bool>& layers)
{
    const std::vector<ChunkPlace> all = places(scene);
    std::vector<PointId> firstIds;
    for (const ChunkPlace& place : all) firstIds.push_back(place.firstId);
    std::vector<std::uint32_t> list;
    std::vector<ScatterEntry> entries;
    for (const GlVisibility::Band& band : m_visibility.collect(firstIds)) {
        const auto commands = GlVisibility::readBack(band, all.size(), list);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const Layer& layer = scene.layers[all[i].layer];
            const GlPointCopy::Chunk& chunk = copyOf(layer).chunks()[all[i].chunk];
            if (!layers[all[i].layer] || !chunk.words) continue;
            const std::uint32_t* const words = layer.store->words().data() + chunk.first;
            const std::uint8_t* const classes = layer.store->classes().data() + chunk.first;
            const std::uint32_t* const slots = list.data() + commands[i].firstIndex;
            for (std::size_t done = 0; done < commands[i].count;) {
                const std::size_t count = std::min(kScatterEntries, commands[i].count - done);
                entries.resize(count);
                tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14), [&](const auto& r) {
                    for (std::size_t k = r.begin(); k != r.end(); ++k) {
                        const std::uint32_t slot = std::min(slots[done + k], chunk.slots - 1);
                        entries[k] = {slot, words[slot], classes[slot]};
                    }
                });
                const std::size_t bytes = count * sizeof(ScatterEntry);
                if (m_entries.size() < bytes) {
                    m_entries = GlBuffer();
                    m_entries = GlBuffer::allocate(bytes);
                }
                m_entries.write(0, entries.data(), bytes);
                m_scatter[bool(chunk.classes)].use();
                glUniform1ui(0, GLuint(count));
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_entries.id());
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, chunk.words.id());
                if (chunk.classes) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, chunk.classes.id());
                glDispatchCompute(GLuint((count + 255) / 256), 1, 1);
                done += count;
            }
        }
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                    GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
}

void GlPointsBackend::runResolve(const FrameScene& scene, const ResolveSettings& settings)
{
    const TargetSize size = m_visibility.size();
    GlProgram& program = m_resolve[sampleCountIndex(size.samples)];
    if (!program)
        program = GlProgram::compute("resolve.comp",
                                     {GlVisibility::shaderHead(size.samples), shader("resolve.comp.glsl")});
    const auto texture = [&](GLenum format) {
        checkGlErrors("drawing");
        GlTexture t = GlTexture::create();
        glBindTexture(GL_TEXTURE_2D, t.id());
        glTexStorage2D(GL_TEXTURE_2D, 1, format, size.width, size.height);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        checkGlErrors("making the picture");
        return t;
    };
    glActiveTexture(GL_TEXTURE0);
    if (!m_picture) m_picture = texture(GL_R32UI);

    std::vector<ChunkPlace> drawn = places(scene);
    std::erase_if(drawn,
                  [&](const ChunkPlace& p) { return !copyOf(scene.layers[p.layer]).chunks()[p.chunk].words; });
    if (drawn.size() > kResolveChunks && !m_sums) m_sums = texture(GL_RGBA32UI);

    // As resolve.comp reads it: two tables of 256 colours, the colour of no value, the background's rows.
    std::vector<Rgba8> tables;
    tables.insert(tables.end(), settings.colorMap.begin(), settings.colorMap.end());
    tables.insert(tables.end(), settings.palette.begin(), settings.palette.end());
    tables.push_back(settings.noValue);
    for (int y = 0; y < size.height; ++y) tables.push_back(backgroundOf(y, size.height, settings));
    const std::size_t bytes = tables.size() * sizeof(Rgba8);
    if (m_tables.size() < bytes) {
        m_tables = GlBuffer();
        m_tables = GlBuffer::allocate(bytes);
    }
    m_tables.write(0, tables.data(), bytes);

    m_visibility.bindTextures();
    program.use();
    glUniform2i(7, size.width, size.height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, m_tables.id());
    glBindImageTexture(1, m_picture.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
    if (m_sums) glBindImageTexture(0, m_sums.id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32UI);
    for (std::size_t first = 0; first == 0 || first < drawn.size(); first += kResolveChunks) {
        GLuint firstIds[kResolveChunks]{}, counts[kResolveChunks]{}, kinds[kResolveChunks]{};
        GLfloat lows[kResolveChunks]{}, highs[kResolveChunks]{};
        for (std::size_t k = 0; k < kResolveChunks; ++k) {
            GLuint words = m_tables.id();  // something must be bound
            if (first + k < drawn.size()) {
                const ChunkPlace& place = drawn[first + k];
                const GlPointCopy::Chunk& chunk = copyOf(scene.layers[place.layer]).chunks()[place.chunk];
                const LayerColors& colors = settings.layers[place.layer];
                firstIds[k] = place.firstId;
                counts[k] = chunk.slots;
                kinds[k] = GLuint(colors.kind);
                lows[k] = colors.low;
                highs[k] = colors.high;
                words = chunk.words.id();
            }
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(k), words);
        }
        glUniform4uiv(0, 1, firstIds);
        glUniform4uiv(1, 1, counts);
        glUniform4uiv(2, 1, kinds);
        glUniform4fv(3, 1, lows);
        glUniform4fv(4, 1, highs);
        glUniform1i(5, first == 0);
        glUniform1i(6, first + kResolveChunks >= drawn.size());
        glDispatchCompute((GLuint(size.width) + 15) / 16, (GLuint(size.height) + 15) / 16, 1);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void GlPointsBackend::resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out)
{
    out.resize(m_visibility.size().width, m_visibility.size().height);
    if (m_visibility.empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    updateVisible(scene, Part::Words);
    runResolve(scene, settings);
    glBindTexture(GL_TEXTURE_2D, m_picture.id());
    static_assert(std::endian::native == std::endian::little);  // the lowest byte of a word is red
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, out.pixels.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    checkGlErrors("making the picture");
}

void GlPointsBackend::depths(std::vector<float>& out)
{
    const GlStateGuard guard;
    m_visibility.depths(out);
    checkGlErrors("reading depths");
}

std::optional<RasterBackend::Hit> GlPointsBackend::pick(int x, int y, int radius)
{
    const GlStateGuard guard;
    const auto hit = m_visibility.pick(x, y, radius);
    checkGlErrors("picking a point");
    return hit;
}

double GlPointsBackend::coveredShare()
{
    const GlStateGuard guard;
    const double share = m_visibility.coveredShare();
    checkGlErrors("counting pixels");
    return share;
}

}  // namespace

std::unique_ptr<RasterBackend> makeGlPointsBackend(const GlPointsLimits& limits)
{
    return std::make_unique<GlPointsBackend>(limits);
}

}  // namespace punctum::render
