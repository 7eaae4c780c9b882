// SPDX-License-Identifier: MIT
#pragma once

#include "ui/maps/MapChoice.h"

#include <QDialog>

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;

namespace punctum::ui
{

class Document;
class NumberField;

/// Asks which map of a document is to be made, and how fine. GUI thread only; deletes itself when closed.
class MapDialog final : public QDialog
{
    Q_OBJECT
public:
    MapDialog(const Document& document, QWidget* parent);

    /// Nothing when a field holds what cannot be used, which is marked then.
    std::optional<MapChoice> choice();
    /// What is wrong; empty when nothing is.
    QString problem() const;

signals:
    /// It was closed with Save.
    void wanted(const punctum::ui::MapChoice& choice);

private:
    void addKinds();
    void addAttributes(const Document& document);
    void change();
    QString aboutKind() const;
    void accepted();

    bool m_trees = false;      ///< the document has numbered trees
    glm::dvec2 m_extent{0.0};  ///< of the document, units of X and Y
    QFormLayout* m_form;
    QComboBox* m_kind;
    QComboBox* m_attribute;
    QComboBox* m_statistic;
    NumberField* m_cell;
    NumberField* m_step;
    QLineEdit* m_where;
    QCheckBox* m_wgs84;
    QLabel* m_about;
    QLabel* m_size;
    QLabel* m_problem;
};

}  // namespace punctum::ui
