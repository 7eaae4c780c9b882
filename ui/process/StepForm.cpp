// SPDX-License-Identifier: MIT
#include "ui/process/StepForm.h"

#include "core/process/Values.h"
#include "render/color/ColorMap.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesModel.h"
#include "ui/document/Document.h"
#include "ui/process/ClassesField.h"
#include "ui/select/RuleField.h"
#include "ui/style/Icons.h"
#include "ui/style/NumberField.h"
#include "ui/style/Swatch.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScopedValueRollback>
#include <QStyle>
#include <QToolButton>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kNarrow = 220;  // px: where a name and its field beside each other leave too little of the field

using Type = StepParameter::Type;

bool isNumeric(const StepParameter& parameter)
{
    return parameter.type == Type::Integer || parameter.type == Type::Real;
}

bool isLanguage(const StepParameter& parameter)
{
    return parameter.type == Type::Rule || parameter.type == Type::Condition;
}

/// Why a step would refuse the number; empty when it would not.
QString whyOutside(const StepParameter& parameter, const NumberField& field)
{
    const auto number = field.number();
    if (!number) return {};
    if (parameter.type == Type::Integer && *number != std::floor(*number))
        return StepForm::tr("%1: a whole number is wanted here.").arg(toQString(parameter.label));
    if (parameter.min < parameter.max && (*number < parameter.min || *number > parameter.max))
        return StepForm::tr("%1: from %2 to %3.")
            .arg(toQString(parameter.label), numberText(parameter.min), numberText(parameter.max));
    return {};
}

/// A preset as the field shows it.
QString shownPreset(const StepParameter& parameter, const QString& preset)
{
    if (isNumeric(parameter)) return localNumber(preset);
    return parameter.type == StepParameter::Type::ClassCode ? classText(preset.toUInt()) : preset;
}

QString unitName(StepParameter::Unit unit, const QString& length)
{
    switch (unit) {
        case StepParameter::Unit::None:
            break;
        case StepParameter::Unit::Length:
            return length;
        case StepParameter::Unit::Area:
            return length + QChar(0x00B2);
        case StepParameter::Unit::Degrees:
            return QChar(0x00B0);
        case StepParameter::Unit::PerCent:
            return QStringLiteral("%");
    }
    return {};
}

}  // namespace

StepForm::StepForm(QWidget* parent)
    : QWidget(parent), m_form(new QFormLayout), m_more(new QPushButton(tr("More settings")))
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(8);
    m_form->setHorizontalSpacing(12);
    m_form->setVerticalSpacing(8);
    m_form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    m_form->setRowWrapPolicy(QFormLayout::WrapLongRows);
    m_more->setProperty("flat", true);
    m_more->setCheckable(true);
    m_more->setToolTip(tr("Show what seldom needs to be changed"));
    column->addLayout(m_form);
    column->addWidget(m_more, 0, Qt::AlignLeft);
    connect(m_more, &QPushButton::toggled, this, &StepForm::fold);
    fold();
}

/// In a narrow panel fields stand below their names.
void StepForm::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    m_form->setRowWrapPolicy(width() < kNarrow ? QFormLayout::WrapAllRows : QFormLayout::WrapLongRows);
}

void StepForm::setStep(const Step* step)
{
    const QScopedValueRollback filling(m_filling, true);
    while (m_form->rowCount() > 0) m_form->removeRow(0);
    m_fields.clear();
    m_step = step;
    if (step != nullptr)
        for (const bool advanced : {false, true})
            for (const StepParameter& parameter : step->parameters())
                if (parameter.advanced == advanced) addField(parameter);
    m_more->setChecked(false);
    fillUnits();
    fillAttributes();
    fillClasses();
    fillPresets();
    fold();
    markChanged();
}

