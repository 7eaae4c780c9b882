// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Journal.h"
#include "ui/Question.h"

#include <QDateTime>
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
class Progress;
}

namespace punctum::ui
{

class Document;
class Workspace;
struct OpenCloud;

/// What the user says when asked whether to recover.
enum class RecoveryAnswer {
    Recover,
    Later,     ///< nothing happens, and it is asked again when the file is opened next
    SetAside,  ///< it is not asked again; the edits stay in the list of those that can be had back
};

/// Edits that were not saved, in a journal that waits for its file or was set aside.
struct KeptJournal {
    std::filesystem::path path;  ///< of the journal
    QString file;                ///< that the edits are of
    QString edits;               ///< "Set class 2 Ground, Delete and 3 more"
    QDateTime changed;
    bool setAside = false;
};

/// Sees to it that a crash loses no edit: begins a journal with the first edit of a file, and when a file is opened
/// that a program left with a journal, offers to do again what it tells.
///
/// GUI thread only, but for noteDown(). Borrows the workspace.
class Recovery final : public QObject
{
    Q_OBJECT
public:
    /// `folder`: where journals are kept; empty: none are.
    Recovery(Workspace& workspace, std::filesystem::path folder);

    /// Called by a job that is about to change a cloud, with its gate held: begins the journal where there is none.
    /// What keeps it from that is told once, and never stops the edit.
    void noteDown(OpenCloud& data, Progress& progress) noexcept;
    /// There is nothing to recover: the file is closed in order, or was saved, and what the journal tells is about
    /// the file of before (with the gate held).
    static void dropJournal(OpenCloud& data) noexcept;

    /// Looks for a journal of the document, and asks.
    void look(Document& document);

    /// Asks whether to recover. None: nothing is recovered, and nothing lost.
    std::function<void(const Question& question, std::function<void(RecoveryAnswer)> answer)> ask;

    /// Looks for all journals that can be had back, newest first, in a job.
    void listKept(std::function<void(std::vector<KeptJournal>)> found);
    /// Does the edits of one again, in its file, which is opened where it is not open.
    void recoverKept(const KeptJournal& kept);
    /// Deletes it for good.
    void removeKept(const std::filesystem::path& path, std::function<void()> done);

private:
    std::filesystem::path pathOf(const CloudKey& key) const;
    void offer(Document& document, const std::filesystem::path& path,
               const std::shared_ptr<JournalContents>& journal);
    void recover(Document& document, const std::filesystem::path& path,
                 const std::shared_ptr<const JournalContents>& journal);
    void recoverFrom(Document& document, const std::filesystem::path& path);
    /// A journal that has been followed becomes the one that is kept on.
    void goOn(OpenCloud& data, const std::filesystem::path& path, const CloudKey& key) const;
    void warn(const QString& sentence);

    Workspace& m_workspace;
    std::filesystem::path m_folder;
    std::map<QString, std::filesystem::path> m_wanted;  ///< journals to be followed once their files are open
};

}  // namespace punctum::ui
