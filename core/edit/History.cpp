// SPDX-License-Identifier: MIT
#include "core/edit/History.h"

#include "core/Memory.h"
#include "core/edit/Command.h"
#include "core/edit/Journal.h"
#include "core/edit/SpillFile.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

namespace punctum
{

namespace
{

constexpr PointIndex kCompareGrain = 1 << 16;

/// Points whose value of the attribute differs between the column and these values of it, without those of
/// `leftOut` (null: none).
PointIndex countDifferent(const Attribute& attribute, std::span<const std::byte> before, const PointSet* leftOut,
                          Progress& progress)
{
    const Column& column = *attribute.columns[0];
    const std::size_t bytes = column.elementBytes();
    const std::uint64_t mask =
        attribute.bitWidth == 0 ? ~std::uint64_t(0) : attribute.maxBits() << attribute.bitShift;
    const auto differs = [&](PointIndex i) {
        if (leftOut != nullptr && leftOut->contains(i)) return false;
        const std::byte *a = before.data() + i * bytes, *b = column.data() + i * bytes;
        if (bytes > sizeof mask) return std::memcmp(a, b, bytes) != 0;
        std::uint64_t x = 0, y = 0;
        std::memcpy(&x, a, bytes);
        std::memcpy(&y, b, bytes);
        return ((x ^ y) & mask) != 0;
    };
    const PointIndex n = tbb::parallel_reduce(
        tbb::blocked_range<PointIndex>(0, column.size(), kCompareGrain), PointIndex(0),
        [&](const tbb::blocked_range<PointIndex>& r, PointIndex sum) {
            if (!progress.cancelled())
                for (PointIndex i = r.begin(); i != r.end(); ++i) sum += differs(i) ? 1 : 0;
            return sum;
        },
        std::plus<>());
    progress.check();
    return n;
}

template <typename List, typename Item>
bool contains(const List& list, const Item& item)
{
    return std::find(list.begin(), list.end(), item) != list.end();
}

/// The columns of which some of the commands swap values.
std::vector<std::shared_ptr<Column>> swappedColumns(const std::vector<const Command*>& way)
{
    std::vector<std::shared_ptr<Column>> columns;
    for (const Command* command : way)
        for (const auto& column : command->effect().columns)
            if (!contains(columns, column)) columns.push_back(column);
    return columns;
}

/// A column's values on the other side of all the commands.
Buffer valuesBefore(const Column& column, const std::vector<const Command*>& way, Progress& progress)
{
    const std::size_t bytes = std::size_t(column.size()) * column.elementBytes();
    Buffer before(bytes);
    std::memcpy(before.data(), column.data(), bytes);
    for (const Command* command : way) {
        progress.check();
        command->cross(column, {before.data(), bytes});
    }
    return before;
}

bool hasMember(const PointSet& points, PointRange range)
{
    for (PointIndex i = range.first; i < range.last; i = (i / 64 + 1) * 64) {
        std::uint64_t bits = points.words()[i / 64] >> (i % 64);
        if (const PointIndex left = range.last - i; left < 64) bits &= (std::uint64_t(1) << left) - 1;
        if (bits != 0) return true;
    }
    return false;
}

}  // namespace

std::size_t HistoryRoom::defaultMemory() noexcept
{
    constexpr std::size_t kLeast = std::size_t(256) << 20;
    return std::max(kLeast, std::size_t(memoryBudget() / 16));
}

void History::push(std::unique_ptr<Command> command)
{
    if (command == nullptr) return;
    command->prepare();
    std::vector<std::unique_ptr<Command>> forgotten;  // destroyed last, outside both locks: they may be large
    const std::lock_guard changing(m_changing);
    {
        const std::lock_guard lock(m_mutex);
        m_commands.reserve(m_commands.size() + 1);  // whatever can fail fails before the points change
        forgotten.reserve(m_commands.size() - m_done + 1);
    }
    if (const auto journal = this->journal()) journal->done(*command);
    command->dropRecipe();  // its set may be large
    command->apply(*m_cloud);
    {
        const std::lock_guard lock(m_mutex);
        const auto undone = m_commands.begin() + std::ptrdiff_t(m_done);
        forgotten.assign(std::make_move_iterator(undone), std::make_move_iterator(m_commands.end()));
        m_commands.erase(undone, m_commands.end());
        if (m_saved > std::ptrdiff_t(m_done)) m_saved = -1;
        if (!m_room.undo) {
            m_saved = -1;
            forgotten.push_back(std::move(command));
            return;
        }
        m_commands.push_back(std::move(command));
        ++m_done;
    }
    stowDistant();
}

void History::undo()
{
    move(false);
}

void History::redo()
{
    move(true);
}

void History::move(bool forward)
{
    const std::lock_guard changing(m_changing);
    if (forward ? !canRedo() : !canUndo()) return;
    // Only a change alters m_commands and m_done, and changes take turns: reading them here needs no lock.
    Command& command = *m_commands[forward ? m_done : m_done - 1];
    command.prepare();
    if (const auto journal = this->journal()) journal->moved(command, *m_cloud, forward);
    command.apply(*m_cloud);
    {
        const std::lock_guard lock(m_mutex);
        forward ? ++m_done : --m_done;
    }
    stowDistant();
}

/// Commands near the present state are at hand at once; the others are put together once they take too much, and
/// the farthest go to the file. Takes a while: what the window asks meanwhile is answered, as only a change alters
/// the list.
void History::stowDistant() noexcept
{
    std::size_t bytes = 0;
    bool over = false, takes = !m_room.folder.empty();
    Kept kept;
    const auto visit = [&](Command& command) {
        bytes += command.memory();
        const auto tooMuch = [&] { return over || kept.memory + command.memory() > m_room.memory; };
        if (bytes > m_room.loose || tooMuch()) command.stow();
        over = tooMuch();
        if (over && takes && command.memory() > 0) takes = spill(command);
        kept.memory += command.memory();
        kept.file += command.spilled();
    };
    for (std::size_t step = 0; step < m_commands.size(); ++step) {
        if (step < m_done) visit(*m_commands[m_done - 1 - step]);
        if (m_done + step < m_commands.size()) visit(*m_commands[m_done + step]);
    }
    const std::lock_guard lock(m_mutex);
    m_kept = kept;
}

/// Whether it is worth trying with the next one.
bool History::spill(Command& command) noexcept
{
    try {
        if (!m_file) m_file = SpillFile::create(m_room.folder);
        command.spill(*m_file);
        return true;
    } catch (const std::exception& e) {
        const std::lock_guard lock(m_mutex);
        if (!std::exchange(m_warned, true)) m_warning = e.what();
        return false;
    }
}

void History::setJournal(std::shared_ptr<Journal> journal)
{
    const std::lock_guard lock(m_mutex);
    std::vector<Identity> commands;
    for (const auto& command : m_commands) commands.push_back(command->identity());
    if (journal) journal->recognize(commands, m_done);
    m_journal = std::move(journal);
}

std::shared_ptr<Journal> History::journal() const
{
    const std::lock_guard lock(m_mutex);
    return m_journal;
}

bool History::canUndo() const
{
    const std::lock_guard lock(m_mutex);
    return m_done > 0;
}

bool History::canRedo() const
{
    const std::lock_guard lock(m_mutex);
    return m_done < m_commands.size();
}

std::string History::undoName() const
{
    const std::lock_guard lock(m_mutex);
    return m_done > 0 ? m_commands[m_done - 1]->name() : std::string();
}

std::string History::redoName() const
{
    const std::lock_guard lock(m_mutex);
    return m_done < m_commands.size() ? m_commands[m_done]->name() : std::string();
}

bool History::modified() const
{
    const std::lock_guard lock(m_mutex);
    return m_saved != std::ptrdiff_t(m_done);
}

void History::markSaved()
{
    const std::lock_guard lock(m_mutex);
    m_saved = std::ptrdiff_t(m_done);
}

void History::forgetSaved()
{
    const std::lock_guard lock(m_mutex);
    m_saved = -1;
}

/// The commands from now to the saved state, in the order in which they are to be crossed; nothing where it cannot
/// be reached. Hold m_changing.
std::optional<std::vector<const Command*>> History::wayToSaved() const
{
    const std::lock_guard lock(m_mutex);
    if (m_saved < 0) return std::nullopt;
    std::vector<const Command*> way;
    const auto saved = std::size_t(m_saved);
    for (std::size_t k = m_done; k > saved; --k) way.push_back(m_commands[k - 1].get());
    for (std::size_t k = m_done; k < saved; ++k) way.push_back(m_commands[k].get());
    return way;
}

std::optional<std::vector<bool>> History::changedIn(std::span<const PointRange> ranges, Progress& progress) const
{
    const std::lock_guard changing(m_changing);  // nobody else writes to the cloud's columns meanwhile
    const auto way = wayToSaved();
    if (!way) return std::nullopt;
    std::vector<bool> changed(ranges.size(), false);
    for (const auto& column : swappedColumns(*way)) {
        const Buffer before = valuesBefore(*column, *way, progress);
        const std::size_t bytes = column->elementBytes();
        for (std::size_t k = 0; k < ranges.size(); ++k)
            changed[k] = changed[k] || std::memcmp(before.data() + ranges[k].first * bytes,
                                                   column->data() + ranges[k].first * bytes,
                                                   std::size_t(ranges[k].size()) * bytes) != 0;
    }
    for (const Command* command : *way) {
        const Command::Effect effect = command->effect();
        if (!effect.added.empty() || !effect.removed.empty()) {
            changed.assign(ranges.size(), true);
            break;
        }
        if (!effect.deletes) continue;
        const auto points = command->points();
        for (std::size_t k = 0; k < ranges.size(); ++k)
            changed[k] = changed[k] || !points || hasMember(*points, ranges[k]);
    }
    return changed;
}

CommandPreview History::beforeLast(Progress& progress) const
{
    const std::lock_guard changing(m_changing);  // nobody else writes to the cloud's columns meanwhile
    const Command* last = nullptr;
    {
        const std::lock_guard lock(m_mutex);
        if (m_done > 0) last = m_commands[m_done - 1].get();
    }
    return last != nullptr ? previewOf(*last, *m_cloud, progress) : CommandPreview();
}

std::optional<std::vector<AttributeChange>> History::changes(Progress& progress) const
{
    const std::lock_guard changing(m_changing);  // nobody else writes to the cloud's columns meanwhile
    const auto reachable = wayToSaved();
    if (!reachable) return std::nullopt;
    const std::vector<const Command*>& way = *reachable;

    const bool back = !way.empty() && m_done > std::size_t(m_saved);
    std::vector<std::string> added, replaced;  // since the saved state
    for (auto command = way.rbegin(); command != way.rend(); ++command) {
        const Command::Effect effect = (*command)->effect();
        const auto& gone = back ? effect.removed : effect.added;
        for (const Attribute& a : gone) std::erase(added, a.name);
        for (const Attribute& a : back ? effect.added : effect.removed) {
            added.push_back(a.name);
            const auto sameName = [&](const Attribute& old) { return old.name == a.name && old.components == 1; };
            if (std::any_of(gone.begin(), gone.end(), sameName) && !contains(replaced, a.name))
                replaced.push_back(a.name);
        }
    }

    std::vector<AttributeChange> found;
    const PointIndex deleted = m_cloud->deleted() ? m_cloud->deleted()->count() : 0;
    found.reserve(replaced.size());
    for (const std::string& name : replaced) found.push_back({name, m_cloud->size() - deleted});
    for (const auto& column : swappedColumns(way)) {
        const std::size_t bytes = std::size_t(column->size()) * column->elementBytes();
        const Buffer before = valuesBefore(*column, way, progress);
        for (const Attribute& a : m_cloud->attributes()) {
            if (a.components != 1 || a.columns[0] != column || contains(added, a.name)) continue;
            if (const PointIndex n = countDifferent(a, {before.data(), bytes}, m_cloud->deleted().get(), progress);
                n != 0)
                found.push_back({a.name, n});
        }
    }
    return found;
}

std::vector<std::string> History::names() const
{
    const std::lock_guard lock(m_mutex);
    std::vector<std::string> names;
    names.reserve(m_commands.size());
    for (const auto& command : m_commands) names.push_back(command->name());
    return names;
}

std::vector<PointIndex> History::changedPoints() const
{
    const std::lock_guard lock(m_mutex);
    std::vector<PointIndex> counts;
    counts.reserve(m_commands.size());
    for (const auto& command : m_commands) counts.push_back(command->changedPoints());
    return counts;
}

History::Kept History::kept() const
{
    const std::lock_guard lock(m_mutex);
    return m_kept;
}

std::string History::takeWarning()
{
    const std::lock_guard lock(m_mutex);
    return std::exchange(m_warning, {});
}

std::size_t History::position() const
{
    const std::lock_guard lock(m_mutex);
    return m_done;
}

}  // namespace punctum
