// SPDX-License-Identifier: MIT
#include "ui/docks/ProcessingDock.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "render/color/ColorMap.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesModel.h"
#include "ui/document/Workspace.h"
#include "ui/style/Icons.h"
#include "ui/style/NumberField.h"
#include "ui/style/Swatch.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QStyle>
#include <QVBoxLayout>

#include <cmath>

namespace punctum::ui
{

namespace
{

/// The attribute that a rule sets; empty for a text that is no rule, which the step will say.
QString targetOfRule(const QString& text)
{
    try {
        return toQString(expression::Rule(text.toStdString()).target());
    } catch (const Error&) {
        return {};
    }
}

bool isNumber(const StepParameter& parameter)
{
    return parameter.type == StepParameter::Type::Integer || parameter.type == StepParameter::Type::Real;
}

/// Why a step would refuse the number; empty when it would not.
QString outOfBounds(const StepParameter& parameter, const NumberField& field)
{
    const auto number = field.number();
    if (!number) return {};
    if (parameter.type == StepParameter::Type::Integer && *number != std::floor(*number))
        return ProcessingDock::tr("%1: a whole number is wanted here.").arg(toQString(parameter.label));
    if (parameter.min < parameter.max && (*number < parameter.min || *number > parameter.max))
        return ProcessingDock::tr("%1: from %2 to %3.")
            .arg(toQString(parameter.label), numberText(parameter.min), numberText(parameter.max));
    return {};
}

}  // namespace

ProcessingDock::ProcessingDock(Workspace& workspace, QWidget* parent)
    : QDockWidget(tr("Process"), parent),
      m_workspace(workspace),
      m_steps(new QComboBox),
      m_help(dimLabel({})),
      m_form(new QFormLayout),
      m_show(new QCheckBox(tr("Show the result"))),
      m_run(new QPushButton(tr("Run"))),
      m_progress(new QProgressBar),
      m_result(new QLabel)
{
    setObjectName(QStringLiteral("processing"));
    for (const Step* each : allSteps()) m_steps->addItem(toQString(each->title()), toQString(each->name()));
    m_steps->setAccessibleName(tr("Processing step"));
    mayBeNarrow(*m_steps);
    m_help->setWordWrap(true);
    m_help->setTextInteractionFlags(Qt::TextSelectableByMouse);
    m_form->setHorizontalSpacing(12);
    m_form->setVerticalSpacing(8);
    m_form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    m_form->setRowWrapPolicy(QFormLayout::WrapLongRows);
    m_show->setChecked(true);
    m_show->setToolTip(tr("Color the points by what the step made, as soon as it is there"));
    m_run->setProperty("primary", true);
    m_progress->setRange(0, 1000);
    m_progress->setTextVisible(false);
    m_result->setWordWrap(true);
    m_result->setTextInteractionFlags(Qt::TextSelectableByMouse);

    auto* content = new QWidget;
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 10, 12, 10);
    column->setSpacing(12);
    column->addWidget(m_steps);
    column->addWidget(m_help);
    column->addLayout(m_form);
    column->addWidget(m_show);
    column->addWidget(m_run);
    column->addWidget(m_progress);
    column->addWidget(m_result);
    column->addStretch(1);
    setWidget(scrollColumn(content));
    setMinimumWidth(kLeastPanelWidth);

    connect(m_steps, &QComboBox::currentIndexChanged, this, &ProcessingDock::buildFields);
    connect(m_run, &QPushButton::clicked, this, [this] {
        if (m_job == 0)
            run();
        else if (m_running.hasExpired(QApplication::doubleClickInterval()))  // a double click means to run it
            m_workspace.cancel(m_job);
    });
    connect(&m_workspace, &Workspace::stepEnded, this, &ProcessingDock::ended);
    connect(&m_workspace, &Workspace::documentStateChanged, this, &ProcessingDock::updateState);
    buildFields();
    updateState();
}

const Step* ProcessingDock::step() const
{
    return findStep(m_steps->currentData().toString().toStdString());
}

void ProcessingDock::chooseStep(const QString& name)
{
    const int row = m_steps->findData(name);
    if (row >= 0) m_steps->setCurrentIndex(row);
}

QString ProcessingDock::resultText() const
{
    return m_result->text();
}

void ProcessingDock::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::attributesChanged, this, &ProcessingDock::fillAttributes);
    fillUnits();
    fillAttributes();
    fillClasses();
    m_result->clear();
    updateState();
}

