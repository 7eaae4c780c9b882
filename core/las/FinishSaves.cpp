// SPDX-License-Identifier: MIT
#include "core/las/FinishSaves.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/AtomicFile.h"
#include "core/las/ManifestFiles.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace punctum::las
{

namespace
{

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLongestWait{5};  ///< for other programs' renames, which take milliseconds

std::optional<ContentStamp> contentsOf(const fs::path& path)
{
    struct stat s {
    };
    if (::lstat(path.c_str(), &s) != 0) return {};
    // What is no regular file is not what any save left there.
    if (!S_ISREG(s.st_mode)) return ContentStamp{UINT64_MAX, 0};
    const FileStamp stamp = FileStamp::of(s);
    return ContentStamp{stamp.size, stamp.modified};
}

bool isAsWritten(const fs::path& temporary, const ManifestEntry& entry)
{
    try {
        return digestOfFile(File(temporary)) == entry.digest;
    } catch (const Error&) {
        return false;
    }
}

/// What came of the files of a save.
struct Outcome {
    std::size_t total = 0;
    std::vector<std::string> named;    ///< now
    std::vector<std::string> changed;  ///< since, by somebody else
    std::vector<std::string> kept;     ///< temporary files that wait beside these
    std::vector<std::string> lost;     ///< as before: what was written of them is gone
    std::vector<std::string> failed;   ///< the system does not let them have their names
    std::vector<std::string> indexed;  ///< have a .lax index of before beside them
    int error = 0;
};

/// Gives one file its name where it has not got it, and the target is still the one of before.
void finishFile(const fs::path& folder, const ManifestEntry& entry, Outcome& outcome)
{
    const fs::path temporary = folder / entry.temporary, target = folder / entry.target;
    const std::string name = shownName(target);
    const auto there = contentsOf(temporary), now = contentsOf(target);
    const bool untouched = now == entry.before;
    if (!there) {  // it has its name, and may have been changed since; or was deleted
        if (untouched && now != entry.written) outcome.lost.push_back(name);
    } else if (!(there == entry.written && isAsWritten(temporary, entry))) {
        (untouched ? outcome.lost : outcome.changed).push_back(name);
        outcome.kept.push_back(shownName(temporary));
    } else if (!untouched) {
        outcome.changed.push_back(name);
        outcome.kept.push_back(shownName(temporary));
    } else if (::rename(temporary.c_str(), target.c_str()) != 0) {
        outcome.error = errno;
        outcome.failed.push_back(name);
    } else {
        outcome.named.push_back(name);
    }
    fs::path index = target;
    std::error_code ignored;
    if (entry.before && fs::is_regular_file(index.replace_extension(".lax"), ignored))
        outcome.indexed.push_back(shownName(index));
}

std::vector<std::string> sentencesOn(const Outcome& o)
{
    std::vector<std::string> sentences;
    const std::string which = "A save of " + grouped(o.total) + " files was cut off";
    if (!o.failed.empty())
        sentences.push_back(which + " and cannot be finished (" + systemReason(o.error) +
                            "); these are still as before: " + listText(o.failed) +
                            ". Allow writing to the folder, and open them again.");
    else if (!o.named.empty() && o.changed.empty() && o.lost.empty())
        sentences.push_back(which + "; it is finished now: all of them are as they were saved (" +
                            listText(o.named) + " just now).");
    else if (!o.named.empty())
        sentences.push_back(which + "; " + listText(o.named) + " got what was saved just now.");
    if (!o.changed.empty())
        sentences.push_back("Changed since a save of several files was cut off, and left as they are: " +
                            listText(o.changed) + ". What was saved is beside them: " + listText(o.kept) + ".");
    if (!o.lost.empty())
        sentences.push_back(
            "As before a save of several files that was cut off, since what was saved of them is "
            "gone or damaged: " +
            listText(o.lost) + ".");
    if (!o.named.empty() && !o.indexed.empty())
        sentences.push_back("LAStools' indexes beside the files that were saved may be of before: remove " +
                            listText(o.indexed) + ".");
    return sentences;
}

/// Looks at folders and finishes what is found there.
class Finisher
{
public:
    std::vector<std::string> sentences;

    void look(const fs::path& folder)
    {
        std::vector<std::string> found;
        std::error_code ec;
        for (auto it = fs::directory_iterator(folder, ec); !ec && it != fs::directory_iterator();
             it.increment(ec)) {
            const std::string name = it->path().filename().string();
            if (isManifestName(name)) found.push_back(name);
            if (isManifestLeftover(name)) ::unlink(it->path().c_str());
        }
        std::sort(found.begin(), found.end());
        for (const std::string& name : found) finish(folder, name);
    }

private:
    /// What is found from several folders is said once.
    void say(const std::string& sentence)
    {
        if (std::find(sentences.begin(), sentences.end(), sentence) == sentences.end())
            sentences.push_back(sentence);
    }
    void refused(const fs::path& folder)
    {
        say("A save of several files in the folder " + shownName(folder) +
            " was cut off, and its list of files may not be read or is not to be trusted; who saved them should "
            "open "
            "them again.");
    }
    void undecided()
    {
        say("A save of several files was cut off before it counted: they are as they were before.");
    }

    /// Reads a locked manifest; false when there is nothing more to do about it.
    bool read(const FoundManifest& found, const fs::path& folder, SaveManifest& manifest)
    {
        switch (found.access()) {
            case FoundManifest::Access::Gone:
                return false;
            case FoundManifest::Access::InUse:
                say("Another program is saving files in the folder " + shownName(folder) +
                    " now; open them again when it has ended.");
                return false;
            case FoundManifest::Access::Refused:
                refused(folder);
                return false;
            case FoundManifest::Access::Locked:
                break;
        }
        m_state = parseManifest(found.text(), manifest);
        if (m_state == ManifestState::Foreign) refused(folder);
        return m_state != ManifestState::Foreign;
    }

    void finish(const fs::path& folder, const std::string& name)
    {
        std::error_code ec;
        const fs::path here = fs::canonical(folder, ec);
        if (ec) return;
        SaveManifest manifest;
        fs::path decider = here;
        {
            const FoundManifest found(here / name, m_waitUntil);
            if (!read(found, here, manifest)) return;
            if (m_state == ManifestState::Incomplete) {
                ::unlink((here / name).c_str());
                return undecided();
            }
            if (manifest.decider.empty()) return finishAll(here, name, manifest);
            decider = manifest.decider;
        }
        if (!fs::is_directory(decider, ec))
            return say("A save of several files was cut off. Whether it counts is to be seen in the folder " +
                       printable(decider.string()) + ", which is not there now; open the files when it is.");
        SaveManifest deciding;
        const FoundManifest found(decider / name, m_waitUntil);
        if (found.access() == FoundManifest::Access::Gone) {  // it never counted
            ::unlink((here / name).c_str());
            return undecided();
        }
        if (!read(found, decider, deciding)) return;
        if (m_state == ManifestState::Incomplete) {
            ::unlink((decider / name).c_str());
            ::unlink((here / name).c_str());
            return undecided();
        }
        const auto& others = deciding.others;
        if (!deciding.decider.empty() || std::find(others.begin(), others.end(), here) == others.end())
            return refused(here);
        finishAll(decider, name, deciding);
    }

    /// The save counts: gives its files their names, in all folders.
    void finishAll(const fs::path& folder, const std::string& name, const SaveManifest& manifest)
    {
        Outcome outcome;
        outcome.total = manifest.total;
        for (const ManifestEntry& entry : manifest.files) finishFile(folder, entry, outcome);
        bool all = syncFolder(folder) == 0;
        for (const fs::path& other : manifest.others) {
            std::error_code ec;
            if (other == folder) continue;
            if (!fs::is_directory(other, ec)) {
                say("A save of several files was cut off, and cannot be finished in the folder " +
                    printable(other.string()) + ", which is not there now; open the files again when it is.");
                all = false;
                continue;
            }
            const FoundManifest found(other / name, m_waitUntil);
            SaveManifest part;
            if (found.access() == FoundManifest::Access::Gone) continue;  // all of its files have their names
            if (!read(found, other, part)) {
                all = false;
                continue;
            }
            if (m_state != ManifestState::Whole || part.decider != folder) {
                refused(other);
                all = false;
                continue;
            }
            for (const ManifestEntry& entry : part.files) finishFile(other, entry, outcome);
            all = syncFolder(other) == 0 && all;
        }
        for (const std::string& sentence : sentencesOn(outcome)) say(sentence);
        if (!all || !outcome.failed.empty()) return;
        std::vector<fs::path> others;
        for (const fs::path& other : manifest.others)
            if (other != folder) others.push_back(other / name);
        if (removeManifests(others)) ::unlink((folder / name).c_str());
    }

    ManifestState m_state = ManifestState::Whole;
    FoundManifest::Clock::time_point m_waitUntil = FoundManifest::Clock::now() + kLongestWait;  ///< for all of them
};

}  // namespace

std::vector<std::string> finishSaves(std::span<const fs::path> places)
{
    Finisher finisher;
    std::set<fs::path> seen;
    const auto look = [&](const fs::path& folder) {
        if (seen.insert(folder).second) finisher.look(folder);
    };
    for (const fs::path& place : places) {
        std::error_code ec;
        const fs::file_status status = fs::symlink_status(place, ec);
        if (fs::is_directory(status)) {
            look(place);
            continue;
        }
        look(folderOf(place));
        if (!fs::is_symlink(status)) continue;  // a save follows links
        const fs::path real = fs::canonical(place, ec);
        if (!ec) look(fs::is_directory(real, ec) ? real : folderOf(real));
    }
    return std::move(finisher.sentences);
}

}  // namespace punctum::las
