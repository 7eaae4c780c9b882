// SPDX-License-Identifier: MIT
#pragma once

#include <QObject>
#include <QString>

namespace punctum::ui
{

class Document;
class Selection;
class Workspace;

/// One order of what was done to a document, its selections and the edits of its points, for undo and redo: what
/// was done last is undone first. A selection that was made before an edit is undone after it.
///
/// GUI thread only; borrows both.
class UndoOrder final : public QObject
{
    Q_OBJECT
public:
    UndoOrder(Workspace& workspace, Selection& selection, QObject* parent = nullptr);

    /// Of the active document: what would be undone, or done again. `possible` where there is something.
    struct Next {
        bool possible = false;
        bool selection = false;  ///< of the selection, not of points
        QString name;
    };
    Next nextUndo() const;
    Next nextRedo() const;

    void undo();
    void redo();

signals:
    /// What comes next is another one, or may be.
    void changed();

private:
    Workspace& m_workspace;
    Selection& m_selection;
};

}  // namespace punctum::ui
