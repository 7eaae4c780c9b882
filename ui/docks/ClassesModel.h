// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Document.h"

#include <QAbstractTableModel>
#include <QPointer>

#include <vector>

namespace punctum::ui
{

class ViewSettings;

/// The classes that occur in one document: visible, color, code, name, count, locked; sorted by code. GUI thread
/// only.
class ClassesModel final : public QAbstractTableModel
{
    Q_OBJECT
public:
    enum Column { Visible, Color, Code, Name, Count, Locked, Columns };
    enum Role { CodeRole = Qt::UserRole, CountRole };

    explicit ClassesModel(ViewSettings& settings, QObject* parent = nullptr);

    void setDocument(Document* document);
    /// Points of a class; 0 when it does not occur.
    quint64 countOf(unsigned code) const;

    int rowCount(const QModelIndex& parent = {}) const override;
    int columnCount(const QModelIndex& parent = {}) const override;
    QVariant data(const QModelIndex& index, int role) const override;
    QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
    bool setData(const QModelIndex& index, const QVariant& value, int role) override;
    Qt::ItemFlags flags(const QModelIndex& index) const override;

private:
    void takeCounts();

    ViewSettings& m_settings;
    QPointer<Document> m_document;
    std::vector<unsigned> m_codes;
};

}  // namespace punctum::ui
