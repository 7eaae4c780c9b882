// SPDX-License-Identifier: MIT
#include "ui/select/EditDock.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/expression/Syntax.h"
#include "core/measure/Spacing.h"
#include "render/color/ColorMap.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/select/RuleField.h"
#include "ui/select/RulePreview.h"
#include "ui/select/Selection.h"
#include "ui/style/NumberField.h"
#include "ui/style/Swatch.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QPushButton>
#include <QShortcut>
#include <QVBoxLayout>

namespace punctum::ui
{

namespace
{

constexpr int kAnyClass = -1;

}  // namespace

EditDock::EditDock(Workspace& workspace, Selection& selection, ViewRenderer& renderer, const ViewSettings& settings,
                   QWidget* parent)
    : QDockWidget(tr("Edit"), parent),
      m_workspace(workspace),
      m_selection(selection),
      m_result(new QLabel),
      m_preview(new RulePreview(workspace, renderer, settings, this)),
      m_endPreview(new QPushButton(tr("End preview"))),
      m_escape(new QShortcut(Qt::Key_Escape, parent ? parent : this))
{
    setObjectName(QStringLiteral("edit"));
    m_result->setWordWrap(true);
    m_result->setTextInteractionFlags(Qt::TextSelectableByMouse);
    auto* content = new QWidget;
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 10, 12, 10);
    column->setSpacing(14);
    column->addWidget(makeClassPart());
    column->addWidget(makeRulePart());
    column->addWidget(makeNeighborPart());
    column->addWidget(m_result);
    column->addWidget(m_endPreview);
    column->addStretch(1);
    setWidget(scrollColumn(content));
    setMinimumWidth(kLeastPanelWidth);
    connect(&m_selection, &Selection::changed, this, [this] {
        takeState();
        // a new selection is to be seen, and it may be what the rule is for
        if (m_selection.points(m_document) != m_previewed) m_preview->end();
    });
    connect(&m_selection, &Selection::neighborsTaken, this, &EditDock::tellNeighbors);
    m_endPreview->setToolTip(tr("Show the points as they are (Escape)"));
    connect(m_endPreview, &QPushButton::clicked, m_preview, &RulePreview::end);
    connect(m_escape, &QShortcut::activated, m_preview, &RulePreview::end);
    connect(m_preview, &RulePreview::told, this, &EditDock::say);
    connect(m_preview, &RulePreview::failed, this, &EditDock::sayWrong);
    connect(m_preview, &RulePreview::toggled, this, &EditDock::followPreview);
    // what a view shows that nobody can tell from the truth must not outlive the panel that says so
    connect(this, &QDockWidget::visibilityChanged, m_preview, [this](bool visible) {
        if (!visible) m_preview->end();
    });
    followPreview(false);
    fillClasses();
    takeState();
}

QWidget* EditDock::makeClassPart()
{
    auto* part = new QWidget;
    auto* grid = new QGridLayout(part);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(8);
    grid->setColumnStretch(1, 1);
    m_from = new QComboBox;
    m_to = new QComboBox;
    m_previewClass = new QPushButton(tr("Preview"));
    m_setClass = new QPushButton(tr("Set class"));
    m_setClass->setProperty("primary", true);
    for (QComboBox* box : {m_from, m_to}) {
        box->setMaxVisibleItems(18);
        box->setMinimumContentsLength(12);
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        connect(box, &QComboBox::currentIndexChanged, m_preview, &RulePreview::end);
    }
    m_from->setAccessibleName(tr("Class that changes"));
    m_to->setAccessibleName(tr("Class that points get"));
    m_previewClass->setToolTip(tr("Show the points in their new classes, and count them; nothing changes"));
    m_setClass->setToolTip(tr("Give the selected points this class; the keys 0 to 9 do it at once"));
    grid->addWidget(heading(tr("Class of the selected points")), 0, 0, 1, 2);
    grid->addWidget(dimLabel(tr("From")), 1, 0);
    grid->addWidget(m_from, 1, 1);
    grid->addWidget(dimLabel(tr("To")), 2, 0);
    grid->addWidget(m_to, 2, 1);
    auto* row = new QHBoxLayout;
    row->setSpacing(6);
    row->addWidget(m_previewClass, 1);
    row->addWidget(m_setClass, 1);
    grid->addLayout(row, 3, 0, 1, 2);
    connect(m_previewClass, &QPushButton::clicked, this, &EditDock::previewClass);
    connect(m_setClass, &QPushButton::clicked, this, [this] {
        setClass(m_to->currentData().toUInt(), chosenFrom());
        if (m_job != 0) emit begun();
    });
    return part;
}

