// SPDX-License-Identifier: MIT
#include "render/scene/VisibleStretches.h"

#include "core/cloud/LinearSide.h"
#include "render/scene/FrameScene.h"
#include "render/scene/ScreenDensity.h"
#include "render/scene/TargetSize.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace punctum::render
{

namespace
{

/// Of the sum of its terms' sizes, what a linear function of a position may be off by where it is computed in
/// float.
constexpr double kRounding = 1e-5;

/// Of what is drawn: in front, in the picture with the widest point's margin, within the planes. Of places relative
/// to the projection's reference.
std::vector<LinearSide> sidesOf(const Layer& layer, const TargetSize& size)
{
    const LayerProjection& p = layer.projection;
    const auto row = [](const glm::vec4& r) { return LinearSide(glm::dvec3(r), double(r.w)); };
    const LinearSide x = row(p.rowX), y = row(p.rowY), depth = row(p.rowD), nothing(glm::dvec3(0.0), 0.0);
    // x_px >= at, times the depth, which is above 0 for all that is drawn; so for the other edges
    const auto edge = [&](const LinearSide& along, double sign, double at) {
        LinearSide side = LinearSide(nothing).add(along, sign);
        return p.perspective ? side.add(depth, -sign * at) : side.add(-sign * at);
    };
    const double margin = double(p.margin()) + 1.0;
    std::vector<LinearSide> sides{LinearSide(depth).add(-double(p.nearDepth)), edge(x, 1.0, -margin),
                                  edge(x, -1.0, size.width + margin), edge(y, 1.0, -margin),
                                  edge(y, -1.0, size.height + margin)};
    if (layer.clip.on)
        for (std::size_t k = 0; k < layer.clip.planeCount; ++k) sides.push_back(row(layer.clip.planes[k]));
    return sides;
}

bool outOfSight(const Layer& layer, const LocalBox& box, std::span<const LinearSide> sides)
{
    if (layer.clip.on)
        for (int axis = 0; axis < 3; ++axis)
            if (box.high[axis] < layer.clip.low[axis] || box.low[axis] > layer.clip.high[axis]) return true;
    const glm::dvec3 reference(layer.projection.reference);
    const glm::dvec3 low = glm::dvec3(box.low) - reference, high = glm::dvec3(box.high) - reference;
    return std::any_of(sides.begin(), sides.end(),
                       [&](const LinearSide& s) { return s.of(low, high, kRounding) == LinearSide::Box::Outside; });
}

}  // namespace

/// Where a stretch comes to lie; the share of its windows that is drawn where nobody knows.
struct VisibleStretches::Seen {
    std::optional<ScreenRect> rect;
    double shareElse = 1.0;
};

void VisibleStretches::Level::add(SlotRange range)
{
    if (!places.empty() && places.back().last == range.first)
        places.back().last = range.last;
    else
        places.push_back(range);
    count += range.size();
}

VisibleStretches::VisibleStretches(const Layer& layer, const TargetSize& size, Detail detail)
    : m_window(layer.store->order().windowSize()), m_stretchPlaces(layer.store->stretchPlaces()), m_levels(1)
{
    const PointStore& store = *layer.store;
    const std::size_t stretches = store.stretches();
    if (stretches == 0) return;
    const bool partly = detail == Detail::OfScreen, growing = !store.full();
    const std::vector<LinearSide> sides = sidesOf(layer, size);
    // The cloud makes its boxes anew for whoever asks while it is read.
    const BlockBoxes* const arriving = growing ? store.cloud().arriving() : nullptr;
    const std::shared_ptr<const BlockBoxes> known = arriving == nullptr ? store.boxes() : nullptr;
    const BlockBoxes& boxes = arriving != nullptr ? *arriving : *known;
    std::vector<Seen> seen;  // by Detail::OfScreen, each in the list
    for (std::size_t k = 0; k < stretches; ++k) {
        const LocalBox box = store.frame().toLocal(boxes[k]);
        // While points arrive, the first ones of a stretch may be there, but not in the box yet.
        if (box.empty() && !(partly && growing)) continue;
        if (!box.empty() && outOfSight(layer, box, sides)) continue;
        m_list.push_back(std::uint32_t(k));
        m_known += box.empty() ? 0 : 1;
        if (!partly) continue;
        const auto rect = box.empty() ? std::nullopt : screenRect(layer.projection, box);
        // of what reaches behind the eye all is drawn, and of what is not known no more than has to be
        seen.push_back({rect, box.empty() ? 0.0 : 1.0});
    }
    if (partly) chooseWindows(store, size, growing, seen);
    for (const std::uint32_t stretch : m_list) {
        const Slot first = Slot(stretch) * m_stretchPlaces;
        const SlotRange places{first, std::min(m_window, first + m_stretchPlaces)};
        m_levels[0].add(places);
        if (!this->partly()) continue;
        m_levels.resize(std::max(m_levels.size(), std::size_t(std::bit_width(windows(stretch)))));
        for (std::size_t level = 1; (std::uint32_t(1) << level) <= windows(stretch); ++level)
            m_levels[level].add(places);
    }
    const Slot slots = store.slotCount();
    m_share = std::min(1.0, double(drawn({0, slots})) / double(slots));
    m_all = m_list.size() == stretches && m_windows.empty();
}

PointIndex pointsInSight(const Layer& layer, const TargetSize& size, std::span<const PointRange> ranges)
{
    const PointStore& store = *layer.store;
    if (store.stretches() == 0) return 0;
    const BlockBoxes* const arriving = store.cloud().arriving();
    const std::shared_ptr<const BlockBoxes> known = arriving == nullptr ? store.boxes() : nullptr;
    const BlockBoxes& boxes = arriving != nullptr ? *arriving : *known;
    const std::vector<LinearSide> sides = sidesOf(layer, size);
    PointIndex points = 0;
    for (const PointRange& range : ranges)
        for (PointIndex first = range.first, last = first; first < range.last; first = last) {
            const PointIndex stretch = first / PointStore::kStretchPoints;
            last = std::min(range.last, (stretch + 1) * PointStore::kStretchPoints);
            const LocalBox box = store.frame().toLocal(boxes[std::size_t(stretch)]);
            if (box.empty() || !outOfSight(layer, box, sides)) points += last - first;
        }
    return points;
}

/// As many windows of each as the screen can show where it comes to lie, as a power of two.
void VisibleStretches::chooseWindows(const PointStore& store, const TargetSize& size, bool growing,
                                     std::span<const Seen> seen)
{
    const std::uint32_t all = store.order().memberMask() + 1;
    const std::uint64_t inWindow = std::max<std::uint64_t>(1, m_list.size() * m_stretchPlaces);
    // while the store is filled boxes may grow yet
    const std::uint32_t least = growing ? store.windowsOfGrowing(inWindow) : 1;
    ScreenDensity density(size);
    for (const Seen& each : seen)
        if (each.rect) density.add(*each.rect, double(PointStore::kStretchPoints));
    density.finish(kPointsAPixel);
    m_windows.assign(store.stretches(), 0);
    bool some = false;
    for (std::size_t i = 0; i < m_list.size(); ++i) {
        const double share = seen[i].rect ? density.share(*seen[i].rect) : seen[i].shareElse;
        const auto wanted = std::min(all, std::bit_ceil(std::uint32_t(std::ceil(share * all))));
        m_windows[m_list[i]] = std::max(wanted, least);
        some = some || m_windows[m_list[i]] < all;
    }
    // While the store is filled, whoever draws partly looks anew at what is in sight as it grows.
    if (!some && !(growing && m_list.size() < store.stretches())) m_windows.clear();
}

auto VisibleStretches::levelOf(std::uint64_t window) const noexcept -> const Level&
{
    static const Level nothing;
    if (m_windows.empty()) return m_levels.front();
    const auto level = std::size_t(std::bit_width(window));
    return level < m_levels.size() ? m_levels[level] : nothing;
}

std::uint64_t VisibleStretches::drawn(SlotRange slots) const noexcept
{
    const std::uint64_t first = slots.first / m_window,
                        last = (std::uint64_t(slots.last) + m_window - 1) / m_window;
    if (m_windows.empty()) return last > first ? (last - first) * m_levels.front().count : 0;
    std::uint64_t sum = 0;
    for (std::uint64_t window = first; window < last; ++window) sum += levelOf(window).count;
    return sum;
}

Slot VisibleStretches::runOf(Slot first, std::uint64_t slots, Slot last) const noexcept
{
    std::uint64_t end = first;
    for (std::uint64_t drawn = 0; drawn < slots && end < last; end += m_window)
        drawn += levelOf(end / m_window).count;
    return Slot(std::min<std::uint64_t>(end, last));
}

void VisibleStretches::pieces(SlotRange slots, Slot most, std::vector<SlotRange>& out) const
{
    const auto add = [&](std::uint64_t first, std::uint64_t last) {
        first = std::max<std::uint64_t>(first, slots.first);
        last = std::min<std::uint64_t>(last, slots.last);
        for (; first < last; first += most)
            out.push_back({Slot(first), Slot(std::min<std::uint64_t>(first + most, last))});
    };
    if (slots.first >= slots.last) return;
    if (m_all) return add(slots.first, slots.last);
    for (std::uint64_t window = slots.first / m_window * std::uint64_t(m_window); window < slots.last;
         window += m_window)
        for (const SlotRange& places : levelOf(window / m_window).places)
            add(window + places.first, window + places.last);
}

}  // namespace punctum::render
