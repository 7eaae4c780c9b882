// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlBackend.h"

#include "core/Error.h"
#include "render/raster/gl/Shaders.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace punctum::render
{
namespace
{

using Part = GlPointCopy::Part;

/// drawTimed() brings points to the device in steps of so many slots, for at most this share of its time.
constexpr Slot kUploadSlots = PointStore::kBlockSlots;
constexpr double kUploadShare = 0.5;
/// Commands of drawTimed(), about: 100 KiB.
constexpr std::size_t kMostCommands = 2048;

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
    std::vector<GlBudget::Piece> budgeted;
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
            m_pieces.clear();
            pieces(layer, {at, last}, std::max<std::size_t>(1, kMostCommands / runs.size()), m_pieces);
            // A run begins with a command at its first slot (GlBudget).
            if (at == run.range.first && (m_pieces.empty() || m_pieces.front().first != at))
                m_pieces.insert(m_pieces.begin(), SlotRange{at, at});
            for (const SlotRange& piece : m_pieces) {
                places.push_back({layer.firstId + first, run.layer, chunk});
                budgeted.push_back({piece.first - first, piece.size(), piece.first - run.range.first,
                                    end - run.range.first, run.step});
            }
            at = last;
        }
        if (end < run.range.last) break;
    }
    m_budget.mark(GlBudget::Moment::FirstBegins);
    drawSlots(scene, scene.layers[runs.front().layer], runs.front().range);
    m_budget.mark(GlBudget::Moment::FirstDone);
    const GlVisibility::Band& decided =
        m_budget.decide(budgeted, runs.front().range.size(), m_groupPoints.run, seconds);
    if (!budgeted.empty()) drawCommands(scene, places, {&decided, 1});
    m_budget.mark(GlBudget::Moment::Done);
    checkGlErrors("drawing points");
}

PointDrawing::Timed GlBackend::timed()
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

void GlBackend::redraw(const FrameScene& scene, std::span<const PointId> ids)
{
    if (m_visibility->empty()) return;
    const GlStateGuard guard;
    updateCopies(scene);
    for (const Layer& layer : scene.layers) {
        GlPointCopy& copy = copyOf(layer);
        copy.rebuilt = false;
        copy.update(*layer.store, Part::Positions, {0, layer.store->slotCount()});
        if (scene.filters()) copy.update(*layer.store, Part::Groups, {0, layer.store->slotCount()});
    }
    // As collect() lists what is in the buffer, in one list for the whole picture.
    const std::vector<ChunkPlace> all = places(scene);
    std::vector<std::vector<std::uint32_t>> slots(all.size());
    for (const PointId id : ids) {
        if (!scene.ids.find(id)) continue;
        const auto after = std::upper_bound(all.begin(), all.end(), id,
                                            [](PointId i, const ChunkPlace& place) { return i < place.firstId; });
        slots[std::size_t(after - all.begin()) - 1].push_back(id - (after - 1)->firstId);
    }
    std::vector<GlVisibility::Command> commands;
    std::vector<std::uint32_t> list;
    for (const std::vector<std::uint32_t>& chunk : slots) {
        GlVisibility::Command command{};
        command.count = std::uint32_t(chunk.size());
        command.instances = 1;
        command.firstIndex = std::uint32_t(list.size());
        command.groups[0] = (command.count + m_groupPoints.list - 1) / m_groupPoints.list;
        command.groups[1] = command.groups[2] = 1;
        commands.push_back(command);
        list.insert(list.end(), chunk.begin(), chunk.end());
    }
    m_visibility->clear();
    if (list.empty()) return;
    GlVisibility::Band band;
    band.commands.reserve(commands.size() * sizeof(GlVisibility::Command));
    band.commands.write(0, commands.data(), commands.size() * sizeof(GlVisibility::Command), m_traffic);
    band.list.reserve(list.size() * sizeof(std::uint32_t));
    band.list.write(0, list.data(), list.size() * sizeof(std::uint32_t), m_traffic);
    drawCommands(scene, all, {&band, 1});
    checkGlErrors("drawing points");
}

void GlBackend::depths(std::vector<float>& out)
{
    const GlStateGuard guard;
    m_picture.depths(*m_visibility, out);
    checkGlErrors("reading depths");
}

void GlBackend::nearestIds(std::vector<PointId>& out)
{
    const GlStateGuard guard;
    m_picture.nearestIds(*m_visibility, out);
    checkGlErrors("reading the nearest points");
}

std::optional<VisibilityBuffer::Hit> GlBackend::pick(int x, int y, int radius)
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
