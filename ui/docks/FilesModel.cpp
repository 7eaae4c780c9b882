// SPDX-License-Identifier: MIT
#include "ui/docks/FilesModel.h"

#include "ui/basic/Text.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

void FilesModel::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) {
        connect(document, &Document::partsChanged, this, &FilesModel::takeParts);
        connect(document, &Document::partsShownChanged, this, &FilesModel::takeParts);
        connect(document, &Document::stateChanged, this, &FilesModel::takeParts);
    }
    beginResetModel();
    m_rows = document ? int(document->parts().size()) : 0;
    endResetModel();
    emit summaryChanged();
}

void FilesModel::takeParts()
{
    // Files do not come or go while a document is open.
    if (m_rows != 0) emit dataChanged(index(0, 0), index(m_rows - 1, Columns - 1));
    emit summaryChanged();
}

bool FilesModel::changed(const Document::Part& part) const
{
    return m_document->many() ? part.changed : m_document->modified();
}

bool FilesModel::severalCrs() const
{
    if (!m_document) return false;
    const auto& parts = m_document->parts();
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Document::Part& part) { return part.crs != parts.front().crs; });
}

int FilesModel::changedFiles() const
{
    if (!m_document) return 0;
    const auto& parts = m_document->parts();
    return int(std::count_if(parts.begin(), parts.end(), [this](const auto& part) { return changed(part); }));
}

QString FilesModel::extentText(const Document::Part& part) const
{
    if (part.bounds.empty()) return {};
    const glm::dvec3 size = (part.bounds.max - part.bounds.min) * m_document->viewStretch(part.bounds);
    const auto text = [](double length) { return numberText(length < 10.0 ? length : std::round(length)); };
    const QString unit = m_document->lengthUnit();
    return QStringLiteral("%1 × %2").arg(text(size.x), text(size.y)) +
           (unit.isEmpty() ? QString() : QLatin1Char(' ') + unit);
}

QString FilesModel::tip(const Document::Part& part) const
{
    QStringList lines{part.path, pointsText(part.points.size())};
    if (const QString extent = extentText(part); !extent.isEmpty()) lines << extent;
    if (part.crs) lines << (part.crs->isEmpty() ? tr("Coordinate system not stated") : *part.crs);
    if (part.moved)
        lines << tr("Shown where the coordinate system of the other files puts it; the file keeps its own");
    if (part.damaged) lines << tr("Damaged: it may be saved under another name only");
    if (changed(part)) lines << tr("Not saved");
    if (!part.shown) lines << tr("Hidden: neither drawn nor selected nor counted");
    return lines.join(QLatin1Char('\n'));
}

int FilesModel::rowCount(const QModelIndex& parent) const
{
    return parent.isValid() || !m_document ? 0 : m_rows;
}

int FilesModel::columnCount(const QModelIndex& parent) const
{
    return parent.isValid() ? 0 : int(Columns);
}

QVariant FilesModel::data(const QModelIndex& index, int role) const
{
    if (!index.isValid() || index.row() >= rowCount()) return {};
    const Document::Part& part = m_document->parts()[std::size_t(index.row())];
    switch (role) {
        case ChangedRole:
            return changed(part);
        case Qt::CheckStateRole:
            if (index.column() == Name) return part.shown ? Qt::Checked : Qt::Unchecked;
            return {};
        case Qt::DecorationRole:
            if (index.column() == Name && part.damaged) return lineIcon(QStringLiteral("warning"));
            return {};
        case Qt::DisplayRole:
            switch (index.column()) {
                case Name:
                    return changed(part) ? part.name + QStringLiteral(" *") : part.name;
                case Points:
                    return countText(part.points.size());
                case Size:
                    return extentText(part);
                default:
                    return !part.crs ? QString() : part.crs->isEmpty() ? tr("not stated") : *part.crs;
            }
        case SortRole:
            switch (index.column()) {
                case Points:
                    return qulonglong(part.points.size());
                case Size: {
                    if (part.bounds.empty()) return 0.0;
                    const glm::dvec3 size = part.bounds.max - part.bounds.min;
                    return size.x * size.y;
                }
                default:
                    return index.column() == Name ? part.name : part.crs.value_or(QString());
            }
        case Qt::TextAlignmentRole:
            if (index.column() == Points || index.column() == Size) return int(Qt::AlignRight | Qt::AlignVCenter);
            return int(Qt::AlignLeft | Qt::AlignVCenter);
        case Qt::ForegroundRole:
            if (!part.shown) return themeColors().dim;
            return {};
        case Qt::ToolTipRole:
            return tip(part);
        case Qt::AccessibleTextRole:
            if (index.column() == Name) return part.shown ? part.name : tr("%1, hidden").arg(part.name);
            return {};
        default:
            return {};
    }
}

QVariant FilesModel::headerData(int section, Qt::Orientation orientation, int role) const
{
    if (orientation != Qt::Horizontal) return {};
    if (role == Qt::TextAlignmentRole)
        return int((section == Points || section == Size ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
    if (role != Qt::DisplayRole) return {};
    switch (section) {
        case Name:
            return tr("File");
        case Points:
            return tr("Points");
        case Size:
            return tr("Extent");
        default:
            return tr("System");
    }
}

bool FilesModel::setData(const QModelIndex& index, const QVariant& value, int role)
{
    if (!index.isValid() || index.column() != Name || role != Qt::CheckStateRole || !m_document) return false;
    m_document->setShown({std::size_t(index.row())}, value.toInt() == Qt::Checked);
    return true;
}

Qt::ItemFlags FilesModel::flags(const QModelIndex& index) const
{
    if (!index.isValid()) return Qt::NoItemFlags;
    Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemNeverHasChildren;
    // While points come, none of them can be left out.
    if (index.column() == Name && m_document && !m_document->loading()) flags |= Qt::ItemIsUserCheckable;
    return flags;
}

}  // namespace punctum::ui
