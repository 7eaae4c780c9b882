// SPDX-License-Identifier: MIT
// GlBackend: words of visible points, and the picture.
#include "render/raster/gl/GlBackend.h"
#include "render/raster/gl/Shaders.h"
#include "render/resolve/Background.h"
#include "uniforms.h"

#include <epoxy/gl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace punctum::render
{
namespace
{

/// Entries of one run of scatter.comp: 48 MiB.
constexpr std::size_t kScatterEntries = std::size_t(1) << 22;
/// Chunks of words that one run of resolve.comp sees.
constexpr std::size_t kResolveChunks = 4;

/// As scatter.comp reads it.
struct ScatterEntry {
    std::uint32_t slot, word, group;
};
static_assert(sizeof(ScatterEntry) == 12);

/// As color.glsl takes it.
GLuint kindOf(const LayerColors& colors)
{
    return GLuint(colors.kind) | (colors.marked ? 8u : 0u);
}

}  // namespace

void useLayerColors(const LayerColors& colors)
{
    glUniform1ui(at::kKind, kindOf(colors));
    glUniform2f(at::kRange, colors.low, colors.high);
}

void GlBackend::updateVisible(const FrameScene& scene, GlPointCopy::Part part)
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
        const bool loading = !store.full();
        if (part == GlPointCopy::Part::Groups) copy.requireGroups();

        const std::size_t stale = copy.staleBlocks(store, part);
        copy.updateSome(store, part, m_limits.blocksAFrame);
        if (stale <= m_limits.blocksAFrame) {
            if (part == GlPointCopy::Part::Words && !store.stale()) {
                copy.wordsOutdated = false;
                copy.encoder = encoder;
            }
        } else if (!loading || copy.wordsOutdated) {
            // While a file loads, what was drawn had its words brought by draw().
            layers[i] = any = true;
        }
    }
    if (any) scatter(scene, layers);
}

void GlBackend::scatter(const FrameScene& scene, const std::vector<bool>& layers)
{
    const std::vector<ChunkPlace> all = places(scene);
    std::vector<PointId> firstIds;
    firstIds.reserve(all.size());
    for (const ChunkPlace& place : all) firstIds.push_back(place.firstId);
    std::vector<std::uint32_t> list;
    std::vector<ScatterEntry> entries;
    for (const GlVisibility::Band& band : m_visibility->collect(firstIds)) {
        const auto commands = m_visibility->readBack(band, all.size(), list);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const Layer& layer = scene.layers[all[i].layer];
            const GlPointCopy::Chunk& chunk = copyOf(layer).chunks()[all[i].chunk];
            if (!layers[all[i].layer] || !chunk.words) continue;
            const std::uint32_t* const words = layer.store->words().data() + chunk.first;
            const auto classes = layer.store->classes().subspan(chunk.first);
            const auto hidden = layer.store->hidden().subspan(chunk.first);
            const std::uint32_t* const slots = list.data() + commands[i].firstIndex;
            for (std::size_t done = 0; done < commands[i].count;) {
                const std::size_t count = std::min(kScatterEntries, commands[i].count - done);
                entries.resize(count);
                tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14), [&](const auto& r) {
                    for (std::size_t k = r.begin(); k != r.end(); ++k) {
                        const std::uint32_t slot = std::min(slots[done + k], chunk.slots - 1);
                        entries[k] = {slot, words[slot], groupOf(classes[slot], hidden[slot])};
                    }
                });
                m_entries.reserve(count * sizeof(ScatterEntry));
                m_entries.write(0, entries.data(), count * sizeof(ScatterEntry), m_traffic);
                m_scatter[bool(chunk.groups)].use();
                glUniform1ui(at::kCount, GLuint(count));
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_entries.id());
                glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, chunk.words.id());
                if (chunk.groups) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, chunk.groups.id());
                glDispatchCompute(GLuint((count + 255) / 256), 1, 1);
                done += count;
            }
        }
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                    GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
}

