// SPDX-License-Identifier: MIT
#pragma once

#include "ui/navigate/SavedViews.h"

#include <QDialog>

class QLabel;
class QPushButton;
class QTreeWidget;

namespace punctum::ui
{

class Places;

/// Lists the saved views of the files that are open, to go there, rename and delete them. GUI thread only; deletes
/// itself when it is closed.
class SavedViewsDialog final : public QDialog
{
    Q_OBJECT
public:
    SavedViewsDialog(Places& places, QWidget* parent);

    QTreeWidget& list() noexcept { return *m_list; }
    QPushButton& goButton() noexcept { return *m_go; }
    QPushButton& renameButton() noexcept { return *m_rename; }
    QPushButton& removeButton() noexcept { return *m_remove; }
    /// Why a name was not taken; empty when all is well.
    QString problem() const;

private:
    void fill();
    const SavedViews::View* chosen() const;
    void takeChoice();
    void takeName();

    Places& m_places;
    std::vector<SavedViews::View> m_views;
    QTreeWidget* m_list;
    QLabel* m_problem;
    QPushButton *m_go, *m_rename, *m_remove;
};

}  // namespace punctum::ui