void ProcessingDock::buildFields()
{
    while (m_form->rowCount() > 0) m_form->removeRow(0);
    m_fields.clear();
    m_result->clear();
    const Step* chosen = step();
    if (!chosen) return;
    m_help->setText(toQString(chosen->help()));
    for (const StepParameter& parameter : chosen->parameters()) {
        Field field;
        using Type = StepParameter::Type;
        if (parameter.type == Type::AttributeName || parameter.type == Type::ClassCode ||
            parameter.type == Type::Choice) {
            auto* box = new QComboBox;
            mayBeNarrow(*box);
            box->setMaxVisibleItems(18);
            if (parameter.type == Type::Choice && parameter.optional) box->addItem(tr("none"), QString());
            for (const std::string& choice : parameter.choices) box->addItem(toQString(choice), toQString(choice));
            field.widget = box;
        } else if (isNumber(parameter)) {
            auto* edit = new NumberField;
            edit->setOptional(parameter.optional || parameter.fit.used() || !parameter.preset.empty());
            edit->put(toQString(parameter.preset));
            if (parameter.optional && parameter.preset.empty()) edit->setPlaceholderText(tr("not used"));
            if (parameter.fit.used()) edit->setPlaceholderText(tr("fits the data"));
            field.widget = edit;
            connect(edit, &QLineEdit::returnPressed, this, &ProcessingDock::run);
            connect(edit, &QLineEdit::editingFinished, edit, &NumberField::check);
            connect(edit, &NumberField::problemChanged, m_result, &QLabel::setText);
        } else {
            auto* edit = new QLineEdit(toQString(parameter.preset));
            if (parameter.optional && parameter.preset.empty()) edit->setPlaceholderText(tr("not used"));
            field.widget = edit;
            connect(edit, &QLineEdit::returnPressed, this, &ProcessingDock::run);
        }
        field.name = dimLabel(toQString(parameter.label));
        field.name->setMinimumHeight(kFieldHeight);  // in line with the middle of its field
        for (QWidget* widget : std::initializer_list<QWidget*>{field.name, field.widget})
            widget->setToolTip(toQString(parameter.help));
        m_form->addRow(field.name, field.widget);
        field.parameter = parameter;
        m_fields.push_back(std::move(field));
    }
    fillUnits();
    fillAttributes();
    fillClasses();
}

void ProcessingDock::fillUnits()
{
    const QString known = m_document ? m_document->lengthUnit() : QString();
    const QString unit = known.isEmpty() ? tr("units") : known;
    for (const Field& field : m_fields) {
        QString name = toQString(field.parameter.label);
        if (field.parameter.unit == StepParameter::Unit::Length) name += QStringLiteral(" (%1)").arg(unit);
        field.name->setText(name);
        field.widget->setAccessibleName(name);
    }
}

void ProcessingDock::fillAttributes()
{
    for (Field& field : m_fields) {
        if (field.parameter.type != StepParameter::Type::AttributeName) continue;
        auto* box = static_cast<QComboBox*>(field.widget);
        const QString chosen =
            box->currentText().isEmpty() ? toQString(field.parameter.preset) : box->currentText();
        box->clear();
        if (!m_document) continue;
        for (const Attribute& attribute : m_document->attributes())
            if (attribute.components == 1 && attribute.kind != AttributeKind::Opaque &&
                !(field.parameter.ownOnly && attribute.standard))
                box->addItem(lineIcon(iconNameOf(attribute.kind)), toQString(attribute.name));
        const int row = box->findText(chosen);
        const int z = box->findText(QStringLiteral("Z"));
        box->setCurrentIndex(row >= 0 ? row : std::max(z, 0));
        box->setPlaceholderText(field.parameter.ownOnly ? tr("none beside the standard's") : QString());
    }
}

void ProcessingDock::fillClasses()
{
    for (Field& field : m_fields) {
        if (field.parameter.type != StepParameter::Type::ClassCode) continue;
        auto* box = static_cast<QComboBox*>(field.widget);
        const QVariant chosen = box->currentIndex() >= 0 ? box->currentData()
                                : field.parameter.preset.empty()
                                    ? QVariant(2)
                                    : QVariant(toQString(field.parameter.preset).toInt());
        box->clear();
        for (unsigned code = 0; code < render::asprsClasses().size(); ++code)
            box->addItem(swatchIcon(render::asprsClasses()[code].color), classText(code), int(code));
        box->setCurrentIndex(std::max(0, box->findData(chosen)));
    }
}

QString ProcessingDock::valueOf(const Field& field) const
{
    switch (field.parameter.type) {
        case StepParameter::Type::AttributeName:
            return static_cast<QComboBox*>(field.widget)->currentText();
        case StepParameter::Type::ClassCode:
        case StepParameter::Type::Choice:
            return static_cast<QComboBox*>(field.widget)->currentData().toString();
        case StepParameter::Type::Rule:
        case StepParameter::Type::Condition:
        case StepParameter::Type::ClassCodes:
        case StepParameter::Type::Text:
            return static_cast<QLineEdit*>(field.widget)->text().trimmed();
        case StepParameter::Type::Integer:
        case StepParameter::Type::Real:
            break;
    }
    return static_cast<NumberField*>(field.widget)->plain();
}

