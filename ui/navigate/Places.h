// SPDX-License-Identifier: MIT
#pragma once

#include "ui/navigate/SavedViews.h"

#include <QObject>

#include <glm/vec3.hpp>

#include <vector>

class QAction;
class QMenu;

namespace punctum::ui
{

class AxesMark;
class Menus;
class Viewport;
class WindowSettings;
class Workspace;

/// Where the main view may go, and how it looks there: orthographic or not, the axes in its corner, a coordinate,
/// views that were saved, the camera as a file. Brings its entries into the View menu. GUI thread only; a child of
/// the window, borrows what it is made with.
class Places final : public QObject
{
    Q_OBJECT
public:
    Places(Menus& menus, Workspace& workspace, Viewport& view, WindowSettings& settings);

    AxesMark& axes() noexcept { return *m_axes; }

    /// Asks for a coordinate.
    void askCoordinate();
    /// Goes there, and says so when it lies outside of all that is open. Without `hasHeight` the view stays as high
    /// as it is.
    void goTo(glm::dvec3 world, bool hasHeight);

    /// Those of the files that are open, of the active one first.
    std::vector<SavedViews::View> views() const;
    /// Asks for a name.
    void askName();
    void save(const QString& name);
    void recall(const SavedViews::View& view);
    /// The number k of views(), from 1 on, as the keys count; says so when there is none.
    void recall(int number);
    /// False when the name is none, or taken.
    bool rename(const SavedViews::View& view, const QString& name);
    /// Asks first.
    void remove(const SavedViews::View& view);
    /// The main view's camera as `punctum render --camera` reads it.
    QString cameraText() const;
    /// Writes that by a job.
    void writeCamera(const QString& path);

signals:
    void savedViewsChanged();

private:
    void addActions();
    void addSavedViews(QMenu& menu);
    void fillMenu();
    void chooseCameraFile();
    void say(const QString& sentence);
    void keep();

    Menus& m_menus;
    Workspace& m_workspace;
    Viewport& m_view;
    WindowSettings& m_settings;
    AxesMark* m_axes;
    SavedViews m_saved;
    QMenu* m_menu = nullptr;         ///< of saved views
    QAction* m_listEnd = nullptr;    ///< in it, what comes after the views
    std::vector<QAction*> m_listed;  ///< the views in it
};

}  // namespace punctum::ui