QWidget* EditDock::makeRulePart()
{
    auto* part = new QWidget;
    auto* column = new QVBoxLayout(part);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(8);
    m_rule = new RuleField;
    m_rule->setPlaceholderText(QStringLiteral("Classification = 2 if Z < 12.5"));
    m_rule->setAccessibleName(tr("Rule or condition"));
    m_rule->setToolTip(tr(
        "Attribute = value if condition, or a condition alone to select by. Numbers are written with a point here, "
        "whatever the language. The user guide tells more."));
    m_selectedOnly = new QCheckBox(tr("Selected points only"));
    m_select = new QPushButton(tr("Select"));
    m_previewRule = new QPushButton(tr("Preview"));
    m_apply = new QPushButton(tr("Apply"));
    m_select->setToolTip(tr("Select the points for which the condition holds"));
    m_previewRule->setToolTip(
        tr("Show how the points would look, and count those that would change; nothing changes"));
    m_apply->setToolTip(tr("Change the points; it can be undone"));
    auto* row = new FoldingRow(6, 2, 1);
    for (QPushButton* button : {m_select, m_previewRule}) row->first().addWidget(button, 1);
    row->second().addWidget(m_apply, 1);
    column->addWidget(heading(tr("Rule")));
    column->addWidget(m_rule);
    column->addWidget(m_selectedOnly);
    column->addWidget(row);
    connect(m_select, &QPushButton::clicked, this, &EditDock::selectByRule);
    connect(m_previewRule, &QPushButton::clicked, this, &EditDock::previewRule);
    connect(m_apply, &QPushButton::clicked, this, &EditDock::applyRule);
    connect(m_rule, &RuleField::returnPressed, this, &EditDock::previewRule);
    connect(m_rule, &RuleField::textChanged, m_preview, &RulePreview::end);
    connect(m_selectedOnly, &QCheckBox::toggled, m_preview, &RulePreview::end);
    return part;
}

QWidget* EditDock::makeNeighborPart()
{
    auto* part = new QWidget;
    auto* grid = new QGridLayout(part);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(6);
    m_distance = new NumberSpin;
    m_distance->setRange(0.001, 1e6);
    m_distance->setDecimals(3);
    m_distance->setMinimumHeight(kFieldHeight);
    m_distance->setValue(1.0);
    m_distance->setAccessibleName(tr("Distance between neighbors"));
    grid->addWidget(heading(tr("Neighbors of the selected points")), 0, 0, 1, 3);
    grid->addWidget(dimLabel(tr("Distance")), 1, 0);
    grid->addWidget(m_distance, 1, 1, 1, 2);
    auto* row = new FoldingRow(6, 2, 1);
    grid->addWidget(row, 2, 0, 1, 3);
    const auto add = [&](int at, const QString& text, const QString& tip, void (Selection::*act)(double)) {
        m_neighbors[std::size_t(at)] = new QPushButton(text);
        m_neighbors[std::size_t(at)]->setToolTip(tip);
        (at < 2 ? row->first() : row->second()).addWidget(m_neighbors[std::size_t(at)], 1);
        connect(m_neighbors[std::size_t(at)], &QPushButton::clicked, this, [this, act] {
            m_asked = m_distance->text();
            (m_selection.*act)(m_distance->value());
        });
    };
    connect(m_distance, &QDoubleSpinBox::valueChanged, this, [this] { m_distanceIsOwn = true; });
    add(0, tr("Grow"), tr("Select the points within this distance, too"), &Selection::grow);
    add(1, tr("Shrink"), tr("Leave out points that have others within this distance"), &Selection::shrink);
    add(2, tr("Connected"), tr("Select all that can be reached in steps of this length"),
        &Selection::connectNeighbors);
    return part;
}

