// SPDX-License-Identifier: MIT
#include "core/edit/Journal.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/edit/Command.h"
#include "core/edit/PackedSet.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <shared_mutex>
#include <string_view>

namespace punctum
{

namespace
{

constexpr std::string_view kFirstLine = "punctum-journal 1";
constexpr std::size_t kSumDigits = 8;

// -- checksums

/// CRC-32 (IEEE 802.3), which finds every burst of up to 32 bits.
std::uint32_t crc32(std::uint32_t crc, std::string_view text) noexcept
{
    static const auto table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t n = 0; n < 256; ++n) {
            std::uint32_t c = n;
            for (int k = 0; k < 8; ++k) c = (c & 1u) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
            t[n] = c;
        }
        return t;
    }();
    crc = ~crc;
    for (const char c : text) crc = table[(crc ^ static_cast<unsigned char>(c)) & 255u] ^ (crc >> 8);
    return ~crc;
}

std::uint64_t mixed(std::uint64_t v) noexcept  // the finalizer of MurmurHash3
{
    v = (v ^ (v >> 33)) * 0xFF51AFD7ED558CCDu;
    v = (v ^ (v >> 33)) * 0xC4CEB9FE1A85EC53u;
    return v ^ (v >> 33);
}

std::uint64_t digestOf(const std::byte* bytes, std::size_t n, std::uint64_t seed) noexcept
{
    // four lanes, so that multiplications overlap
    std::array<std::uint64_t, 4> lanes{seed, seed + 1, seed + 2, seed + 3};
    std::size_t at = 0;
    for (; at + 32 <= n; at += 32)
        for (std::size_t lane = 0; lane < 4; ++lane) {
            std::uint64_t v;
            std::memcpy(&v, bytes + at + 8 * lane, sizeof v);
            lanes[lane] = std::rotl((lanes[lane] ^ v) * 0x9E3779B97F4A7C15u, 29);
        }
    for (; at < n; ++at)
        lanes[0] = std::rotl((lanes[0] ^ std::to_integer<std::uint64_t>(bytes[at])) * 0x9E3779B97F4A7C15u, 29);
    std::uint64_t sum = n;
    for (const std::uint64_t lane : lanes) sum = mixed(sum ^ lane);
    return sum;
}

/// The name that a file has for it: that of the attribute that shows it, where it was renamed.
std::string nameOf(const Column& column, const PointCloud& cloud)
{
    for (const Attribute& a : cloud.attributes())
        if (!a.standard && a.components == 1 && a.columns[0].get() == &column) return a.name;
    return column.name();
}

void takeKept(const Column& column, const KeptPoints& kept, std::byte* out)
{
    const std::size_t bytes = column.elementBytes();
    for (const PointRange& run : kept.ranges()) {
        const auto n = std::size_t(run.size()) * bytes;
        std::memcpy(out, column.data() + run.first * bytes, n);
        out += n;
    }
}

// -- text

std::string hex(std::uint64_t v, int digits)
{
    std::string text(std::size_t(digits), '0');
    for (int k = digits - 1; k >= 0; --k, v >>= 4) text[std::size_t(k)] = "0123456789abcdef"[v & 15u];
    return text;
}

template <typename T>
bool parse(std::string_view text, T& out, int base = 10)
{
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out, base);
    return error == std::errc() && end == text.data() + text.size();
}

/// A word without blanks: what is no plain letter is written as %41.
std::string escaped(std::string_view text)
{
    std::string word;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                           std::string_view("._-/:+*()<>,").find(c) != std::string_view::npos;
        if (plain)
            word += c;
        else
            word += '%' + hex(byte, 2);
    }
    return word.empty() ? std::string("%") : word;
}

std::optional<std::string> unescaped(std::string_view word)
{
    if (word == "%") return std::string();
    std::string text;
    for (std::size_t k = 0; k < word.size(); ++k) {
        if (word[k] != '%') {
            text += word[k];
            continue;
        }
        unsigned byte = 0;
        if (k + 2 >= word.size() || !parse(word.substr(k + 1, 2), byte, 16)) return {};
        text += char(byte);
        k += 2;
    }
    return text;
}

std::vector<std::string_view> words(std::string_view line)
{
    std::vector<std::string_view> all;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find(' '), line.size());
        all.push_back(line.substr(0, end));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return all;
}

