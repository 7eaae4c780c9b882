// SPDX-License-Identifier: MIT
#include "ui/process/StepChooser.h"

#include "core/steps/Steps.h"
#include "ui/basic/Text.h"
#include "ui/process/StepIcons.h"
#include "ui/style/Icons.h"

#include <QCoreApplication>
#include <QKeyEvent>
#include <QLineEdit>
#include <QTreeWidget>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kNameRole = Qt::UserRole;
constexpr int kWordsRole = Qt::UserRole + 1;  ///< all that the search looks through
constexpr int kPicture = 20;                  ///< px

QString wordsOf(const Step& step)
{
    const StepDescription& about = step.description();
    QString words = toQString(about.title + ' ' + about.name + ' ') + toQString(nameOf(about.group)) +
                    toQString(' ' + about.help + ' ' + about.source);
    for (const StepParameter& p : about.parameters) words += toQString(' ' + p.label);
    return words;
}

}  // namespace

StepChooser::StepChooser(QWidget* parent) : QWidget(parent), m_search(new QLineEdit), m_list(new QTreeWidget)
{
    m_search->setPlaceholderText(tr("Search"));
    m_search->setClearButtonEnabled(true);
    m_search->setAccessibleName(tr("Search processing steps"));
    m_search->setToolTip(tr("Finds steps by name, group and what they do; Enter takes the first"));
    m_search->installEventFilter(this);
    m_list->setHeaderHidden(true);
    m_list->setColumnCount(1);
    m_list->setIndentation(10);
    m_list->setRootIsDecorated(false);
    m_list->setIconSize(QSize(kPicture, kPicture));
    m_list->setAccessibleName(tr("Processing steps"));
    m_list->setEditTriggers(QAbstractItemView::NoEditTriggers);
    m_list->setItemsExpandable(false);
    m_list->installEventFilter(this);
    QTreeWidgetItem* group = nullptr;
    const StepDescription* before = nullptr;
    for (const Step* step : allSteps()) {
        const StepDescription& about = step->description();
        if (before == nullptr || before->group != about.group) {
            group = new QTreeWidgetItem(m_list, {toQString(nameOf(about.group))});
            QFont bold = font();
            bold.setBold(true);
            group->setFont(0, bold);
            group->setFlags(Qt::ItemIsEnabled);
        }
        before = &about;
        auto* item = new QTreeWidgetItem(group, {toQString(about.title)});
        item->setIcon(0, stepIcon(*step));
        item->setToolTip(0, toQString(about.help));
        item->setData(0, kNameRole, toQString(about.name));
        item->setData(0, kWordsRole, wordsOf(*step));
    }
    m_list->expandAll();
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(10, 10, 10, 6);
    column->setSpacing(8);
    column->addWidget(m_search);
    column->addWidget(m_list, 1);
    connect(m_search, &QLineEdit::textChanged, this, &StepChooser::find);
    connect(m_search, &QLineEdit::returnPressed, this, [this] { choose(m_list->currentItem()); });
    connect(m_list, &QTreeWidget::itemClicked, this, [this](const QTreeWidgetItem* item) { choose(item); });
}

void StepChooser::mark(const Step* step)
{
    m_search->clear();
    for (int g = 0; step != nullptr && g < m_list->topLevelItemCount(); ++g)
        for (int k = 0; k < m_list->topLevelItem(g)->childCount(); ++k) {
            QTreeWidgetItem* item = m_list->topLevelItem(g)->child(k);
            if (item->data(0, kNameRole).toString() != toQString(step->name())) continue;
            m_list->setCurrentItem(item);
            m_list->scrollToItem(item, QAbstractItemView::PositionAtCenter);  // the next one is wanted, often
        }
}

/// Every word has to be there; a title that has the first one comes first.
void StepChooser::find(const QString& text)
{
    const QStringList words = text.split(QLatin1Char(' '), Qt::SkipEmptyParts);
    QTreeWidgetItem* best = nullptr;
    bool byTitle = false;
    for (int g = 0; g < m_list->topLevelItemCount(); ++g) {
        QTreeWidgetItem* group = m_list->topLevelItem(g);
        bool any = false;
        for (int k = 0; k < group->childCount(); ++k) {
            QTreeWidgetItem* item = group->child(k);
            const QString all = item->data(0, kWordsRole).toString();
            const bool found = std::all_of(words.begin(), words.end(), [&](const QString& word) {
                return all.contains(word, Qt::CaseInsensitive);
            });
            item->setHidden(!found);
            any = any || found;
            const bool title = !words.isEmpty() && item->text(0).contains(words.front(), Qt::CaseInsensitive);
            if (found && (best == nullptr || (title && !byTitle))) {
                best = item;
                byTitle = title;
            }
        }
        group->setHidden(!any);
    }
    m_list->setCurrentItem(best);
}

void StepChooser::choose(const QTreeWidgetItem* item)
{
    if (item == nullptr || item->isHidden()) return;
    const QString name = item->data(0, kNameRole).toString();
    if (!name.isEmpty()) emit chosen(name);
}

bool StepChooser::eventFilter(QObject* watched, QEvent* event)
{
    if (event->type() != QEvent::KeyPress) return false;
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (watched == m_search && (key == Qt::Key_Down || key == Qt::Key_Up)) {
        QCoreApplication::sendEvent(m_list, event);
        return true;
    }
    if (watched == m_list && (key == Qt::Key_Return || key == Qt::Key_Enter)) {
        choose(m_list->currentItem());
        return true;
    }
    return false;
}

}  // namespace punctum::ui
