// SPDX-License-Identifier: MIT
#include "ui/window/Panels.h"

#include "ui/style/Theme.h"

#include <QDockWidget>
#include <QEvent>
#include <QLabel>
#include <QMainWindow>

#include <algorithm>
#include <utility>

namespace punctum::ui
{

namespace
{

// Shares of the window's width, and px: wide enough to read, and the view has most of it.
constexpr double kLeftShare = 0.235, kRightShare = 0.21;
constexpr int kMostLeft = 350, kMostRight = 310;
constexpr int kLeastView = 560;                                   // px, as long as the panels can do with less
constexpr double kBroughtShare = 0.45;                            // of the window's height, at most
constexpr double kAttributesShare = 0.7, kProcessingShare = 0.8;  // of the window's height

}  // namespace

Panels::Panels(QMainWindow& window) : QObject(&window), m_window(window)
{
    m_window.setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
    m_window.setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
    m_window.installEventFilter(this);
    m_resized.setSingleShot(true);  // when all has its new place
    connect(&m_resized, &QTimer::timeout, this, &Panels::makeRoom);
}

bool Panels::eventFilter(QObject* watched, QEvent* event)
{
    if (event->type() == QEvent::Resize) m_resized.start(0);
    return QObject::eventFilter(watched, event);
}

void Panels::makeRoom()
{
    const QWidget* const view = m_window.centralWidget();
    int lacking = kLeastView - (view ? view->width() : kLeastView);
    QList<QDockWidget*> wide;
    QList<int> widths;
    for (const auto area : {Qt::LeftDockWidgetArea, Qt::RightDockWidgetArea}) {
        // Any that stands there is as wide as all others; those behind it lie outside.
        QDockWidget* panel = nullptr;
        int least = kLeastPanelWidth;
        for (QDockWidget* dock : m_window.findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly)) {
            if (m_window.dockWidgetArea(dock) != area || dock->isFloating() || !dock->isVisible()) continue;
            least = std::max(least, dock->minimumSizeHint().width());
            if (m_window.rect().intersects(dock->geometry())) panel = dock;
        }
        const int spare = panel ? std::min(lacking, panel->width() - least) : 0;
        if (spare <= 0) continue;
        wide << panel;
        widths << panel->width() - spare;
        lacking -= spare;
    }
    m_window.resizeDocks(wide, widths, Qt::Horizontal);
}

void Panels::addLeft(const QList<QDockWidget*>& docks)
{
    for (QDockWidget* dock : docks) {
        m_window.addDockWidget(Qt::LeftDockWidgetArea, dock);
        auto* const title = new QLabel(dock->windowTitle());
        title->setProperty("dockTitle", true);
        dock->setTitleBarWidget(title);
    }
    m_left += docks;
}

void Panels::addRight(const QList<QDockWidget*>& docks)
{
    for (qsizetype k = 0; k < docks.size(); ++k) {
        m_window.addDockWidget(Qt::RightDockWidgetArea, docks[k]);
        if (k > 0) m_window.tabifyDockWidget(docks[k - 1], docks[k]);
        docks[k]->setTitleBarWidget(new QWidget);
    }
    docks.front()->raise();
    m_right << docks;
}

void Panels::arrange()
{
    const int width = m_window.width(), height = m_window.height();
    m_window.resizeDocks({m_left.front(), m_right.front().front()},
                         {std::clamp(int(width * kLeftShare), kLeastPanelWidth, kMostLeft),
                          std::clamp(int(width * kRightShare), kLeastPanelWidth, kMostRight)},
                         Qt::Horizontal);
    const auto split = [&](QDockWidget* upper, QDockWidget* lower, double share) {
        m_window.resizeDocks({upper, lower}, {int(height * share), int(height * (1.0 - share))}, Qt::Vertical);
    };
    split(m_left.front(), m_left.back(), kAttributesShare);
    split(m_right.front().front(), m_right.back().front(), kProcessingShare);
}

void Panels::bring(QDockWidget& dock, int height)
{
    if (dock.isHidden()) return;
    dock.raise();
    const int wanted = std::min(height, int(m_window.height() * kBroughtShare));
    if (!dock.isFloating() && dock.height() < wanted) m_window.resizeDocks({&dock}, {wanted}, Qt::Vertical);
}

bool Panels::shown() const
{
    const QList<QDockWidget*> docks = m_window.findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly);
    // Not isVisible(): of several in one place all but one are hidden behind it.
    return std::any_of(docks.begin(), docks.end(), [](const QDockWidget* dock) { return !dock->isHidden(); });
}

void Panels::toggle()
{
    if (!shown()) {
        for (const QPointer<QDockWidget>& dock : std::exchange(m_hidden, {}))
            if (dock) dock->show();
        if (!shown())  // each of them was closed by hand before
            for (QDockWidget* dock : m_window.findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly)) dock->show();
        return;
    }
    m_hidden.clear();
    for (QDockWidget* dock : m_window.findChildren<QDockWidget*>(Qt::FindDirectChildrenOnly)) {
        if (dock->isHidden()) continue;
        m_hidden << dock;
        dock->hide();
    }
}

}  // namespace punctum::ui
