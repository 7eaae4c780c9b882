// SPDX-License-Identifier: MIT
#include "ui/docks/FilesDock.h"

#include "ui/basic/Text.h"
#include "ui/docks/FilesModel.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/style/Widgets.h"

#include <QClipboard>
#include <QCollator>
#include <QGuiApplication>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QSortFilterProxyModel>
#include <QTableView>
#include <QVBoxLayout>

#include <algorithm>
#include <numeric>

namespace punctum::ui
{

namespace
{

constexpr int kSearchFrom = 12;                  // files: fewer are seen at once
constexpr int kRowHeight = 26, kCrsWidth = 110;  // px
constexpr int kLeastWithExtents = 330;           // px

constexpr int kAroundRows = 180;       // px
constexpr std::size_t kMostRows = 20;  // that it asks room for

/// By what the columns hold; numbers in names are numbers, so that tile 10 comes after tile 9.
class FileOrder final : public QSortFilterProxyModel
{
public:
    explicit FileOrder(QObject* parent) : QSortFilterProxyModel(parent)
    {
        m_names.setNumericMode(true);
        m_names.setCaseSensitivity(Qt::CaseInsensitive);
    }

protected:
    bool lessThan(const QModelIndex& left, const QModelIndex& right) const override
    {
        if (left.column() != FilesModel::Name) return QSortFilterProxyModel::lessThan(left, right);
        return m_names.compare(left.data(sortRole()).toString(), right.data(sortRole()).toString()) < 0;
    }

private:
    QCollator m_names;
};

}  // namespace

FilesDock::FilesDock(Workspace& workspace, QWidget* parent)
    : QDockWidget(tr("Files"), parent),
      m_workspace(workspace),
      m_model(new FilesModel(this)),
      m_sorted(new FileOrder(this)),
      m_view(new QTableView),
      m_hint(new QLabel),
      m_search(new QLineEdit),
      m_all(new QPushButton(tr("Show all"))),
      m_none(new QPushButton(tr("Hide all"))),
      m_zoom(new QPushButton(tr("Zoom to"))),
      m_save(new QPushButton(tr("Save"))),
      m_remove(new QPushButton(tr("Remove")))
{
    setObjectName(QStringLiteral("files"));
    m_sorted->setSourceModel(m_model);
    m_sorted->setSortRole(FilesModel::SortRole);
    m_sorted->setFilterCaseSensitivity(Qt::CaseInsensitive);
    m_sorted->setFilterKeyColumn(FilesModel::Name);
    m_sorted->setDynamicSortFilter(false);  // a row stays where it is while its file changes
    m_view->setModel(m_sorted);
    m_view->setShowGrid(false);
    m_view->setWordWrap(false);
    m_view->setTextElideMode(Qt::ElideLeft);  // tiles differ at the end of their names
    m_view->setSortingEnabled(true);
    m_view->setSelectionBehavior(QAbstractItemView::SelectRows);
    m_view->setSelectionMode(QAbstractItemView::ExtendedSelection);
    m_view->setEditTriggers(QAbstractItemView::NoEditTriggers);
    m_view->setVerticalScrollMode(QAbstractItemView::ScrollPerPixel);
    m_view->verticalHeader()->hide();
    m_view->verticalHeader()->setSectionResizeMode(QHeaderView::Fixed);
    m_view->verticalHeader()->setDefaultSectionSize(kRowHeight);
    m_view->setAccessibleName(tr("Files of the survey"));
    m_view->setContextMenuPolicy(Qt::CustomContextMenu);
    QHeaderView* const header = m_view->horizontalHeader();
    header->setHighlightSections(false);
    header->setMinimumSectionSize(48);
    header->setSectionResizeMode(FilesModel::Name, QHeaderView::Stretch);
    for (const int column : {FilesModel::Points, FilesModel::Size})
        header->setSectionResizeMode(column, QHeaderView::ResizeToContents);
    header->setResizeContentsPrecision(0);  // by the rows that are seen: there may be thousands
    header->resizeSection(FilesModel::Crs, kCrsWidth);
    m_view->sortByColumn(FilesModel::Name, Qt::AscendingOrder);
    connect(m_view, &QTableView::doubleClicked, this, &FilesDock::zoom);
    connect(m_view, &QWidget::customContextMenuRequested, this, [this](const QPoint& place) {
        if (!m_view->indexAt(place).isValid()) return;
        QMenu* const menu = makeMenu();
        connect(menu, &QMenu::aboutToHide, menu, &QObject::deleteLater);
        menu->popup(m_view->viewport()->mapToGlobal(place));
    });
    connect(m_view->selectionModel(), &QItemSelectionModel::selectionChanged, this, &FilesDock::updateButtons);
    connect(m_model, &FilesModel::summaryChanged, this, &FilesDock::updateSummary);

    m_search->setPlaceholderText(tr("Find a file"));
    m_search->setClearButtonEnabled(true);
    m_search->setAccessibleName(tr("Find a file"));
    connect(m_search, &QLineEdit::textChanged, m_sorted, &QSortFilterProxyModel::setFilterFixedString);

    for (QPushButton* button : {m_all, m_none}) button->setProperty("flat", true);
    m_all->setToolTip(tr("Draw the points of every file"));
    m_none->setToolTip(tr("Draw no file; then tick the ones to look at"));
    m_zoom->setToolTip(tr("Bring the chosen files into the view; a double-click does it, too"));
    m_save->setToolTip(tr("Save the chosen files alone, those of them that changed"));
    m_remove->setToolTip(tr("Go on without the chosen files; on the disk they stay as they are"));
    connect(m_all, &QPushButton::clicked, this, [this] {
        if (m_document) m_document->showAllParts();
    });
    connect(m_none, &QPushButton::clicked, this, [this] {
        if (!m_document) return;
        std::vector<std::size_t> all(m_document->parts().size());
        std::iota(all.begin(), all.end(), std::size_t(0));
        m_document->setShown(all, false);
    });
    connect(m_zoom, &QPushButton::clicked, this, &FilesDock::zoom);
    connect(m_save, &QPushButton::clicked, this, &FilesDock::saveChosen);
    connect(m_remove, &QPushButton::clicked, this, [this] {
        if (m_document) emit removeWanted(m_document, chosen());
    });
    m_hint->setProperty("dim", true);
    m_hint->setWordWrap(true);

    auto* content = new QWidget;
    auto* shown = new QHBoxLayout;
    shown->addWidget(m_hint, 1);
    shown->addWidget(m_all);
    shown->addWidget(m_none);
    auto* buttons = new FoldingRow(8, 1, 2);
    buttons->first().addWidget(m_zoom, 1);
    buttons->second().addWidget(m_save, 1);
    buttons->second().addWidget(m_remove, 1);
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 8, 10, 8);
    column->setSpacing(8);
    column->addLayout(shown);
    column->addWidget(m_search);
    column->addWidget(m_view, 1);
    column->addWidget(buttons);
    setWidget(content);
    updateSummary();
}

