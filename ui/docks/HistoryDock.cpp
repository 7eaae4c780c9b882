// SPDX-License-Identifier: MIT
#include "ui/docks/HistoryDock.h"

#include "core/edit/History.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/style/Theme.h"

#include <QListWidget>
#include <QPainter>
#include <QStyledItemDelegate>

namespace punctum::ui
{

namespace
{

constexpr int kMargin = 10, kGap = 12;  // px

/// The edit's name, and at the right how many points it changed.
class EditDelegate final : public QStyledItemDelegate
{
public:
    using QStyledItemDelegate::QStyledItemDelegate;

    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override
    {
        QStyleOptionViewItem row = option;
        initStyleOption(&row, index);
        const QString name = row.text, count = index.data(HistoryDock::kCountRole).toString();
        row.text.clear();
        row.palette.setColor(QPalette::Highlight, themeColors().accentSoft);  // on which the count can be read
        row.palette.setColor(QPalette::HighlightedText, themeColors().text);
        const QWidget* const widget = option.widget;
        widget->style()->drawControl(QStyle::CE_ItemViewItem, &row, painter, widget);
        const QRect inside = option.rect.adjusted(kMargin, 0, -kMargin, 0);
        const QFontMetrics metrics(row.font);
        const int width = metrics.horizontalAdvance(count);
        const bool chosen = row.state & QStyle::State_Selected;
        painter->save();
        painter->setFont(row.font);
        painter->setPen(themeColors().dim);
        painter->drawText(inside, Qt::AlignRight | Qt::AlignVCenter, count);
        painter->setPen(row.palette.color(chosen ? QPalette::HighlightedText : QPalette::Text));
        painter->drawText(inside, Qt::AlignLeft | Qt::AlignVCenter,
                          metrics.elidedText(name, Qt::ElideRight, inside.width() - width - kGap));
        painter->restore();
    }
    QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex&) const override
    {
        return {120, QFontMetrics(option.font).height() + 9};
    }
};

}  // namespace

HistoryDock::HistoryDock(Workspace& workspace, QWidget* parent)
    : QDockWidget(tr("History"), parent), m_workspace(workspace), m_list(new QListWidget)
{
    setObjectName(QStringLiteral("history"));
    m_list->setFrameShape(QFrame::NoFrame);
    m_list->setItemDelegate(new EditDelegate(m_list));
    m_list->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    m_list->setAccessibleName(tr("Edits, oldest first"));
    setWidget(m_list);
    connect(m_list, &QListWidget::itemClicked, this, [this](QListWidgetItem* item) {
        if (m_document) m_workspace.walk(*m_document, std::size_t(m_list->row(item)));
    });
    connect(m_list, &QListWidget::itemActivated, m_list, &QListWidget::itemClicked);
    fill();
}

void HistoryDock::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::stateChanged, this, &HistoryDock::fill);
    fill();
}

void HistoryDock::fill()
{
    QStringList names, counts;
    QString tip = tr("Click an edit to go back or forward to the state after it");
    std::size_t position = 0;
    if (m_document) {
        const History& history = m_document->history();
        names << tr("Opened");
        for (const std::string& name : history.names()) names << toQString(name);
        counts << QString();
        for (const PointIndex points : history.changedPoints())
            counts << (points == 0 ? QString() : countText(points));
        position = history.position();
        const History::Kept kept = history.kept();
        if (kept.file > 0)
            tip +=
                QLatin1Char('\n') +
                tr("Kept for that: %1 in memory, %2 on the disk").arg(bytesText(kept.memory), bytesText(kept.file));
        else if (kept.memory > 0)
            tip += QLatin1Char('\n') + tr("Kept for that: %1 in memory").arg(bytesText(kept.memory));
    }
    m_list->setToolTip(tip);
    // stateChanged comes often, while a file loads for example: nothing moves unless something is other
    bool same = names.size() == m_list->count();
    for (int row = 0; same && row < m_list->count(); ++row) same = m_list->item(row)->text() == names[row];
    if (!same) {
        m_list->clear();
        m_list->addItems(names);
    }
    for (int row = 0; row < m_list->count(); ++row) {
        QListWidgetItem& item = *m_list->item(row);
        item.setData(kCountRole, counts.value(row));
        item.setToolTip(counts.value(row).isEmpty() ? names.value(row)
                                                    : tr("%1: %2 points").arg(names.value(row), counts.value(row)));
        item.setForeground(std::size_t(row) > position ? QBrush(themeColors().dim) : QBrush());
        QFont font = item.font();
        font.setBold(std::size_t(row) == position);
        item.setFont(font);
    }
    if (m_list->count() > 0) m_list->setCurrentRow(int(position));
}

}  // namespace punctum::ui
