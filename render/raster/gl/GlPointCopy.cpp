// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlPointCopy.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>

namespace punctum::render
{
namespace
{

constexpr Slot kBlockSlots = PointStore::kBlockSlots;
/// After more calls of fill() than that a block is brought over whole.
constexpr std::uint32_t kMostArrivals = 256;
/// Runs of slots so near to each other are brought over as one.
constexpr Slot kGap = 32;

std::uint32_t versionOf(const PointStore& store, GlPointCopy::Part part, Slot block) noexcept
{
    switch (part) {
        case GlPointCopy::Part::Positions:
            return store.positionVersion(block);
        case GlPointCopy::Part::Words:
            return store.wordVersion(block);
        case GlPointCopy::Part::Groups:
            break;
    }
    return store.classVersion(block);
}

}  // namespace

GlPointCopy::GlPointCopy(const PointStore& store, Slot chunkSlots, GlTraffic& traffic)
    : m_traffic(&traffic),
      m_store(store.identity()),
      m_slots(store.slotCount()),
      m_chunkSlots(chunkSlots),
      m_chunkBlocks(chunkSlots / kBlockSlots),
      m_frame(store.frame())
{
    for (Have& have : m_have) {
        have.versions.resize(store.blocks());
        have.arrivals.resize(store.blocks());
    }
    assert(chunkSlots >= kBlockSlots && chunkSlots % kBlockSlots == 0);
    for (std::uint64_t first = 0; first < m_slots; first += chunkSlots) {
        Chunk chunk;
        chunk.first = Slot(first);
        chunk.slots = Slot(std::min<std::uint64_t>(chunkSlots, m_slots - first));
        m_chunks.push_back(std::move(chunk));
    }
}

bool GlPointCopy::matches(const PointStore& store) const noexcept
{
    const LocalFrame& frame = store.frame();
    return store.identity() == m_store && frame.origin == m_frame.origin && frame.shift == m_frame.shift;
}

bool GlPointCopy::outdated(const PointStore& store, Part part, Slot block) const noexcept
{
    return have(part).versions[block] != versionOf(store, part, block);
}

void GlPointCopy::allocate(Chunk& chunk, Part part)
{
    const auto slots = std::size_t(chunk.slots);
    if (!chunk.positions) {
        GlBuffer positions = GlBuffer::allocate(slots * sizeof(LocalPosition));
        GlBuffer words = GlBuffer::allocate(slots * sizeof(std::uint32_t));
        positions.clear();  // all slots empty
        words.clear();
        chunk.points = GlVertexArray::create();
        glBindVertexArray(chunk.points.id());
        glBindVertexBuffer(0, positions.id(), 0, sizeof(LocalPosition));
        glVertexAttribIFormat(0, 3, GL_INT, 0);
        glVertexAttribBinding(0, 0);
        glEnableVertexAttribArray(0);
        glBindVertexBuffer(2, words.id(), 0, sizeof(std::uint32_t));
        glVertexAttribIFormat(2, 1, GL_UNSIGNED_INT, 0);
        glVertexAttribBinding(2, 2);
        glEnableVertexAttribArray(2);
        chunk.positions = std::move(positions);
        chunk.words = std::move(words);
    }
    if (part == Part::Groups && !chunk.groups) {
        chunk.groups = GlBuffer::allocate((slots + 1) / 2 * 4);
        chunk.groups.clear();
        glBindVertexArray(chunk.points.id());
        glBindVertexBuffer(1, chunk.groups.id(), 0, sizeof(std::uint16_t));
        glVertexAttribIFormat(1, 1, GL_UNSIGNED_SHORT, 0);
        glVertexAttribBinding(1, 1);
        glEnableVertexAttribArray(1);
    }
}

void GlPointCopy::put(const PointStore& store, Part part, Slot firstBlock, Slot lastBlock)
{
    Chunk& chunk = m_chunks[firstBlock / m_chunkBlocks];
    allocate(chunk, part);
    // The versions first: what is written between here and the copying raises them again.
    Have& mine = have(part);
    const auto arrivals = std::uint32_t(store.arrivals());
    for (Slot b = firstBlock; b < lastBlock; ++b) {
        mine.versions[b] = versionOf(store, part, b);
        mine.arrivals[b] = arrivals;
    }
    write(
        store, part, chunk,
        {firstBlock * kBlockSlots, Slot(std::min<std::uint64_t>(std::uint64_t(lastBlock) * kBlockSlots, m_slots))});
}

void GlPointCopy::putArrived(const PointStore& store, Part part, Slot block)
{
    const std::uint32_t from = have(part).arrivals[block];
    const auto to = std::uint32_t(store.arrivals());
    const SlotRange all{block * kBlockSlots,
                        Slot(std::min<std::uint64_t>((std::uint64_t(block) + 1) * kBlockSlots, m_slots))};
    if (to - from > kMostArrivals) return put(store, part, block, block + 1);
    m_runs.clear();
    if (!store.arrivedSlots(from, to, all, m_runs)) return;
    std::sort(m_runs.begin(), m_runs.end(),
              [](const SlotRange& a, const SlotRange& b) { return a.first < b.first; });
    std::size_t count = 0, slots = 0;
    for (const SlotRange& run : m_runs) {
        if (count > 0 && run.first <= m_runs[count - 1].last + kGap)
            m_runs[count - 1].last = std::max(m_runs[count - 1].last, run.last);
        else
            m_runs[count++] = run;
    }
    m_runs.resize(count);
    for (const SlotRange& run : m_runs) slots += run.size();
    if (slots >= std::size_t(all.size()) / 4 * 3) return put(store, part, block, block + 1);
    Chunk& chunk = m_chunks[block / m_chunkBlocks];
    for (const SlotRange& run : m_runs) write(store, part, chunk, run);
    have(part).arrivals[block] = to;
}

void GlPointCopy::write(const PointStore& store, Part part, Chunk& chunk, SlotRange slots)
{
    const auto first = std::size_t(slots.first), count = std::size_t(slots.size());
    const std::size_t at = first - chunk.first;
    switch (part) {
        case Part::Positions:
            chunk.positions.write(at * sizeof(LocalPosition), store.positions().data() + first,
                                  count * sizeof(LocalPosition), *m_traffic);
            break;
        case Part::Words:
            chunk.words.write(at * 4, store.words().data() + first, count * 4, *m_traffic);
            break;
        case Part::Groups: {
            std::vector<std::uint16_t> groups(count);
            const auto classes = store.classes().subspan(first), hidden = store.hidden().subspan(first);
            for (std::size_t k = 0; k < count; ++k) groups[k] = groupOf(classes[k], hidden[k]);
            chunk.groups.write(at * sizeof(std::uint16_t), groups.data(), count * sizeof(std::uint16_t),
                               *m_traffic);
            break;
        }
    }
}

void GlPointCopy::update(const PointStore& store, Part part, SlotRange range)
{
    if (range.first >= range.last) return;
    const Slot last = (range.last - 1) / kBlockSlots + 1;
    const Have& mine = have(part);
    const auto arrivals = std::uint32_t(store.arrivals());
    for (Slot b = range.first / kBlockSlots; b < last;) {
        Chunk& chunk = m_chunks[b / m_chunkBlocks];
        const Slot chunkEnd = std::min(last, (b / m_chunkBlocks + 1) * m_chunkBlocks);
        allocate(chunk, part);
        while (b < chunkEnd) {
            Slot end = b;
            const auto whole = [&](Slot block) {
                return outdated(store, part, block) || arrivals - mine.arrivals[block] > kMostArrivals;
            };
            while (end < chunkEnd && whole(end)) ++end;
            if (end > b) put(store, part, b, end);
            if (end < chunkEnd && mine.arrivals[end] != arrivals) putArrived(store, part, end);
            b = end + 1;
        }
        b = chunkEnd;
    }
}

std::size_t GlPointCopy::staleBlocks(const PointStore& store, Part part) const noexcept
{
    const Slot all = Slot(have(part).versions.size());
    std::size_t count = 0;
    for (Slot b = 0; b < all; ++b) count += allocated(b) && outdated(store, part, b);
    return count;
}

void GlPointCopy::updateSome(const PointStore& store, Part part, std::size_t blocks)
{
    const Slot all = Slot(have(part).versions.size());
    for (Slot looked = 0; looked < all && blocks > 0; ++looked) {
        m_cursor = m_cursor + 1 < all ? m_cursor + 1 : 0;
        if (!allocated(m_cursor) || !outdated(store, part, m_cursor)) continue;
        put(store, part, m_cursor, m_cursor + 1);
        --blocks;
    }
}

void GlPointCopy::requireGroups()
{
    for (Chunk& chunk : m_chunks)
        if (chunk.positions) allocate(chunk, Part::Groups);
}

}  // namespace punctum::render