QWidget* StepForm::makeField(const StepParameter& parameter)
{
    const auto tell = [this] {
        if (m_filling) return;
        fold();
        markChanged();
        emit changed();
    };
    if (parameter.type == Type::AttributeName || parameter.type == Type::ClassCode ||
        parameter.type == Type::Choice) {
        auto* box = new QComboBox;
        mayBeNarrow(*box);
        box->setMaxVisibleItems(18);
        if (parameter.type == Type::Choice && parameter.optional) box->addItem(tr("none"), QString());
        for (const std::string& choice : parameter.choices) box->addItem(toQString(choice), toQString(choice));
        connect(box, &QComboBox::currentIndexChanged, this, tell);
        return box;
    }
    if (parameter.type == Type::ClassCodes) {
        auto* field = new ClassesField;
        field->setDocument(m_document);
        connect(field, &ClassesField::changed, this, tell);
        connect(field, &ClassesField::returnPressed, this, &StepForm::returnPressed);
        return field;
    }
    if (isNumeric(parameter)) {
        auto* edit = new NumberField;
        edit->setOptional(parameter.optional || parameter.fit.used() || !parameter.preset.empty());
        if (parameter.optional && parameter.preset.empty()) edit->setPlaceholderText(tr("not used"));
        if (parameter.fit.used()) edit->setPlaceholderText(tr("fits the data"));
        connect(edit, &QLineEdit::returnPressed, this, &StepForm::returnPressed);
        connect(edit, &QLineEdit::editingFinished, edit, &NumberField::check);
        connect(edit, &QLineEdit::textChanged, this, tell);
        connect(edit, &NumberField::problemChanged, this, &StepForm::problemChanged);
        return edit;
    }
    if (isLanguage(parameter)) {
        auto* edit = new RuleField;
        edit->setPlaceholderText(parameter.type == Type::Rule ? QStringLiteral("Classification = 2 if Z < 12.5")
                                                              : QStringLiteral("Classification == 7"));
        connect(edit, &RuleField::returnPressed, this, &StepForm::returnPressed);
        connect(edit, &RuleField::textChanged, this, tell);
        return edit;
    }
    auto* edit = new QLineEdit;
    if (parameter.optional && parameter.preset.empty()) edit->setPlaceholderText(tr("not used"));
    connect(edit, &QLineEdit::returnPressed, this, &StepForm::returnPressed);
    connect(edit, &QLineEdit::textChanged, this, tell);
    return edit;
}

void StepForm::addField(const StepParameter& parameter)
{
    Field field;
    field.parameter = parameter;
    field.widget = makeField(parameter);
    field.name = dimLabel(toQString(parameter.label));
    field.name->setMinimumHeight(kFieldHeight);  // in line with the middle of its field
    field.reset = new QToolButton;
    field.reset->setIcon(lineIcon(QStringLiteral("undo")));
    field.reset->setIconSize(QSize(14, 14));
    field.reset->setFocusPolicy(Qt::StrongFocus);
    field.reset->setAccessibleName(tr("Reset %1").arg(toQString(parameter.label)));
    field.row = new QWidget;
    auto* row = new QHBoxLayout(field.row);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(2);
    row->addWidget(field.widget, 1);
    row->addWidget(field.reset, 0, Qt::AlignTop);
    connect(field.reset, &QToolButton::clicked, this, [this, key = parameter.key] {
        const auto found =
            std::find_if(m_fields.begin(), m_fields.end(), [&](auto& f) { return f.parameter.key == key; });
        if (found == m_fields.end()) return;
        put(*found, found->preset);
        found->widget->setFocus();
    });
    QString help = toQString(parameter.help);
    help += toQString(whenText(parameter));
    if (const std::string preset = presetText(parameter); !preset.empty())
        help += QLatin1Char(' ') + toQString(preset);
    for (QWidget* widget : std::initializer_list<QWidget*>{field.name, field.widget}) widget->setToolTip(help);
    m_form->addRow(field.name, field.row);
    field.preset = toQString(parameter.preset);
    m_fields.push_back(std::move(field));
}

bool StepForm::matters(const Field& field) const
{
    const StepParameter::When& when = field.parameter.when;
    return when.key.empty() || std::any_of(m_fields.begin(), m_fields.end(), [&](const Field& other) {
               return other.parameter.key == when.key && valueOf(other) == toQString(when.value);
           });
}

/// Shows what is asked for: with *More settings* also what seldom is, and nothing that has no effect.
void StepForm::fold()
{
    bool any = false;
    for (const Field& field : m_fields) {
        const bool matter = matters(field);
        any = any || (field.parameter.advanced && matter);
        const bool shown = matter && (!field.parameter.advanced || m_more->isChecked());
        for (QWidget* widget : {static_cast<QWidget*>(field.name), field.row}) widget->setVisible(shown);
    }
    m_more->setVisible(any);
    m_more->setText(m_more->isChecked() ? tr("Fewer settings") : tr("More settings"));
}

