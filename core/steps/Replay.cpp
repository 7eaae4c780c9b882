// SPDX-License-Identifier: MIT
#include "core/steps/Replay.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/edit/History.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"

#include <memory>
#include <new>
#include <optional>
#include <stdexcept>

namespace punctum
{

namespace
{

/// What the sentence about an entry calls it.
std::string nameOf(const JournalEntry& entry, const History& history)
{
    switch (entry.kind) {
        case JournalEntry::Kind::Undo:
            return "Undo " + history.undoName();
        case JournalEntry::Kind::Redo:
            return "Redo " + history.redoName();
        case JournalEntry::Kind::Do:
            break;
    }
    return entry.name;
}

/// Why it could not be followed; nothing: it was. Throws Cancelled.
std::optional<std::string> trouble(const JournalEntry& entry, const PointCloud& cloud, History& history,
                                   Progress& progress)
{
    try {
        follow(entry, cloud, history, progress);
        return {};
    } catch (const Cancelled&) {
        throw;
    } catch (const std::bad_alloc&) {
        return "There is not enough memory.";
    } catch (const std::length_error&) {  // more than any memory
        return "There is not enough memory.";
    } catch (const std::exception& e) {
        return e.what();
    }
}

}  // namespace

void follow(const JournalEntry& entry, const PointCloud& cloud, History& history, Progress& progress)
{
    if (entry.kind == JournalEntry::Kind::Undo) return history.undo();
    if (entry.kind == JournalEntry::Kind::Redo) return history.redo();
    Recipe recipe = entry.recipe;
    if (entry.within) recipe.within = std::make_shared<PointSet>(entry.within->unpacked());
    auto command = makeCommand(recipe, cloud, progress);
    const PointIndex changed = command ? command->changedPoints() : 0;
    if (changed != entry.changed)
        throw Error("It would change " + pointsText(changed) + " in place of " + grouped(entry.changed) + ".");
    // No such entry is ever noted, and an undo after it would take back another one.
    if (!command) throw Error("It would change nothing.");
    history.push(std::move(command));
}

Replayed replay(const JournalContents& journal, const PointCloud& cloud, History& history, Progress& progress)
{
    if (!(keyOf(cloud, progress) == journal.key))
        throw Error("The journal is about another file, or this one was changed since: it was begun with " +
                    journalFileText(journal.file) + " of " + pointsText(journal.key.points) + ".");
    Replayed replayed;
    for (const JournalEntry& entry : journal.entries) {
        progress.check();
        const std::string name = nameOf(entry, history);
        const auto reason = trouble(entry, cloud, history, progress);
        if (reason) {
            replayed.stopped = "\"" + printable(name) + "\" cannot be done again: " + *reason;
            break;
        }
        ++replayed.entries;
    }
    return replayed;
}

}  // namespace punctum
