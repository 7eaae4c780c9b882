// SPDX-License-Identifier: MIT
#pragma once

#include "render/gl/GlObjects.h"
#include "render/scene/VisibleStretches.h"
#include "render/store/PointStore.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace punctum::render
{

/// What filters go by: the class, and whether the point is hidden.
constexpr std::uint16_t groupOf(std::uint8_t pointClass, std::uint8_t hidden) noexcept
{
    return std::uint16_t(pointClass | (hidden != 0 ? 256u : 0u));
}

/// The copy of one PointStore in the device's memory, in chunks small enough for one storage block each.
///
/// Blocks of PointStore::kBlockSlots slots are brought over when their version has risen, and only when somebody
/// asks for them. Of what arrives while a file loads, in every block a little at a time, the new slots alone are
/// brought: so each is sent once. Owned by the backend; the thread of its
/// context. Members throw Error when the device has no memory left.
class GlPointCopy
{
public:
    /// 2^23 slots make 96 MiB of positions: below the 128 MiB that some drivers set as the limit of a block.
    static constexpr Slot kMostChunkSlots = Slot(1) << 23;

    /// `chunkSlots`: a multiple of PointStore::kBlockSlots. `traffic` outlives it and counts what goes over.
    GlPointCopy(const PointStore& store, Slot chunkSlots, GlTraffic& traffic);

    /// False when the store is another one than this copy was made of, or was rebuilt.
    bool matches(const PointStore& store) const noexcept;

    struct Chunk {
        Slot first = 0;
        Slot slots = 0;
        GlBuffer positions;    ///< 3 x int32 a slot
        GlBuffer words;        ///< uint32 a slot
        GlBuffer groups;       ///< uint16 a slot, groupOf(); empty until they are asked for
        GlVertexArray points;  ///< attribute 0: positions; 1: groups, once there are any; 2: words
    };
    /// Chunk i begins at slot i * chunkSlots(). Buffers are empty handles until something was put there.
    std::span<const Chunk> chunks() const noexcept { return m_chunks; }
    Slot chunkSlots() const noexcept { return m_chunkSlots; }

    /// Groups are what filters go by.
    enum class Part { Positions, Words, Groups };
    /// Brings over the blocks that touch `range` and have changed; reads the store while loaders may write it.
    void update(const PointStore& store, Part part, SlotRange range);
    /// How many blocks have changed; chunks that nothing was drawn of do not count.
    std::size_t staleBlocks(const PointStore& store, Part part) const noexcept;
    /// Brings over at most so many changed blocks, beginning where the last call ended.
    void updateSome(const PointStore& store, Part part, std::size_t blocks);
    /// Makes room for groups wherever something was drawn, so that attribute 1 can be used.
    void requireGroups();

    // -- notes of GlBackend on this copy
    bool rebuilt = false;        ///< visible points may not have come over yet
    bool wordsOutdated = false;  ///< words of visible points may be those of another attribute or of an older value
    GlBuffer inSight;            ///< VisibleStretches::list() of ...
    std::shared_ptr<const VisibleStretches> visible;  ///< ... what was drawn last; null: nothing is there
    std::shared_ptr<const AttributeEncoder> encoder;  ///< of the words, when they were last found complete

private:
    void allocate(Chunk& chunk, Part part);
    bool allocated(Slot block) const noexcept { return bool(m_chunks[block / m_chunkBlocks].positions); }
    /// What is here of a part, by block.
    struct Have {
        std::vector<std::uint32_t> versions;
        std::vector<std::uint32_t> arrivals;  ///< of PointStore::arrivals()
    };
    Have& have(Part part) noexcept { return m_have[std::size_t(part)]; }
    const Have& have(Part part) const noexcept { return m_have[std::size_t(part)]; }
    bool outdated(const PointStore& store, Part part, Slot block) const noexcept;
    /// Consecutive blocks of one chunk.
    void put(const PointStore& store, Part part, Slot firstBlock, Slot lastBlock);
    /// What has arrived in a block since.
    void putArrived(const PointStore& store, Part part, Slot block);
    /// Slots of one chunk, as they are.
    void write(const PointStore& store, Part part, Chunk& chunk, SlotRange slots);

    GlTraffic* m_traffic;  ///< never null
    Identity m_store;      ///< PointStore::identity()
    Slot m_slots;
    Slot m_chunkSlots, m_chunkBlocks;
    LocalFrame m_frame;
    std::vector<Chunk> m_chunks;
    std::array<Have, 3> m_have;     ///< by Part
    std::vector<SlotRange> m_runs;  ///< kept, so that memory is not asked for each time
    Slot m_cursor = 0;
};

}  // namespace punctum::render
