// SPDX-License-Identifier: MIT
#include "core/edit/CommandPreview.h"

#include "core/cloud/Slabs.h"
#include "core/edit/Command.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <map>
#include <set>
#include <shared_mutex>
#include <string>

namespace punctum
{

namespace
{

constexpr std::size_t kClasses = 256;

/// A column of the cloud, and what it holds on the other side.
struct Crossed {
    std::shared_ptr<Column> now, after;
};

/// The attributes as the cloud has them now.
std::vector<Attribute> listOf(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    return cloud.attributes();
}

const Attribute* findIn(const std::vector<Attribute>& attributes, std::string_view name)
{
    const auto found = std::find_if(attributes.begin(), attributes.end(), [&](auto& a) { return a.name == name; });
    return found == attributes.end() ? nullptr : &*found;
}

/// Raw bytes of both, but for the bits of other attributes.
bool sameAt(const Attribute& a, const Attribute& b, PointIndex i)
{
    for (std::uint32_t c = 0; c < a.components; ++c) {
        const Column &p = *a.columns[c], &q = *b.columns[c];
        if (a.bitWidth != 0 || b.bitWidth != 0 || p.type() != q.type() || p.components() != q.components()) {
            const double v = a.number(i, c), w = b.number(i, c);
            if (v != w && !(v != v && w != w)) return false;
            continue;
        }
        const std::size_t bytes = p.elementBytes();
        if (std::memcmp(p.data() + i * bytes, q.data() + i * bytes, bytes) != 0) return false;
    }
    return true;
}

/// Of a field in bytes.
std::size_t classAt(const Attribute& classes, PointIndex i)
{
    return std::size_t(std::to_integer<unsigned>(classes.columns[0]->data()[i]) >> classes.bitShift) &
           std::size_t(classes.maxBits());
}

/// What one command leads to.
class Crossing
{
public:
    Crossing(const Command& command, const PointCloud& cloud, Progress& progress)
        : m_command(command),
          m_cloud(cloud),
          m_progress(progress),
          m_effect(command.effect()),
          m_now(listOf(cloud)),
          m_deleted(cloud.deleted())
    {
    }

    CommandPreview look(std::string_view shows)
    {
        CommandPreview found;
        auto preview = std::make_shared<Preview>();
        bring(*preview);
        cross(*preview);
        found.deletes = m_effect.deletes;
        auto points = changedPoints(*preview);
        found.changed = points ? points->count() : m_command.changedPoints();
        if (!points) return found;
        if (found.changed == 0) return found;
        preview->points = points;
        preview->shows = chosen(*preview, shows);
        found.classes = countClasses(*preview);
        found.preview = std::move(preview);
        return found;
    }

private:
    /// What comes new, or takes the place of another attribute of the name.
    void bring(Preview& preview)
    {
        for (Attribute& attribute : m_command.brings()) {
            preview.attributes.push_back(attribute);
            m_new.insert(attribute.name);
        }
        for (const Attribute& added : m_effect.added) {
            const Attribute* const replaced = findIn(m_now, added.name);
            const bool swapped = std::find(m_effect.columns.begin(), m_effect.columns.end(), added.columns[0]) !=
                                 m_effect.columns.end();
            if (!swapped && (replaced == nullptr || !sameColumns(added, *replaced))) {  // it was undone
                preview.attributes.push_back(added);
                m_new.insert(added.name);
            }
            if (replaced == nullptr || !swapped || added.components != 1 || added.type() != ScalarType::U8)
                continue;
            // Classification in a column of its own: what the bits hold, then what the command changes of it
            Attribute wide = added;
            wide.columns[0] = std::make_shared<Column>(added.name, ScalarType::U8, added.size());
            const std::span<std::uint8_t> to = wide.columns[0]->values<std::uint8_t>();
            m_progress.begin("Preview of " + added.name, m_cloud.size());
            forEachSlab(m_cloud, m_progress, [&](std::size_t firstWord, std::size_t lastWord) {
                const PointIndex first = firstWord * 64;
                const PointIndex last = std::min<PointIndex>(m_cloud.size(), lastWord * 64);
                replaced->gatherBits(PointRange{first, last}, to.data() + first);
            });
            m_command.cross(*added.columns[0], std::as_writable_bytes(to));
            preview.attributes.push_back(std::move(wide));
        }
        // the other side of what was done: what it took out comes back
        for (const Attribute& removed : m_effect.removed)
            if (findIn(m_now, removed.name) != nullptr && findIn(preview.attributes, removed.name) == nullptr &&
                removed.size() == m_cloud.size() && findIn(m_effect.added, removed.name) != nullptr &&
                !sameColumns(removed, *findIn(m_now, removed.name)))
                preview.attributes.push_back(removed);
    }

    static bool sameColumns(const Attribute& a, const Attribute& b)
    {
        return a.components == b.components && a.columns == b.columns;
    }

