// SPDX-License-Identifier: MIT
// punctum replay: does again what a journal of the window tells, on the file that it was begun with.
#include "core/steps/Replay.h"
#include "app/Console.h"
#include "app/Files.h"
#include "app/commands/Command.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/edit/History.h"
#include "core/edit/Literal.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"

#include <memory>

namespace punctum::app
{

namespace
{

struct ReplayOptions {
    std::string journal;
    std::vector<std::string> in;
    std::string out;
    bool list = false;
    bool upgrade = false;
    bool noVerify = false;
    bool replaceProtected = false;
    bool json = false;
};

/// A literal holds the values of its points: too many to be listed.
Json shownValues(const Recipe& recipe)
{
    return recipe.step == kLiteralStep ? Json::object() : Json(recipe.values);
}

void listJournal(const JournalContents& journal, bool json)
{
    if (json) {
        Json entries = Json::array();
        for (const JournalEntry& entry : journal.entries) switch (entry.kind) {
                case JournalEntry::Kind::Undo:
                    entries.push_back({{"kind", "undo"}});
                    break;
                case JournalEntry::Kind::Redo:
                    entries.push_back({{"kind", "redo"}});
                    break;
                case JournalEntry::Kind::Do:
                    entries.push_back({{"kind", "do"},
                                       {"name", entry.name},
                                       {"step", entry.recipe.step},
                                       {"values", shownValues(entry.recipe)},
                                       {"points_changed", entry.changed}});
            }
        Json files = Json::array();
        for (const auto& file : filesOfJournal(journal.file)) files.push_back(file.string());
        printJson({{"file", files.empty() ? Json("") : files[0]},
                   {"files", files},
                   {"points", journal.key.points},
                   {"entries", entries},
                   {"in_force", journal.inForce()},
                   {"damage", journal.damage.empty() ? Json(nullptr) : Json(journal.damage)}});
        return;
    }
    std::string text = "Journal of " + journal.file + ", " + pointsText(journal.key.points) + "\n";
    for (const JournalEntry& entry : journal.entries) switch (entry.kind) {
            case JournalEntry::Kind::Undo:
                text += "  undo\n";
                break;
            case JournalEntry::Kind::Redo:
                text += "  redo\n";
                break;
            case JournalEntry::Kind::Do:
                text += "  " + entry.name + ": " + pointsText(entry.changed) + "\n";
        }
    print(text);
}

void runReplay(const ReplayOptions& options, Progress& progress)
{
    const JournalContents journal = readJournal(options.journal);
    if (!journal.damage.empty()) note(journal.damage);
    if (options.list) {
        listJournal(journal, options.json);
        return;
    }
    const std::vector<std::filesystem::path> files = inputFiles(options.in, progress);
    const Output out = outputOf(options.out, files.size() > 1);
    const auto session = loadForWriting(files, out, progress, true);
    const Replayed replayed = session->recover({options.journal, journal}, progress);
    if (!replayed.stopped.empty()) note(replayed.stopped);
    const bool whole = journal.damage.empty() && replayed.stopped.empty();
    if (!options.json)
        note(grouped(replayed.entries) + (replayed.entries == 1 ? " entry" : " entries") +
             " of the journal followed.");
    las::WriteOptions write;
    write.verify = !options.noVerify;
    write.replaceProtected = options.replaceProtected;
    write.upgrade = options.upgrade;
    reportWritten(saveSession(*session, out, write, progress), options.out, options.json,
                  {{"entries", replayed.entries}, {"whole", whole}});
    if (!whole) throw Reported();
}

}  // namespace

void addReplay(CLI::App& root, Action& action)
{
    CLI::App& command =
        addCommand(root, "replay",
                   "Do again what a journal tells, on the file that it was begun with, and write the "
                   "result. The window keeps a journal of unsaved edits. Exit code 1 when not all of "
                   "it could be followed; what could is written.");
    const auto options = std::make_shared<ReplayOptions>();
    command.add_option("JOURNAL", options->journal, "Journal to follow")->required();
    CLI::Option* in = command.add_option(
        "IN", options->in,
        "The LAS or LAZ file, or the files of the survey, as they were when the journal was begun");
    CLI::Option* out =
        command
            .add_option("-o,--output", options->out,
                        "File to write (.las or .laz), or a folder, in which each file gets its own name")
            ->type_name("OUT");
    command.add_flag("--list", options->list, "List what the journal tells, and do nothing else");
    addUpgrade(command, options->upgrade);
    addNoVerify(command, options->noVerify);
    addReplaceProtected(command, options->replaceProtected);
    command.add_flag("--json", options->json, "Report in JSON");
    command.callback([=, &action] {
        if (!options->list) {
            if (in->empty()) throw CLI::RequiredError("IN");
            if (out->empty()) throw CLI::RequiredError("-o OUT");
        }
        action = [options](Progress& p) { runReplay(*options, p); };
    });
}

}  // namespace punctum::app
