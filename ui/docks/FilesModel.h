// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Document.h"

#include <QAbstractTableModel>
#include <QPointer>

namespace punctum::ui
{

/// The files of the active document, a row each: for a list of thousands. GUI thread only.
class FilesModel final : public QAbstractTableModel
{
    Q_OBJECT
public:
    enum Column { Name, Points, Size, Crs, Columns };
    enum Role {
        ChangedRole = Qt::UserRole,  ///< something of it is not saved
        SortRole,
    };

    explicit FilesModel(QObject* parent = nullptr) : QAbstractTableModel(parent) {}

    void setDocument(Document* document);
    const Document* document() const { return m_document; }
    /// Whether files differ in what they say of it.
    bool severalCrs() const;
    int changedFiles() const;

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
    bool setData(const QModelIndex& index, const QVariant& value, int role) override;
    Qt::ItemFlags flags(const QModelIndex& index) const override;

signals:
    /// What all rows together say.
    void summaryChanged();

private:
    void takeParts();
    bool changed(const Document::Part& part) const;
    QString extentText(const Document::Part& part) const;
    QString tip(const Document::Part& part) const;

    QPointer<Document> m_document;
    int m_rows = 0;
};

}  // namespace punctum::ui
