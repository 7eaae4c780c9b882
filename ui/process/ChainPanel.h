// SPDX-License-Identifier: MIT
#pragma once

#include "ui/process/StepWish.h"

#include <QWidget>

#include <vector>

class QLabel;
class QListWidget;
class QPushButton;
class QToolButton;

namespace punctum::ui
{

class Workspace;

/// Steps that are to run one after another: their order, and as a recipe in a file. GUI thread only.
class ChainPanel final : public QWidget
{
    Q_OBJECT
public:
    explicit ChainPanel(Workspace& workspace, QWidget* parent = nullptr);

    const std::vector<StepWish>& chain() const noexcept { return m_chain; }
    void add(StepWish wish);
    void setChain(std::vector<StepWish> chain);
    /// Whether something runs: nothing can be changed then.
    void setBusy(bool busy);
    /// Marks the step that runs; -1: none.
    void setCurrent(int row);
    /// By jobs; what goes wrong is told by failed().
    void saveTo(const QString& path);
    void loadFrom(const QString& path);
    QListWidget& list() noexcept { return *m_list; }
    QPushButton& runButton() noexcept { return *m_run; }

signals:
    void runWanted();
    /// A step of it was chosen to be looked at.
    void chosen(int row);
    void failed(const QString& sentence);

private:
    void fill();
    void take();
    void move(int by);
    void removeCurrent();
    QToolButton* button(const QString& icon, const QString& tip);

    Workspace& m_workspace;
    std::vector<StepWish> m_chain;
    QListWidget* m_list;
    QToolButton *m_up, *m_down, *m_remove, *m_save, *m_load;
    QPushButton* m_run;
    bool m_busy = false;
};

}  // namespace punctum::ui
