// SPDX-License-Identifier: MIT
#include "core/edit/Command.h"

#include "core/Error.h"
#include "core/edit/PackedValues.h"
#include "core/task/LockedLoop.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <mutex>
#include <new>
#include <utility>

namespace punctum
{

namespace
{

/// Words of the set that one task takes at a time: 32,768 points.
constexpr std::size_t kBlockWords = 512;

/// Swaps the masked bits of the members of words [first, last) with `values`.
template <typename T>
void swapBits(const PointSet& points, std::size_t first, std::size_t last, std::byte* column, std::byte* values,
              T mask)
{
    T* const data = reinterpret_cast<T*>(column);
    points.forEachInWords(first, last, [&](PointIndex i) {
        T value;
        std::memcpy(&value, values, sizeof value);  // the vector of bytes promises no alignment
        const T difference = T((data[i] ^ value) & mask);
        data[i] = T(data[i] ^ difference);
        value = T(value ^ difference);
        std::memcpy(values, &value, sizeof value);
        values += sizeof value;
    });
}

void swapBytes(const PointSet& points, std::size_t first, std::size_t last, std::byte* column, std::byte* values,
               std::size_t elementBytes)
{
    points.forEachInWords(first, last, [&](PointIndex i) {
        std::swap_ranges(values, values + elementBytes, column + i * elementBytes);
        values += elementBytes;
    });
}

bool sameShape(const Column& a, const Column& b)
{
    return a.type() == b.type() && a.components() == b.components() && a.size() == b.size();
}

bool contains(const std::vector<std::shared_ptr<Column>>& columns, const std::shared_ptr<Column>& column)
{
    return std::find(columns.begin(), columns.end(), column) != columns.end();
}

/// Adds the attribute, and those of its columns that the cloud does not have yet.
void addWithColumns(PointCloud& cloud, const Attribute& attribute)
{
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        if (!contains(cloud.columns(), attribute.columns[c])) cloud.addColumn(attribute.columns[c]);
    cloud.addAttribute(attribute);
}

}  // namespace

Command::Command(std::string name) : m_name(std::move(name)) {}

ValueCommand::ValueCommand(std::string name, const Attribute& attribute, std::shared_ptr<const PointSet> points,
                           std::vector<std::byte> values)
    : Command(std::move(name)),
      m_notice{ChangeNotice::Kind::Values, {attribute.name}, points},
      m_column(attribute.columns[0]),
      m_points(std::move(points)),
      m_ranks(m_points->ranks(kBlockWords)),
      m_count(m_ranks.back()),
      m_values(std::move(values))
{
    assert(m_points->size() == m_column->size());
    assert(m_values->size() == m_count * m_column->elementBytes());
    if (attribute.bitWidth != 0) m_mask = attribute.maxBits() << attribute.bitShift;
}

void ValueCommand::apply(PointCloud& cloud) noexcept
{
    {
        const std::unique_lock lock(cloud.mutex());
        std::byte* const column = m_column->data();
        const std::size_t bytes = m_column->elementBytes();
        forPiecesLocked(lock, m_points->words().size(), kBlockWords, [&](std::size_t first, std::size_t last) {
            std::byte* const values = m_values->data() + m_ranks[first / kBlockWords] * bytes;
            switch (bytes) {
                case 1:
                    swapBits(*m_points, first, last, column, values, std::uint8_t(m_mask));
                    break;
                case 2:
                    swapBits(*m_points, first, last, column, values, std::uint16_t(m_mask));
                    break;
                case 4:
                    swapBits(*m_points, first, last, column, values, std::uint32_t(m_mask));
                    break;
                case 8:
                    swapBits(*m_points, first, last, column, values, m_mask);
                    break;
                default:
                    swapBytes(*m_points, first, last, column, values, bytes);
            }
        });
    }
    cloud.notify(m_notice);
}

/// One element for each point.
std::vector<std::byte> ValueCommand::values() const
{
    std::vector<std::byte> kept = m_values.copy();
    if (!m_packed) return kept;
    auto values = unpackedRuns(kept, m_column->elementBytes(), m_count);
    if (!values) throw Error("What this edit needs was damaged on the disk; the points stay as they are.");
    return std::move(*values);
}

void ValueCommand::prepare()
{
    m_stowed = false;
    m_points.fetch();
    m_notice.points = m_points.points();
    m_ranks = m_points->ranks(kBlockWords);
    m_values.fetch();
    if (m_packed) *m_values = values();
    m_packed = false;
}

void ValueCommand::stow() noexcept
{
    if (std::exchange(m_stowed, true)) return;
    try {
        m_points.stow();
        m_notice.points.reset();
        m_ranks = {};
        if (m_packed || m_values.spilled() != 0) return;
        if (auto packed = packedRuns(*m_values, m_column->elementBytes())) {
            *m_values = std::move(*packed);
            m_packed = true;
        }
    } catch (const std::bad_alloc&) {
        // then it stays as it is, which is as good
    }
}

void ValueCommand::spill(SpillFile& file)
{
    m_points.spill(file);
    m_values.spill(file);
}

std::size_t ValueCommand::memory() const noexcept
{
    return m_points.memory() + m_values.memory() + m_ranks.size() * sizeof m_ranks[0];
}

void ValueCommand::cross(const Column& column, std::span<std::byte> values) const
{
    if (&column != m_column.get()) return;
    const std::size_t bytes = column.elementBytes();
    const std::vector<std::byte> ourValues = this->values();
    const std::byte* theirs = ourValues.data();
    std::byte mask[sizeof m_mask];
    std::memcpy(mask, &m_mask, sizeof mask);
    m_points.points()->forEach([&](PointIndex i) {
        std::byte* const ours = values.data() + i * bytes;
        for (std::size_t k = 0; k < bytes; ++k) {
            const std::byte m = k < sizeof mask ? mask[k] : std::byte(0xFF);
            ours[k] = (ours[k] & ~m) | (theirs[k] & m);
        }
        theirs += bytes;
    });
}

AttributesCommand::AttributesCommand(std::string name, std::vector<Attribute> attributes)
    : Command(std::move(name)), m_attributes(std::move(attributes))
{
    if (!m_attributes.empty()) m_changedPoints = m_attributes.front().size();
}

/// Whether `ours` can take the place of `theirs`, given the trades planned before; plans it if so.
bool AttributesCommand::planTrade(const PointCloud& cloud, const Attribute& theirs, const Attribute& ours)
{
    if (theirs.components != ours.components || theirs.bitWidth != 0 || ours.bitWidth != 0) return false;
    if (theirs.scaled != ours.scaled || theirs.scale != ours.scale || theirs.offset != ours.offset) return false;
    auto planned = m_trades;
    for (std::uint32_t c = 0; c < ours.components; ++c) {
        const Trade trade{theirs.columns[c], ours.columns[c]};
        if (!sameShape(*trade.theirs, *trade.ours)) return false;
        if (trade.theirs == trade.ours || std::find(planned.begin(), planned.end(), trade) != planned.end())
            continue;
        if (contains(cloud.columns(), trade.ours)) return false;  // it would lose what it has for others
        for (const Trade& other : planned)
            if (other.theirs == trade.theirs || other.ours == trade.ours) return false;
        planned.push_back(trade);
    }
    m_trades = std::move(planned);
    return true;
}

void AttributesCommand::plan(const PointCloud& cloud)
{
    m_values.kind = ChangeNotice::Kind::Values;
    m_list.kind = ChangeNotice::Kind::Attributes;
    if (const auto& deleted = cloud.deleted()) m_changedPoints -= std::min(m_changedPoints, deleted->count());
    for (Attribute& attribute : m_attributes) {
        const Attribute* const there = cloud.findAttribute(attribute.name);
        if (there != nullptr && planTrade(cloud, *there, attribute)) {
            m_values.attributes.push_back(attribute.name);
            continue;
        }
        if (there != nullptr) m_displaced.push_back(*there);
        m_list.attributes.push_back(attribute.name);
        m_added.push_back(std::move(attribute));
    }
    m_attributes.clear();
    // What is added may show a column that traded places: the new values are in the cloud's column then.
    for (Attribute& attribute : m_added)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            for (const Trade& trade : m_trades)
                if (trade.ours == attribute.columns[c]) attribute.columns[c] = trade.theirs;
}

void AttributesCommand::apply(PointCloud& cloud) noexcept
{
    {
        const std::unique_lock lock(cloud.mutex());
        // Made once: a command is undone and redone on the same state of the cloud.
        if (!std::exchange(m_planned, true)) plan(cloud);
        for (const Trade& trade : m_trades) std::swap(*trade.theirs, *trade.ours);
        for (const Attribute& attribute : m_done ? m_added : m_displaced) cloud.removeAttribute(attribute.name);
        for (const Attribute& attribute : m_done ? m_displaced : m_added) addWithColumns(cloud, attribute);
        m_done = !m_done;
        keepDetached(cloud);
    }
    if (!m_list.attributes.empty()) cloud.notify(m_list);
    if (!m_values.attributes.empty()) cloud.notify(m_values);
}

void AttributesCommand::keepDetached(const PointCloud& cloud)
{
    m_detached.clear();
    for (const Trade& trade : m_trades) m_detached.add(trade.ours);
    for (const Attribute& attribute : m_done ? m_displaced : m_added)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            if (!contains(cloud.columns(), attribute.columns[c])) m_detached.add(attribute.columns[c]);
}

Command::Effect AttributesCommand::effect() const
{
    Effect effect;
    for (const Trade& trade : m_trades) effect.columns.push_back(trade.theirs);
    effect.added = m_added;
    effect.removed = m_displaced;
    return effect;
}

void AttributesCommand::cross(const Column& column, std::span<std::byte> values) const
{
    for (const Trade& trade : m_trades)
        if (trade.theirs.get() == &column) std::memcpy(values.data(), trade.ours->data(), values.size());
}

}  // namespace punctum
