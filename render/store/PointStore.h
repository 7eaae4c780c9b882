// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "render/order/SlotOrder.h"
#include "render/store/AttributeEncoder.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace punctum::render {

/// Position of a slot: raw LAS integers minus the frame's origin, so that nothing is rounded at any extent.
/// x == 0 marks an empty slot.
struct LocalPosition {
    std::int32_t x = 0, y = 0, z = 0;
};
static_assert(sizeof(LocalPosition) == 12);

/// `local` integer frame of a store: local = (raw - origin) >> shift, always > 0 for points inside the frame.
/// The origin comes from the data, not from the header's offset. shift is 0 unless the raw extent is above 2^30.
struct LocalFrame {
    glm::i64vec3 origin{0};
    int shift = 0;

    static LocalFrame around(const RawBounds& bounds) noexcept;
    bool holds(const RawBounds& bounds) const noexcept;
    glm::dvec3 toRaw(const glm::dvec3& local) const noexcept { return local * double(1 << shift) + glm::dvec3(origin); }
};

/// What is drawn of a cloud, in slot order: position (12 bytes), shown attribute (4 bytes), class (1 byte).
///
/// Threads: fill() is called by loader threads while one render thread reads; a slot that is being written may be
/// read half-written, which is why the progressive loop draws everything once more after loading has ended.
/// Everything else belongs to the render thread.
class PointStore {
public:
    PointStore(std::shared_ptr<const PointCloud> cloud, const RawBounds& firstBounds,
               OrderKind order = OrderKind::Stratified);

    const PointCloud& cloud() const noexcept { return *m_cloud; }
    const SlotOrder& order() const noexcept { return m_order; }
    const LocalFrame& frame() const noexcept { return m_frame; }
    Slot slots() const noexcept { return m_order.slots(); }

    /// Takes the points of a range from the cloud's columns. Any thread; each point once.
    void fill(PointRange range) noexcept;
    /// Points taken so far.
    PointIndex filled() const noexcept { return m_filled.load(std::memory_order_acquire); }
    /// True when a point did not fit into the frame (firstBounds was wrong): call rebuild() when loading has ended.
    bool outgrown() const noexcept { return m_outgrown.load(std::memory_order_relaxed); }
    /// A new frame around the true bounds, and all slots anew. Render thread.
    void rebuild(const RawBounds& bounds);

    std::span<const LocalPosition> positions() const noexcept;
    std::span<const std::uint32_t> words() const noexcept;   ///< shown attribute, see AttributeEncoder
    std::span<const std::uint8_t> classes() const noexcept;

    /// Rises with every write to a block of kBlockSlots slots: a GPU copy compares it with what it has.
    static constexpr Slot kBlockSlots = 1 << 16;
    std::uint32_t positionVersion(Slot block) const noexcept;
    std::uint32_t wordVersion(Slot block) const noexcept;

    // -- the shown attribute; all of these: render thread
    /// Shows another attribute from now on: every slot becomes stale.
    void show(const Attribute& attribute);
    const AttributeEncoder& encoder() const noexcept { return *m_encoder; }
    /// Marks the words and classes of these points (null: of all) as out of date.
    void markStale(const PointSet* points);
    bool stale() const noexcept { return m_staleLeft; }
    /// Brings the slots listed up to date, in parallel; returns how many were stale.
    std::size_t refresh(std::span<const Slot> slots);
    /// Brings about `points` more points up to date, in file order; call until stale() is false.
    void refreshNext(PointIndex points);

private:
    void encode(PointRange range) noexcept;

    std::shared_ptr<const PointCloud> m_cloud;
    SlotOrder m_order;
    LocalFrame m_frame;
    Buffer m_positions, m_words, m_classes;
    Attribute m_classification;            ///< columns empty: the cloud has no classes
    std::shared_ptr<AttributeEncoder> m_encoder;
    mutable std::mutex m_encoderMutex;
    std::atomic<PointIndex> m_filled{0};
    std::atomic<bool> m_outgrown{false};
    std::unique_ptr<std::atomic<std::uint32_t>[]> m_positionVersions, m_wordVersions;
    std::vector<std::uint64_t> m_fresh;    ///< a bit a slot: up to date since the last markStale
    bool m_staleLeft = false;
    PointIndex m_refreshed = 0;            ///< points before this one are up to date
};

}  // namespace punctum::render
