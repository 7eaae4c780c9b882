// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuBackend.h"

#include "core/Error.h"
#include "render/raster/cpu/CpuResolve.h"
#include "render/resolve/HoleFill.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

namespace punctum::render
{

namespace
{

constexpr std::uint64_t kEmpty = ~std::uint64_t(0);
/// Kernels count cells in 32 bits.
constexpr std::uint64_t kMostCells = 0xFFFFFFFFu;

/// Slots a task draws: long enough to hide scheduling, short enough to share a run among threads.
constexpr Slot kDrawGrain = 8192;
/// How many ids ahead positions are asked for.
constexpr std::size_t kPrefetchAhead = 64;
/// How many pieces ahead, and of each so many slots: pieces lie far apart, and have 16 slots for each stretch.
constexpr std::size_t kPiecesAhead = 12;
constexpr std::size_t kAheadSlots = 64;
/// Stretches that are drawn through all windows together.
constexpr std::size_t kStretchesTogether = 4;
/// Cells whose ids make one list when the picture is seen anew.
constexpr std::size_t kBandCells = std::size_t(1) << 14;

/// Everything that drawing a layer needs.
struct Drawing {
    KernelChoice kernel;
    ProjectArguments arguments;
    SplatTarget target;
    const LocalPosition* positions;
    PointId firstId;
    const std::uint8_t* classes;
    const bool* classVisible;    ///< null: all are
    const std::uint8_t* hidden;  ///< null: no point is
    const LayerClip* clip;       ///< null: all is drawn
    glm::ivec3 reference;
};

Drawing prepare(const KernelChoice& kernel, const FrameScene& scene, std::size_t layer, const TargetSize& size,
                std::uint64_t* cells)
{
    const Layer& l = scene.layers[layer];
    const LayerProjection& p = l.projection;
    Drawing d{};
    d.kernel = kernel;
    d.target = {cells,
                size.width,
                size.height,
                size.samples,
                p.sizeInSteps(),
                samplePlaces(size.samples),
                p.sizeOverDepth * float(kSampleSteps),
                p.mostInSteps(),
                p.round};
    for (int k = 0; k < 4; ++k) {
        d.arguments.rowX[k] = p.rowX[k];
        d.arguments.rowY[k] = p.rowY[k];
        d.arguments.rowD[k] = p.rowD[k];
    }
    for (int k = 0; k < 3; ++k) d.arguments.reference[k] = p.reference[k];
    d.arguments.perspective = p.perspective;
    d.arguments.nearDepth = p.nearDepth;
    const float margin = p.singlePixels(size.samples) ? 0.0f : p.margin();
    d.arguments.lowX = d.arguments.lowY = -margin;
    d.arguments.highX = float(size.width) + margin;
    d.arguments.highY = float(size.height) + margin;
    d.positions = l.store->positions().data();
    d.firstId = l.firstId;
    d.classes = l.store->classes().data();
    d.classVisible = scene.allClassesVisible ? nullptr : scene.classVisible.data();
    d.hidden = l.store->hidesAny() ? l.store->hidden().data() : nullptr;
    d.clip = l.clip.on ? &l.clip : nullptr;
    d.reference = p.reference;
    return d;
}

bool inside(const LayerClip& clip, const LocalPosition& p, const glm::ivec3& reference)
{
    bool in = p.x >= clip.low.x && p.x <= clip.high.x && p.y >= clip.low.y && p.y <= clip.high.y &&
              p.z >= clip.low.z && p.z <= clip.high.z;
    for (std::size_t k = 0; k < clip.planeCount && in; ++k) {
        const glm::vec4& plane = clip.planes[k];
        in = plane.x * float(p.x - reference.x) +
                 (plane.y * float(p.y - reference.y) + (plane.z * float(p.z - reference.z) + plane.w)) >=
             0.0f;
    }
    return in;
}

/// Leaves in the block what the scene shows of it.
std::size_t keepShown(const Drawing& d, ProjectedBlock& block, std::size_t count)
{
    if (d.classVisible == nullptr && d.hidden == nullptr && d.clip == nullptr) return count;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const PointId id = block.id[k];
        block.x[kept] = block.x[k];
        block.y[kept] = block.y[k];
        block.depth[kept] = block.depth[k];
        block.id[kept] = id;
        const PointId slot = id - d.firstId;
        kept += (d.classVisible == nullptr || d.classVisible[d.classes[slot]]) &
                (d.hidden == nullptr || d.hidden[slot] == 0) &
                (d.clip == nullptr || inside(*d.clip, d.positions[slot], d.reference));
    }
    return kept;
}

/// `hidden`, when not null: gets the ids that SplatKernel finds hidden.
void splat(const Drawing& d, ProjectedBlock& block, std::size_t count, std::vector<PointId>* hidden = nullptr)
{
    PointId ids[kProjectBlock + 1];
    const std::size_t n =
        d.kernel.splat(d.target, block, keepShown(d, block, count), hidden != nullptr ? ids : nullptr);
    if (hidden != nullptr) hidden->insert(hidden->end(), ids, ids + n);
}

void drawIds(const Drawing& d, std::span<const PointId> ids, std::vector<PointId>* hidden)
{
    ProjectedBlock block;
    LocalPosition gathered[kProjectBlock + 8];
    for (std::size_t at = 0; at < ids.size(); at += kProjectBlock) {
        const std::size_t count = std::min(kProjectBlock, ids.size() - at);
        for (std::size_t k = 0; k < count; ++k) {
            if (at + k + kPrefetchAhead < ids.size())
                __builtin_prefetch(d.positions + (ids[at + k + kPrefetchAhead] - d.firstId));
            gathered[k] = d.positions[ids[at + k] - d.firstId];
        }
        const std::size_t kept = d.kernel.project(&gathered[0].x, count, 0, d.arguments, block);
        for (std::size_t k = 0; k < kept; ++k) block.id[k] = ids[at + block.id[k]];
        splat(d, block, kept, hidden);
    }
}

/// Draws pieces of a store's slots; short ones are gathered into blocks.
template <typename Each>
class PieceDrawing
{
public:
    PieceDrawing(const Drawing& d, const Each& each) : m_d(d), m_each(each) {}

