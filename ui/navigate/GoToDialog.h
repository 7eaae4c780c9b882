// SPDX-License-Identifier: MIT
#pragma once

#include <QDialog>

#include <glm/vec3.hpp>

#include <array>
#include <optional>

class QLabel;

namespace punctum::ui
{

class NumberField;

/// Asks for a place by its coordinates: X and Y, and Z or none. Two or three numbers that are pasted into one field
/// go into all of them. GUI thread only; deletes itself when closed.
class GoToDialog final : public QDialog
{
    Q_OBJECT
public:
    /// `x`, `y`: the program's texts that the fields begin with. `unit`: of X and Y; empty: not known.
    GoToDialog(const QString& x, const QString& y, const QString& unit, QWidget* parent);

    NumberField& field(int axis) { return *m_fields[std::size_t(axis)]; }
    /// What is wrong with the fields, in a sentence; empty when nothing is said.
    QString problem() const;
    /// Takes the place, or says what is wrong.
    void go();

signals:
    /// Without `hasHeight`, z says nothing.
    void placeChosen(const glm::dvec3& world, bool hasHeight);

private:
    /// Several numbers in one field become one in each.
    bool distribute(int axis);

    std::array<NumberField*, 3> m_fields{};
    std::array<qsizetype, 3> m_lengths{};  ///< of the texts, before the last change
    QLabel* m_problem;
};

}  // namespace punctum::ui
