// SPDX-License-Identifier: MIT
#include "ui/navigate/GoToDialog.h"

#include "ui/navigate/Coordinates.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr double kLargestCoordinate = 1e15;  // as of a camera file
constexpr int kCoordinateWidth = 220;        // px

}  // namespace

GoToDialog::GoToDialog(const QString& x, const QString& y, const QString& unit, QWidget* parent)
    : QDialog(parent), m_problem(new QLabel)
{
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("goTo"));
    setWindowTitle(tr("Go to coordinate"));
    auto* const form = new QFormLayout;
    form->setHorizontalSpacing(16);
    form->setVerticalSpacing(9);
    const std::array names{tr("&X"), tr("&Y"), tr("&Z")};
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t k = std::size_t(axis);
        auto* const number = m_fields[k] = new NumberField;
        number->setMinimumWidth(kCoordinateWidth);
        number->setAccessibleName(QString(names[k]).remove(QLatin1Char('&')));
        number->setOptional(axis == 2);
        form->addRow(names[k], number);
        connect(number, &QLineEdit::textEdited, this, [this, axis, k](const QString& text) {
            // Typing adds one character at a time: more of them were pasted.
            const bool pasted = text.size() > m_lengths[k] + 1;
            m_lengths[k] = text.size();
            m_problem->clear();
            if (pasted) distribute(axis);
        });
        connect(number, &QLineEdit::textChanged, this, [this, k](const QString& text) {
            if (!m_fields[k]->isModified()) m_lengths[k] = text.size();
        });
        connect(number, &QLineEdit::selectionChanged, this, [this, k] {
            // What is selected will be replaced by what is pasted.
            m_lengths[k] = m_fields[k]->text().size() - m_fields[k]->selectedText().size();
        });
    }
    m_fields[2]->setPlaceholderText(tr("as high as now"));
    m_fields[0]->put(x);
    m_fields[1]->put(y);
    m_fields[0]->selectAll();

    auto* const hint = dimLabel((unit.isEmpty() ? tr("In the coordinates of the file.")
                                                : tr("In the coordinates of the file (%1).").arg(unit)) +
                                QLatin1Char(' ') + tr("A pair such as \"x; y\" can be pasted into one field."));
    hint->setWordWrap(true);
    m_problem->setObjectName(QStringLiteral("problem"));
    m_problem->setTextFormat(Qt::PlainText);
    m_problem->setWordWrap(true);
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    auto* const goThere = buttons->addButton(tr("&Go"), QDialogButtonBox::AcceptRole);
    goThere->setProperty("primary", true);
    goThere->setDefault(true);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, this, &GoToDialog::go);
    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(20, 18, 20, 14);
    column->setSpacing(14);
    column->addLayout(form);
    column->addWidget(hint);
    column->addWidget(m_problem);
    column->addWidget(buttons);
}

QString GoToDialog::problem() const
{
    return m_problem->text();
}

bool GoToDialog::distribute(int axis)
{
    const auto numbers = readCoordinates(m_fields[std::size_t(axis)]->text());
    if (numbers.empty()) return false;
    for (std::size_t k = 0; k < numbers.size(); ++k) m_fields[k]->put(numbers[k].plain);
    m_fields[numbers.size() - 1]->setFocus();
    m_fields[numbers.size() - 1]->selectAll();
    return true;
}

void GoToDialog::go()
{
    for (int axis = 0; axis < 3; ++axis)
        if (distribute(axis)) break;
    glm::dvec3 world(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        NumberField& number = field(axis);
        if (number.check() && std::abs(number.number().value_or(0.0)) > kLargestCoordinate)
            number.refuse(tr("No coordinate is that large."));
        if (!number.problem().isEmpty()) {
            m_problem->setText(QStringLiteral("%1: %2").arg(number.accessibleName(), number.problem()));
            number.setFocus();
            return;
        }
        world[axis] = number.number().value_or(0.0);
    }
    const bool hasHeight = field(2).number().has_value();
    accept();
    emit placeChosen(world, hasHeight);
}

}  // namespace punctum::ui