    void draw(std::span<const SlotRange> pieces)
    {
        for (std::size_t k = 0; k < pieces.size(); ++k) {
            if (k + kPiecesAhead < pieces.size()) askFor(pieces[k + kPiecesAhead]);
            std::size_t at = pieces[k].first;
            const std::size_t end = pieces[k].last;
            for (; end - at >= kProjectBlock; at += kProjectBlock)
                m_each(m_block, m_d.kernel.project(&m_d.positions[at].x, kProjectBlock, m_d.firstId + PointId(at),
                                                   m_d.arguments, m_block));
            while (at < end) {
                const std::size_t count = std::min(end - at, kProjectBlock - m_waiting);
                std::copy_n(m_d.positions + at, count, m_gathered + m_waiting);
                std::iota(m_ids + m_waiting, m_ids + m_waiting + count, m_d.firstId + PointId(at));
                at += count;
                m_waiting += count;
                if (m_waiting == kProjectBlock) finish();
            }
        }
    }
    void finish()
    {
        const std::size_t kept =
            m_d.kernel.project(&m_gathered[0].x, std::exchange(m_waiting, 0), 0, m_d.arguments, m_block);
        for (std::size_t k = 0; k < kept; ++k) m_block.id[k] = m_ids[m_block.id[k]];
        m_each(m_block, kept);
    }

private:
    void askFor(const SlotRange& piece) const
    {
        const auto* const bytes = reinterpret_cast<const char*>(m_d.positions + piece.first);
        const std::size_t length = std::min<std::size_t>(piece.size(), kAheadSlots) * sizeof(LocalPosition);
        for (std::size_t b = 0; b < length; b += 64) __builtin_prefetch(bytes + b);
    }

