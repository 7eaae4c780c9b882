// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>
#include <QPointer>

class QListWidget;

namespace punctum::ui
{

class Document;
class Workspace;

/// The edits of the active document in order; a click on one walks there, undoing or redoing what lies between.
/// GUI thread only.
class HistoryDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit HistoryDock(Workspace& workspace, QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// What an item tells beside its text: how many points its edit changed.
    static constexpr int kCountRole = Qt::UserRole;

    QListWidget& list() noexcept { return *m_list; }

private:
    void fill();

    Workspace& m_workspace;
    QPointer<Document> m_document;
    QListWidget* m_list;
};

}  // namespace punctum::ui
