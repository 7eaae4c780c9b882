// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"
#include "ui/style/Theme.h"

#include <QAction>
#include <QObject>
#include <QStringList>

#include <functional>
#include <vector>

class QActionGroup;
class QMenu;
class QToolBar;

namespace punctum::ui
{

class Document;
class MainWindow;
class ViewSettings;

/// Menus, tool bar and shortcuts of the window: every action in one place. What they do is the window's.
/// GUI thread only; a child of the window.
class MainMenu final : public QObject
{
    Q_OBJECT
public:
    explicit MainMenu(MainWindow& window);

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
    /// "Ctrl+O  Open", one line an action that has a shortcut, by menus; for the help page.
    struct Shortcut {
        QString group, keys, what;
    };
    std::vector<Shortcut> shortcuts() const;
    /// For parts that bring actions of their own: listed with the shortcuts, and off while nothing is open.
    QAction* add(QMenu* menu, const QString& text, const QString& icon, const QList<QKeySequence>& keys,
                 const QString& tip, std::function<void()> act);
    void needsDocument(QAction* action);
    /// A tool of the view that is on or off; at most one of its group is on. Marks it with `id`.
    QAction* addTool(QMenu* menu, QActionGroup* group, int id, const QString& text, const QString& icon,
                     const QList<QKeySequence>& keys, const QString& tip, std::function<void(bool on)> toggled);
    /// A menu before Process.
    QMenu& insertMenu(const QString& title);
    QToolBar& toolBar() noexcept { return *m_toolBar; }
    QMenu& viewMenu() noexcept { return *m_viewMenu; }
    /// In the View menu, what comes after the places that the view can go to.
    QAction* placesEnd() const noexcept { return m_placesEnd; }

    QAction* open = nullptr;
    QAction* save = nullptr;
    QAction* saveAs = nullptr;
    QAction* screenshot = nullptr;
    QAction* close = nullptr;
    QAction* undo = nullptr;
    QAction* redo = nullptr;
    QAction* fit = nullptr;
    QAction* fullScreen = nullptr;

signals:
    void backendChosen(std::optional<punctum::render::BackendKind> kind);
    void orderChosen(punctum::render::OrderKind order);
    void appearanceChosen(punctum::ui::Appearance appearance);
    void recentChosen(const QString& path);
    void recentCleared();

private:
    void takeUndo();
    void makeFile();
    void makeEdit();
    void makeView();
    void chooseBackground(ViewSettings& settings);
    void makeProcess();
    void makeHelp();
    void makeToolBar();

    MainWindow& m_window;
    QToolBar* m_toolBar = nullptr;
    QMenu* m_processMenu = nullptr;
    QMenu* m_viewMenu = nullptr;
    QAction* m_placesEnd = nullptr;
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
    std::vector<QAction*> m_needDocument;
    std::vector<QAction*> m_all;
    QString m_colorKey;  ///< what the "color by" menu was made from
};

}  // namespace punctum::ui
