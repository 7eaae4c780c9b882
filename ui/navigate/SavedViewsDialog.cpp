// SPDX-License-Identifier: MIT
#include "ui/navigate/SavedViewsDialog.h"

#include "ui/navigate/Places.h"
#include "ui/style/Widgets.h"

#include <QDialogButtonBox>
#include <QFileInfo>
#include <QHeaderView>
#include <QLabel>
#include <QPointer>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTreeWidget>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

SavedViewsDialog::SavedViewsDialog(Places& places, QWidget* parent)
    : QDialog(parent), m_places(places), m_list(new QTreeWidget), m_problem(new QLabel)
{
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("savedViews"));
    setWindowTitle(tr("Saved views"));
    m_list->setColumnCount(2);
    m_list->setHeaderLabels({tr("Name"), tr("File")});
    m_list->setRootIsDecorated(false);
    m_list->setEditTriggers(QAbstractItemView::NoEditTriggers);
    m_list->setAccessibleName(tr("Saved views"));
    m_list->header()->setSectionResizeMode(0, QHeaderView::Stretch);
    m_list->header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
    m_list->header()->setStretchLastSection(false);
    m_problem->setTextFormat(Qt::PlainText);
    m_problem->setWordWrap(true);
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    m_go = buttons->addButton(tr("&Go There"), QDialogButtonBox::ActionRole);
    m_rename = buttons->addButton(tr("&Rename"), QDialogButtonBox::ActionRole);
    m_remove = buttons->addButton(tr("&Delete"), QDialogButtonBox::ActionRole);
    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(16, 16, 16, 12);
    column->setSpacing(10);
    column->addWidget(m_list, 1);
    column->addWidget(m_problem);
    column->addWidget(buttons);
    resize(520, 320);

    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
    connect(m_list, &QTreeWidget::currentItemChanged, this, &SavedViewsDialog::takeChoice);
    connect(m_list, &QTreeWidget::itemChanged, this, &SavedViewsDialog::takeName);
    connect(m_list, &QTreeWidget::itemDoubleClicked, this, [this] {
        if (const SavedViews::View* view = chosen()) m_places.recall(*view);
    });
    connect(m_go, &QPushButton::clicked, this, [this] {
        if (const SavedViews::View* view = chosen()) m_places.recall(*view);
    });
    connect(m_rename, &QPushButton::clicked, this, [this] { m_list->editItem(m_list->currentItem(), 0); });
    connect(m_remove, &QPushButton::clicked, this, [this] {
        if (const SavedViews::View* view = chosen()) m_places.remove(*view);
    });
    // Later: what the list's own items have begun, such as taking a name, must end before they go.
    connect(&m_places, &Places::savedViewsChanged, this, &SavedViewsDialog::fill, Qt::QueuedConnection);
    fill();
}

QString SavedViewsDialog::problem() const
{
    return m_problem->text();
}

void SavedViewsDialog::fill()
{
    const int row = std::max(m_list->indexOfTopLevelItem(m_list->currentItem()), 0);
    m_views = m_places.views();
    const QSignalBlocker quiet(m_list);
    m_list->clear();
    for (const SavedViews::View& view : m_views) {
        auto* const item = new QTreeWidgetItem(m_list, {view.name, QFileInfo(view.file).fileName()});
        item->setFlags(item->flags() | Qt::ItemIsEditable);
        item->setToolTip(1, view.file);
    }
    if (!m_views.empty()) m_list->setCurrentItem(m_list->topLevelItem(std::min(row, int(m_views.size()) - 1)));
    m_problem->setText(m_views.empty() ? tr("No view of these files is saved.") : QString());
    takeChoice();
}

const SavedViews::View* SavedViewsDialog::chosen() const
{
    const int row = m_list->indexOfTopLevelItem(m_list->currentItem());
    return row < 0 || std::size_t(row) >= m_views.size() ? nullptr : &m_views[std::size_t(row)];
}

void SavedViewsDialog::takeChoice()
{
    for (QPushButton* const button : {m_go, m_rename, m_remove}) button->setEnabled(chosen() != nullptr);
}

void SavedViewsDialog::takeName()
{
    const SavedViews::View* const view = chosen();
    if (!view) return;
    const QString name = m_list->currentItem()->text(0);
    if (name == view->name || m_places.rename(*view, name)) return;
    {
        const QSignalBlocker quiet(m_list);
        m_list->currentItem()->setText(0, view->name);
    }
    m_problem->setText(name.trimmed().isEmpty() ? tr("A view needs a name.")
                                                : tr("Another view of this file has the name \"%1\".").arg(name));
}

}  // namespace punctum::ui
