// SPDX-License-Identifier: MIT
#include "core/edit/JournalText.h"

#include "core/Error.h"
#include "core/SummedText.h"
#include "core/Text.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace punctum
{

namespace
{

/// More points than any cloud has; counts up to here can be added and rounded without care.
constexpr PointIndex kMostPoints = PointIndex(1) << 40;

std::optional<JournalEntry> entryOf(std::string_view line, PointIndex size)
{
    const auto all = wordsOf(line);
    JournalEntry entry;
    if (all.size() == 1 && (all[0] == "undo" || all[0] == "redo")) {
        entry.kind = all[0] == "undo" ? JournalEntry::Kind::Undo : JournalEntry::Kind::Redo;
        return entry;
    }
    if (all.size() < 4 || all[0] != "do" || !parseWord(all[1], entry.changed)) return {};
    const auto name = unescapedWord(all[2]), step = unescapedWord(all[3]);
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
        const auto key = unescapedWord(all[k].substr(0, equals)), value = unescapedWord(all[k].substr(equals + 1));
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
    return "cloud " + std::to_string(key.points) + " " + key.digestText() + " " + escapedWord(file);
}

std::string journalLine(const JournalEntry& entry)
{
    const Recipe& recipe = entry.recipe;
    std::string line =
        "do " + std::to_string(entry.changed) + " " + escapedWord(entry.name) + " " + escapedWord(recipe.step);
    for (const auto& [key, value] : recipe.values) line += " " + escapedWord(key) + "=" + escapedWord(value);
    if (recipe.within) line += " @" + PackedSet(*recipe.within).text();
    return line;
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
    for (SummedLines lines(text);;) {
        ++number;
        const SummedLines::Next next = lines.next();
        if (next == SummedLines::Next::End) break;
        if (next != SummedLines::Next::Line) {
            damaged(next == SummedLines::Next::CutOff ? "cut off" : "damaged");
            break;
        }
        const std::string_view line = lines.line();
        const auto all = wordsOf(line);
        if (number == 1) {
            if (line != kJournalFirstLine) break;
        } else if (number == 2) {
            CloudKey& key = sound.contents.key;
            const auto file = all.size() == 4 ? unescapedWord(all[3]) : std::nullopt;
            if (!file || all[0] != "cloud" || !parseWord(all[1], key.points) || key.points > kMostPoints ||
                !parseWord(all[2], key.digest, 16))
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
        sound.sum = lines.sum();
        sound.bytes = lines.end();
    }
    if (!begun) throw Error(path, "this is no journal of Punctum, or its beginning is damaged.");
    return sound;
}

std::string journalFiles(const std::vector<std::filesystem::path>& files)
{
    std::string text;
    for (const std::filesystem::path& file : files)
        text += (text.empty() ? std::string() : std::string(1, '\0')) + file.string();
    return text;
}

std::vector<std::filesystem::path> filesOfJournal(const std::string& files)
{
    std::vector<std::filesystem::path> paths;
    for (std::size_t at = 0; at <= files.size();) {
        const std::size_t end = std::min(files.find('\0', at), files.size());
        if (end > at) paths.emplace_back(files.substr(at, end - at));
        at = end + 1;
    }
    return paths;
}

std::string journalFileText(const std::string& files)
{
    const auto paths = filesOfJournal(files);
    if (paths.empty()) return "a file";
    const std::size_t others = paths.size() - 1;
    return paths.front().string() +
           (others == 0 ? "" : " and " + std::to_string(others) + (others == 1 ? " other file" : " other files"));
}

}  // namespace punctum
