// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Workspace.h"

#include <QObject>
#include <QString>

#include <functional>
#include <map>
#include <memory>

namespace punctum::ui
{

/// How the workspace saves: what a save would change is worked out, asked about where that is wished, written, and
/// told; and which changes of a document are unsaved.
///
/// GUI thread only; every call returns at once. Borrows the workspace, whose jobs do the work.
class Saves final : public QObject
{
    Q_OBJECT
public:
    explicit Saves(Workspace& workspace);

    /// Workspace::save().
    void save(Document& document, const QString& path, std::function<void(bool)> ended, Workspace::AskSave ask);
    void saveParts(Document& document, std::vector<std::size_t> parts);
    void merge(Document& document, const QString& path);
    /// Works out Document::unsavedChanges() anew, and which files of a survey have them.
    void countUnsaved(Document& document);
    /// The document is being closed.
    void forget(Document& document) { m_counts.erase(&document); }

signals:
    void saved(punctum::ui::Document* document);

private:
    struct Saving;
    std::shared_ptr<Saving> begin(Document& document, const QString& path, std::function<void(bool)> ended);
    void askReplacing(const std::shared_ptr<Saving>& saving, std::function<void()> proceed);
    void startSave(const std::shared_ptr<Saving>& saving);
    void askFor(const std::shared_ptr<Saving>& saving);

    struct Count {
        JobId job = 0;
        bool again = false;  ///< something changed meanwhile
    };

    Workspace& m_workspace;
    std::map<const Document*, Count> m_counts;
};

}  // namespace punctum::ui
