// SPDX-License-Identifier: MIT
#include "ui/select/EditDock.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/expression/Syntax.h"
#include "core/task/Progress.h"
#include "render/color/ColorMap.h"
#include "ui/Document.h"
#include "ui/Text.h"
#include "ui/Workspace.h"
#include "ui/docks/Swatch.h"
#include "ui/select/Selection.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include <shared_mutex>

namespace punctum::ui
{

namespace
{

constexpr int kAnyClass = -1;

/// "1,000 of 1 Unclassified, 204 of 5 High Vegetation": the classes of the set's points, the most frequent first.
QString classesText(const PointCloud& cloud, const PointSet& points)
{
    constexpr std::size_t kMost = 4;
    std::array<std::uint64_t, 256> counts{};
    {
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const classes = cloud.findAttribute("Classification");
        if (classes == nullptr) return {};
        points.forEach([&](PointIndex i) { ++counts[std::size_t(classes->number(i)) & 255u]; });
    }
    std::vector<unsigned> codes;
    for (unsigned code = 0; code < counts.size(); ++code)
        if (counts[code] != 0) codes.push_back(code);
    std::sort(codes.begin(), codes.end(), [&](unsigned a, unsigned b) { return counts[a] > counts[b]; });
    QStringList parts;
    for (std::size_t k = 0; k < std::min(kMost, codes.size()); ++k)
        parts << EditDock::tr("%1 of %2").arg(countText(counts[codes[k]]), classText(codes[k]));
    if (codes.size() > kMost) parts << EditDock::tr("others");
    return parts.join(QStringLiteral(", "));
}

}  // namespace

EditDock::EditDock(Workspace& workspace, Selection& selection, QWidget* parent)
    : QDockWidget(tr("Edit"), parent), m_workspace(workspace), m_selection(selection), m_result(new QLabel)
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
    column->addStretch(1);
    setWidget(scrollColumn(content));
    setMinimumWidth(250);
    connect(&m_selection, &Selection::changed, this, &EditDock::takeState);
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
    m_setClass = new QPushButton(tr("Set class"));
    m_setClass->setProperty("primary", true);
    for (QComboBox* box : {m_from, m_to}) {
        box->setMaxVisibleItems(18);
        box->setMinimumContentsLength(12);
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    }
    m_from->setAccessibleName(tr("Class that changes"));
    m_to->setAccessibleName(tr("Class that points get"));
    m_setClass->setToolTip(tr("Give the selected points this class; the keys 0 to 9 do it at once"));
    grid->addWidget(heading(tr("Class of the selected points")), 0, 0, 1, 2);
    grid->addWidget(dimLabel(tr("From")), 1, 0);
    grid->addWidget(m_from, 1, 1);
    grid->addWidget(dimLabel(tr("To")), 2, 0);
    grid->addWidget(m_to, 2, 1);
    grid->addWidget(m_setClass, 3, 0, 1, 2);
    connect(m_setClass, &QPushButton::clicked, this, [this] {
        const int from = m_from->currentData().toInt();
        setClass(m_to->currentData().toUInt(), from == kAnyClass ? std::nullopt : std::optional<unsigned>(from));
    });
    return part;
}

QWidget* EditDock::makeRulePart()
{
    auto* part = new QWidget;
    auto* column = new QVBoxLayout(part);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(8);
    m_rule = new QLineEdit;
    m_rule->setPlaceholderText(QStringLiteral("Classification = 2 if Z < 12.5"));
    m_rule->setAccessibleName(tr("Rule or condition"));
    m_rule->setToolTip(
        tr("Attribute = value if condition, or a condition alone to select by; the user guide tells the "
           "language"));
    m_rule->setClearButtonEnabled(true);
    m_selectedOnly = new QCheckBox(tr("Selected points only"));
    m_select = new QPushButton(tr("Select"));
    m_preview = new QPushButton(tr("Preview"));
    m_apply = new QPushButton(tr("Apply"));
    m_select->setToolTip(tr("Select the points for which the condition holds"));
    m_preview->setToolTip(tr("Select and count the points that the rule would change; nothing changes"));
    m_apply->setToolTip(tr("Change the points; it can be undone"));
    auto* row = new QHBoxLayout;
    row->setSpacing(6);
    for (QPushButton* button : {m_select, m_preview, m_apply}) row->addWidget(button, 1);
    column->addWidget(heading(tr("Rule")));
    column->addWidget(m_rule);
    column->addWidget(m_selectedOnly);
    column->addLayout(row);
    connect(m_select, &QPushButton::clicked, this, &EditDock::selectByRule);
    connect(m_preview, &QPushButton::clicked, this, &EditDock::previewRule);
    connect(m_apply, &QPushButton::clicked, this, &EditDock::applyRule);
    connect(m_rule, &QLineEdit::returnPressed, this, &EditDock::previewRule);
    return part;
}

