// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlBackend.h"

#include "core/Error.h"
#include "render/raster/gl/Shaders.h"
#include "render/resolve/Background.h"
#include "uniforms.h"

#include <epoxy/gl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace punctum::render
{
namespace
{

using Part = GlPointCopy::Part;

/// Entries of one run of scatter.comp: 48 MiB.
constexpr std::size_t kScatterEntries = std::size_t(1) << 22;
/// drawTimed() brings points to the device in steps of so many slots, for at most this share of its time.
constexpr Slot kUploadSlots = PointStore::kBlockSlots;
constexpr double kUploadShare = 0.5;
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

void useProjection(const LayerProjection& p)
{
    glUniform3i(at::kReference, p.reference.x, p.reference.y, p.reference.z);
    glUniform4f(at::kRowX, p.rowX.x, p.rowX.y, p.rowX.z, p.rowX.w);
    glUniform4f(at::kRowY, p.rowY.x, p.rowY.y, p.rowY.z, p.rowY.w);
    glUniform4f(at::kRowD, p.rowD.x, p.rowD.y, p.rowD.z, p.rowD.w);
    glUniform1i(at::kPerspective, p.perspective);
    glUniform1f(at::kNearDepth, p.nearDepth);
}

void useLayerColors(const LayerColors& colors)
{
    glUniform1ui(at::kKind, kindOf(colors));
    glUniform2f(at::kRange, colors.low, colors.high);
}

void usePointSize(const LayerProjection& p, int least, int most)
{
    const int size = std::clamp(p.sizeInSteps(), least, most);
    glUniform2i(at::kSizes, size, p.grows() ? std::clamp(p.mostInSteps(), size, most) : size);
    glUniform1f(at::kSizeOverDepth, p.sizeOverDepth * float(kSampleSteps));
    glUniform1i(at::kCircles, p.round);
}

void useClip(const LayerClip& clip)
{
    glUniform3i(at::kClipLow, clip.low.x, clip.low.y, clip.low.z);
    glUniform3i(at::kClipHigh, clip.high.x, clip.high.y, clip.high.z);
    glUniform1i(at::kPlaneCount, clip.on ? GLint(clip.planeCount) : -1);
    if (clip.planeCount > 0) glUniform4fv(at::kPlanes, GLsizei(clip.planeCount), &clip.planes[0].x);
}

std::array<std::uint32_t, 8> shownClasses(const FrameScene& scene) noexcept
{
    std::array<std::uint32_t, 8> shown{};
    for (std::size_t c = 0; c < scene.classVisible.size(); ++c)
        shown[c / 32] |= std::uint32_t(scene.classVisible[c]) << (c % 32);
    return shown;
}

GlBackend::GlBackend(const GlLimits& limits, const GroupPoints& groupPoints)
    : m_info(requireGl43()), m_limits(limits), m_groupPoints(groupPoints)
{
    constexpr Slot kBlock = PointStore::kBlockSlots;
    if (m_limits.chunkSlots == 0) {
        const std::int64_t fits = m_info.maxStorageBlock / std::int64_t(sizeof(LocalPosition));
        m_limits.chunkSlots =
            Slot(std::clamp<std::int64_t>(fits / kBlock * kBlock, kBlock, GlPointCopy::kMostChunkSlots));
    }
    for (const bool groups : {false, true})
        m_scatter[groups] = GlProgram::compute(
            "scatter.comp", {kShaderHead, groups ? "#define GROUPS\n" : "", shader("scatter.comp.glsl")});
}

GlBackend::~GlBackend() = default;

std::string GlBackend::description() const
{
    return m_info.renderer + ", OpenGL " + std::to_string(m_info.major) + "." + std::to_string(m_info.minor);
}

void GlBackend::setTarget(const TargetSize& size)
{
    const GlStateGuard guard;
    if (size.width > m_info.maxTextureSize || size.height > m_info.maxTextureSize)
        throw Error("The graphics card draws pictures of at most " + std::to_string(m_info.maxTextureSize) +
                    " px a side. Ask for a smaller one or choose the CPU backend.");
    m_picture.reset();
    for (auto& [store, copy] : m_copies) copy.rebuilt = false;
    m_visibility->setSize(size, m_info);
    if (!m_visibility->empty()) targetChanged();
    checkGlErrors("making the picture's buffers");
}

void GlBackend::clear()
{
    const GlStateGuard guard;
    m_visibility->clear();
    for (auto& [store, copy] : m_copies) copy.rebuilt = false;
}

void GlBackend::visibleIds(std::vector<PointId>& out)
{
    out.clear();
    const GlStateGuard guard;
    // One chunk that begins at id 0: ids come back as they are.
    const PointId zero = 0;
    std::vector<std::uint32_t> list;
    for (const GlVisibility::Band& band : m_visibility->collect({&zero, 1})) {
        m_visibility->readBack(band, 1, list);
        out.insert(out.end(), list.begin(), list.end());
    }
    checkGlErrors("reading what is visible");
}

void GlBackend::updateCopies(const FrameScene& scene)
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
        GlPointCopy copy(store, m_limits.chunkSlots, m_traffic);
        copy.rebuilt = known;
        copy.encoder = store.encoder();
        m_copies.emplace(&store, std::move(copy));
    }
}

std::vector<GlBackend::ChunkPlace> GlBackend::places(const FrameScene& scene) const
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

