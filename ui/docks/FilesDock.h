// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <QDockWidget>
#include <QPointer>

#include <cstddef>
#include <vector>

class QLabel;
class QLineEdit;
class QMenu;
class QPushButton;
class QSortFilterProxyModel;
class QTableView;

namespace punctum::ui
{

class Document;
class FilesModel;
class Workspace;

/// The files of the active document: how large each is and where, whether it is shown, and whether something of it
/// is not saved. Zooms to files, shows and hides them, saves some of them alone, and takes them out of a survey.
/// GUI thread only; borrows the workspace.
class FilesDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit FilesDock(Workspace& workspace, QWidget* parent = nullptr);

    void setDocument(Document* document);

    FilesModel& model() noexcept { return *m_model; }
    QTableView& view() noexcept { return *m_view; }
    QLineEdit& search() noexcept { return *m_search; }
    QPushButton& zoomButton() noexcept { return *m_zoom; }
    QPushButton& saveButton() noexcept { return *m_save; }
    QPushButton& removeButton() noexcept { return *m_remove; }
    QString summary() const;
    /// px, with which so many rows are seen.
    int heightFor(std::size_t rows) const;
    /// Places in Document::parts() of the chosen rows, rising.
    std::vector<std::size_t> chosen() const;
    /// What a right click brings, about the chosen rows; the caller owns it.
    QMenu* makeMenu();

protected:
    void resizeEvent(QResizeEvent* event) override;

signals:
    void zoomWanted(const punctum::WorldBounds& bounds);
    /// The document is to go on without these files.
    void removeWanted(punctum::ui::Document* document, const std::vector<std::size_t>& parts);

private:
    void updateSummary();
    void updateButtons();
    void updateColumns();
    void zoom();
    void saveChosen();
    void setShown(bool shown);
    void showOnly();
    /// Of the chosen ones, those that have changed.
    std::vector<std::size_t> changedOnes() const;

    Workspace& m_workspace;
    QPointer<Document> m_document;
    FilesModel* m_model;
    QSortFilterProxyModel* m_sorted;
    QTableView* m_view;
    QLabel* m_hint;
    QLineEdit* m_search;
    QPushButton *m_all, *m_none, *m_zoom, *m_save, *m_remove;
};

}  // namespace punctum::ui
