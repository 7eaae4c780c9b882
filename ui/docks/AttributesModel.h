// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Document.h"

#include <QAbstractListModel>
#include <QPointer>

namespace punctum::ui
{

/// The attributes of one document, as the dock lists them. GUI thread only.
class AttributesModel final : public QAbstractListModel
{
    Q_OBJECT
public:
    enum Role {
        NameRole = Qt::UserRole,
        DetailRole,  ///< "uint16  ·  12 to 4,095  ·  mean 340"
        KindRole,    ///< int of AttributeKind
        ShownRole,   ///< whether the view is colored by it
        DrawableRole
    };

    using QAbstractListModel::QAbstractListModel;

    void setDocument(Document* document);
    Document* document() const { return m_document; }
    /// Name of the attribute on screen.
    void setShown(const QString& name);
    QString shown() const { return m_shown; }
    QModelIndex indexOf(const QString& name) const;
    /// Name of the drawable attribute `steps` further down the list, round its ends; empty when there is none.
    QString neighbor(int steps) const;

    int rowCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    Qt::ItemFlags flags(const QModelIndex& index) const override;
    QStringList mimeTypes() const override;
    QMimeData* mimeData(const QModelIndexList& indexes) const override;
    Qt::DropActions supportedDragActions() const override { return Qt::CopyAction; }

private:
    QString detail(const Attribute& attribute) const;
    QPointer<Document> m_document;
    QString m_shown;
};

/// Name of the icon for attributes of this kind.
QString iconNameOf(AttributeKind kind);

}  // namespace punctum::ui
