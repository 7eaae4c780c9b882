// SPDX-License-Identifier: MIT
#include "ui/docks/AttributesDock.h"

#include "ui/docks/AttributeActions.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ColorPanel.h"
#include "ui/document/Workspace.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QComboBox>
#include <QDrag>
#include <QMimeData>
#include <QPainter>
#include <QSignalBlocker>
#include <QStyledItemDelegate>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

namespace
{

/// Two lines an attribute: its name, and what is known of its values.
class AttributeDelegate final : public QStyledItemDelegate
{
public:
    using QStyledItemDelegate::QStyledItemDelegate;

    QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex&) const override
    {
        const QFontMetrics name(option.font), detail(scaledFont(option.font, kDetail));
        return {100, name.height() + detail.height() + 13};
    }

    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override
    {
        const ThemeColors& colors = themeColors();
        const bool shown = index.data(AttributesModel::ShownRole).toBool();
        const bool enabled = index.flags() & Qt::ItemIsEnabled;
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        const QRectF plate = QRectF(option.rect).adjusted(4, 1, -4, -1);
        painter->setPen(Qt::NoPen);
        if (shown)
            painter->setBrush(colors.accentSoft);
        else if (option.state & (QStyle::State_Selected | QStyle::State_MouseOver))
            painter->setBrush(colors.hover);
        if (painter->brush() != Qt::NoBrush) painter->drawRoundedRect(plate, 6, 6);
        if (option.state & QStyle::State_HasFocus) {
            painter->setPen(QPen(colors.accent, 1.2));
            painter->setBrush(Qt::NoBrush);
            painter->drawRoundedRect(plate.adjusted(0.6, 0.6, -0.6, -0.6), 6, 6);
        }

        const QColor text = enabled ? colors.text : colors.dim;
        const QRect icon(option.rect.left() + 14, option.rect.center().y() - 9, 19, 19);
        const AttributeKind kind = AttributeKind(index.data(AttributesModel::KindRole).toInt());
        lineIcon(iconNameOf(kind), shown ? colors.accent : colors.dim).paint(painter, icon);

        const QFont nameFont = scaledFont(option.font, 1.0, shown);
        const QFont detailFont = scaledFont(option.font, kDetail);
        const QFontMetrics name(nameFont), detail(detailFont);
        const QRect lines = option.rect.adjusted(44, 6, -12, -6);
        painter->setFont(nameFont);
        painter->setPen(text);
        painter->drawText(
            QRect(lines.left(), lines.top(), lines.width(), name.height()), Qt::AlignVCenter,
            name.elidedText(index.data(AttributesModel::NameRole).toString(), Qt::ElideRight, lines.width()));
        painter->setFont(detailFont);
        painter->setPen(colors.dim);
        painter->drawText(
            QRect(lines.left(), lines.top() + name.height() + 1, lines.width(), detail.height()), Qt::AlignVCenter,
            detail.elidedText(index.data(AttributesModel::DetailRole).toString(), Qt::ElideRight, lines.width()));
        painter->restore();
    }

private:
    static constexpr double kDetail = 0.88;  // of the name's size
};

constexpr std::size_t kManyFiles = 50;
constexpr int kFilesPause = 250;  // ms

}  // namespace

AttributesView::AttributesView(QWidget* parent) : QListView(parent)
{
    setItemDelegate(new AttributeDelegate(this));
    setDragEnabled(true);
    setDragDropMode(QAbstractItemView::DragOnly);
    setSelectionMode(QAbstractItemView::SingleSelection);
    setMouseTracking(true);
    setUniformItemSizes(true);
    setVerticalScrollMode(QAbstractItemView::ScrollPerPixel);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setEditTriggers(QAbstractItemView::NoEditTriggers);
    setAccessibleName(tr("Attributes"));
}

void AttributesView::resizeEvent(QResizeEvent* event)
{
    QListView::resizeEvent(event);
    scrollTo(currentIndex());
}

void AttributesView::startDrag(Qt::DropActions actions)
{
    const QModelIndexList chosen = selectedIndexes();
    if (chosen.isEmpty() || !(chosen.front().flags() & Qt::ItemIsDragEnabled)) return;
    const QModelIndex& index = chosen.front();
    const QString name = index.data(AttributesModel::NameRole).toString();
    const ThemeColors& colors = themeColors();
    const QFont bold = scaledFont(font(), 1.0, true);
    const QSize size(QFontMetrics(bold).horizontalAdvance(name) + 48, QFontMetrics(bold).height() + 14);
    const qreal ratio = devicePixelRatioF();
    QPixmap chip(size * ratio);
    chip.setDevicePixelRatio(ratio);
    chip.fill(Qt::transparent);
    QPainter painter(&chip);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QPen(colors.accent, 1.2));
    painter.setBrush(colors.raised);
    painter.drawRoundedRect(QRectF(QPointF(), QSizeF(size)).adjusted(1, 1, -1, -1), size.height() / 2.0,
                            size.height() / 2.0);
    lineIcon(iconNameOf(AttributeKind(index.data(AttributesModel::KindRole).toInt())), colors.accent)
        .paint(&painter, QRect(13, (size.height() - 17) / 2, 17, 17));
    painter.setFont(bold);
    painter.setPen(colors.text);
    painter.drawText(QRect(36, 0, size.width() - 44, size.height()), Qt::AlignVCenter, name);
    painter.end();

    auto* drag = new QDrag(this);
    drag->setMimeData(model()->mimeData({index}));
    drag->setPixmap(chip);
    drag->setHotSpot(QPoint(size.width() / 2, size.height() + 6));
    drag->exec(actions, Qt::CopyAction);
}