void GlBackend::updateTables(const ResolveSettings& settings)
{
    // As color.glsl reads it: three tables of 256 colors, the color of no value, the background's rows.
    const int height = m_visibility->size().height;
    std::vector<Rgba8> tables;
    tables.insert(tables.end(), settings.colorMap.begin(), settings.colorMap.end());
    tables.insert(tables.end(), settings.palette.begin(), settings.palette.end());
    tables.insert(tables.end(), settings.tone.begin(), settings.tone.end());
    tables.push_back(settings.noValue);
    for (int y = 0; y < height; ++y) tables.push_back(backgroundOf(y, height, settings));
    const std::size_t bytes = tables.size() * sizeof(Rgba8);
    m_tables.reserve(bytes);
    m_tables.write(0, tables.data(), bytes, m_traffic);
    m_lit = settings.normals == NormalLook::Lit;
    m_light = settings.light;
    m_eye = settings.eye;
}

void GlBackend::useColors() const
{
    glUniform1i(at::kLit, m_lit);
    glUniform3f(at::kLight, m_light.x, m_light.y, m_light.z);
    glUniform3f(at::kEye, m_eye.x, m_eye.y, m_eye.z);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, m_tables.id());
}

void GlBackend::addColors(const FrameScene& scene, const ResolveSettings& settings, std::size_t layer,
                          SlotRange slots)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    slots = ready(scene, layer, slots);
    if (slots.size() == 0) return;
    updateTables(settings);
    m_visibility->requireSums();
    addSlots(scene, scene.layers[layer], settings.layers[layer], slots);
    checkGlErrors("adding colors");
}

void GlBackend::runResolve(const FrameScene& scene, const ResolveSettings& settings)
{
    const TargetSize size = m_visibility->size();
    const bool means = settings.means && m_visibility->hasSums(), light = settings.eyeDome.on();
    GlProgram& program = m_resolve[sampleCountIndex(size.samples)][(means ? 1u : 0u) + (light ? 2u : 0u)];
    if (!program)
        program = m_visibility->reader(
            "resolve.comp",
            {light ? "#define EYE_DOME\n" : "", light ? shader("eyedome.glsl") : "",
             light ? shader("shade.glsl") : "", shader("color.glsl"), shader("resolve.comp.glsl")},
            means);
    if (means) m_visibility->makeMeans();
    if (light) m_picture.prepareLight(*m_visibility, settings.eyeDome);

    std::vector<ChunkPlace> drawn = places(scene);
    std::erase_if(drawn,
                  [&](const ChunkPlace& p) { return !copyOf(scene.layers[p.layer]).chunks()[p.chunk].words; });
    updateTables(settings);
    program.use();
    useColors();
    if (light) glUniform1i(at::kReach, settings.eyeDome.reach);
    glBindImageTexture(1, m_picture.picture(*m_visibility), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
    if (drawn.size() > kResolveChunks)
        glBindImageTexture(0, m_picture.sums(*m_visibility), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32UI);
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
                kinds[k] = kindOf(colors);
                lows[k] = colors.low;
                highs[k] = colors.high;
                words = chunk.words.id();
            }
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(k), words);
        }
        glUniform4uiv(at::kFirstIds, 1, firstIds);
        glUniform4uiv(at::kCounts, 1, counts);
        glUniform4uiv(at::kKinds, 1, kinds);
        glUniform4fv(at::kLows, 1, lows);
        glUniform4fv(at::kHighs, 1, highs);
        glUniform1i(at::kFirst, first == 0);
        glUniform1i(at::kLast, first + kResolveChunks >= drawn.size());
        m_visibility->runOverAll();
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    if (settings.closeHoles) m_picture.closeHoles(*m_visibility);
}

void GlBackend::resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out)
{
    resolveOnDevice(scene, settings);
    readPicture(out);
}

void GlBackend::resolveOnDevice(const FrameScene& scene, const ResolveSettings& settings)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    updateVisible(scene, GlPointCopy::Part::Words);
    runResolve(scene, settings);
    checkGlErrors("making the picture");
}

void GlBackend::readPicture(Image& out)
{
    out.resize(m_visibility->size().width, m_visibility->size().height);
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    m_picture.read(out);
    checkGlErrors("reading the picture");
}

void GlBackend::copyPicture(unsigned texture)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    m_picture.copyTo(texture, m_visibility->size());
    checkGlErrors("handing the picture over");
}

}  // namespace punctum::render
