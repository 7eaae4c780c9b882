// SPDX-License-Identifier: MIT
#pragma once

#include "core/Identity.h"
#include "core/cloud/BlockBoxes.h"
#include "core/edit/Preview.h"
#include "render/order/SlotOrder.h"
#include "render/store/AttributeEncoder.h"
#include "render/store/DealOut.h"
#include "render/store/LocalFrame.h"

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::render
{

struct Arrangement;

/// The attribute that a cloud is first shown by, judged by the points of `range`: RGB if it has colors, else
/// Intensity if it varies, else Classification if it varies, else Z.
std::string firstAttribute(const PointCloud& cloud, PointRange range);

/// What is drawn of a cloud, in slot order: position (12 bytes), shown attribute (4 bytes, the "word"), class
/// (1 byte).
///
/// Threads: fill() is called by loader threads while one render thread reads; a slot that is being written may be
/// read half-written, which is why the progressive loop draws everything once more after loading has ended.
/// Everything else belongs to the render thread, which holds the cloud's mutex() shared in show(), refresh(),
/// refreshNext(), markStale() and setBounds().
class PointStore
{
public:
    /// `firstBounds`: a first idea of the raw extent (las::SourceFile::sampledBounds). Throws Error (memory).
    PointStore(std::shared_ptr<const PointCloud> cloud, const RawBounds& firstBounds,
               OrderKind order = OrderKind::Stratified);
    ~PointStore();

    /// What a copy on a graphics card knows it by.
    const Identity& identity() const noexcept { return m_identity; }
    const PointCloud& cloud() const noexcept { return *m_cloud; }
    const SlotOrder& order() const noexcept { return m_order; }
    const LocalFrame& frame() const noexcept { return m_frame; }
    Slot slotCount() const noexcept { return m_order.slotCount(); }
    /// Its positions lie in a file, as memoryBudget() does not hold them: reading all of them takes the disk.
    bool beyondMemory() const noexcept { return m_slots.positions.inFile(); }

    /// Takes the points of a range from the cloud's columns. Any thread; each point once.
    void fill(PointRange range);
    /// Takes those of a range that lie in the first windows, as a picture of the whole is made of these: fill()
    /// will be told of the range once more. `windows`: more than all are all; in the prime order, a few points are
    /// taken where that is less. Any thread, each point once, before fill().
    void fillAhead(PointRange range, std::uint32_t windows);
    /// Likewise, all where memory holds the slots, else no more than are drawn while points arrive, so that no
    /// other pages are touched.
    void fillAhead(PointRange range) { fillAhead(range, beyondMemory() ? windowsOfGrowing() : UINT32_MAX); }
    /// Of a cloud whose slots memory does not hold, so many windows are drawn of all that is in sight while points
    /// arrive, at least: 16 M slots in all, as a power of two. `inWindow`: slots of a window that are in sight; 0:
    /// all.
    std::uint32_t windowsOfGrowing(std::uint64_t inWindow = 0) const noexcept;
    /// So many slots instead. Before anything is filled.
    void setSlotsOfGrowing(std::uint64_t count) noexcept { m_slotsOfGrowing = count; }
    /// Points of a range turned out to be damaged after they were taken: their slots are empty again. Any thread.
    void withdraw(PointRange range);
    /// fill() for all points of a cloud that is complete, in parallel.
    void fillAll();
    bool isFilled(PointIndex index) const noexcept;
    /// Points taken so far.
    PointIndex filled() const noexcept { return m_filled.load(std::memory_order_acquire); }
    /// All points were taken.
    bool full() const noexcept { return filled() >= m_cloud->size(); }
    /// True when a point did not fit into the frame (firstBounds was wrong): call setBounds() when loading has
    /// ended.
    bool outgrown() const noexcept { return m_outgrown.load(std::memory_order_relaxed); }
    /// Tells the true bounds once all points have come; takes all slots anew when the frame does not hold them.
    void setBounds(const RawBounds& bounds);
    /// Raw bounds as far as they are known: those given at first, then those of setBounds().
    const RawBounds& bounds() const noexcept { return m_bounds; }

    std::span<const LocalPosition> positions() const noexcept;
    std::span<const std::uint32_t> words() const noexcept;  ///< shown attribute, see AttributeEncoder
    std::span<const std::uint8_t> classes() const noexcept;

    // -- what lies together
    /// A stretch: so many points at consecutive places, of the file or of an arrangement. In each window of the
    /// order they are consecutive slots.
    static constexpr PointIndex kStretchPoints = BlockBoxes::kPoints;
    /// 0 in the prime order, whose slots lie anywhere.
    std::size_t stretches() const noexcept
    {
        return m_order.kind() == OrderKind::Stratified
                   ? std::size_t((m_cloud->size() + kStretchPoints - 1) / kStretchPoints)
                   : 0;
    }
    /// Slots of a stretch in each window; the last one has fewer.
    Slot stretchPlaces() const noexcept { return Slot(kStretchPoints >> m_order.groupBits()); }
    /// Of each stretch, in raw coordinates.
    std::shared_ptr<const BlockBoxes> boxes() const { return m_boxes ? m_boxes : m_cloud->boxes(); }

    // -- another order of the places
    /// Slots by which fewer points have to be looked at for a part of the cloud, as what lies together comes
    /// together (RunOrder). Null where it would not pay: where a cube of a tenth of each side, anywhere, would
    /// spare less than `worth` points (four times as many where points change places one by one, which takes
    /// memory, and time whenever another attribute is shown); with points that could not be read; in the prime
    /// order; and where memory is short. `bounds` as for setBounds(). Any thread, once loading has ended; takes
    /// some 150 ns a point and core at most. Takes cloud().mutex() shared for some 20 ms at a time. Throws
    /// Cancelled, Error (memory).
    std::unique_ptr<Arrangement> arrangement(const RawBounds& bounds, Progress& progress,
                                             double worth = double(kWorthSparing)) const;
    /// Some milliseconds of a core.
    static constexpr PointIndex kWorthSparing = 1'000'000;
    /// Goes on with other slots; what copies of words, classes and hidden points became stale meanwhile is made
    /// anew. All numbers of slots that anybody has are of no use from now on.
    void arrange(Arrangement&& arrangement);
    bool arranged() const noexcept { return m_order.runs() != nullptr; }

    // -- points that are not to be drawn, whatever their class
    /// Hides these points of the cloud from now on, and no others; null: none. In parallel, some nanoseconds a
    /// point.
    void hide(const PointSet* points);
    bool hidesAny() const noexcept { return m_hidesAny; }
    /// 1 for a hidden slot; all 0 unless hidesAny().
    std::span<const std::uint8_t> hidden() const noexcept;

    /// How many calls of fill() have ended. A copy on a device brings over what came since it looked last.
    std::size_t arrivals() const noexcept { return m_arrivals.load(std::memory_order_acquire); }
    /// Appends the points of these calls, and of fillAhead().
    void arrivedPoints(std::size_t from, std::size_t to, std::vector<PointRange>& out) const;
    /// Appends runs of slots, within these, that have the points of the calls [from, to) in them, in no order and
    /// with some more; false where nothing is worth bringing yet: in the prime order the points of each call are
    /// everywhere, so all slots are given, each time twice as many points have come, and at the end.
    bool arrivedSlots(std::size_t from, std::size_t to, SlotRange within, std::vector<SlotRange>& out) const;

    /// Rises with every write to a block of kBlockSlots slots, but for those of fill(): a copy on a device compares
    /// it with what it has.
    static constexpr int kBlockBits = 16;
    static constexpr Slot kBlockSlots = 1 << kBlockBits;
    Slot blocks() const noexcept { return (slotCount() + kBlockSlots - 1) >> kBlockBits; }
    std::uint32_t positionVersion(Slot block) const noexcept
    {
        return m_positionVersions[block].load(std::memory_order_acquire);
    }
    /// Of words.
    std::uint32_t wordVersion(Slot block) const noexcept
    {
        return m_wordVersions[block].load(std::memory_order_acquire);
    }
    /// Of classes and of what is hidden.
    std::uint32_t classVersion(Slot block) const noexcept { return wordVersion(block) + m_hiddenVersion; }

    // -- the shown attribute
    /// Shows another attribute from now on: every slot becomes stale.
    void show(const Attribute& attribute);
    /// Marks these points as selected; null: none. Only those that were not, or are no longer, become stale.
    void setSelection(std::shared_ptr<const PointSet> selection);
    /// Colors as they would be after a change, until it is taken back by null. Where the shown attribute is one of
    /// the preview's, its new values are shown; else new classes are, whatever was shown; of other changes the
    /// points are marked as selected ones are. Selecting and show() go on beneath. Every slot becomes stale.
    void setPreview(std::shared_ptr<const Preview> preview);
    /// What words are made by. Null until the first points have come (or show() was called).
    std::shared_ptr<const AttributeEncoder> encoder() const;
    /// The attribute of the cloud that is shown, beneath any preview. Not before there is an encoder().
    Attribute shown() const;
    /// True when many colors turned up that do not fit what the first ones looked like (16 bits in a cloud that
    /// seemed to have 8): show() it again.
    bool colorsMisjudged() const;
    /// Marks the words and classes of these points (null: of all) as out of date. Few points are brought up to
    /// date at once.
    void markStale(const PointSet* points);
    bool stale() const noexcept { return m_stale; }
    /// Brings the slots listed up to date, in parallel; returns how many were stale.
    std::size_t refresh(std::span<const Slot> slotList);
    /// Brings about `points` more points up to date, in file order; call until stale() is false.
    void refreshNext(PointIndex points);

private:
    std::shared_ptr<AttributeEncoder> makeEncoder(const Attribute& attribute, PointRange range) const;
    std::shared_ptr<const AttributeEncoder> encoderFor(PointRange range);
    /// Of the cloud; beside it the preview's, where there is one.
    void setEncoder(std::shared_ptr<const AttributeEncoder> encoder);
    /// Encodes the points at some places and puts them into their slots; positions too when asked for. Versions are
    /// for the caller to raise.
    void put(PointRange places, const AttributeEncoder& encoder, bool positions,
             std::uint32_t windows = UINT32_MAX);
    void bumpVersions(PointRange places, bool positions) noexcept;

    Identity m_identity;
    std::shared_ptr<const PointCloud> m_cloud;
    SlotOrder m_order;
    RawBounds m_bounds;
    LocalFrame m_frame;
    SlotArrays m_slots;
    Buffer m_hidden;
    std::shared_ptr<const BlockBoxes> m_boxes;    ///< by place; null: places are those of the file
    std::atomic<std::uint64_t> m_wordChanges{0};  ///< rises with all that words and classes are made by
    Attribute m_classification;                   ///< without columns when the cloud has none
    mutable std::mutex m_encoderMutex;
    std::shared_ptr<const AttributeEncoder> m_encoder;
    std::shared_ptr<const AttributeEncoder> m_previewEncoder;  ///< instead, while there is a preview
    std::shared_ptr<const Preview> m_preview;
    std::shared_ptr<const PointSet> m_selection;  ///< null until anything was selected
    std::uint64_t m_slotsOfGrowing = 16'000'000;  ///< 270 MB
    std::atomic<PointIndex> m_filled{0};
    struct Arrival {
        PointRange range;
        std::uint32_t windows = UINT32_MAX;  ///< that have points of it now
        PointIndex after = 0;                ///< points of all calls until this one
    };
    PointIndex pointsAhead(PointRange range, std::uint32_t windows) const noexcept;
    PointIndex takenAhead(PointRange range) const;
    void noteArrival(PointRange range, std::uint32_t windows, PointIndex points);
    mutable std::mutex m_arrivalMutex;  ///< guards what follows, but for atomics
    std::vector<Arrival> m_arrived;
    std::map<PointIndex, Arrival> m_ahead;   ///< of fillAhead(), by their first point
    std::atomic<std::size_t> m_arrivals{0};  ///< size of m_arrived
    std::atomic<bool> m_outgrown{false};
    std::atomic<PointIndex> m_colorsCut{0};        ///< points whose color is brighter than the encoder holds
    mutable std::atomic<float> m_coloredShare{0};  ///< of the points by which colors were judged: those not black
    int m_rejudged = 0;                            ///< how often colorsMisjudged() was followed
    std::vector<std::atomic<std::uint32_t>> m_positionVersions, m_wordVersions;
    std::vector<std::uint64_t> m_fresh;  ///< a bit a slot: up to date although m_refreshed has not come to it
    bool m_stale = false;
    bool m_hidesAny = false;
    std::uint32_t m_hiddenVersion = 0;  ///< rises with each hide()
    PointIndex m_refreshed = 0;         ///< points at places before this one are up to date
};

}  // namespace punctum::render