    /// Columns whose values are swapped: those attributes that look otherwise then, and what shows them together.
    void cross(Preview& preview)
    {
        for (const auto& column : m_effect.columns) {
            if (std::none_of(m_now.begin(), m_now.end(), [&](const Attribute& a) { return shows(a, *column); }))
                continue;
            if (m_crossed.contains(column.get())) continue;
            const auto after = std::make_shared<Column>(column->name(), column->type(), column->size());
            after->setAbsent(column->absent());
            const std::size_t bytes = column->elementBytes();
            m_progress.begin("Preview of " + column->name(), m_cloud.size());
            forEachSlab(m_cloud, m_progress, [&](std::size_t firstWord, std::size_t lastWord) {
                const std::size_t first = firstWord * 64,
                                  last = std::min<std::size_t>(m_cloud.size(), lastWord * 64);
                std::memcpy(after->data() + first * bytes, column->data() + first * bytes, (last - first) * bytes);
            });
            m_command.cross(*column, {after->data(), column->size() * bytes});
            m_crossed.emplace(column.get(), after);
        }
        std::vector<Attribute> together;
        for (const Attribute& attribute : m_now) {
            if (findIn(preview.attributes, attribute.name) != nullptr) continue;
            Attribute after = attribute;
            bool other = false;
            for (std::uint32_t c = 0; c < attribute.components; ++c)
                if (const auto found = m_crossed.find(attribute.columns[c].get()); found != m_crossed.end()) {
                    after.columns[c] = found->second;
                    other = true;
                }
            if (!other || differing(attribute, after)->count() == 0) continue;
            (attribute.components == 1 ? preview.attributes : together).push_back(std::move(after));
        }
        preview.attributes.insert(preview.attributes.end(), together.begin(), together.end());
    }

    static bool shows(const Attribute& attribute, const Column& column)
    {
        return std::any_of(attribute.columns.begin(), attribute.columns.end(),
                           [&](const auto& c) { return c.get() == &column; });
    }

    /// Points, but for deleted ones, where they are not the same.
    std::shared_ptr<PointSet> differing(const Attribute& now, const Attribute& after)
    {
        auto points = std::make_shared<PointSet>(m_cloud.size());
        m_progress.begin("Comparing " + now.name, m_cloud.size());
        forEachSlab(m_cloud, m_progress, [&](std::size_t firstWord, std::size_t lastWord) {
            for (std::size_t w = firstWord; w < lastWord; ++w)
                for (std::uint64_t bits = shownBits(m_cloud.size(), m_deleted.get(), w); bits != 0;
                     bits &= bits - 1) {
                    const PointIndex i = PointIndex(w * 64 + std::size_t(std::countr_zero(bits)));
                    if (!sameAt(now, after, i)) points->insert(i);
                }
        });
        return points;
    }

    /// Null where none of them is to be seen changing.
    std::shared_ptr<PointSet> changedPoints(const Preview& preview)
    {
        if (m_effect.deletes)
            if (const auto points = m_command.points()) return std::make_shared<PointSet>(*points);
        std::shared_ptr<PointSet> points;
        for (const Attribute& after : preview.attributes) {
            const Attribute* const now = findIn(m_now, after.name);
            auto some = std::make_shared<PointSet>(m_cloud.size());
            if (now != nullptr && now->components == after.components) {
                some = differing(*now, after);
            } else {
                some->insert(PointRange{0, m_cloud.size()});
                if (m_deleted) some->remove(*m_deleted);
            }
            if (points)
                points->insert(*some);
            else
                points = std::move(some);
        }
        return points;
    }

    /// Which of them is to be seen where the view shows none of them; empty: the points are marked.
    std::string chosen(const Preview& preview, std::string_view shows) const
    {
        if (findIn(preview.attributes, shows) != nullptr) return std::string(shows);
        const Attribute* best = nullptr;
        for (const Attribute& a : preview.attributes)
            if (m_new.contains(a.name) && (best == nullptr || a.components > best->components)) best = &a;
        return best != nullptr ? best->name : std::string();
    }

    std::vector<CommandPreview::ClassChange> countClasses(const Preview& preview)
    {
        const Attribute* const now = findIn(m_now, "Classification");
        const Attribute* const after = findIn(preview.attributes, "Classification");
        if (now == nullptr || now->type() != ScalarType::U8 || (after == nullptr && !m_effect.deletes)) return {};
        std::vector<PointIndex> counts(kClasses * kClasses);
        m_progress.begin("Counting classes", m_cloud.size());
        forEachSlab(m_cloud, m_progress, [&](std::size_t firstWord, std::size_t lastWord) {
            std::map<std::size_t, PointIndex> few;  // of 65,536 points: seldom more than some pairs
            preview.points->forEachInWords(firstWord, lastWord, [&](PointIndex i) {
                ++few[classAt(*now, i) * kClasses + (m_effect.deletes ? 0 : classAt(*after, i))];
            });
            for (const auto& [pair, count] : few)
                std::atomic_ref(counts[pair]).fetch_add(count, std::memory_order_relaxed);
        });
        std::vector<CommandPreview::ClassChange> changes;
        for (std::size_t k = 0; k < counts.size(); ++k) {
            const auto from = std::uint8_t(k / kClasses), to = std::uint8_t(k % kClasses);
            if (counts[k] == 0 || (!m_effect.deletes && from == to)) continue;
            changes.push_back({from, m_effect.deletes ? std::nullopt : std::optional(to), counts[k]});
        }
        std::stable_sort(changes.begin(), changes.end(), [](auto& a, auto& b) { return a.points > b.points; });
        return changes;
    }

    const Command& m_command;
    const PointCloud& m_cloud;
    Progress& m_progress;
    Command::Effect m_effect;
    std::vector<Attribute> m_now;
    std::shared_ptr<const PointSet> m_deleted;
    std::map<const Column*, std::shared_ptr<Column>> m_crossed;
    std::set<std::string> m_new;
};

}  // namespace

CommandPreview previewOf(const Command& command, const PointCloud& cloud, Progress& progress,
                         std::string_view shows)
{
    return Crossing(command, cloud, progress).look(shows);
}

}  // namespace punctum
