// SPDX-License-Identifier: MIT
#include "core/process/Replay.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/edit/History.h"
#include "core/process/MakeCommand.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum
{

Replayed replay(const JournalContents& journal, const PointCloud& cloud, History& history, Progress& progress)
{
    if (!(keyOf(cloud, progress) == journal.key))
        throw Error("The journal is about another file, or this one was changed since: it was begun with " +
                    (journal.file.empty() ? std::string("a file") : journal.file) + " of " +
                    pointsText(journal.key.points) + ".");
    Replayed replayed;
    for (const JournalEntry& entry : journal.entries) {
        progress.check();
        switch (entry.kind) {
            case JournalEntry::Kind::Undo:
                history.undo();
                break;
            case JournalEntry::Kind::Redo:
                history.redo();
                break;
            case JournalEntry::Kind::Do: {
                std::unique_ptr<Command> command;
                std::string reason;
                try {
                    Recipe recipe = entry.recipe;
                    if (entry.within) recipe.within = std::make_shared<PointSet>(entry.within->unpacked());
                    command = makeCommand(recipe, cloud, progress);
                } catch (const Error& e) {
                    reason = e.what();
                }
                const PointIndex changed = command ? command->changedPoints() : 0;
                if (reason.empty() && changed != entry.changed)
                    reason =
                        "It would change " + pointsText(changed) + " in place of " + grouped(entry.changed) + ".";
                if (!reason.empty()) {
                    replayed.stopped = "\"" + entry.name + "\" cannot be done again: " + reason;
                    return replayed;
                }
                history.push(std::move(command));
            }
        }
        ++replayed.entries;
    }
    return replayed;
}

}  // namespace punctum
