// SPDX-License-Identifier: MIT
#include "core/edit/Journal.h"

#include "core/Error.h"
#include "core/SummedText.h"
#include "core/edit/Command.h"
#include "core/edit/Literal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace punctum
{

namespace
{

std::string readAll(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error(path, "the journal cannot be opened.");
    return {std::istreambuf_iterator<char>(in), {}};
}

[[noreturn]] void failWriting(const std::filesystem::path& path)
{
    throw Error(path, std::string("the journal cannot be written: ") + std::strerror(errno) + ".");
}

int openLocked(const std::filesystem::path& path, int flags)
{
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | flags, 0600);
    if (file < 0) failWriting(path);
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
        ::close(file);
        throw Error(path, "another window writes this journal.");
    }
    return file;
}

}  // namespace

std::unique_ptr<Journal> Journal::create(const std::filesystem::path& path, const CloudKey& key,
                                         const std::string& file, std::shared_ptr<const KeptPoints> kept)
{
    std::error_code ignored;
    std::filesystem::create_directories(path.parent_path(), ignored);
    std::unique_ptr<Journal> journal(new Journal(path, openLocked(path, O_CREAT)));
    if (journalHasEdits(path)) {
        const std::filesystem::path aside = setJournalAside(path);
        journal.reset(new Journal(path, openLocked(path, O_CREAT | O_EXCL)));
        journal->m_setAside = aside;
    }
    journal->m_kept = std::move(kept);
    if (::ftruncate(journal->m_file, 0) != 0) failWriting(path);
    journal->add(std::string(kJournalFirstLine));
    journal->add(journalCloudLine(key, file));
    return journal;
}

std::unique_ptr<Journal> Journal::resume(const std::filesystem::path& path)
{
    std::unique_ptr<Journal> journal(new Journal(path, openLocked(path, 0)));
    const SoundJournal sound = soundPart(path, readAll(path));
    if (::ftruncate(journal->m_file, off_t(sound.bytes)) != 0 || ::lseek(journal->m_file, 0, SEEK_END) < 0)
        failWriting(path);
    journal->m_sum = sound.sum;
    journal->m_moves.resize(sound.position + sound.undone);
    journal->m_position = sound.position;
    return journal;
}

void Journal::recognize(const std::vector<Identity>& history, std::size_t done) noexcept
{
    const std::lock_guard lock(m_mutex);
    if (done < m_position || history.size() - done < m_moves.size() - m_position) return;
    for (std::size_t k = 0; k < m_moves.size(); ++k) m_moves[k].command = history[done - m_position + k];
}

Journal::~Journal()
{
    if (m_file >= 0) ::close(m_file);
}

void Journal::add(const std::string& line)
{
    std::uint32_t sum = m_sum;
    const std::string whole = summed(line, sum);
    for (std::size_t at = 0; at < whole.size();) {
        const ssize_t n = ::write(m_file, whole.data() + at, whole.size() - at);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) failWriting(m_path);
        at += std::size_t(n);
    }
    if (::fdatasync(m_file) != 0 && errno != EINVAL && errno != EROFS) failWriting(m_path);
    m_sum = sum;
}

template <typename Work>
void Journal::guarded(Work work) noexcept
{
    const std::lock_guard lock(m_mutex);
    if (m_file < 0 || !m_failure.empty()) return;
    try {
        work();
    } catch (const std::exception& e) {
        m_failure = e.what();
    }
}

/// `recipe`: with points of the cloud; the entry has their places in the file.
JournalEntry Journal::entryOf(const Command& command, Recipe recipe) const
{
    JournalEntry entry;
    entry.changed = command.changedPoints();
    entry.name = command.name();
    entry.recipe = std::move(recipe);
    if (!m_kept) return entry;
    auto& within = entry.recipe.within;
    if (within) within = std::make_shared<PointSet>(m_kept->places(*within));
    const auto points = command.points();
    if (points && m_kept->places(*points).count() != entry.changed)
        throw Error("It concerns points that were deleted when the file was saved. Save once.");
    if (!points) entry.changed = std::min(entry.changed, m_kept->count());  // it changes all points that there are
    return entry;
}

/// What is undone is forgotten, and a move follows that is told by an entry.
template <typename MakeEntry>
void Journal::push(const Identity& command, bool forward, MakeEntry makeEntry)
{
    m_moves.resize(m_position);
    Move move{command, forward, m_gap.empty()};
    std::string line;
    if (move.noted) {
        try {
            line = journalLine(makeEntry());
        } catch (const std::exception& e) {
            m_gap = e.what();
            move.noted = false;
        }
    }
    if (move.noted) add(line);
    m_moves.push_back(move);
    ++m_position;
}

void Journal::done(const Command& command) noexcept
{
    guarded([&] {
        push(command.identity(), true, [&] {
            if (!command.recipe()) throw Error("\"" + command.name() + "\" cannot be noted in the journal.");
            return entryOf(command, *command.recipe());
        });
    });
}

void Journal::moved(const Command& command, const PointCloud& cloud, bool forward) noexcept
{
    const auto is = [&](const Move& move, bool direction) {
        return move.command == command.identity() && move.forward == direction;
    };
    guarded([&] {
        if (m_position > 0 && is(m_moves[m_position - 1], !forward)) {
            --m_position;
            if (m_moves[m_position].noted) return add("undo");
            if (m_position == 0 || m_moves[m_position - 1].noted) m_gap.clear();
        } else if (m_position < m_moves.size() && m_moves[m_position].noted && is(m_moves[m_position], forward)) {
            ++m_position;
            add("redo");
        } else {
            push(command.identity(), forward, [&] {
                JournalEntry entry = entryOf(command, literalOf(command, cloud, forward, m_kept.get()));
                entry.name = literalName(entry.recipe);
                return entry;
            });
        }
    });
}

std::string Journal::failure() const
{
    const std::lock_guard lock(m_mutex);
    return m_failure.empty() ? m_gap : m_failure;
}

void Journal::remove() noexcept
{
    const std::lock_guard lock(m_mutex);
    if (m_file < 0) return;
    ::unlink(m_path.c_str());
    ::close(m_file);
    m_file = -1;
}

JournalContents readJournal(const std::filesystem::path& path)
{
    return soundPart(path, readAll(path)).contents;
}

std::filesystem::path setJournalAside(const std::filesystem::path& path)
{
    constexpr int kMost = 1000;
    for (int k = 1; k <= kMost; ++k) {
        std::filesystem::path aside = path.string() + (k == 1 ? "" : "-" + std::to_string(k)) + ".declined";
        if (::link(path.c_str(), aside.c_str()) == 0) {
            ::unlink(path.c_str());
            return aside;
        }
        if (errno == EEXIST) continue;
        // a disk without hard links
        if (std::filesystem::exists(aside)) continue;
        if (::rename(path.c_str(), aside.c_str()) == 0) return aside;
        break;
    }
    throw Error(path, std::string("the journal cannot be set aside: ") + std::strerror(errno) + ".");
}

bool journalHasEdits(const std::filesystem::path& path)
{
    if (!std::filesystem::is_regular_file(path)) return false;
    const std::string text = readAll(path);
    return std::count(text.begin(), text.end(), '\n') > 2;
}

bool isJournalInUse(const std::filesystem::path& path)
{
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool locked = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(file);
    return locked;
}

}  // namespace punctum
