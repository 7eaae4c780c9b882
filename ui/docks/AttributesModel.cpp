// SPDX-License-Identifier: MIT
#include "ui/docks/AttributesModel.h"

#include "ui/basic/Text.h"
#include "ui/style/Icons.h"
#include "ui/view/Viewport.h"

#include <QMimeData>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

QString iconNameOf(AttributeKind kind)
{
    switch (kind) {
        case AttributeKind::Scalar:
            return QStringLiteral("scalar");
        case AttributeKind::Class:
            return QStringLiteral("class");
        case AttributeKind::Category:
            return QStringLiteral("category");
        case AttributeKind::Color:
            return QStringLiteral("color");
        case AttributeKind::Vector:
            return QStringLiteral("vector");
        case AttributeKind::Opaque:
            break;
    }
    return QStringLiteral("opaque");
}

namespace
{

/// Five digits are enough for a mean that is only looked at.
QString shortText(double value)
{
    if (value == 0.0 || !std::isfinite(value)) return numberText(value);
    const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - 4.0);
    return numberText(std::round(value / unit) * unit);
}

}  // namespace

void AttributesModel::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    beginResetModel();
    m_document = document;
    endResetModel();
    if (!document) return;
    connect(document, &Document::attributesChanged, this, [this] {
        beginResetModel();
        endResetModel();
    });
    connect(document, &Document::figuresChanged, this, [this](const QString& name) {
        const QModelIndex index = indexOf(name);
        if (index.isValid()) emit dataChanged(index, index);
    });
}

void AttributesModel::setShown(const QString& name)
{
    if (name == m_shown) return;
    m_shown = name;
    if (rowCount() > 0) emit dataChanged(index(0), index(rowCount() - 1), {ShownRole});
}

QModelIndex AttributesModel::indexOf(const QString& name) const
{
    for (int row = 0; row < rowCount(); ++row)
        if (index(row).data(NameRole).toString() == name) return index(row);
    return {};
}

QString AttributesModel::neighbor(int steps) const
{
    const int count = rowCount();
    const int start = indexOf(m_shown).row();
    for (int i = 1; i <= count; ++i) {
        const int row = ((start + steps * i) % count + count) % count;
        if (index(row).data(DrawableRole).toBool()) return index(row).data(NameRole).toString();
    }
    return {};
}

int AttributesModel::rowCount(const QModelIndex& parent) const
{
    return parent.isValid() || !m_document ? 0 : int(m_document->attributes().size());
}

QString AttributesModel::detail(const Attribute& attribute) const
{
    QStringList parts;
    if (attribute.kind == AttributeKind::Opaque) {
        parts << tr("%1 bytes, not described").arg(attribute.columns[0] ? attribute.columns[0]->elementBytes() : 0);
        return parts.front();
    }
    QString type = toQString(nameOf(attribute.type()));
    if (attribute.bitWidth != 0)
        type = attribute.bitWidth == 1 ? tr("1 bit") : tr("%1 bits").arg(attribute.bitWidth);
    if (attribute.components > 1) type += QStringLiteral(" × %1").arg(attribute.components);
    parts << type;
    if (const AttributeFigures* figures = m_document->figures(toQString(attribute.name))) {
        if (attribute.components == 1) {
            const AttributeStatistics& f = (*figures)[0];
            if (f.count == 0) {
                parts << tr("no values");
            } else if (toDouble(f.min) == toDouble(f.max)) {
                parts << tr("always %1").arg(shownValue(attribute, f.min));
            } else {
                parts << tr("%1 to %2").arg(shownValue(attribute, f.min), shownValue(attribute, f.max));
                if (attribute.kind == AttributeKind::Scalar) parts << tr("mean %1").arg(shortText(f.mean));
            }
        } else {
            double low = toDouble((*figures)[0].min), high = toDouble((*figures)[0].max);
            for (std::uint32_t c = 1; c < attribute.components; ++c) {
                low = std::min(low, toDouble((*figures)[c].min));
                high = std::max(high, toDouble((*figures)[c].max));
            }
            parts << tr("%1 to %2").arg(numberText(low), numberText(high));
        }
    }
    return parts.join(QStringLiteral("  ·  "));
}

QVariant AttributesModel::data(const QModelIndex& index, int role) const
{
    if (!index.isValid() || index.row() >= rowCount()) return {};
    const Attribute& attribute = m_document->attributes()[std::size_t(index.row())];
    const QString name = toQString(attribute.name);
    switch (role) {
        case Qt::DisplayRole:
        case NameRole:
            return name;
        case DetailRole:
            return detail(attribute);
        case KindRole:
            return int(attribute.kind);
        case ShownRole:
            return name == m_shown;
        case DrawableRole:
            return attribute.kind != AttributeKind::Opaque;
        case Qt::DecorationRole:
            return lineIcon(iconNameOf(attribute.kind));
        case Qt::ToolTipRole: {
            QString text = name;
            if (!attribute.unit.empty()) text += QStringLiteral(" (%1)").arg(toQString(attribute.unit));
            if (!attribute.description.empty()) text += QLatin1Char('\n') + toQString(attribute.description);
            if (!detail(attribute).isEmpty()) text += QLatin1Char('\n') + detail(attribute);
            if (attribute.kind != AttributeKind::Opaque)
                text +=
                    QLatin1Char('\n') + tr("Drag it onto the view or double-click it to color the points by it.");
            return text;
        }
        default:
            return {};
    }
}

Qt::ItemFlags AttributesModel::flags(const QModelIndex& index) const
{
    if (!index.isValid()) return Qt::NoItemFlags;
    if (!index.data(DrawableRole).toBool()) return Qt::ItemIsSelectable | Qt::ItemNeverHasChildren;
    return Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsDragEnabled | Qt::ItemNeverHasChildren;
}

QStringList AttributesModel::mimeTypes() const
{
    return {QLatin1String(kAttributeMimeType)};
}

QMimeData* AttributesModel::mimeData(const QModelIndexList& indexes) const
{
    if (indexes.isEmpty()) return nullptr;
    auto* mime = new QMimeData;
    mime->setData(QLatin1String(kAttributeMimeType), indexes.front().data(NameRole).toString().toUtf8());
    return mime;
}

}  // namespace punctum::ui
