// SPDX-License-Identifier: MIT
#pragma once

#include <QObject>

class QMainWindow;

namespace punctum::ui
{

/// Keys without Ctrl and Alt, such as Delete, the digits and the letters of tools, act where a view has the keys,
/// and not while a panel or a tool bar has them: there they are meant for a list or a field. A view takes them from
/// a list or a button when the mouse comes to it. GUI thread only; a child of the window, made when its panels and
/// tool bars are there.
class PlainKeys final : public QObject
{
    Q_OBJECT
public:
    explicit PlainKeys(QMainWindow& window);

    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace punctum::ui