void StepForm::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::attributesChanged, this, &StepForm::fillAttributes);
    m_scale.reset();
    const QScopedValueRollback filling(m_filling, true);
    for (const Field& field : m_fields)
        if (auto* classes = qobject_cast<ClassesField*>(field.widget)) classes->setDocument(document);
    fillUnits();
    fillAttributes();
    fillClasses();
    fillPresets();
    markChanged();
}

void StepForm::setScale(const std::optional<DataScale>& scale)
{
    m_scale = scale;
    const QScopedValueRollback filling(m_filling, true);
    fillPresets();
    markChanged();
}

void StepForm::fillUnits()
{
    const QString known = m_document ? m_document->lengthUnit() : QString();
    for (const Field& field : m_fields) {
        QString name = toQString(field.parameter.label);
        const QString unit = unitName(field.parameter.unit, known.isEmpty() ? tr("units") : known);
        if (!unit.isEmpty()) name += QStringLiteral(" (%1)").arg(unit);
        field.name->setText(name);
        field.widget->setAccessibleName(name);
        if (auto* classes = qobject_cast<ClassesField*>(field.widget)) classes->edit().setAccessibleName(name);
    }
}

void StepForm::fillAttributes()
{
    const QScopedValueRollback filling(m_filling, true);
    for (Field& field : m_fields) {
        if (field.parameter.type != Type::AttributeName) continue;
        auto* box = static_cast<QComboBox*>(field.widget);
        const QString chosen = box->currentIndex() < 0 ? field.preset : valueOf(field);
        box->clear();
        if (field.parameter.optional) box->addItem(tr("none"), QString());
        if (!m_document) continue;
        for (const Attribute& attribute : m_document->attributes())
            if (attribute.components == 1 && attribute.kind != AttributeKind::Opaque &&
                !(field.parameter.ownOnly && attribute.standard))
                box->addItem(lineIcon(iconNameOf(attribute.kind)), toQString(attribute.name),
                             toQString(attribute.name));
        const int row = box->findData(chosen);
        const int z = field.parameter.optional ? 0 : box->findData(QStringLiteral("Z"));
        box->setCurrentIndex(row >= 0 ? row : std::max(z, 0));
        box->setPlaceholderText(field.parameter.ownOnly ? tr("none beside the standard's") : QString());
        if (field.preset.isEmpty() && !field.parameter.optional) field.preset = valueOf(field);
    }
    markChanged();
}

void StepForm::fillClasses()
{
    for (Field& field : m_fields) {
        if (field.parameter.type != Type::ClassCode) continue;
        auto* box = static_cast<QComboBox*>(field.widget);
        const bool optional = field.parameter.optional && field.parameter.preset.empty();
        if (field.preset.isEmpty() && !optional) field.preset = QStringLiteral("2");
        const QString chosen = box->currentIndex() >= 0 ? valueOf(field) : field.preset;
        box->clear();
        if (optional) box->addItem(tr("none"), QString());
        for (unsigned code = 0; code < render::asprsClasses().size(); ++code)
            box->addItem(swatchIcon(render::asprsClasses()[code].color), classText(code), QString::number(code));
        box->setCurrentIndex(std::max(0, box->findData(chosen)));
    }
}

/// Presets go into fields in which nobody has written anything else.
void StepForm::fillPresets()
{
    for (Field& field : m_fields) {
        const QString before = field.preset;
        if (field.parameter.fit.used())
            field.preset = m_scale ? toQString(presetOf(field.parameter, *m_scale)) : QString();
        const QString now = valueOf(field);
        if (now.isEmpty() || (field.parameter.fit.used() && now == before)) put(field, field.preset);
    }
}

