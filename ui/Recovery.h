// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Journal.h"
#include "ui/Question.h"

#include <QObject>
#include <QPointer>
#include <QString>

#include <filesystem>
#include <functional>
#include <memory>

namespace punctum
{
class Progress;
}

namespace punctum::ui
{

class Document;
class Workspace;
struct OpenCloud;

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
    AskQuestion ask;

private:
    std::filesystem::path pathOf(const CloudKey& key) const;
    void offer(Document& document, const std::filesystem::path& path, std::shared_ptr<JournalContents> journal);
    void recover(Document& document, const std::filesystem::path& path,
                 const std::shared_ptr<const JournalContents>& journal);
    void warn(const QString& sentence);

    Workspace& m_workspace;
    std::filesystem::path m_folder;
};

}  // namespace punctum::ui