void GlBackend::draw(const FrameScene& scene, std::size_t layer, SlotRange slots)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    slots = ready(scene, layer, slots);
    if (slots.size() == 0) return;
    drawSlots(scene, scene.layers[layer], slots);
    checkGlErrors("drawing points");
}

SlotRange GlBackend::ready(const FrameScene& scene, std::size_t layer, SlotRange slots)
{
    updateCopies(scene);
    const Layer& l = scene.layers[layer];
    slots.last = std::min(slots.last, l.store->slotCount());
    if (slots.first >= slots.last) return {};
    updateFor(scene, l, slots);
    return slots;
}

void GlBackend::updateFor(const FrameScene& scene, const Layer& layer, SlotRange slots)
{
    GlPointCopy& copy = copyOf(layer);
    // Words before positions, as a point that was not there before shall not come with an older word.
    copy.update(*layer.store, Part::Words, slots);
    if (scene.filters()) copy.update(*layer.store, Part::Groups, slots);
    copy.update(*layer.store, Part::Positions, slots);
}

void GlBackend::startClock()
{
    const GlStateGuard guard;
    m_budget.mark(GlBudget::Moment::Start);
}

void GlBackend::drawTimed(const FrameScene& scene, std::span<const Run> runs, double seconds)
{
    if (m_visibility->empty() || runs.empty()) return;
    using namespace std::chrono;
    const auto enough = steady_clock::now() + duration<double>(std::clamp(seconds, 0.0, 1.0) * kUploadShare);
    const GlStateGuard guard;
    updateCopies(scene);
    std::vector<ChunkPlace> places;
    std::vector<GlBudget::Piece> pieces;
    for (std::size_t i = 0; i < runs.size() && (i < 2 || steady_clock::now() < enough); ++i) {
        const Run& run = runs[i];
        const Layer& layer = scene.layers[run.layer];
        const GlPointCopy& copy = copyOf(layer);
        // By steps, until it has taken long enough; where nothing has to be brought over, that is no time.
        Slot end = run.range.first;
        do {
            const std::uint64_t step = (kUploadSlots + run.step - 1) / run.step * std::uint64_t(run.step);
            const Slot next = Slot(std::min<std::uint64_t>(end + step, run.range.last));
            updateFor(scene, layer, {end, next});
            end = next;
        } while (end < run.range.last && (i == 0 || steady_clock::now() < enough));
        for (Slot at = run.range.first; at < end && i > 0;) {
            const std::size_t chunk = at / copy.chunkSlots();
            const Slot first = copy.chunks()[chunk].first;
            const Slot last = std::min(end, first + copy.chunks()[chunk].slots);
            places.push_back({layer.firstId + first, run.layer, chunk});
            pieces.push_back({at - first, last - at, at - run.range.first, end - run.range.first, run.step});
            at = last;
        }
        if (end < run.range.last) break;
    }
    m_budget.mark(GlBudget::Moment::FirstBegins);
    drawSlots(scene, scene.layers[runs.front().layer], runs.front().range);
    m_budget.mark(GlBudget::Moment::FirstDone);
    const GlVisibility::Band& decided =
        m_budget.decide(pieces, runs.front().range.size(), m_groupPoints.run, seconds);
    if (!pieces.empty()) drawCommands(scene, places, {&decided, 1});
    m_budget.mark(GlBudget::Moment::Done);
    checkGlErrors("drawing points");
}

RasterBackend::Timed GlBackend::timed()
{
    const GlStateGuard guard;
    const Timed timed = m_budget.result();
    checkGlErrors("reading the clock");
    return timed;
}

void GlBackend::reproject(const FrameScene& scene)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    for (const Layer& layer : scene.layers) {
        GlPointCopy& copy = copyOf(layer);
        if (std::exchange(copy.rebuilt, false))
            copy.update(*layer.store, Part::Positions, {0, layer.store->slotCount()});
    }
    if (scene.filters()) updateVisible(scene, Part::Groups);

    std::vector<ChunkPlace> all = places(scene);
    std::vector<PointId> firstIds;
    firstIds.reserve(all.size());
    for (const ChunkPlace& place : all) firstIds.push_back(place.firstId);
    const auto bands = m_visibility->collect(firstIds, m_groupPoints.list);
    m_visibility->clear();
    drawCommands(scene, all, bands);
    checkGlErrors("drawing points");
}

void GlBackend::updateVisible(const FrameScene& scene, Part part)
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
        if (part == Part::Groups) copy.requireGroups();

        const std::size_t stale = copy.staleBlocks(store, part);
        copy.updateSome(store, part, m_limits.blocksAFrame);
        if (stale <= m_limits.blocksAFrame) {
            if (part == Part::Words && !store.stale()) {
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
    updateVisible(scene, Part::Words);
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

void GlBackend::depths(std::vector<float>& out)
{
    const GlStateGuard guard;
    m_picture.depths(*m_visibility, out);
    checkGlErrors("reading depths");
}

std::optional<RasterBackend::Hit> GlBackend::pick(int x, int y, int radius)
{
    const GlStateGuard guard;
    const auto hit = m_visibility->pick(x, y, radius);
    checkGlErrors("picking a point");
    return hit;
}

double GlBackend::coveredShare()
{
    const GlStateGuard guard;
    const double share = m_visibility->coveredShare();
    checkGlErrors("counting pixels");
    return share;
}

}  // namespace punctum::render
