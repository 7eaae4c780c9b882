// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>

#include <map>

class QLabel;
class QVBoxLayout;

namespace punctum::ui
{

class JobsModel;
class Workspace;

/// One row for each job: what it is, what it does now, how far it is, a button to stop it. GUI thread only.
class JobsDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit JobsDock(Workspace& workspace, QWidget* parent = nullptr);
    JobsModel& model() noexcept { return *m_model; }

private:
    void updateRows(int first, int last);
    void updateEmpty();

    JobsModel* m_model = nullptr;
    QVBoxLayout* m_column = nullptr;
    QLabel* m_empty = nullptr;
    std::map<quint64, QWidget*> m_rows;
};

}  // namespace punctum::ui
