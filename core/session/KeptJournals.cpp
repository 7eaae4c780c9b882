// SPDX-License-Identifier: MIT
#include "core/session/KeptJournals.h"

#include "core/Error.h"
#include "core/edit/Journal.h"
#include "core/session/SurveyFiles.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <system_error>

namespace punctum
{

std::vector<KeptJournal> keptJournals(const std::filesystem::path& folder, Progress& progress)
{
    std::vector<KeptJournal> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        progress.check();
        const std::string name = entry.path().filename().string();
        const bool aside = name.ends_with(kSetAsideEnding);
        if ((!aside && !name.ends_with(kJournalEnding)) || isJournalInUse(entry.path())) continue;
        try {
            const JournalContents journal = readJournal(entry.path());
            auto names = journal.inForce();
            if (names.empty()) continue;
            const auto changed = std::chrono::time_point_cast<std::chrono::system_clock::duration>(
                std::chrono::file_clock::to_sys(std::filesystem::last_write_time(entry.path(), error)));
            found.push_back({entry.path(), filesOfJournal(journal.file), std::move(names), changed, aside});
        } catch (const Error&) {
            continue;  // no journal, or not even its beginning can be read
        }
    }
    std::sort(found.begin(), found.end(),
              [](const KeptJournal& a, const KeptJournal& b) { return a.changed > b.changed; });
    return found;
}

}  // namespace punctum
