// SPDX-License-Identifier: MIT
#include "ui/docks/ClassesDock.h"

#include "core/select/Selecting.h"
#include "ui/basic/Text.h"
#include "ui/docks/ClassesModel.h"
#include "ui/document/Document.h"
#include "ui/style/Theme.h"
#include "ui/view/ViewSettings.h"

#include <QColorDialog>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QMenu>
#include <QPainter>
#include <QPushButton>
#include <QStyledItemDelegate>
#include <QTableView>
#include <QVBoxLayout>

namespace punctum::ui
{

namespace
{

constexpr int kLeastWithCounts = 270;  // px

/// The color as a rounded square; hollow for a class that is hidden.
class SwatchDelegate final : public QStyledItemDelegate
{
public:
    using QStyledItemDelegate::QStyledItemDelegate;
    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override
    {
        QStyleOptionViewItem plain(option);
        plain.state &= ~QStyle::State_HasFocus;
        if (option.state & QStyle::State_Selected) painter->fillRect(option.rect, themeColors().accentSoft);
        const QColor color = index.data(Qt::DecorationRole).value<QColor>();
        const bool visible =
            index.siblingAtColumn(ClassesModel::Visible).data(Qt::CheckStateRole).toInt() == Qt::Checked;
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        QRectF swatch(0, 0, 15, 15);
        swatch.moveCenter(QRectF(option.rect).center());
        painter->setPen(QPen(visible ? color.darker(135) : color, 1.2));
        painter->setBrush(visible ? QBrush(color) : QBrush(Qt::NoBrush));
        painter->drawRoundedRect(swatch, 4, 4);
        painter->restore();
    }
};

}  // namespace

ClassesDock::ClassesDock(ViewSettings& settings, QWidget* parent)
    : QDockWidget(tr("Classes"), parent),
      m_settings(settings),
      m_model(new ClassesModel(settings, this)),
      m_view(new QTableView),
      m_hint(new QLabel),
      m_all(new QPushButton(tr("Show all"))),
      m_none(new QPushButton(tr("Hide all")))
{
    setObjectName(QStringLiteral("classes"));
    m_view->setModel(m_model);
    m_view->setItemDelegateForColumn(ClassesModel::Color, new SwatchDelegate(m_view));
    m_view->setShowGrid(false);
    m_view->setWordWrap(false);
    m_view->setSelectionBehavior(QAbstractItemView::SelectRows);
    m_view->setSelectionMode(QAbstractItemView::SingleSelection);
    m_view->setEditTriggers(QAbstractItemView::NoEditTriggers);
    m_view->verticalHeader()->hide();
    m_view->verticalHeader()->setDefaultSectionSize(28);
    m_view->setAccessibleName(tr("Classes"));
    QHeaderView* header = m_view->horizontalHeader();
    header->setMinimumSectionSize(24);
    header->setHighlightSections(false);
    header->setSectionResizeMode(QHeaderView::ResizeToContents);
    header->setSectionResizeMode(ClassesModel::Visible, QHeaderView::Fixed);
    header->setSectionResizeMode(ClassesModel::Color, QHeaderView::Fixed);
    header->setSectionResizeMode(ClassesModel::Name, QHeaderView::Stretch);
    header->resizeSection(ClassesModel::Visible, 30);
    header->resizeSection(ClassesModel::Color, 28);
    header->setSectionResizeMode(ClassesModel::Code, QHeaderView::Fixed);
    header->resizeSection(ClassesModel::Code, 42);
    header->setSectionResizeMode(ClassesModel::Locked, QHeaderView::Fixed);
    header->resizeSection(ClassesModel::Locked, 42);
    connect(m_view, &QTableView::clicked, this, [this](const QModelIndex& index) {
        if (index.column() == ClassesModel::Color) chooseColor(index);
    });
    connect(m_view, &QTableView::doubleClicked, this, [this](const QModelIndex& index) {
        if (index.column() >= ClassesModel::Code && index.column() != ClassesModel::Locked)
            m_settings.showOnlyClass(index.data(ClassesModel::CodeRole).toUInt());
    });

    m_view->setContextMenuPolicy(Qt::CustomContextMenu);
    connect(m_view, &QWidget::customContextMenuRequested, this, [this](const QPoint& place) {
        const QModelIndex index = m_view->indexAt(place);
        if (!index.isValid()) return;
        QMenu* const menu = makeMenu(index);
        connect(menu, &QMenu::aboutToHide, menu, &QObject::deleteLater);
        menu->popup(m_view->viewport()->mapToGlobal(place));
    });

    for (QPushButton* button : {m_all, m_none}) button->setProperty("flat", true);
    m_all->setToolTip(tr("Draw the points of every class"));
    m_none->setToolTip(tr("Draw no class; then tick the ones to look at, or double-click one to see it alone"));
    connect(m_all, &QPushButton::clicked, this, [this] { m_settings.setAllClassesVisible(true); });
    connect(m_none, &QPushButton::clicked, this, [this] { m_settings.setAllClassesVisible(false); });
    m_hint->setProperty("dim", true);
    m_hint->setWordWrap(true);

    auto* content = new QWidget;
    auto* row = new QHBoxLayout;
    row->addWidget(m_hint, 1);
    row->addWidget(m_all);
    row->addWidget(m_none);
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 6, 8, 8);
    column->setSpacing(6);
    column->addLayout(row);
    column->addWidget(m_view, 1);
    setWidget(content);
    connect(m_model, &QAbstractItemModel::modelReset, this, &ClassesDock::updateHint);
    updateHint();
}