/// `kept` (null: all): the points of the cloud that the file holds.
std::string lineOf(const Command& command, const KeptPoints* kept)
{
    const Recipe& recipe = *command.recipe();
    PointIndex changed = command.changedPoints();
    std::optional<PackedSet> within;
    if (recipe.within) within.emplace(kept ? kept->places(*recipe.within) : *recipe.within);
    if (kept) {
        const auto points = command.points();
        if (points && kept->places(*points).count() != changed)
            throw Error("It concerns points that were deleted when the file was saved. Save once.");
        if (!points) changed = std::min(changed, kept->count());  // it changes all points that there are
    }
    std::string line = "do " + std::to_string(changed) + " " + escaped(command.name()) + " " + escaped(recipe.step);
    for (const auto& [key, value] : recipe.values) line += " " + escaped(key) + "=" + escaped(value);
    if (within) line += " @" + within->text();
    return line;
}

std::optional<JournalEntry> entryOf(std::string_view line, PointIndex size)
{
    const auto all = words(line);
    JournalEntry entry;
    if (all.size() == 1 && all[0] == "undo") {
        entry.kind = JournalEntry::Kind::Undo;
        return entry;
    }
    if (all.size() == 1 && all[0] == "redo") {
        entry.kind = JournalEntry::Kind::Redo;
        return entry;
    }
    if (all.size() < 4 || all[0] != "do" || !parse(all[1], entry.changed)) return {};
    const auto name = unescaped(all[2]), step = unescaped(all[3]);
    if (!name || !step) return {};
    entry.name = *name;
    entry.recipe.step = *step;
    for (std::size_t k = 4; k < all.size(); ++k) {
        if (all[k].starts_with('@')) {
            const auto set = PackedSet::fromText(all[k].substr(1), size);
            if (!set) return {};
            entry.recipe.within = std::make_shared<PointSet>(set->unpacked());
            continue;
        }
        const std::size_t equals = all[k].find('=');
        if (equals == std::string_view::npos) return {};
        const auto key = unescaped(all[k].substr(0, equals)), value = unescaped(all[k].substr(equals + 1));
        if (!key || !value) return {};
        entry.recipe.values[*key] = *value;
    }
    return entry;
}

/// What of a journal's bytes is sound.
struct Sound {
    JournalContents contents;
    std::uint32_t sum = 0;  ///< of the last sound line
    std::size_t bytes = 0;  ///< up to its end
    std::ptrdiff_t position = 0;
    std::size_t undone = 0;  ///< commands that can be redone
};

Sound soundPart(const std::filesystem::path& path, const std::string& text)
{
    Sound sound;
    std::size_t number = 0;
    const auto damaged = [&](const std::string& what) {
        sound.contents.damage =
            "The journal is " + what + " in line " + std::to_string(number) + "; the " +
            (sound.contents.entries.size() == 1 ? std::string("entry")
                                                : grouped(sound.contents.entries.size()) + " entries") +
            " before can be used.";
    };
    for (std::size_t at = 0; at < text.size(); at = sound.bytes) {
        ++number;
        const std::size_t end = text.find('\n', at);
        if (end == std::string::npos) {
            damaged("cut off");
            break;
        }
        const std::string_view whole(text.data() + at, end - at);
        std::uint32_t sum = 0;
        const bool summed = whole.size() > kSumDigits + 1 && whole[whole.size() - kSumDigits - 1] == ' ' &&
                            parse(whole.substr(whole.size() - kSumDigits), sum, 16);
        const std::string_view line = summed ? whole.substr(0, whole.size() - kSumDigits - 1) : whole;
        if (!summed || crc32(sound.sum, line) != sum) {
            damaged("damaged");
            break;
        }
        const auto all = words(line);
        if (number == 1) {
            if (line != kFirstLine) break;
        } else if (number == 2) {
            CloudKey& key = sound.contents.key;
            const auto file = all.size() == 4 ? unescaped(all[3]) : std::nullopt;
            if (!file || all[0] != "cloud" || !parse(all[1], key.points) || !parse(all[2], key.digest, 16)) break;
            sound.contents.file = *file;
        } else {
            auto entry = entryOf(line, sound.contents.key.points);
            const bool fits =
                entry && (entry->kind == JournalEntry::Kind::Do ||
                          (entry->kind == JournalEntry::Kind::Undo ? sound.position > 0 : sound.undone > 0));
            if (!fits) {
                damaged("not understood");
                break;
            }
            switch (entry->kind) {
                case JournalEntry::Kind::Do:
                    ++sound.position;
                    sound.undone = 0;
                    break;
                case JournalEntry::Kind::Undo:
                    --sound.position;
                    ++sound.undone;
                    break;
                case JournalEntry::Kind::Redo:
                    ++sound.position;
                    --sound.undone;
            }
            sound.contents.entries.push_back(std::move(*entry));
        }
        sound.sum = sum;
        sound.bytes = end + 1;
    }
    if (sound.contents.key.points == 0 && sound.contents.entries.empty() && sound.contents.file.empty())
        throw Error(path, "this is no journal of Punctum, or its beginning is damaged.");
    return sound;
}

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

std::string CloudKey::text() const
{
    return std::to_string(points) + "-" + hex(digest, 16);
}

