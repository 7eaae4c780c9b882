// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Recovery.h"

#include <QDialog>

#include <vector>

class QPushButton;
class QTreeWidget;

namespace punctum::ui
{

/// Lists the unsaved edits of before crashes that wait or were set aside, and gives them back: opens the file where
/// it is not open, and does them again. GUI thread only; deletes itself when it is closed.
class RecoveryList final : public QDialog
{
    Q_OBJECT
public:
    RecoveryList(Workspace& workspace, QWidget* parent);

    QTreeWidget& list() noexcept { return *m_list; }
    QPushButton& recoverButton() noexcept { return *m_recover; }
    QPushButton& removeButton() noexcept { return *m_remove; }

private:
    void look();
    void fill(std::vector<KeptJournal> journals);
    const KeptJournal* chosen() const;
    void takeChoice();

    Workspace& m_workspace;
    std::vector<KeptJournal> m_journals;
    QTreeWidget* m_list;
    QPushButton* m_recover;
    QPushButton* m_remove;
};

}  // namespace punctum::ui
