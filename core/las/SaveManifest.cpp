// SPDX-License-Identifier: MIT
#include "core/las/SaveManifest.h"

#include "core/SummedText.h"
#include "core/Text.h"
#include "core/las/Leftovers.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace punctum::las
{

namespace
{

constexpr std::string_view kFirstLine = "punctum-save 1", kAnyVersion = "punctum-save ";
constexpr std::string_view kNameStart = ".punctum-save-";
constexpr std::size_t kDigestPlaces = 16, kDigestBytes = 4096;
constexpr std::size_t kMostFiles = 1'000'000;
constexpr std::size_t kLongestPlainName = 255;

bool isPlainName(const std::string& name)
{
    return !name.empty() && name.size() <= kLongestPlainName && name != "." && name != ".." &&
           name.find('/') == std::string::npos && name.find('\0') == std::string::npos;
}

std::string contentsWords(const ContentStamp& contents)
{
    return std::to_string(contents.size) + " " + std::to_string(contents.modified);
}

/// "file TEMPORARY TARGET SIZE TIME SIZE TIME DIGEST", or "new" without the first size and time.
std::optional<ManifestEntry> entryOfLine(const std::vector<std::string_view>& words)
{
    const bool isNew = words[0] == "new";
    const std::size_t at = isNew ? 3 : 5;  // of the contents that were written
    if (words.size() != at + 3) return {};
    ManifestEntry entry;
    const auto temporary = unescapedWord(words[1]), target = unescapedWord(words[2]);
    if (!temporary || !target || !isPlainName(*temporary) || !isPlainName(*target)) return {};
    if (temporaryProcess(*temporary, *target) == 0) return {};
    entry.temporary = *temporary;
    entry.target = *target;
    if (!isNew) {
        entry.before.emplace();
        if (!parseWord(words[3], entry.before->size) || !parseWord(words[4], entry.before->modified)) return {};
    }
    if (!parseWord(words[at], entry.written.size) || !parseWord(words[at + 1], entry.written.modified) ||
        !parseWord(words[at + 2], entry.digest, 16))
        return {};
    return entry;
}

std::optional<std::filesystem::path> folderOfLine(const std::vector<std::string_view>& words)
{
    const auto folder = words.size() == 2 ? unescapedWord(words[1]) : std::nullopt;
    if (!folder || !folder->starts_with('/') || folder->find('\0') != std::string::npos) return {};
    return std::filesystem::path(*folder);
}

/// Takes one line over; false when no save of ours writes it.
bool take(std::string_view line, SaveManifest& manifest, bool& ended)
{
    const auto words = wordsOf(line);
    if (words.empty() || ended) return false;
    if (words[0] == "decider" || words[0] == "folder") {
        auto folder = folderOfLine(words);
        if (!folder || !manifest.decider.empty() || !manifest.files.empty()) return false;
        if (words[0] == "folder")
            manifest.others.push_back(std::move(*folder));
        else
            manifest.decider = std::move(*folder);
        return manifest.decider.empty() || manifest.others.empty();
    }
    if (words[0] == "file" || words[0] == "new") {
        auto entry = entryOfLine(words);
        if (!entry || manifest.files.size() == kMostFiles) return false;
        manifest.files.push_back(std::move(*entry));
        return true;
    }
    ended = words[0] == "end" && words.size() == 2 && parseWord(words[1], manifest.total);
    return ended;
}

}  // namespace

std::string manifestText(const SaveManifest& manifest)
{
    std::uint32_t sum = 0;
    std::string text = summed(std::string(kFirstLine), sum);
    if (!manifest.decider.empty()) text += summed("decider " + escapedWord(manifest.decider.string()), sum);
    for (const auto& folder : manifest.others) text += summed("folder " + escapedWord(folder.string()), sum);
    for (const ManifestEntry& entry : manifest.files)
        text += summed((entry.before ? "file " : "new ") + escapedWord(entry.temporary) + " " +
                           escapedWord(entry.target) + " " +
                           (entry.before ? contentsWords(*entry.before) + " " : std::string()) +
                           contentsWords(entry.written) + " " + hexText(entry.digest, 8),
                       sum);
    return text + summed("end " + std::to_string(manifest.total), sum);
}

ManifestState parseManifest(std::string_view text, SaveManifest& manifest)
{
    manifest = {};
    SummedLines lines(text);
    if (lines.next() != SummedLines::Next::Line) return ManifestState::Incomplete;
    if (lines.line() != kFirstLine)
        return lines.line().starts_with(kAnyVersion) ? ManifestState::Foreign : ManifestState::Incomplete;
    bool ended = false;
    for (;;) {
        const SummedLines::Next next = lines.next();
        if (next == SummedLines::Next::End) return ended ? ManifestState::Whole : ManifestState::Incomplete;
        if (next != SummedLines::Next::Line) return ManifestState::Incomplete;
        if (!take(lines.line(), manifest, ended)) return ManifestState::Foreign;
    }
}

std::string manifestName()
{
    return std::string(kNameStart) + processSuffix();
}

bool isManifestName(std::string_view name)
{
    return processOfManifest(name) != 0;
}

long processOfManifest(std::string_view name)
{
    return name.starts_with(kNameStart) ? processOfSuffix(name.substr(kNameStart.size())) : 0;
}

bool isManifestLeftover(std::string_view name)
{
    // ".punctum-save-PROCESS-NUMBER" as the target of a temporary name
    const std::size_t mark = name.rfind(".tmp-");
    if (mark == std::string_view::npos || !name.starts_with('.')) return false;
    const std::string target(name.substr(1, mark - 1));
    const long process = temporaryProcess(name, target);
    return isManifestName(target) && process != 0 && !isRunning(process);
}

std::uint32_t digestOfFile(const File& file)
{
    std::uint32_t sum = crc32(0, std::to_string(file.size()));
    std::array<char, kDigestBytes> bytes;
    const std::uint64_t last = file.size() > kDigestBytes ? file.size() - kDigestBytes : 0;
    std::uint64_t before = 0;
    for (std::size_t k = 0; k < kDigestPlaces; ++k) {
        const std::uint64_t at =
            last / (kDigestPlaces - 1) * k + last % (kDigestPlaces - 1) * k / (kDigestPlaces - 1);
        if (k != 0 && at == before) continue;
        before = at;
        const auto n = std::size_t(std::min<std::uint64_t>(kDigestBytes, file.size() - at));
        file.readAt(at, std::as_writable_bytes(std::span(bytes)).first(n));
        sum = crc32(sum, {bytes.data(), n});
    }
    return sum;
}

}  // namespace punctum::las
