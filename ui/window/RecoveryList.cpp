// SPDX-License-Identifier: MIT
#include "ui/window/RecoveryList.h"

#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/style/Widgets.h"

#include <QDateTime>
#include <QDialogButtonBox>
#include <QHeaderView>
#include <QPointer>
#include <QPushButton>
#include <QTreeWidget>
#include <QVBoxLayout>

#include <algorithm>
#include <chrono>

namespace punctum::ui
{

namespace
{

/// The file that the edits are of, or how many they are.
QString fileText(const KeptJournal& journal)
{
    return journal.files.size() == 1 ? toQString(journal.files.front().filename())
                                     : RecoveryList::tr("%1 files").arg(countText(journal.files.size()));
}

}  // namespace

RecoveryList::RecoveryList(Workspace& workspace, QWidget* parent)
    : QDialog(parent), m_workspace(workspace), m_list(new QTreeWidget)
{
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("recoveryList"));
    setWindowTitle(tr("Recover edits"));
    auto* text = dimLabel(tr(
        "Edits that were not saved before the program ended. Recover opens the file and does them again, which can "
        "be undone; the points must be those of then."));
    text->setWordWrap(true);
    m_list->setColumnCount(4);
    m_list->setHeaderLabels({tr("File"), tr("Edits"), tr("Last edit"), tr("State")});
    m_list->setRootIsDecorated(false);
    m_list->setAccessibleName(tr("Unsaved edits"));
    m_list->header()->setSectionResizeMode(QHeaderView::ResizeToContents);
    m_list->header()->setSectionResizeMode(1, QHeaderView::Stretch);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    m_recover = buttons->addButton(tr("&Recover"), QDialogButtonBox::ActionRole);
    m_remove = buttons->addButton(tr("&Delete"), QDialogButtonBox::ActionRole);
    m_remove->setToolTip(tr("Throw these edits away for good"));
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(16, 16, 16, 12);
    column->setSpacing(10);
    column->addWidget(text);
    column->addWidget(m_list, 1);
    column->addWidget(buttons);
    resize(760, 340);

    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
    connect(m_list, &QTreeWidget::currentItemChanged, this, &RecoveryList::takeChoice);
    connect(m_recover, &QPushButton::clicked, this, [this] {
        if (const KeptJournal* journal = chosen()) m_workspace.recovery().recoverKept(*journal);
        close();
    });
    connect(m_remove, &QPushButton::clicked, this, [this] {
        const KeptJournal* const journal = chosen();
        if (!journal || !m_workspace.askQuestion) return;
        m_workspace.askQuestion(
            {tr("Delete these edits?"),
             tr("%1 of %2 cannot be recovered then.").arg(editsText(journal->edits), fileText(*journal)),
             tr("&Delete")},
            [self = QPointer(this), path = journal->path](bool wanted) {
                if (!self || !wanted) return;
                self->m_workspace.recovery().removeKept(path, [self] {
                    if (self) self->look();
                });
            });
    });
    takeChoice();
    look();
}

void RecoveryList::look()
{
    m_workspace.recovery().listKept([self = QPointer(this)](std::vector<KeptJournal> journals) {
        if (self) self->fill(std::move(journals));
    });
}

void RecoveryList::fill(std::vector<KeptJournal> journals)
{
    m_journals = std::move(journals);
    m_list->clear();
    for (const KeptJournal& journal : m_journals) {
        const auto changed = QDateTime::fromSecsSinceEpoch(std::chrono::system_clock::to_time_t(journal.changed));
        const QString edits = editsText(journal.edits);
        QStringList files;
        for (const std::filesystem::path& file : journal.files) files << toQString(file);
        auto* item = new QTreeWidgetItem(
            m_list, {fileText(journal), edits, windowLocale().toString(changed, QLocale::ShortFormat),
                     journal.setAside ? tr("set aside") : tr("waits for its file")});
        item->setToolTip(0, files.join(QLatin1Char('\n')));
        item->setToolTip(1, edits);
    }
    if (!m_journals.empty()) m_list->setCurrentItem(m_list->topLevelItem(0));
    takeChoice();
}

const KeptJournal* RecoveryList::chosen() const
{
    const int row = m_list->indexOfTopLevelItem(m_list->currentItem());
    return row < 0 || std::size_t(row) >= m_journals.size() ? nullptr : &m_journals[std::size_t(row)];
}

void RecoveryList::takeChoice()
{
    for (QPushButton* button : {m_recover, m_remove}) button->setEnabled(chosen() != nullptr);
}

}  // namespace punctum::ui