void FilesDock::resizeEvent(QResizeEvent* event)
{
    QDockWidget::resizeEvent(event);
    updateColumns();
}

/// The names have what is left: what a narrow panel has no room for is in the tips.
void FilesDock::updateColumns()
{
    const bool narrow = width() < kLeastWithExtents, crs = m_model->severalCrs();
    m_view->setColumnHidden(FilesModel::Size, narrow);
    m_view->setColumnHidden(FilesModel::Crs, !crs);
    m_view->setColumnHidden(FilesModel::Points, narrow && crs);
}

void FilesDock::setDocument(Document* document)
{
    m_document = document;
    m_search->clear();
    m_model->setDocument(document);
    m_sorted->sort(m_view->horizontalHeader()->sortIndicatorSection(),
                   m_view->horizontalHeader()->sortIndicatorOrder());
    m_search->setVisible(m_model->rowCount() >= kSearchFrom);
    updateSummary();
}

int FilesDock::heightFor(std::size_t rows) const
{
    return kAroundRows + kRowHeight * int(std::min<std::size_t>(rows, kMostRows));
}

QString FilesDock::summary() const
{
    return m_hint->text();
}

void FilesDock::updateSummary()
{
    QStringList words;
    if (m_document) {
        const int files = m_model->rowCount(), hidden = m_document->hiddenParts(),
                  changed = m_model->changedFiles();
        words << (files == 1 ? tr("1 file") : tr("%1 files").arg(countText(std::uint64_t(files))));
        if (hidden != 0) words << tr("%1 hidden").arg(countText(std::uint64_t(hidden)));
        if (changed != 0) words << tr("%1 not saved").arg(countText(std::uint64_t(changed)));
        m_all->setEnabled(hidden != 0);
        m_none->setEnabled(hidden != files && !m_document->loading());
    } else {
        m_all->setEnabled(false);
        m_none->setEnabled(false);
    }
    m_hint->setText(words.join(QStringLiteral(", ")));
    updateButtons();
    updateColumns();
}

