// SPDX-License-Identifier: MIT
#include "ui/Panels.h"

#include <QDockWidget>
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
constexpr int kLeastLeft = 230, kMostLeft = 350, kLeastRight = 230, kMostRight = 310;
constexpr double kAttributesShare = 0.7, kProcessingShare = 0.8;  // of the window's height

}  // namespace

Panels::Panels(QMainWindow& window) : QObject(&window), m_window(window)
{
    m_window.setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
    m_window.setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
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
                         {std::clamp(int(width * kLeftShare), kLeastLeft, kMostLeft),
                          std::clamp(int(width * kRightShare), kLeastRight, kMostRight)},
                         Qt::Horizontal);
    const auto split = [&](QDockWidget* upper, QDockWidget* lower, double share) {
        m_window.resizeDocks({upper, lower}, {int(height * share), int(height * (1.0 - share))}, Qt::Vertical);
    };
    split(m_left.front(), m_left.back(), kAttributesShare);
    split(m_right.front().front(), m_right.back().front(), kProcessingShare);
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
