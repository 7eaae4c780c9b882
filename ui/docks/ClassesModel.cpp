// SPDX-License-Identifier: MIT
#include "ui/docks/ClassesModel.h"

#include "ui/basic/Text.h"
#include "ui/style/Theme.h"
#include "ui/view/ViewSettings.h"

#include <QColor>

namespace punctum::ui
{

ClassesModel::ClassesModel(ViewSettings& settings, QObject* parent)
    : QAbstractTableModel(parent), m_settings(settings)
{
    connect(&m_settings, &ViewSettings::changed, this, [this] {
        if (!m_codes.empty()) emit dataChanged(index(0, 0), index(rowCount() - 1, Columns - 1));
    });
}

void ClassesModel::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::classCountsChanged, this, &ClassesModel::takeCounts);
    takeCounts();
}

void ClassesModel::takeCounts()
{
    std::vector<unsigned> codes;
    if (m_document && m_document->classCounts())
        for (unsigned code = 0; code < 256; ++code)
            if ((*m_document->classCounts())[code] > 0) codes.push_back(code);
    if (codes == m_codes) {
        if (!codes.empty()) emit dataChanged(index(0, 0), index(rowCount() - 1, Columns - 1));
        return;
    }
    beginResetModel();
    m_codes = std::move(codes);
    endResetModel();
}

quint64 ClassesModel::countOf(unsigned code) const
{
    return m_document && m_document->classCounts() && code < 256 ? (*m_document->classCounts())[code] : 0;
}

int ClassesModel::rowCount(const QModelIndex& parent) const
{
    return parent.isValid() ? 0 : int(m_codes.size());
}

int ClassesModel::columnCount(const QModelIndex& parent) const
{
    return parent.isValid() ? 0 : int(Columns);
}

QVariant ClassesModel::data(const QModelIndex& index, int role) const
{
    if (!index.isValid() || index.row() >= rowCount()) return {};
    const unsigned code = m_codes[std::size_t(index.row())];
    if (role == CodeRole) return code;
    if (role == CountRole) return countOf(code);
    const bool visible = m_settings.display().classVisible[code];
    switch (role) {
        case Qt::CheckStateRole:
            if (index.column() == Visible) return visible ? Qt::Checked : Qt::Unchecked;
            if (index.column() == Locked) return m_settings.classLocked(code) ? Qt::Checked : Qt::Unchecked;
            return {};
        case Qt::DecorationRole:
            if (index.column() == Color) {
                const render::Rgba8 c = m_settings.display().palette[code];
                return QColor(c.r, c.g, c.b);
            }
            return {};
        case Qt::DisplayRole:
            switch (index.column()) {
                case Code:
                    return code;
                case Name:
                    return classText(code).section(QLatin1Char(' '), 1);
                case Count:
                    return countText(countOf(code));
                default:
                    return {};
            }
        case Qt::TextAlignmentRole:
            if (index.column() == Count || index.column() == Code) return int(Qt::AlignRight | Qt::AlignVCenter);
            return int(Qt::AlignLeft | Qt::AlignVCenter);
        case Qt::ForegroundRole:
            if (!visible || index.column() == Code) return themeColors().dim;
            return {};
        case Qt::ToolTipRole:
            switch (index.column()) {
                case Visible:
                    return visible ? tr("Hide this class") : tr("Show this class");
                case Color:
                    return tr("Click to choose another color");
                case Locked:
                    return m_settings.classLocked(code) ? tr("Let tools select this class again")
                                                        : tr("Lock this class: tools leave its points alone");
                default:
                    return tr("%1: %2").arg(classText(code), pointsText(countOf(code)));
            }
        case Qt::AccessibleTextRole:
            return classText(code);
        default:
            return {};
    }
}

QVariant ClassesModel::headerData(int section, Qt::Orientation orientation, int role) const
{
    if (orientation != Qt::Horizontal) return {};
    if (role == Qt::TextAlignmentRole)
        return int((section == Name ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
    if (role != Qt::DisplayRole) return {};
    switch (section) {
        case Code:
            return tr("Code");
        case Name:
            return tr("Class");
        case Count:
            return tr("Points");
        case Locked:
            return tr("Lock");
        default:
            return {};
    }
}

bool ClassesModel::setData(const QModelIndex& index, const QVariant& value, int role)
{
    if (!index.isValid() || role != Qt::CheckStateRole) return false;
    const bool on = value.toInt() == Qt::Checked;
    if (index.column() == Visible)
        m_settings.setClassVisible(index.data(CodeRole).toUInt(), on);
    else if (index.column() == Locked)
        m_settings.setClassLocked(index.data(CodeRole).toUInt(), on);
    else
        return false;
    return true;
}

Qt::ItemFlags ClassesModel::flags(const QModelIndex& index) const
{
    if (!index.isValid()) return Qt::NoItemFlags;
    Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemNeverHasChildren;
    if (index.column() == Visible || index.column() == Locked) flags |= Qt::ItemIsUserCheckable;
    return flags;
}

}  // namespace punctum::ui
