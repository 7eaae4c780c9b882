// SPDX-License-Identifier: MIT
#pragma once

#include <QList>
#include <QObject>
#include <QPointer>
#include <QTimer>

class QDockWidget;
class QMainWindow;

namespace punctum::ui
{

/// Where the panels of a window stand, and how all of them make room for the view at once.
///
/// GUI thread only. A child of the window.
class Panels final : public QObject
{
    Q_OBJECT
public:
    explicit Panels(QMainWindow& window);

    /// Panels at the left, one below the other, under titles.
    void addLeft(const QList<QDockWidget*>& docks);
    /// Panels at the right that share a place; their tabs say their names.
    void addRight(const QList<QDockWidget*>& docks);
    /// Widths and heights as they suit the window's size; for a window that nobody has arranged.
    void arrange();
    /// Brings a panel to the front and, where it stands lower, makes it as high as its rows need, up to a part of
    /// the window. One that was closed stays closed.
    void bring(QDockWidget& dock, int height);
    bool eventFilter(QObject* watched, QEvent* event) override;

    /// Whether one can be seen.
    bool shown() const;
    /// Hides all that are shown, or shows those that were hidden so.
    void toggle();

private:
    /// In a window that has become small the panels give the view what they can do without.
    void makeRoom();

    QMainWindow& m_window;
    QTimer m_resized;
    QList<QDockWidget*> m_left;
    QList<QList<QDockWidget*>> m_right;
    QList<QPointer<QDockWidget>> m_hidden;
};

}  // namespace punctum::ui
