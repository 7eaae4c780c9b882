// SPDX-License-Identifier: MIT
#pragma once

#include "render/order/SlotOrder.h"

#include <cstdint>
#include <span>
#include <vector>

namespace punctum::render
{

class PointStore;
struct Layer;
struct TargetSize;

/// Of what is in sight, what a picture asks for.
enum class Detail {
    All,
    /// Of stretches that are small on the screen no more than it can show: a random subset, which is their first
    /// windows, by which kPointsAPixel points fall on a px, as ScreenDensity tells.
    OfScreen,
};

/// Which stretches of a layer (PointStore::stretches()) a view can see: those whose box meets the picture and what
/// the clip leaves. Points of the others need not be looked at. The box is compared with each edge of the picture
/// (frustum culling, as of the batches in Schuetz, Kerbl, Wimmer 2022, section 3), with some room for rounding: no
/// point that would be drawn is left out.
///
/// By Detail::OfScreen, a stretch is drawn in the first windows of the order alone, 1, 2, 4 ... of them, by the
/// density of points on the screen: a level of detail with no structure to build, as any windows are a random
/// subset of the stretch. It does what the refinement of a tree's nodes by their size on the screen does in Goswami
/// et al. 2013 (Algorithm 4), and makes the first slots of the order all that an overview reads.
///
/// Immutable; any thread.
class VisibleStretches
{
public:
    /// 8 points fall on a px at random: in 0.03 % of the cases none does.
    static constexpr double kPointsAPixel = 8.0;

    /// All boxes of the store must be known, but for Detail::OfScreen: of a stretch that has none yet, or may grow
    /// while the store is filled, some windows are drawn, wherever it may be.
    VisibleStretches(const Layer& layer, const TargetSize& size, Detail detail = Detail::All);

    /// All slots are drawn.
    bool all() const noexcept { return m_all; }
    /// Share of the slots that are drawn, 0 to 1.
    double share() const noexcept { return m_share; }
    /// Some stretches in sight are not drawn in all windows; while the store is filled, or some are out of sight.
    bool partly() const noexcept { return !m_windows.empty(); }
    /// Windows, from the first one, in which a stretch of the list() is drawn.
    std::uint32_t windows(std::size_t stretch) const noexcept
    {
        return m_windows.empty() ? UINT32_MAX : m_windows[stretch];
    }
    /// Whether a slot is drawn. For partly().
    bool draws(Slot slot) const noexcept { return slot / m_window < m_windows[slot % m_window / m_stretchPlaces]; }
    /// How many slots of a run of whole windows are drawn.
    std::uint64_t drawn(SlotRange slots) const noexcept;
    /// The end of the run of whole windows from `first` on in which so many slots are drawn; at most `last`.
    Slot runOf(Slot first, std::uint64_t slots, Slot last) const noexcept;
    /// How many stretches in sight have a box.
    std::size_t known() const noexcept { return m_known; }
    /// Those in sight, rising.
    std::span<const std::uint32_t> list() const noexcept { return m_list; }
    /// Appends what of a run of slots is in sight, in rising order, in pieces of at most `most` slots.
    void pieces(SlotRange slots, Slot most, std::vector<SlotRange>& out) const;

private:
    struct Level {
        std::vector<SlotRange> places;  ///< drawn in each of the windows; rising and apart
        std::uint64_t count = 0;        ///< of these slots
        void add(SlotRange range);
    };
    struct Seen;
    void chooseWindows(const PointStore& store, const TargetSize& size, bool growing, std::span<const Seen> seen);
    const Level& levelOf(std::uint64_t window) const noexcept;

    Slot m_window = 1, m_stretchPlaces = 1;  ///< slots of a window of the order, and of a stretch in it
    /// Of window 0, of window 1, of 2 and 3, of 4 to 7, ...; by Detail::All a single one.
    std::vector<Level> m_levels;
    std::vector<std::uint32_t> m_list;
    std::vector<std::uint32_t> m_windows;  ///< of each stretch, of those out of sight 0; empty: all
    double m_share = 1.0;
    bool m_all = true;
    std::size_t m_known = 0;
};

/// How many of these points are of stretches that a view can see, by their boxes as they are now, while the store
/// is filled.
PointIndex pointsInSight(const Layer& layer, const TargetSize& size, std::span<const PointRange> ranges);

}  // namespace punctum::render