QWidget* EditDock::makeNeighborPart()
{
    auto* part = new QWidget;
    auto* grid = new QGridLayout(part);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(6);
    m_distance = new QDoubleSpinBox;
    m_distance->setRange(0.001, 1e6);
    m_distance->setDecimals(3);
    m_distance->setValue(1.0);
    m_distance->setAccessibleName(tr("Distance between neighbors"));
    grid->addWidget(heading(tr("Neighbors of the selected points")), 0, 0, 1, 3);
    grid->addWidget(dimLabel(tr("Distance")), 1, 0);
    grid->addWidget(m_distance, 1, 1, 1, 2);
    const auto add = [&](int at, const QString& text, const QString& tip, void (Selection::*act)(double)) {
        m_neighbors[std::size_t(at)] = new QPushButton(text);
        m_neighbors[std::size_t(at)]->setToolTip(tip);
        grid->addWidget(m_neighbors[std::size_t(at)], 2, at);
        connect(m_neighbors[std::size_t(at)], &QPushButton::clicked, this,
                [this, act] { (m_selection.*act)(m_distance->value()); });
    };
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
    if (document) connect(document, &Document::stateChanged, this, &EditDock::takeState);
    m_result->clear();
    takeState();
}

void EditDock::fillClasses()
{
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
    m_setClass->setEnabled(some);
    for (QPushButton* button : m_neighbors) button->setEnabled(some);
    for (QPushButton* button : {m_select, m_preview, m_apply}) button->setEnabled(ready());
    m_selectedOnly->setEnabled(some);
    const QString unit = m_document ? m_document->coordinateUnit() : QString();
    m_distance->setSuffix(unit.isEmpty() ? QString() : QLatin1Char(' ') + unit);
}

QString EditDock::resultText() const
{
    return m_result->text();
}

void EditDock::say(const QString& text)
{
    m_result->setText(text);
}

void EditDock::setClass(unsigned to, std::optional<unsigned> from)
{
    const auto points = selected();
    if (!points) return;
    QString rule = QStringLiteral("Classification = %1").arg(to);
    if (from) rule += QStringLiteral(" if Classification == %1").arg(*from);
    runRule(rule, points, tr("Set class %1").arg(classText(to)));
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
    if (!points) say(tr("Select the points first."));
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
        say(toQString(std::string(e.what())));
        return std::nullopt;
    }
}

void EditDock::applyRule()
{
    runRule(m_rule->text(), ruleScope(), tr("Set by rule"));
}

void EditDock::runRule(const QString& text, std::shared_ptr<const PointSet> within, const QString& title)
{
    if (const auto rule = parsed(text)) run(Recipe{"set", {{"rule", rule->text()}}, std::move(within)}, title);
}

void EditDock::run(const Recipe& recipe, const QString& title)
{
    if (!ready()) return;
    m_job = m_workspace.edit(
        *m_document, title, recipe, [this, title](const JobInfo& info, const Workspace::EditOutcome& outcome) {
            m_job = 0;
            takeState();
            if (info.state == JobState::Failed) say(toQString(info.error));
            if (info.state == JobState::Cancelled) say(tr("Cancelled, nothing changed."));
            if (info.state == JobState::Finished)
                say(outcome.changed == 0 ? tr("%1: no point had to change.").arg(title)
                                         : tr("%1: %2 changed.").arg(title, pointsText(outcome.changed)));
        });
    takeState();
}

void EditDock::previewRule()
{
    const auto rule = parsed(m_rule->text());
    if (!ready() || !rule) return;
    struct Found {
        std::shared_ptr<const PointSet> points;
        PointIndex count = 0;
        QString classes;
    };
    const auto found = std::make_shared<Found>();
    m_job = m_workspace.startJob(
        tr("Preview of the rule"),
        [rule = *rule, cloud = m_document->cloud(), within = ruleScope(), found](Progress& progress) {
            const auto command = rule.run(*cloud, within.get(), progress);
            if (!command) return;
            found->points = command->points();
            found->count = command->changedPoints();
            if (found->points) found->classes = classesText(*cloud, *found->points);
        },
        [this, found](const JobInfo& info) {
            m_job = 0;
            takeState();
            if (info.state == JobState::Failed) return say(toQString(info.error));
            if (info.state != JobState::Finished) return;
            if (found->count == 0) return say(tr("No point would change."));
            m_selection.show(found->points);
            say(tr("%1 would change: %2.").arg(pointsText(found->count), found->classes));
        },
        true);
    takeState();
}

void EditDock::selectByRule()
{
    QString text = m_rule->text().trimmed();
    try {
        // of a rule, the points that its first condition names
        const expression::Assignment rule = expression::parseAssignment(text.toStdString());
        if (rule.cases.size() == 1 && !rule.cases.front().condition.empty()) {
            const auto bytes = text.toUtf8();
            const qsizetype at = bytes.indexOf(" if ");
            if (at >= 0) text = QString::fromUtf8(bytes.mid(at + 4));
        }
    } catch (const Error&) {
        // a condition, then; it tells itself what is wrong with it
    }
    try {
        m_selection.selectByRule(text);
        say({});
    } catch (const Error& e) {
        say(toQString(std::string(e.what())));
    }
}

}  // namespace punctum::ui
