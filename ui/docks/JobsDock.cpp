// SPDX-License-Identifier: MIT
#include "ui/docks/JobsDock.h"

#include "core/task/Jobs.h"
#include "ui/docks/JobsModel.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QGridLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>
#include <QVBoxLayout>

#include <cmath>

namespace punctum::ui
{

namespace
{

/// One job.
class JobRow final : public QWidget
{
public:
    JobRow(JobsModel& model, quint64 id)
        : m_title(new QLabel),
          m_percent(dimLabel({})),
          m_stage(dimLabel({})),
          m_bar(new QProgressBar),
          m_close(new QToolButton)
    {
        m_stage->setFont(scaledFont(font(), 0.9));
        m_stage->setWordWrap(true);
        m_stage->setTextInteractionFlags(Qt::TextSelectableByMouse);
        m_title->setTextFormat(Qt::PlainText);
        m_stage->setTextFormat(Qt::PlainText);
        m_bar->setRange(0, 1000);
        m_bar->setTextVisible(false);
        m_close->setIcon(lineIcon(QStringLiteral("close")));
        m_close->setIconSize(QSize(13, 13));
        QObject::connect(m_close, &QToolButton::clicked, &model, [&model, id] { model.closeOrCancel(id); });
        auto* grid = new QGridLayout(this);
        grid->setContentsMargins(0, 2, 0, 6);
        grid->setHorizontalSpacing(8);
        grid->setVerticalSpacing(3);
        grid->addWidget(m_title, 0, 0);
        grid->addWidget(m_percent, 0, 1);
        grid->addWidget(m_close, 0, 2, 2, 1, Qt::AlignVCenter);
        grid->addWidget(m_bar, 1, 0, 1, 2);
        grid->addWidget(m_stage, 2, 0, 1, 3);
        grid->setColumnStretch(0, 1);
    }

    void show(const QModelIndex& index)
    {
        const JobState state = JobState(index.data(JobsModel::StateRole).toInt());
        const double fraction = index.data(JobsModel::FractionRole).toDouble();
        const bool running = state == JobState::Running;
        m_title->setText(index.data().toString());
        m_title->setToolTip(index.data().toString());
        m_stage->setText(index.data(JobsModel::StageRole).toString());
        m_stage->setToolTip(index.data(JobsModel::ErrorRole).toString());
        m_bar->setValue(int(std::lround(fraction * 1000.0)));
        m_bar->setVisible(running);
        m_percent->setText(running ? QStringLiteral("%1 %").arg(int(fraction * 100.0)) : QString());
        m_close->setToolTip(running ? QObject::tr("Stop this job") : QObject::tr("Remove from the list"));
        m_close->setAccessibleName(m_close->toolTip());
        m_stage->setStyleSheet(
            state == JobState::Failed ? QStringLiteral("color: %1;").arg(themeColors().error.name()) : QString());
    }

private:
    QLabel* m_title;
    QLabel* m_percent;
    QLabel* m_stage;
    QProgressBar* m_bar;
    QToolButton* m_close;
};

}  // namespace

JobsDock::JobsDock(Workspace& workspace, QWidget* parent)
    : QDockWidget(tr("Jobs"), parent),
      m_model(new JobsModel(workspace, this)),
      m_empty(dimLabel(tr("Nothing runs.")))
{
    setObjectName(QStringLiteral("jobs"));
    auto* content = new QWidget;
    m_column = new QVBoxLayout(content);
    m_column->setContentsMargins(12, 8, 10, 8);
    m_column->setSpacing(2);
    m_column->addWidget(m_empty);
    m_column->addStretch(1);
    setWidget(scrollColumn(content));

    connect(m_model, &QAbstractItemModel::rowsInserted, this, [this](const QModelIndex&, int first, int last) {
        for (int row = first; row <= last; ++row) {
            const quint64 id = m_model->index(row).data(JobsModel::IdRole).toULongLong();
            auto* widget = new JobRow(*m_model, id);
            m_rows[id] = widget;
            m_column->insertWidget(row + 1, widget);  // behind the word that nothing runs
        }
        updateRows(first, last);
        updateEmpty();
    });
    connect(m_model, &QAbstractItemModel::rowsAboutToBeRemoved, this,
            [this](const QModelIndex&, int first, int last) {
                for (int row = first; row <= last; ++row) {
                    const auto found = m_rows.find(m_model->index(row).data(JobsModel::IdRole).toULongLong());
                    if (found == m_rows.end()) continue;
                    found->second->hide();
                    found->second->deleteLater();
                    m_rows.erase(found);
                }
                updateEmpty();
            });
    connect(m_model, &QAbstractItemModel::dataChanged, this,
            [this](const QModelIndex& first, const QModelIndex& last) { updateRows(first.row(), last.row()); });
}

void JobsDock::updateRows(int first, int last)
{
    for (int row = first; row <= last; ++row) {
        const QModelIndex index = m_model->index(row);
        const auto found = m_rows.find(index.data(JobsModel::IdRole).toULongLong());
        if (found != m_rows.end()) static_cast<JobRow*>(found->second)->show(index);
    }
}

void JobsDock::updateEmpty()
{
    m_empty->setVisible(m_rows.empty());
}

}  // namespace punctum::ui