    const Drawing& m_d;
    const Each& m_each;
    ProjectedBlock m_block;
    LocalPosition m_gathered[kProjectBlock + 8];
    PointId m_ids[kProjectBlock];
    std::size_t m_waiting = 0;
};

/// Calls each(block, count) for the projected points of a run of slots, where something is in sight. There, a few
/// stretches are drawn through all windows of the run before the next ones: what they cover of the picture stays in
/// the cache, and other threads draw elsewhere.
template <typename Each>
void forEachBlock(const Drawing& d, const Layer& layer, SlotRange slots, const Each& each)
{
    if (slots.first >= slots.last) return;
    if (!layer.visible || layer.visible->all()) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(slots.first, slots.last, kDrawGrain), [&](const auto& r) {
            ProjectedBlock block;
            for (std::size_t at = r.begin(); at < r.end(); at += kProjectBlock) {
                const std::size_t count = std::min(kProjectBlock, r.end() - at);
                each(block,
                     d.kernel.project(&d.positions[at].x, count, d.firstId + PointId(at), d.arguments, block));
            }
        });
        return;
    }
    const VisibleStretches& visible = *layer.visible;
    const std::span<const std::uint32_t> list = visible.list();
    const std::uint64_t window = layer.store->order().windowSize(), places = layer.store->stretchPlaces();
    const std::uint64_t firstWindow = slots.first / window, lastWindow = (slots.last - 1) / window + 1;
    const std::uint64_t drawn = std::max<std::uint64_t>(1, visible.drawn(slots));
    const std::size_t grain = std::max<std::size_t>(kStretchesTogether, kDrawGrain * list.size() / drawn);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, list.size(), grain), [&](const auto& r) {
        PieceDrawing<Each> drawing(d, each);
        std::vector<SlotRange> pieces;
        for (std::size_t group = r.begin(); group < r.end(); group += kStretchesTogether) {
            const auto together = list.subspan(group, std::min(kStretchesTogether, r.end() - group));
            pieces.clear();
            std::uint64_t last = firstWindow;
            for (const std::uint32_t stretch : together)
                last = std::max<std::uint64_t>(last, visible.windows(stretch));
            for (std::uint64_t w = firstWindow; w < std::min(last, lastWindow); ++w) {
                const std::uint64_t begin = w * window;
                for (const std::uint32_t stretch : together) {
                    if (w >= visible.windows(stretch)) continue;
                    const std::uint64_t first = std::max<std::uint64_t>(slots.first, begin + stretch * places);
                    const std::uint64_t end =
                        std::min({std::uint64_t(slots.last), begin + window, begin + (stretch + 1) * places});
                    if (first >= end) continue;
                    if (!pieces.empty() && pieces.back().last == first)
                        pieces.back().last = Slot(end);
                    else
                        pieces.push_back({Slot(first), Slot(end)});
                }
            }
            drawing.draw(pieces);
        }
        drawing.finish();
    });
}

}  // namespace

CpuBackend::CpuBackend(const KernelChoice& kernel) : m_kernel(kernel) {}

std::string CpuBackend::description() const
{
    return "CPU, " + std::string(m_kernel.name) + ", " + std::to_string(tbb::info::default_concurrency()) +
           " threads";
}

void CpuBackend::setTarget(const TargetSize& size)
{
    checkSampleCount(size.samples);
    const std::uint64_t cells =
        std::uint64_t(size.width) * std::uint64_t(size.height) * std::uint64_t(size.samples);
    if (cells >= kMostCells)
        throw Error("A picture of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                    " px with " + std::to_string(size.samples) +
                    " samples a pixel is too large. Ask for fewer of either.");
    if (m_cells.size() != (cells + 1) * 8) m_cells = Buffer((cells + 1) * 8);
    m_size = size;
    clear();
    cellSpan().data()[cells] = 0;  // SplatTarget
}

std::span<const std::uint64_t> CpuBackend::cells() const noexcept
{
    return {reinterpret_cast<const std::uint64_t*>(m_cells.data()),
            m_cells.size() == 0 ? 0 : m_cells.size() / 8 - 1};
}