void ClassesDock::resizeEvent(QResizeEvent* event)
{
    QDockWidget::resizeEvent(event);
    // The names have what is left: in a narrow panel the counts are in the tips alone.
    m_view->setColumnHidden(ClassesModel::Count, width() < kLeastWithCounts);
}

QMenu* ClassesDock::makeMenu(const QModelIndex& index)
{
    const unsigned code = index.data(ClassesModel::CodeRole).toUInt();
    auto* menu = new QMenu(m_view);
    const auto select = [&](const QString& text, SelectMode mode) {
        menu->addAction(text, this, [this, code, mode] { emit selectWanted(code, mode); });
    };
    select(tr("&Select Points of %1").arg(classText(code)), SelectMode::Replace);
    select(tr("&Add Them to the Selection"), SelectMode::Add);
    select(tr("S&ubtract Them from the Selection"), SelectMode::Subtract);
    select(tr("&Intersect the Selection with Them"), SelectMode::Intersect);
    menu->addSeparator();
    menu->addAction(tr("Show &Only This Class"), this, [this, code] { m_settings.showOnlyClass(code); });
    return menu;
}

void ClassesDock::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::classCountsChanged, this, &ClassesDock::updateHint);
    m_model->setDocument(document);
    updateHint();
}

void ClassesDock::updateHint()
{
    const int rows = m_model->rowCount();
    m_hint->setText(!m_document                 ? QString()
                    : rows == 1                 ? tr("1 class")
                    : rows > 0                  ? tr("%1 classes").arg(rows)
                    : m_document->classCounts() ? tr("No points")
                                                : tr("Not counted yet"));
    m_all->setEnabled(rows > 0);
    m_none->setEnabled(rows > 0);
}

void ClassesDock::chooseColor(const QModelIndex& index)
{
    const unsigned code = index.data(ClassesModel::CodeRole).toUInt();
    const render::Rgba8 now = m_settings.display().palette[code];
    auto* dialog = new QColorDialog(QColor(now.r, now.g, now.b), this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Color of %1").arg(classText(code)));
    const auto apply = [this, code](const QColor& c) {
        if (c.isValid())
            m_settings.setClassColor(code,
                                     {std::uint8_t(c.red()), std::uint8_t(c.green()), std::uint8_t(c.blue()), 255});
    };
    // The view follows while the color is being looked for; Cancel brings the old one back.
    connect(dialog, &QColorDialog::currentColorChanged, this, apply);
    connect(dialog, &QColorDialog::rejected, this, [apply, now] { apply(QColor(now.r, now.g, now.b)); });
    dialog->open();
}

}  // namespace punctum::ui