bool ProcessingDock::checkFields()
{
    QString problem;
    for (const Field& field : m_fields) {
        QString why;
        if (auto* number = qobject_cast<NumberField*>(field.widget)) {
            number->check();
            why = number->problem();
            if (why.isEmpty()) why = outOfBounds(field.parameter, *number);
        } else if (valueOf(field).isEmpty() && !field.parameter.optional && field.parameter.preset.empty()) {
            why = tr("Fill in the marked fields.");
        }
        markWrong(*field.widget, why);
        if (problem.isEmpty()) problem = why;
    }
    if (problem.isEmpty()) return true;
    m_result->setText(problem);
    return false;
}

bool ProcessingDock::setValue(const QString& key, const QString& text)
{
    for (Field& field : m_fields) {
        if (toQString(field.parameter.key) != key) continue;
        if (auto* box = qobject_cast<QComboBox*>(field.widget)) {
            const int row = field.parameter.type == StepParameter::Type::ClassCode ? box->findData(text.toInt())
                                                                                   : box->findText(text);
            if (row < 0) return false;
            box->setCurrentIndex(row);
        } else if (auto* number = qobject_cast<NumberField*>(field.widget)) {
            number->put(text);
        } else {
            static_cast<QLineEdit*>(field.widget)->setText(text);
        }
        return true;
    }
    return false;
}

void ProcessingDock::run()
{
    const Step* chosen = step();
    if (!chosen || !m_document || m_document->loading() || m_job != 0) return;
    if (!checkFields()) return;
    StepValues values;
    for (const Field& field : m_fields)
        if (const QString text = valueOf(field); !text.isEmpty()) values[field.parameter.key] = text.toStdString();
    m_result->clear();
    m_runningStep = toQString(chosen->name());
    m_target = QStringLiteral("Classification");
    for (const Field& field : m_fields)
        if (field.parameter.type == StepParameter::Type::Rule) m_target = targetOfRule(valueOf(field));
    m_running.start();
    m_job = m_workspace.run(*m_document, *chosen, values);
    updateState();
}

void ProcessingDock::updateState()
{
    const bool busy = m_job != 0;
    m_run->setText(busy ? tr("Cancel") : tr("Run"));
    if (m_run->property("primary").toBool() == busy) {
        m_run->setProperty("primary", !busy);
        m_run->style()->unpolish(m_run);
        m_run->style()->polish(m_run);
    }
    m_run->setEnabled(busy || (m_document && !m_document->loading()));
    m_run->setToolTip(busy ? tr("Stop; nothing changes")
                           : tr("Run this step on the active file. It can be undone."));
    m_progress->setVisible(busy);
    m_steps->setEnabled(!busy);
}

void ProcessingDock::updateProgress()
{
    if (m_job == 0) return;
    for (const JobInfo& info : m_workspace.jobs().running()) {
        if (info.id != m_job) continue;
        m_progress->setValue(int(std::lround(info.fraction * 1000.0)));
        m_result->setText(toQString(info.stage));
    }
}

void ProcessingDock::ended(quint64 job, const QString& title, quint64 changed, const QStringList& newAttributes,
                           const JobInfo& info)
{
    if (job != m_job) return;
    m_job = 0;
    updateState();
    switch (info.state) {
        case JobState::Failed:
            m_result->setText(toQString(info.error));
            if (!isVisible()) m_workspace.say(MessageKind::Error, toQString(info.error), {}, m_document);
            return;
        case JobState::Cancelled:
            m_result->setText(tr("%1: cancelled, nothing changed.").arg(title));
            return;
        case JobState::Running:
        case JobState::Finished:
            break;
    }
    if (changed == 0) {
        m_result->setText(tr("%1: no point had to change.").arg(title));
        return;
    }
    m_result->setText(tr("%1: %2 changed.").arg(title, pointsText(changed)));
    if (!m_show->isChecked() || !m_document) return;
    // Of several new attributes the one that shows them together; without new ones the classes.
    QString wanted;
    for (const QString& name : newAttributes) {
        const Attribute* attribute = m_document->findAttribute(name);
        if (wanted.isEmpty() || (attribute && attribute->components == 3)) wanted = name;
    }
    if (wanted.isEmpty() && m_runningStep == QLatin1String("normals")) wanted = QStringLiteral("Normal");
    if (wanted.isEmpty()) wanted = m_target;
    emit showAttribute(wanted);
}

}  // namespace punctum::ui