CloudKey keyOf(const PointCloud& cloud, Progress& progress, const KeptPoints* kept)
{
    const std::shared_lock lock(cloud.mutex());
    std::size_t total = 0;
    for (const auto& column : cloud.columns()) total += column->size() * column->elementBytes();
    progress.begin("Looking at the points", total);
    constexpr std::size_t kPiece = 1 << 20;  // bytes that one task digests
    CloudKey key;
    key.points = kept ? kept->count() : cloud.size();
    const CoordinateScale& grid = cloud.coordinates();
    for (int axis = 0; axis < 3; ++axis)
        key.digest = mixed(mixed(key.digest ^ std::bit_cast<std::uint64_t>(grid.scale[axis])) ^
                           std::bit_cast<std::uint64_t>(grid.offset[axis]));
    for (const auto& column : cloud.columns()) {
        const std::size_t bytes = std::size_t(key.points) * column->elementBytes();
        Buffer copy(kept ? bytes : 0);
        if (kept) takeKept(*column, *kept, copy.data());
        const std::byte* const data = kept ? copy.data() : column->data();
        std::vector<std::uint64_t> pieces((bytes + kPiece - 1) / kPiece);
        tbb::this_task_arena::isolate([&] {
            tbb::parallel_for(std::size_t(0), pieces.size(), [&](std::size_t k) {
                if (progress.cancelled()) return;
                const std::size_t n = std::min(kPiece, bytes - k * kPiece);
                pieces[k] = digestOf(data + k * kPiece, n, k);
                progress.add(n);
            });
        });
        progress.check();
        const std::string name = nameOf(*column, cloud);
        key.digest = mixed(key.digest ^ digestOf(reinterpret_cast<const std::byte*>(name.data()), name.size(),
                                                 std::uint64_t(column->type())));
        for (const std::uint64_t piece : pieces) key.digest = mixed(key.digest ^ piece);
    }
    return key;
}

std::vector<std::string> JournalContents::inForce() const
{
    std::vector<std::string> names;
    std::size_t position = 0;
    for (const JournalEntry& entry : entries) switch (entry.kind) {
            case JournalEntry::Kind::Do:
                names.resize(position++);
                names.push_back(entry.name);
                break;
            case JournalEntry::Kind::Undo:
                --position;
                break;
            case JournalEntry::Kind::Redo:
                ++position;
        }
    names.resize(position);
    return names;
}

std::unique_ptr<Journal> Journal::create(const std::filesystem::path& path, const CloudKey& key,
                                         const std::string& file, std::shared_ptr<const KeptPoints> kept)
{
    std::error_code ignored;
    std::filesystem::create_directories(path.parent_path(), ignored);
    std::unique_ptr<Journal> journal(new Journal(path, openLocked(path, O_CREAT)));
    journal->m_kept = std::move(kept);
    if (::ftruncate(journal->m_file, 0) != 0) failWriting(path);
    journal->add(std::string(kFirstLine));
    journal->add("cloud " + std::to_string(key.points) + " " + hex(key.digest, 16) + " " + escaped(file));
    return journal;
}

std::unique_ptr<Journal> Journal::resume(const std::filesystem::path& path)
{
    std::unique_ptr<Journal> journal(new Journal(path, openLocked(path, 0)));
    const Sound sound = soundPart(path, readAll(path));
    if (::ftruncate(journal->m_file, off_t(sound.bytes)) != 0 || ::lseek(journal->m_file, 0, SEEK_END) < 0)
        failWriting(path);
    journal->m_sum = sound.sum;
    journal->m_position = sound.position;
    return journal;
}

Journal::~Journal()
{
    if (m_file >= 0) ::close(m_file);
}

void Journal::add(const std::string& line)
{
    const std::uint32_t sum = crc32(m_sum, line);
    const std::string whole = line + " " + hex(sum, int(kSumDigits)) + "\n";
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

void Journal::done(const Command& command) noexcept
{
    guarded([&] {
        if (!command.recipe()) throw Error("\"" + command.name() + "\" cannot be noted in the journal.");
        add(lineOf(command, m_kept.get()));
        ++m_position;
    });
}

void Journal::undone() noexcept
{
    guarded([&] {
        if (m_position == 0)
            throw Error(
                "What was saved has been undone; until it is saved again, a crash would lose further edits.");
        add("undo");
        --m_position;
    });
}

void Journal::redone() noexcept
{
    guarded([&] {
        add("redo");
        ++m_position;
    });
}

std::string Journal::failure() const
{
    const std::lock_guard lock(m_mutex);
    return m_failure;
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

bool isJournalInUse(const std::filesystem::path& path)
{
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool locked = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(file);
    return locked;
}

}  // namespace punctum
