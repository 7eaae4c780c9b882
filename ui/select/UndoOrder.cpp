// SPDX-License-Identifier: MIT
#include "ui/select/UndoOrder.h"

#include "core/edit/History.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/select/Selection.h"

namespace punctum::ui
{

UndoOrder::UndoOrder(Workspace& workspace, Selection& selection, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_selection(selection)
{
    connect(&selection, &Selection::changed, this, &UndoOrder::changed);
}

UndoOrder::Next UndoOrder::nextUndo() const
{
    const Document* const document = m_workspace.active();
    if (!document || document->loading()) return {};
    const History& history = document->history();
    const SelectionSteps::Step* const step = m_selection.nextUndo();
    // it was done after all edits that are in force
    if (step && (step->edits >= history.position() || !history.canUndo())) return {true, true, step->name};
    return {history.canUndo(), false, toQString(history.undoName())};
}

UndoOrder::Next UndoOrder::nextRedo() const
{
    const Document* const document = m_workspace.active();
    if (!document || document->loading()) return {};
    const History& history = document->history();
    const SelectionSteps::Step* const step = m_selection.nextRedo();
    if (step && (step->edits <= history.position() || !history.canRedo())) return {true, true, step->name};
    return {history.canRedo(), false, toQString(history.redoName())};
}

void UndoOrder::undo()
{
    const Next next = nextUndo();
    if (!next.possible) return;
    if (next.selection)
        m_selection.undo();
    else
        m_workspace.undo(*m_workspace.active());
}

void UndoOrder::redo()
{
    const Next next = nextRedo();
    if (!next.possible) return;
    if (next.selection)
        m_selection.redo();
    else
        m_workspace.redo(*m_workspace.active());
}

}  // namespace punctum::ui
