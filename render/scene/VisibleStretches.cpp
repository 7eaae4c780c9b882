// SPDX-License-Identifier: MIT
#include "render/scene/VisibleStretches.h"

#include "core/cloud/LinearSide.h"
#include "render/scene/FrameScene.h"
#include "render/scene/TargetSize.h"

#include <algorithm>

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

}  // namespace

VisibleStretches::VisibleStretches(const Layer& layer, const TargetSize& size)
    : m_window(layer.store->order().windowSize())
{
    const PointStore& store = *layer.store;
    const std::size_t stretches = store.stretches();
    if (stretches == 0) return;
    const Slot stretchPlaces = store.stretchPlaces();
    const std::vector<LinearSide> sides = sidesOf(layer, size);
    const auto boxes = store.boxes();
    std::uint64_t seen = 0;
    for (std::size_t k = 0; k < stretches; ++k) {
        const LocalBox box = store.frame().toLocal((*boxes)[k]);
        if (box.empty()) continue;
        if (layer.clip.on) {
            bool apart = false;
            for (int axis = 0; axis < 3; ++axis)
                apart = apart || box.high[axis] < layer.clip.low[axis] || box.low[axis] > layer.clip.high[axis];
            if (apart) continue;
        }
        const glm::dvec3 reference(layer.projection.reference);
        const glm::dvec3 low = glm::dvec3(box.low) - reference, high = glm::dvec3(box.high) - reference;
        if (std::any_of(sides.begin(), sides.end(), [&](const LinearSide& s) {
                return s.of(low, high, kRounding) == LinearSide::Box::Outside;
            }))
            continue;
        m_list.push_back(std::uint32_t(k));
        const Slot first = Slot(k) * stretchPlaces, last = std::min(m_window, first + stretchPlaces);
        if (!m_places.empty() && m_places.back().last == first)
            m_places.back().last = last;
        else
            m_places.push_back({first, last});
        seen += last - first;
    }
    m_share = std::min(1.0, double(seen) / double(m_window));
    m_all = m_list.size() == stretches;
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
        for (const SlotRange& places : m_places) add(window + places.first, window + places.last);
}

}  // namespace punctum::render