AttributesDock::AttributesDock(Workspace& workspace, ViewSettings& settings, QWidget* parent)
    : QDockWidget(tr("Attributes"), parent),
      m_workspace(workspace),
      m_model(new AttributesModel(this)),
      m_view(new AttributesView),
      m_actions(new AttributeActions(workspace, *m_model, *m_view, this)),
      m_colors(new ColorPanel(settings)),
      m_files(new QComboBox)
{
    setObjectName(QStringLiteral("attributes"));
    m_view->setModel(m_model);
    m_files->setToolTip(tr("The open files; lists, edits and saving are about the chosen one"));
    m_files->setAccessibleName(tr("Open files"));
    m_files->hide();
    connect(m_view, &QListView::doubleClicked, this, [this](const QModelIndex& index) {
        if (index.data(AttributesModel::DrawableRole).toBool())
            emit attributeChosen(index.data(AttributesModel::NameRole).toString());
    });
    connect(m_view, &QListView::activated, this, [this](const QModelIndex& index) {
        if (index.data(AttributesModel::DrawableRole).toBool())
            emit attributeChosen(index.data(AttributesModel::NameRole).toString());
    });
    connect(m_actions, &AttributeActions::shownRenamed, this, &AttributesDock::attributeChosen);
    // Long names are cut off here instead of making the panel wide, and a thousand of them are not measured.
    mayBeNarrow(*m_files);
    connect(m_files, &QComboBox::activated, this, [this](int row) {
        const QVariant chosen = m_files->itemData(row);
        for (Document* document : m_workspace.documents())
            if (QVariant::fromValue(quintptr(document)) == chosen) return m_workspace.setActive(document);
    });
    // Files come and change by the hundred: the list is filled once for all that happen together.
    m_filesTimer.setSingleShot(true);
    connect(&m_filesTimer, &QTimer::timeout, this, &AttributesDock::updateFiles);
    const auto updateSoon = [this] {
        if (!m_filesTimer.isActive())
            m_filesTimer.start(m_workspace.documents().size() < kManyFiles ? 0 : kFilesPause);
    };
    for (const auto signal :
         {&Workspace::documentAdded, &Workspace::activeChanged, &Workspace::documentStateChanged})
        connect(&m_workspace, signal, this, updateSoon);
    connect(&m_workspace, &Workspace::documentRemoved, this, updateSoon);

    auto* content = new QWidget;
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 8, 8, 8);
    column->setSpacing(8);
    column->addWidget(m_files);
    column->addWidget(m_view, 1);
    column->addWidget(m_colors);
    setWidget(content);
    setMinimumWidth(kLeastPanelWidth + 10);  // rows of fields beside their names
}

void AttributesDock::updateFiles()
{
    const auto& documents = m_workspace.documents();
    const QSignalBlocker quiet(m_files);
    m_files->clear();
    for (const Document* document : documents) {
        m_files->addItem(document->name() + (document->modified() ? QStringLiteral(" *") : QString()),
                         QVariant::fromValue(quintptr(document)));
        m_files->setItemData(m_files->count() - 1, document->path(), Qt::ToolTipRole);
    }
    const auto active = std::find(documents.begin(), documents.end(), m_workspace.active());
    m_files->setCurrentIndex(active == documents.end() ? -1 : int(active - documents.begin()));
    m_files->setVisible(documents.size() > 1);
}

void AttributesDock::setDocument(Document* document)
{
    m_model->setDocument(document);
    m_view->scrollTo(m_model->indexOf(m_model->shown()));
    if (!document) m_colors->setKind(std::nullopt);
}

void AttributesDock::setFrame(const Frame& frame)
{
    if (frame.attribute != m_model->shown()) {
        m_model->setShown(frame.attribute);
        m_view->setCurrentIndex(m_model->indexOf(frame.attribute));  // which scrolls to it
    }
    const Document* document = m_model->document();
    const Attribute* attribute = document ? document->findAttribute(frame.attribute) : nullptr;
    m_colors->setKind(attribute ? std::optional(attribute->kind) : std::nullopt);
    m_colors->setRange(frame.range);
}

}  // namespace punctum::ui