QString StepForm::valueOf(const Field& field) const
{
    switch (field.parameter.type) {
        case Type::AttributeName:
        case Type::ClassCode:
        case Type::Choice:
            return static_cast<QComboBox*>(field.widget)->currentData().toString();
        case Type::Rule:
        case Type::Condition:
            return static_cast<RuleField*>(field.widget)->text().trimmed();
        case Type::ClassCodes:
            return static_cast<ClassesField*>(field.widget)->text();
        case Type::Text:
            return static_cast<QLineEdit*>(field.widget)->text().trimmed();
        case Type::Integer:
        case Type::Real:
            break;
    }
    return static_cast<NumberField*>(field.widget)->plain();
}

bool StepForm::put(Field& field, const QString& text)
{
    if (auto* box = qobject_cast<QComboBox*>(field.widget)) {
        const int row = box->findData(text);
        if (row < 0) return false;
        box->setCurrentIndex(row);
    } else if (auto* number = qobject_cast<NumberField*>(field.widget)) {
        number->put(text);
    } else if (auto* classes = qobject_cast<ClassesField*>(field.widget)) {
        classes->setText(text);
    } else if (auto* rule = qobject_cast<RuleField*>(field.widget)) {
        rule->setText(text);
    } else {
        static_cast<QLineEdit*>(field.widget)->setText(text);
    }
    return true;
}

bool StepForm::setValue(const QString& key, const QString& text)
{
    for (Field& field : m_fields)
        if (toQString(field.parameter.key) == key) return put(field, text);
    return false;
}

StepValues StepForm::values(bool changedOnly) const
{
    StepValues values;
    for (const Field& field : m_fields) {
        const QString text = valueOf(field);
        if (text.isEmpty() || !matters(field)) continue;
        const bool own =
            toQString(field.parameter.preset) != text && !(field.parameter.fit.used() && text == field.preset);
        if (!changedOnly || own) values[field.parameter.key] = text.toStdString();
    }
    return values;
}

QString StepForm::check()
{
    QString problem;
    for (const Field& field : m_fields) {
        QString why;
        const QString text = valueOf(field);
        const StepParameter& p = field.parameter;
        if (!matters(field)) continue;
        const bool spared = p.optional || !p.preset.empty() || p.fit.used() || (p.wholeOnly && m_narrowed);
        QWidget* marked = field.widget;
        if (auto* number = qobject_cast<NumberField*>(field.widget)) {
            number->check();
            why = number->problem();
            if (why.isEmpty()) why = whyOutside(p, *number);
        } else if (auto* classes = qobject_cast<ClassesField*>(field.widget)) {
            marked = &classes->edit();
            if (!text.isEmpty() && !classes->classes())
                why = tr("%1: classes are written as 2, 8-9, or none.").arg(toQString(p.label));
            else if (text.isEmpty() && !spared)
                why = tr("Fill in the marked fields.");
        } else if (text.isEmpty() && !spared) {
            why = tr("Fill in the marked fields.");
        }
        markWrong(*marked, why);
        if (!why.isEmpty() && p.advanced) m_more->setChecked(true);
        if (problem.isEmpty()) problem = why;
    }
    return problem;
}

void StepForm::markProblem(const QString& sentence)
{
    for (const Field& field : m_fields)
        if (auto* rule = qobject_cast<RuleField*>(field.widget)) rule->markProblem(sentence);
}

bool StepForm::anyChanged() const
{
    return std::any_of(m_fields.begin(), m_fields.end(),
                       [&](auto& f) { return matters(f) && valueOf(f) != f.preset; });
}

void StepForm::markChanged()
{
    for (const Field& field : m_fields) {
        const StepParameter& p = field.parameter;
        const bool hasPreset = !p.preset.empty() || p.fit.used() || p.optional;
        const bool other = hasPreset && valueOf(field) != field.preset;
        QSizePolicy policy = field.reset->sizePolicy();
        policy.setRetainSizeWhenHidden(true);
        field.reset->setSizePolicy(policy);
        field.reset->setVisible(other);
        field.reset->setToolTip(field.preset.isEmpty()
                                    ? tr("Back to the preset")
                                    : tr("Back to the preset: %1").arg(shownPreset(field.parameter, field.preset)));
        if (field.name->property("dim").toBool() != other) continue;
        field.name->setProperty("dim", !other);  // what is one's own stands out
        field.name->style()->unpolish(field.name);
        field.name->style()->polish(field.name);
    }
}

}  // namespace punctum::ui
