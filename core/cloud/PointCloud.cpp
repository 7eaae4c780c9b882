// SPDX-License-Identifier: MIT
#include "core/cloud/PointCloud.h"

#include "core/cloud/BlockBoxes.h"
#include "core/task/LockedLoop.h"

#include <glm/common.hpp>

#include <algorithm>
#include <map>
#include <utility>

namespace punctum
{

bool ChangeNotice::concerns(const Attribute& attribute) const
{
    return std::any_of(attributes.begin(), attributes.end(), [&](const std::string& changed) {
        if (changed == attribute.name) return true;
        if (attribute.components == 1) return false;
        return std::any_of(attribute.columns.begin(), attribute.columns.end(),
                           [&](const auto& column) { return column && column->name() == changed; });
    });
}

void RawBounds::include(std::int64_t x, std::int64_t y, std::int64_t z) noexcept
{
    const glm::i64vec3 p(x, y, z);
    min = glm::min(min, p);
    max = glm::max(max, p);
}

void RawBounds::include(const RawBounds& other) noexcept
{
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
}

bool RawBounds::holds(const RawBounds& other) const noexcept
{
    if (other.empty()) return true;
    for (int axis = 0; axis < 3; ++axis)
        if (other.min[axis] < min[axis] || other.max[axis] > max[axis]) return false;
    return true;
}

bool RawBounds::meets(const RawBounds& other) const noexcept
{
    for (int axis = 0; axis < 3; ++axis)
        if (std::max(min[axis], other.min[axis]) > std::min(max[axis], other.max[axis])) return false;
    return true;
}

void WorldBounds::include(const WorldBounds& other) noexcept
{
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
}

WorldBounds CoordinateScale::toWorld(const RawBounds& raw) const noexcept
{
    if (raw.empty()) return {};
    glm::dvec3 a, b;
    for (int axis = 0; axis < 3; ++axis) {
        a[axis] = steps(axis)(raw.min[axis]);
        b[axis] = steps(axis)(raw.max[axis]);
    }
    return {glm::min(a, b), glm::max(a, b)};
}

WorldBounds CoordinateScale::headerBox(const RawBounds& raw) const noexcept
{
    if (raw.empty()) return {};
    const glm::dvec3 a = toWorld(glm::dvec3(raw.min)), b = toWorld(glm::dvec3(raw.max));
    return {glm::min(a, b), glm::max(a, b)};
}

struct PointCloud::Listeners {
    std::mutex mutex;
    std::uint64_t last = 0;
    std::map<std::uint64_t, Listener> listeners;
};

PointCloud::PointCloud(PointIndex size, CoordinateScale coordinates)
    : m_size(size),
      m_coordinates(coordinates),
      m_steps{coordinates.steps(0), coordinates.steps(1), coordinates.steps(2)},
      m_listeners(std::make_shared<Listeners>())
{
}

const Attribute* PointCloud::findAttribute(std::string_view name) const noexcept
{
    const auto it = std::find_if(m_attributes.begin(), m_attributes.end(), [&](auto& a) { return a.name == name; });
    return it == m_attributes.end() ? nullptr : &*it;
}

std::shared_ptr<Column> PointCloud::addColumn(std::shared_ptr<Column> column)
{
    return m_columns.emplace_back(std::move(column));
}

void PointCloud::addAttribute(Attribute attribute)
{
    m_attributes.push_back(std::move(attribute));
}

void PointCloud::removeAttribute(std::string_view name)
{
    const auto it = std::find_if(m_attributes.begin(), m_attributes.end(), [&](auto& a) { return a.name == name; });
    if (it == m_attributes.end()) return;
    const Attribute gone = *it;
    m_attributes.erase(it);
    removeColumnsOf(gone);
}

void PointCloud::replaceAttribute(const Attribute& attribute)
{
    const auto it = std::find_if(m_attributes.begin(), m_attributes.end(),
                                 [&](const Attribute& a) { return a.name == attribute.name; });
    if (it == m_attributes.end()) return;
    const Attribute gone = std::exchange(*it, attribute);
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        if (std::find(m_columns.begin(), m_columns.end(), attribute.columns[c]) == m_columns.end())
            addColumn(attribute.columns[c]);
    removeColumnsOf(gone);
}

void PointCloud::removeColumnsOf(const Attribute& gone)
{
    std::erase_if(m_columns, [&](const std::shared_ptr<Column>& column) {
        const auto shows = [&](const Attribute& a) {
            return std::find(a.columns.begin(), a.columns.end(), column) != a.columns.end();
        };
        return shows(gone) && std::none_of(m_attributes.begin(), m_attributes.end(), shows);
    });
}

RawBounds PointCloud::computeBounds() const
{
    return boxes()->bounds();
}

void PointCloud::setArriving(std::shared_ptr<BlockBoxes> boxes)
{
    m_arriving = std::move(boxes);
}

std::shared_ptr<const BlockBoxes> PointCloud::boxes() const
{
    if (m_arriving && m_arriving->complete()) return m_arriving;
    const std::unique_lock lock(m_boxesMutex);
    if (m_boxes) return m_boxes;
    const auto found = std::make_shared<BlockBoxes>(m_size);
    if (m_size != 0) runLocked(lock, [&] { found->includeAll(rawX().data(), rawY().data(), rawZ().data()); });
    if (!m_arriving) m_boxes = found;
    return found;
}

Subscription PointCloud::subscribe(Listener listener)
{
    const std::lock_guard lock(m_listeners->mutex);
    const std::uint64_t id = ++m_listeners->last;
    m_listeners->listeners.emplace(id, std::move(listener));
    return Subscription([id, weak = std::weak_ptr(m_listeners)] {
        if (const auto listeners = weak.lock()) {
            const std::lock_guard guard(listeners->mutex);
            listeners->listeners.erase(id);
        }
    });
}

void PointCloud::notify(const ChangeNotice& notice) const
{
    // Called under the lock: a subscription that has ended is never called again. Listeners only post.
    const std::lock_guard lock(m_listeners->mutex);
    for (const auto& [id, listener] : m_listeners->listeners) listener(notice);
}

std::shared_ptr<const PointSet> deletedPoints(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    return cloud.deleted();
}

void addComposite(PointCloud& cloud, const std::string& name, AttributeKind kind,
                  const std::array<std::string, 3>& parts)
{
    Attribute composite;
    for (std::size_t c = 0; c < 3; ++c) {
        const Attribute* part = cloud.findAttribute(parts[c]);
        if (part == nullptr || part->components != 1) return;
        if (c == 0) composite = *part;
        if (part->type() != composite.type() || part->scaled != composite.scaled ||
            part->scale != composite.scale || part->offset != composite.offset)
            return;
        composite.columns[c] = part->columns[0];
    }
    composite.name = name;
    composite.kind = kind;
    composite.components = 3;
    cloud.addAttribute(composite);
}

}  // namespace punctum
