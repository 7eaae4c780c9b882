// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Recipe.h"

#include <QModelIndex>
#include <QObject>

#include <functional>

class QMenu;

namespace punctum::ui
{

class AttributesModel;
class AttributesView;
class Workspace;

/// The menu on the list of attributes: adds, renames and removes them. Each is one step that can be undone. GUI
/// thread only; borrows all three, which must outlive it.
class AttributeActions final : public QObject
{
    Q_OBJECT
public:
    AttributeActions(Workspace& workspace, AttributesModel& model, AttributesView& view, QObject* parent = nullptr);

    /// For the attribute at a place of the list, or for none. The caller shows and deletes it.
    QMenu* makeMenu(const QModelIndex& index);

signals:
    /// The attribute that is shown has this name now.
    void shownRenamed(const QString& name);

private:
    void askAdd();
    void askRename(const QString& name);
    void run(const QString& title, const Recipe& recipe, std::function<void()> done = {});

    Workspace& m_workspace;
    AttributesModel& m_model;
    AttributesView& m_view;
};

}  // namespace punctum::ui
