// SPDX-License-Identifier: MIT
#include "core/edit/JournalText.h"

#include "core/Error.h"
#include "core/Text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kSumDigits = 8;
/// More points than any cloud has; counts up to here can be added and rounded without care.
constexpr PointIndex kMostPoints = PointIndex(1) << 40;

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
            word += '%' + hexText(byte, 2);
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

std::optional<JournalEntry> entryOf(std::string_view line, PointIndex size)
{
    const auto all = words(line);
    JournalEntry entry;
    if (all.size() == 1 && (all[0] == "undo" || all[0] == "redo")) {
        entry.kind = all[0] == "undo" ? JournalEntry::Kind::Undo : JournalEntry::Kind::Redo;
        return entry;
    }
    if (all.size() < 4 || all[0] != "do" || !parse(all[1], entry.changed)) return {};
    const auto name = unescaped(all[2]), step = unescaped(all[3]);
    if (!name || !step) return {};
    entry.name = *name;
    entry.recipe.step = *step;
    for (std::size_t k = 4; k < all.size(); ++k) {
        if (all[k].starts_with('@')) {
            entry.within = PackedSet::fromText(all[k].substr(1), size);
            if (!entry.within) return {};
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

/// Counts what is in force after the entry; false when there is nothing to undo or redo.
bool follow(const JournalEntry& entry, SoundJournal& sound)
{
    switch (entry.kind) {
        case JournalEntry::Kind::Do:
            ++sound.position;
            sound.undone = 0;
            return true;
        case JournalEntry::Kind::Undo:
            if (sound.position == 0) return false;
            --sound.position;
            ++sound.undone;
            return true;
        case JournalEntry::Kind::Redo:
            if (sound.undone == 0) return false;
            ++sound.position;
            --sound.undone;
    }
    return true;
}

}  // namespace

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

std::string journalCloudLine(const CloudKey& key, const std::string& file)
{
    return "cloud " + std::to_string(key.points) + " " + key.digestText() + " " + escaped(file);
}

std::string journalLine(const JournalEntry& entry)
{
    const Recipe& recipe = entry.recipe;
    std::string line =
        "do " + std::to_string(entry.changed) + " " + escaped(entry.name) + " " + escaped(recipe.step);
    for (const auto& [key, value] : recipe.values) line += " " + escaped(key) + "=" + escaped(value);
    if (recipe.within) line += " @" + PackedSet(*recipe.within).text();
    return line;
}

std::string summed(const std::string& line, std::uint32_t& sum)
{
    sum = crc32(sum, line);
    return line + " " + hexText(sum, int(kSumDigits)) + "\n";
}

SoundJournal soundPart(const std::filesystem::path& path, const std::string& text)
{
    SoundJournal sound;
    std::size_t number = 0;
    bool begun = false;  // its first two lines are sound
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
        const bool hasSum = whole.size() > kSumDigits + 1 && whole[whole.size() - kSumDigits - 1] == ' ' &&
                            parse(whole.substr(whole.size() - kSumDigits), sum, 16);
        const std::string_view line = hasSum ? whole.substr(0, whole.size() - kSumDigits - 1) : whole;
        if (!hasSum || crc32(sound.sum, line) != sum) {
            damaged("damaged");
            break;
        }
        const auto all = words(line);
        if (number == 1) {
            if (line != kJournalFirstLine) break;
        } else if (number == 2) {
            CloudKey& key = sound.contents.key;
            const auto file = all.size() == 4 ? unescaped(all[3]) : std::nullopt;
            if (!file || all[0] != "cloud" || !parse(all[1], key.points) || key.points > kMostPoints ||
                !parse(all[2], key.digest, 16))
                break;
            sound.contents.file = *file;
            begun = true;
        } else {
            auto entry = entryOf(line, sound.contents.key.points);
            if (!entry || !follow(*entry, sound)) {
                damaged("not understood");
                break;
            }
            sound.contents.entries.push_back(std::move(*entry));
        }
        sound.sum = sum;
        sound.bytes = end + 1;
    }
    if (!begun) throw Error(path, "this is no journal of Punctum, or its beginning is damaged.");
    return sound;
}

}  // namespace punctum
