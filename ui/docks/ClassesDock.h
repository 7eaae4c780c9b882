// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>
#include <QPointer>

class QLabel;
class QMenu;
class QModelIndex;
class QPushButton;
class QTableView;

namespace punctum
{
enum class SelectMode;
}

namespace punctum::ui
{

class ClassesModel;
class Document;
class ViewSettings;

/// The classes of the active document: the legend of Classification, and what is shown of it. GUI thread only.
class ClassesDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit ClassesDock(ViewSettings& settings, QWidget* parent = nullptr);

    void setDocument(Document* document);
    ClassesModel& model() noexcept { return *m_model; }
    QTableView& view() noexcept { return *m_view; }
    /// For the class at a place of the list. The caller shows and deletes it.
    QMenu* makeMenu(const QModelIndex& index);

signals:
    void selectWanted(unsigned code, punctum::SelectMode mode);

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    void chooseColor(const QModelIndex& index);
    void updateHint();

    ViewSettings& m_settings;
    ClassesModel* m_model = nullptr;
    QTableView* m_view = nullptr;
    QLabel* m_hint = nullptr;
    QPushButton* m_all = nullptr;
    QPushButton* m_none = nullptr;
    QPointer<Document> m_document;
};

}  // namespace punctum::ui
