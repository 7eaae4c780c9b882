// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"
#include "ui/style/Theme.h"

#include <QAction>
#include <QList>
#include <QObject>
#include <QStringList>

#include <optional>

class QActionGroup;
class QDockWidget;
class QMenu;

namespace punctum::ui
{

class Document;
class Menus;
class UndoOrder;
class ViewSettings;
class Viewport;

/// The window's own menus and the tool bar: files, undo, the view, panels, steps, help. Parts of the window add
/// theirs to the same Menus. It says what is wanted; who does it is the window's matter. GUI thread only; a child
/// of the window.
class MainMenu final : public QObject
{
    Q_OBJECT
public:
    /// `panels`: listed in the menu View, in this order.
    MainMenu(Menus& menus, UndoOrder& undoOrder, Viewport& viewport, ViewSettings& settings,
             const QList<QDockWidget*>& panels);

    /// Makes actions fit the state of the active document (null: none).
    void update(const Document* document);
    void setRecentFiles(const QStringList& paths);
    void setAttributes(const Document* document, const QString& shown);
    /// None: the fastest.
    void setBackend(std::optional<render::BackendKind> kind);
    void setOrder(render::OrderKind order);
    void setAppearance(Appearance appearance);
    /// Reads the settings that other parts may have changed.
    void takeViewSettings(const ViewSettings& settings);

    QAction* open = nullptr;
    QAction* save = nullptr;
    QAction* saveAs = nullptr;
    QAction* saveAsOneFile = nullptr;
    QAction* screenshot = nullptr;
    QAction* close = nullptr;
    QAction* undo = nullptr;
    QAction* redo = nullptr;
    QAction* fit = nullptr;
    QAction* fullScreen = nullptr;

signals:
    void openWanted();
    void openFolderWanted();
    void saveWanted();
    void saveAsWanted();
    void saveAsOneFileWanted();
    void recoverWanted();
    void screenshotWanted();
    void mapWanted();
    void closeWanted();
    void quitWanted();
    void fitAllWanted();
    void fitActiveWanted();
    void removeStraysWanted();
    /// The next (1) or previous (-1) attribute.
    void attributeStepped(int direction);
    void attributeChosen(const QString& name);
    void panelsToggled();
    /// A processing step, by its name.
    void stepChosen(const QString& name);
    void shortcutsWanted();
    void aboutWanted();
    void backendChosen(std::optional<punctum::render::BackendKind> kind);
    void orderChosen(punctum::render::OrderKind order);
    void appearanceChosen(punctum::ui::Appearance appearance);
    void recentChosen(const QString& path);
    void recentCleared();

private:
    void takeUndo();
    void makeFile();
    void makeEdit();
    void makeView(const QList<QDockWidget*>& panels);
    void chooseBackground();
    QMenu& makeProcess();
    void makeHelp();
    void makeToolBar();

    Menus& m_menus;
    UndoOrder& m_undoOrder;
    Viewport& m_viewport;
    ViewSettings& m_settings;
    QMenu* m_recent = nullptr;
    QMenu* m_colorBy = nullptr;
    QActionGroup* m_views = nullptr;
    QActionGroup* m_backends = nullptr;
    QActionGroup* m_orders = nullptr;
    QActionGroup* m_backgrounds = nullptr;
    QActionGroup* m_samples = nullptr;
    QAction* m_eyeDome = nullptr;
    QAction* m_round = nullptr;
    QAction* m_averaged = nullptr;
    QAction* m_litNormals = nullptr;
    QActionGroup* m_sizings = nullptr;
    QActionGroup* m_appearances = nullptr;
    QString m_colorKey;  ///< what the "color by" menu was made from
};

}  // namespace punctum::ui
