// SPDX-License-Identifier: MIT
#pragma once

#include "ui/view/ViewRenderer.h"

#include <QDockWidget>
#include <QListView>
#include <QTimer>

class QComboBox;

namespace punctum::ui
{

class AttributeActions;
class AttributesModel;
class ColorPanel;
class Document;
class ViewSettings;
class Workspace;

/// The list: an attribute is dragged as a chip that bears its name.
class AttributesView final : public QListView
{
    Q_OBJECT
public:
    explicit AttributesView(QWidget* parent = nullptr);

protected:
    void resizeEvent(QResizeEvent* event) override;
    void startDrag(Qt::DropActions actions) override;
};

/// Attributes of the active document, and how the shown one becomes colors. GUI thread only.
class AttributesDock final : public QDockWidget
{
    Q_OBJECT
public:
    AttributesDock(Workspace& workspace, ViewSettings& settings, QWidget* parent = nullptr);

    void setDocument(Document* document);
    /// What the newest picture shows.
    void setFrame(const Frame& frame);
    AttributesModel& model() noexcept { return *m_model; }
    AttributesView& view() noexcept { return *m_view; }
    AttributeActions& actions() noexcept { return *m_actions; }
    /// The list of open files; there while there are several.
    const QComboBox& files() const noexcept { return *m_files; }

signals:
    void attributeChosen(const QString& name);

private:
    void updateFiles();

    Workspace& m_workspace;
    AttributesModel* m_model = nullptr;
    AttributesView* m_view = nullptr;
    AttributeActions* m_actions = nullptr;
    ColorPanel* m_colors = nullptr;
    QComboBox* m_files = nullptr;
    QTimer m_filesTimer;
};

}  // namespace punctum::ui
