// SPDX-License-Identifier: MIT
#pragma once

#include <QFrame>

class QLabel;
class QPushButton;

namespace punctum::ui
{

struct ShownState;
class ViewScope;
class Viewport;

/// Says in a view that points are hidden or deleted, how many are shown and what hides the others, and has a button
/// that shows all. Not there while all points are shown. GUI thread only; a child of the view.
class ShownPill final : public QFrame
{
    Q_OBJECT
public:
    ShownPill(Viewport& viewport, ViewScope& scope);

    void take(const ShownState& state);
    QString text() const;
    QPushButton& showAllButton() noexcept { return *m_showAll; }

private:
    Viewport& m_viewport;
    QLabel* m_text;
    QPushButton* m_showAll;
};

}  // namespace punctum::ui
