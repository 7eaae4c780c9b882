// SPDX-License-Identifier: MIT
#pragma once

#include "ui/select/SelectTools.h"

#include <QObject>

class QAction;
class QActionGroup;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QMenu;
class QToolBar;

namespace punctum::ui
{

class EditDock;
class Menus;
class Selection;
class Workspace;

/// The menu Select, and the bar with its tools, how they put shapes together, how deep they reach, and the count.
/// GUI thread only; a child of the window. Borrows what it is made with.
class SelectBar final : public QObject
{
    Q_OBJECT
public:
    SelectBar(Menus& menus, Workspace& workspace, Selection& selection, SelectTools& tools, EditDock& edit);

    QToolBar& bar() noexcept { return *m_bar; }
    /// "1,204 points selected, 301 of them not visible".
    QString countText() const;

private:
    void addTool(SelectTools::Tool tool, const QString& text, const QString& icon, const QKeySequence& key,
                 const QString& tip);
    void addActions();
    void saveSelected();
    void addChoices();
    /// A thickness that suits the active document, until the user has chosen one for it.
    void presetSlab();
    void takeSettings();
    void takeCount();

    Menus& m_menus;
    Workspace& m_workspace;
    Selection& m_selection;
    SelectTools& m_tools;
    EditDock& m_edit;
    QMenu* m_select;
    QToolBar* m_bar;
    QActionGroup* m_toolActions;
    QComboBox* m_mode;
    QComboBox* m_depth;
    QDoubleSpinBox* m_slab;
    QAction* m_slabAction = nullptr;
    bool m_slabIsOwn = false;
    double m_slabPreset = 0.0;
    QLabel* m_count;
};

}  // namespace punctum::ui