std::vector<std::size_t> FilesDock::chosen() const
{
    std::vector<std::size_t> rows;
    for (const QModelIndex& index : m_view->selectionModel()->selectedRows())
        rows.push_back(std::size_t(m_sorted->mapToSource(index).row()));
    std::sort(rows.begin(), rows.end());
    return rows;
}

std::vector<std::size_t> FilesDock::changedOnes() const
{
    std::vector<std::size_t> rows = chosen();
    std::erase_if(rows, [this](std::size_t row) {
        return !m_model->index(int(row), 0).data(FilesModel::ChangedRole).toBool();
    });
    return rows;
}

void FilesDock::updateButtons()
{
    const std::vector<std::size_t> rows = chosen();
    const bool ready = m_document && !m_document->loading();
    m_zoom->setEnabled(!rows.empty());
    m_save->setEnabled(ready && !changedOnes().empty());
    m_remove->setEnabled(ready && !rows.empty() && rows.size() < m_document->parts().size());
}

void FilesDock::zoom()
{
    if (!m_document) return;
    WorldBounds bounds;
    for (const std::size_t row : chosen()) bounds.include(m_document->parts()[row].bounds);
    if (!bounds.empty()) emit zoomWanted(bounds);
}

void FilesDock::saveChosen()
{
    if (!m_document) return;
    if (m_document->many())
        m_workspace.saveParts(*m_document, changedOnes());
    else
        m_workspace.save(*m_document, m_document->path());
}

void FilesDock::setShown(bool shown)
{
    if (m_document) m_document->setShown(chosen(), shown);
}

void FilesDock::showOnly()
{
    if (!m_document) return;
    const std::vector<std::size_t> rows = chosen();
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < m_document->parts().size(); ++k)
        if (!std::binary_search(rows.begin(), rows.end(), k)) others.push_back(k);
    m_document->setShown(rows, true);
    m_document->setShown(others, false);
}

QMenu* FilesDock::makeMenu()
{
    auto* menu = new QMenu(m_view);
    const std::vector<std::size_t> rows = chosen();
    const bool one = rows.size() == 1, ready = m_document && !m_document->loading() && !rows.empty();
    menu->addAction(tr("&Zoom to"), this, &FilesDock::zoom)->setEnabled(m_zoom->isEnabled());
    menu->addSeparator();
    menu->addAction(tr("Show &Only"), this, &FilesDock::showOnly)->setEnabled(ready);
    menu->addAction(tr("&Show"), this, [this] { setShown(true); })->setEnabled(ready);
    menu->addAction(tr("&Hide"), this, [this] { setShown(false); })->setEnabled(ready);
    menu->addSeparator();
    menu->addAction(one ? tr("Save Only &This File") : tr("Save Only &These Files"), this, &FilesDock::saveChosen)
        ->setEnabled(m_save->isEnabled());
    menu->addAction(tr("&Remove from the Survey"), m_remove, &QPushButton::click)
        ->setEnabled(m_remove->isEnabled());
    menu->addSeparator();
    menu->addAction(tr("&Copy Path"), this,
                    [this, rows] {
                        QStringList paths;
                        for (const std::size_t row : rows)
                            if (m_document && row < m_document->parts().size())
                                paths << m_document->parts()[row].path;
                        QGuiApplication::clipboard()->setText(paths.join(QLatin1Char('\n')));
                    })
        ->setEnabled(ready);
    return menu;
}

}  // namespace punctum::ui
