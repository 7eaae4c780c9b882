// SPDX-License-Identifier: MIT
#pragma once

#include "core/session/KeptJournals.h"
#include "ui/basic/Question.h"

#include <QObject>
#include <QPointer>
#include <QString>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace punctum
{
struct FoundJournal;
}

namespace punctum::ui
{

class Document;
class Workspace;

/// What the user says when asked whether to recover.
enum class RecoveryAnswer {
    Recover,
    Later,     ///< nothing happens, and it is asked again when the file is opened next
    SetAside,  ///< it is not asked again; the edits stay in the list of those that can be had back
};

/// "Set class 2 Ground, Delete and 3 more".
QString editsText(const std::vector<std::string>& names);

/// Sees to it that a crash loses no edit: when a file is opened that a program left with a journal, offers to do
/// again what it tells. Session keeps the journals.
///
/// GUI thread only. Borrows the workspace.
class Recovery final : public QObject
{
    Q_OBJECT
public:
    /// `folder`: where journals are kept; empty: none are.
    Recovery(Workspace& workspace, std::filesystem::path folder);

    /// Looks for a journal of the document, and asks.
    void look(Document& document);

    /// Asks whether to recover. None: nothing is recovered, and nothing lost.
    std::function<void(const Question& question, std::function<void(RecoveryAnswer)> answer)> ask;

    /// Looks for all journals that can be had back, newest first, in a job.
    void listKept(std::function<void(std::vector<KeptJournal>)> found);
    /// Does the edits of one again, in its files, which are opened where they are not open.
    void recoverKept(const KeptJournal& kept);
    /// Deletes it for good.
    void removeKept(const std::filesystem::path& path, std::function<void()> done);

private:
    void offer(Document& document, const std::shared_ptr<const FoundJournal>& journal);
    void recover(Document& document, const std::shared_ptr<const FoundJournal>& journal);
    void recoverFrom(Document& document, const std::filesystem::path& path);

    Workspace& m_workspace;
    std::filesystem::path m_folder;
    std::map<QStringList, std::filesystem::path> m_wanted;  ///< journals to be followed once their files are open
};

}  // namespace punctum::ui
