// SPDX-License-Identifier: MIT
#include "render/progressive/ShownValues.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace punctum::render
{

namespace
{

constexpr Slot kRun = 1 << 16;        // slots looked at together, at least: whole windows are even subsets
constexpr Slot kMostTries = 8 << 20;  // slots looked at in all

/// Which slots a display shows.
class ShownSlots
{
public:
    ShownSlots(const PointStore& store, const DisplaySettings& display)
        : m_store(store),
          m_positions(store.positions()),
          m_hidden(store.hidesAny() ? store.hidden() : std::span<const std::uint8_t>()),
          m_deleted(store.cloud().deleted().get()),
          m_clip(display.clip)
    {
        const bool all =
            std::all_of(display.classVisible.begin(), display.classVisible.end(), [](bool v) { return v; });
        if (!all) {
            m_classes = store.classes();
            m_classVisible = display.classVisible;
        }
        if (m_clip.box) m_box = rawInside(*m_clip.box, store.cloud().coordinates());
    }

    bool contains(Slot slot) const
    {
        if (m_positions[slot].x == 0) return false;  // not read yet
        if (!m_hidden.empty() && m_hidden[slot] != 0) return false;
        if (!m_classes.empty() && !m_classVisible[m_classes[slot]]) return false;
        if (m_deleted == nullptr && !m_clip.any()) return true;
        const PointCloud& cloud = m_store.cloud();
        const PointIndex i = m_store.order().indexOf(slot);
        if (i >= cloud.size() || (m_deleted != nullptr && m_deleted->contains(i))) return false;
        if (m_clip.box) {
            const glm::i64vec3 raw(cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i]);
            for (int axis = 0; axis < 3; ++axis)
                if (raw[axis] < m_box.min[axis] || raw[axis] > m_box.max[axis]) return false;
        }
        return std::all_of(m_clip.planes.begin(), m_clip.planes.end(), [&](const ClipPlane& plane) {
            return glm::dot(plane.normal, cloud.world(i)) >= plane.distance;
        });
    }

private:
    const PointStore& m_store;
    std::span<const LocalPosition> m_positions;
    std::span<const std::uint8_t> m_hidden, m_classes;
    std::array<bool, 256> m_classVisible{};
    const PointSet* m_deleted;
    const Clip& m_clip;
    RawBounds m_box;
};

}  // namespace

void addShownValues(const PointStore& store, const Attribute& attribute, const DisplaySettings& display,
                    std::size_t most, std::vector<double>& values)
{
    const ShownSlots shown(store, display);
    const Slot slots = store.slotCount(), window = std::max<Slot>(store.order().windowSize(), 1);
    const Slot run = (kRun + window - 1) / window * window;
    // The same points whether or not the slots were arranged meanwhile: ranges must not change by that.
    SlotOrder asRead = store.order();
    asRead.setRuns(nullptr);
    const auto slotNow = [&](Slot slot) {
        if (!store.arranged()) return slot;
        const PointIndex i = asRead.indexOf(slot);
        return i < store.cloud().size() ? store.order().slotOf(i) : slots;
    };
    const std::size_t wanted = values.size() + most;
    std::vector<Slot> found;
    for (Slot first = 0; first < std::min(slots, kMostTries) && values.size() < wanted; first += run) {
        found.clear();
        const Slot last = slots - first < run ? slots : first + run;
        for (Slot slot = first; slot < last; ++slot)
            if (const Slot now = slotNow(slot); now < slots && shown.contains(now)) found.push_back(now);
        // Of more than are wanted, as many of all parts of the run.
        const std::size_t take = std::min(found.size(), wanted - values.size());
        for (std::size_t k = 0; k < take; ++k) {
            const PointIndex i = store.order().indexOf(found[k * found.size() / take]);
            if (i >= store.cloud().size()) continue;
            const double value = attribute.number(i);
            if (std::isfinite(value)) values.push_back(value);
        }
        if (slots - first <= run) break;
    }
}

}  // namespace punctum::render