void EditDock::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    m_distanceIsOwn = false;
    if (document) connect(document, &Document::stateChanged, this, &EditDock::takeState);
    m_result->clear();
    takeState();
}

void EditDock::fillClasses()
{
    for (QComboBox* box : {m_from, m_to}) mayBeNarrow(*box);
    m_from->addItem(tr("any class"), kAnyClass);
    for (unsigned code = 0; code < 256; ++code) {
        const QIcon icon = swatchIcon(render::asprsClasses()[code].color);
        m_from->addItem(icon, classText(code), int(code));
        m_to->addItem(icon, classText(code), int(code));
    }
    m_to->setCurrentIndex(m_to->findData(2));
}

void EditDock::takeState()
{
    const bool some = ready() && m_selection.count() > 0;
    m_previewClass->setEnabled(some);
    m_setClass->setEnabled(some);
    for (QPushButton* button : m_neighbors) button->setEnabled(some);
    for (QPushButton* button : {m_select, m_previewRule, m_apply}) button->setEnabled(ready());
    m_selectedOnly->setEnabled(some);
    const QString unit = m_document ? m_document->lengthUnit() : QString();
    m_distance->setSuffix(QLatin1Char(' ') + (unit.isEmpty() ? tr("units") : unit));
    presetDistance();
}

void EditDock::presetDistance()
{
    if (m_distanceIsOwn || !m_document || m_document->spacing() <= 0) return;
    // Twice the spacing reaches the nearest points of a surface wherever they lie at random, and few others.
    putLength(*m_distance, roundLength(2 * m_document->spacing()), 3);
}

void EditDock::tellNeighbors(quint64 joined, quint64 left)
{
    if (joined != 0)
        say(tr("Grown by %1 within %2.").arg(pointsText(joined), m_asked));
    else if (left != 0)
        say(tr("Shrunk by %1 that have others within %2.").arg(pointsText(left), m_asked));
    else
        say(tr("The selection stays as it is: within %1 there is nothing to join or leave.").arg(m_asked));
}

QString EditDock::resultText() const
{
    return m_result->text();
}

void EditDock::say(const QString& text)
{
    m_result->setText(text);
}

void EditDock::refuse(MessageKind kind, const QString& sentence)
{
    say(sentence);
    if (!isVisible()) m_workspace.say(kind, sentence, {}, m_document);  // keys work without the panel
}

void EditDock::sayWrong(const QString& sentence)
{
    const QString text = m_rule->text();
    int blanks = 0;  // the language is told of what stands behind them
    while (blanks < text.size() && text[blanks].isSpace()) ++blanks;
    m_rule->markProblem(sentence, blanks);
    say(sentence);
}

void EditDock::setClass(unsigned to, std::optional<unsigned> from)
{
    if (const auto points = selected()) runRule(classRule(to, from), points, tr("Set class %1").arg(classText(to)));
}

QString EditDock::classRule(unsigned to, std::optional<unsigned> from) const
{
    const QString rule = QStringLiteral("Classification = %1").arg(to);
    return from ? rule + QStringLiteral(" if Classification == %1").arg(*from) : rule;
}

std::optional<unsigned> EditDock::chosenFrom() const
{
    const int from = m_from->currentData().toInt();
    return from == kAnyClass ? std::nullopt : std::optional<unsigned>(from);
}

void EditDock::setWithheld(bool withheld)
{
    if (const auto points = selected())
        runRule(QStringLiteral("Withheld = %1").arg(withheld ? 1 : 0), points,
                withheld ? tr("Set withheld") : tr("Clear withheld"));
}