void CpuBackend::clear()
{
    m_bands.clear();  // ids may have other meanings from now on
    m_sums.clear();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells().size(), std::size_t(1) << 15),
                      [&](const auto& r) { std::fill_n(cellSpan().data() + r.begin(), r.size(), kEmpty); });
}

void CpuBackend::visibleIds(std::vector<PointId>& out)
{
    tbb::enumerable_thread_specific<std::vector<PointId>> parts;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells().size(), 1 << 15), [&](const auto& r) {
        auto& part = parts.local();
        PointId last = kNoPoint;
        for (std::size_t k = r.begin(); k != r.end(); ++k) {
            const auto id = PointId(cells()[k]);
            if (id != last && id != kNoPoint) part.push_back(id);
            last = id;
        }
    });
    out.clear();
    for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
}

void CpuBackend::reproject(const FrameScene& scene)
{
    m_sums.clear();
    // One pass takes the ids out and leaves the buffer empty; ids of a layer stay together.
    const std::size_t layers = scene.layers.size(), bands = (cells().size() + kBandCells - 1) / kBandCells;
    if (m_bands.size() != bands * layers) m_bands.assign(bands * layers, {});
    const auto asked = [&](const PointIds::Place& place) {
        const VisibleStretches* const visible = scene.layers[place.layer].visible.get();
        return visible == nullptr || !visible->partly() || visible->draws(place.slot);
    };
    tbb::parallel_for(std::size_t(0), bands, [&](std::size_t band) {
        Band* const lists = m_bands.data() + band * layers;
        for (std::size_t layer = 0; layer < layers; ++layer) {
            lists[layer].visible.clear();
            lists[layer].again.clear();
        }
        // Points of a layer may have hidden those of others.
        for (std::size_t layer = 0; layer < layers; ++layer) {
            for (const PointId id : lists[layer].hidden)
                if (const auto place = scene.ids.find(id); place && asked(*place))
                    lists[place->layer].again.push_back(id);
            lists[layer].hidden.clear();
        }
        PointId last = kNoPoint;
        const auto part = cellSpan().subspan(band * kBandCells);
        for (std::uint64_t& cell : part.first(std::min(kBandCells, part.size()))) {
            const auto id = PointId(cell);
            cell = kEmpty;
            if (id == last || id == kNoPoint) continue;
            last = id;
            if (const auto place = scene.ids.find(id); place && asked(*place))
                lists[place->layer].visible.push_back(id);
        }
    });
    for (std::size_t layer = 0; layer < layers; ++layer) {
        const Drawing d = prepare(m_kernel, scene, layer, m_size, cellSpan().data());
        tbb::parallel_for(std::size_t(0), bands, [&](std::size_t band) {
            Band& lists = m_bands[band * layers + layer];
            drawIds(d, lists.visible, &lists.hidden);
            drawIds(d, lists.again, nullptr);
        });
    }
}

void CpuBackend::redraw(const FrameScene& scene, std::span<const PointId> ids)
{
    clear();
    std::vector<std::vector<PointId>> lists(scene.layers.size());
    for (const PointId id : ids)
        if (const auto place = scene.ids.find(id)) lists[place->layer].push_back(id);
    for (std::size_t layer = 0; layer < lists.size(); ++layer) {
        const Drawing d = prepare(m_kernel, scene, layer, m_size, cellSpan().data());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lists[layer].size(), kDrawGrain), [&](const auto& r) {
            drawIds(d, std::span<const PointId>(lists[layer]).subspan(r.begin(), r.size()), nullptr);
        });
    }
}

void CpuBackend::draw(const FrameScene& scene, std::size_t layer, SlotRange slots)
{
    const Drawing d = prepare(m_kernel, scene, layer, m_size, cellSpan().data());
    forEachBlock(d, scene.layers[layer], slots,
                 [&](ProjectedBlock& block, std::size_t kept) { splat(d, block, kept); });
}

