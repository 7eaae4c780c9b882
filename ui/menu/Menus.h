// SPDX-License-Identifier: MIT
#pragma once

#include <QAction>
#include <QKeySequence>
#include <QList>
#include <QObject>
#include <QString>

#include <functional>
#include <vector>

class QActionGroup;
class QMainWindow;
class QMenu;
class QToolBar;

namespace punctum::ui
{

/// Where the window's parts put their entries: the menu bar, the tool bar, and all actions with their shortcuts.
/// It knows no part, and what an action does is the part's.
///
/// GUI thread only. A child of the window, and brings its tool bar.
class Menus final : public QObject
{
    Q_OBJECT
public:
    explicit Menus(QMainWindow& window);

    /// Parent of the dialogs that an action opens.
    QMainWindow& window() noexcept { return m_window; }
    QToolBar& toolBar() noexcept { return *m_toolBar; }

    /// A menu of the bar, at its end or where addMenusBefore() says.
    QMenu& addMenu(const QString& title);
    void addMenusBefore(QMenu& menu) { m_before = &menu; }
    /// The menu View, and in it the entry before which places stand that the view can go to.
    QMenu& viewMenu() noexcept { return *m_viewMenu; }
    QAction* placesEnd() const noexcept { return m_placesEnd; }
    void setViewMenu(QMenu& menu) { m_viewMenu = &menu; }
    void setPlacesEnd(QAction* action) { m_placesEnd = action; }

    /// An action of this menu (null: of none), listed with the shortcuts.
    QAction* add(QMenu* menu, const QString& text, const QString& icon, const QList<QKeySequence>& keys,
                 const QString& tip, std::function<void()> act);
    /// A tool of the view that is on or off; at most one of its group is on. Marks it with `id`.
    QAction* addTool(QMenu* menu, QActionGroup* group, int id, const QString& text, const QString& icon,
                     const QList<QKeySequence>& keys, const QString& tip, std::function<void(bool on)> toggled);
    /// It is off while nothing is open.
    void needsDocument(QAction* action);
    void setDocumentOpen(bool open);

    /// "Ctrl+O  Open", one line an action that has a shortcut, by menus; for the help page.
    struct Shortcut {
        QString group, keys, what;
    };
    std::vector<Shortcut> shortcuts() const;
    /// What the help page calls an action whose text changes.
    static void setLastingName(QAction& action, const QString& name);

signals:
    /// A tool was switched: keys are to go to the view.
    void viewWanted();

private:
    QMainWindow& m_window;
    QToolBar* m_toolBar;
    QMenu* m_before = nullptr;
    QMenu* m_viewMenu = nullptr;
    QAction* m_placesEnd = nullptr;
    std::vector<QAction*> m_needDocument;
    std::vector<QAction*> m_all;
};

}  // namespace punctum::ui