void EditDock::deleteSelected()
{
    if (const auto points = selected()) run(Recipe{"delete", {}, points}, tr("Delete"));
}

void EditDock::restoreDeleted()
{
    run(Recipe{"restore", {}, nullptr}, tr("Restore deleted points"));
}

bool EditDock::ready() const
{
    return m_document && !m_document->loading() && m_job == 0;
}

std::shared_ptr<const PointSet> EditDock::selected()
{
    auto points = m_selection.points(m_document);
    if (!points) refuse(MessageKind::Info, tr("Select the points first."));
    return points;
}

std::shared_ptr<const PointSet> EditDock::ruleScope() const
{
    return m_selectedOnly->isEnabled() && m_selectedOnly->isChecked() ? m_selection.points(m_document) : nullptr;
}

std::optional<expression::Rule> EditDock::parsed(const QString& rule)
{
    try {
        return expression::Rule(rule.trimmed().toStdString());
    } catch (const Error& e) {
        sayWrong(toQString(std::string(e.what())));
        return std::nullopt;
    }
}

void EditDock::applyRule()
{
    if (const auto rule = parsed(m_rule->text()))
        run(Recipe{"set", {{"rule", rule->text()}}, ruleScope()}, tr("Set by rule"), true);
    if (m_job != 0) emit begun();
}

void EditDock::runRule(const QString& text, std::shared_ptr<const PointSet> within, const QString& title)
{
    if (const auto rule = parsed(text)) run(Recipe{"set", {{"rule", rule->text()}}, std::move(within)}, title);
}

void EditDock::run(const Recipe& recipe, const QString& title, bool typed)
{
    if (!ready()) return;
    m_job = m_workspace.edit(
        *m_document, title, recipe, [this, title, typed](const JobInfo& info, const EditOutcome& outcome) {
            m_job = 0;
            m_preview->end();
            takeState();
            if (info.state == JobState::Failed)
                typed ? sayWrong(toQString(info.error)) : refuse(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Cancelled) say(tr("Cancelled, nothing changed."));
            if (info.state == JobState::Finished)
                say(outcome.changed == 0
                        ? tr("%1: no point had to change.").arg(title)
                        : tr("%1: %2 changed.").arg(title, pointsText(outcome.changed)) +
                              (outcome.finding.empty() ? QString()
                                                       : QLatin1Char(' ') + toQString(outcome.finding)));
        });
    takeState();
}

void EditDock::previewRule()
{
    preview(m_rule->text(), ruleScope());
}

void EditDock::previewClass()
{
    if (const auto points = selected()) preview(classRule(m_to->currentData().toUInt(), chosenFrom()), points);
}

void EditDock::preview(const QString& text, std::shared_ptr<const PointSet> within)
{
    m_preview->end();
    const auto rule = parsed(text);
    if (!ready() || !rule) return;
    say({});
    m_previewed = m_selection.points(m_document);
    m_preview->begin(*m_document, *rule, std::move(within));
}

void EditDock::followPreview(bool on)
{
    m_endPreview->setVisible(on);
    m_escape->setEnabled(on);
    if (on) return;
    m_previewed = nullptr;
    say({});
}

void EditDock::selectByRule()
{
    QString text = m_rule->text().trimmed();
    try {
        // of a rule, the points that its first condition names
        const std::string bytes = text.toStdString();
        const expression::Assignment rule = expression::parseAssignment(bytes);
        if (const auto& first = rule.cases.front(); rule.cases.size() == 1 && !first.condition.empty())
            text = toQString(bytes.substr(first.conditionByte));
    } catch (const Error&) {
        // a condition, then; it tells itself what is wrong with it
    }
    try {
        m_selection.selectByRule(text);
        say({});
    } catch (const Error& e) {
        sayWrong(toQString(std::string(e.what())));
    }
}

}  // namespace punctum::ui