void CpuBackend::addColors(const FrameScene& scene, const ResolveSettings& settings, std::size_t layer,
                           SlotRange slots)
{
    m_sums.reserve(cells().size());
    const Drawing d = prepare(m_kernel, scene, layer, m_size, cellSpan().data());
    const std::uint32_t* const words = scene.layers[layer].store->words().data();
    forEachBlock(d, scene.layers[layer], slots, [&](ProjectedBlock& block, std::size_t projected) {
        Rgba8 colors[kProjectBlock];
        const std::size_t kept = keepShown(d, block, projected);
        for (std::size_t k = 0; k < kept; ++k)
            colors[k] = colorOf(words[block.id[k] - d.firstId], settings.layers[layer], settings);
        m_sums.add(d.target, block, kept, colors);
    });
}

void CpuBackend::resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out)
{
    resolveCells(cells(), settings.means ? m_sums.sums() : std::span<const CpuSums::Sum>(), m_size, scene, settings,
                 out);
    if (!settings.closeHoles) return;
    depths(m_depths);
    fillHoles(m_depths, out);
}

void CpuBackend::depths(std::vector<float>& out)
{
    const auto samples = std::size_t(m_size.samples);
    out.resize(std::size_t(m_size.width) * std::size_t(m_size.height));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), 1 << 14), [&](const auto& r) {
        for (std::size_t p = r.begin(); p != r.end(); ++p) {
            const auto pixel = cells().subspan(p * samples, samples);
            const std::uint64_t nearest = *std::min_element(pixel.begin(), pixel.end());
            out[p] = nearest == kEmpty ? std::numeric_limits<float>::infinity()
                                       : std::bit_cast<float>(std::uint32_t(nearest >> 32));
        }
    });
}

void CpuBackend::nearestIds(std::vector<PointId>& out)
{
    static_assert(PointId(kEmpty) == kNoPoint);
    const auto samples = std::size_t(m_size.samples);
    out.resize(std::size_t(m_size.width) * std::size_t(m_size.height));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), 1 << 14), [&](const auto& r) {
        for (std::size_t p = r.begin(); p != r.end(); ++p) {
            const auto pixel = cells().subspan(p * samples, samples);
            out[p] = PointId(*std::min_element(pixel.begin(), pixel.end()));
        }
    });
}

std::optional<VisibilityBuffer::Hit> CpuBackend::pick(int x, int y, int radius)
{
    std::optional<Hit> best;
    int bestDistance = radius * radius + 1;
    std::uint64_t bestCell = kEmpty;
    for (int py = std::max(0, y - radius); py <= std::min(m_size.height - 1, y + radius); ++py)
        for (int px = std::max(0, x - radius); px <= std::min(m_size.width - 1, x + radius); ++px) {
            const int distance = (px - x) * (px - x) + (py - y) * (py - y);
            if (distance > radius * radius || distance > bestDistance) continue;
            for (int s = 0; s < m_size.samples; ++s) {
                const std::uint64_t cell = cells()[(std::size_t(py) * std::size_t(m_size.width) + std::size_t(px)) *
                                                       std::size_t(m_size.samples) +
                                                   std::size_t(s)];
                if (cell == kEmpty || (distance == bestDistance && cell >= bestCell)) continue;
                bestDistance = distance;
                bestCell = cell;
                best = Hit{PointId(cell), std::bit_cast<float>(std::uint32_t(cell >> 32))};
            }
        }
    return best;
}

double CpuBackend::coveredShare()
{
    const std::size_t pixels = std::size_t(m_size.width) * std::size_t(m_size.height);
    const auto samples = std::size_t(m_size.samples);
    if (pixels == 0) return 0.0;
    const std::size_t covered = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, pixels, 1 << 15), std::size_t(0),
        [&](const auto& r, std::size_t n) {
            for (std::size_t p = r.begin(); p != r.end(); ++p) {
                const auto pixel = cells().subspan(p * samples, samples);
                n += std::any_of(pixel.begin(), pixel.end(), [](std::uint64_t c) { return c != kEmpty; });
            }
            return n;
        },
        std::plus<>());
    return double(covered) / double(pixels);
}

}  // namespace punctum::render
