// SPDX-License-Identifier: MIT
#include "ui/maps/MapDialog.h"

#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/measure/Spacing.h"
#include "core/raster/TreeList.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kContourKind = 100, kOutlineKind = 101, kTreeKind = 102;  ///< beside those of MapKind
constexpr double kCellSpacings = 2.5;                                   ///< as mapCell() has it
constexpr double kContoursInAll = 20.0;                                 ///< heights that the preset step gives
constexpr int kDialogWidth = 460;                                       // px

}  // namespace

MapDialog::MapDialog(const Document& document, QWidget* parent)
    : QDialog(parent),
      m_form(new QFormLayout),
      m_kind(new QComboBox),
      m_attribute(new QComboBox),
      m_statistic(new QComboBox),
      m_cell(new NumberField),
      m_step(new NumberField),
      m_where(new QLineEdit),
      m_wgs84(new QCheckBox(tr("GeoJSON in &longitude and latitude"))),
      m_about(dimLabel({})),
      m_size(dimLabel({})),
      m_problem(new QLabel)
{
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("exportMap"));
    setWindowTitle(tr("Export map"));
    m_form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    m_form->setHorizontalSpacing(16);
    m_form->setVerticalSpacing(9);
    addKinds();
    addAttributes(document);

    m_trees = treeIdsOf(document.attributes()) != nullptr;

    const QString unit = document.coordinateUnit();
    const auto inUnit = [](const QString& text, const QString& of) {
        return of.isEmpty() ? text : QStringLiteral("%1 (%2)").arg(text, of);
    };
    const WorldBounds box = document.bounds();
    const glm::dvec3 stretch = document.viewStretch(box);
    if (!box.empty()) m_extent = glm::dvec2(box.max - box.min);
    const double spacing = document.spacing() / std::max(stretch.x, stretch.y);
    m_cell->put(plainNumber(spacing > 0.0 ? roundLength(kCellSpacings * spacing) : 1.0));
    m_cell->setAccessibleName(tr("Cell size"));
    m_cell->setToolTip(tr("Side of a cell of the map; cells lie on multiples of it"));
    m_form->addRow(inUnit(tr("Cell &size"), unit), m_cell);
    const double height = box.empty() ? 0.0 : box.max.z - box.min.z;
    m_step->put(plainNumber(height > 0.0 ? roundLength(height / kContoursInAll) : 1.0));
    m_step->setAccessibleName(tr("Contour interval"));
    m_form->addRow(tr("Contour &interval"), m_step);
    m_where->setPlaceholderText(tr("all points, or a condition such as Classification == 6"));
    m_where->setAccessibleName(tr("Which points"));
    m_where->setObjectName(QStringLiteral("mapWhere"));
    m_form->addRow(tr("&Points"), m_where);
    m_wgs84->setToolTip(tr("As RFC 7946 has it; else in the coordinate system of the points"));
    m_form->addRow(QString(), m_wgs84);

    m_about->setWordWrap(true);
    m_problem->setObjectName(QStringLiteral("problem"));
    m_problem->setTextFormat(Qt::PlainText);
    m_problem->setWordWrap(true);
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    auto* const save = buttons->addButton(tr("&Save..."), QDialogButtonBox::AcceptRole);
    save->setProperty("primary", true);
    save->setDefault(true);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, this, &MapDialog::accepted);
    auto* const column = new QVBoxLayout(this);
    column->setContentsMargins(20, 18, 20, 14);
    column->setSpacing(12);
    column->addLayout(m_form);
    column->addWidget(m_about);
    column->addWidget(m_size);
    column->addWidget(m_problem);
    column->addStretch(1);
    column->addWidget(buttons);
    setMinimumWidth(kDialogWidth);

    connect(m_kind, &QComboBox::currentIndexChanged, this, &MapDialog::change);
    connect(m_cell, &QLineEdit::textChanged, this, &MapDialog::change);
    connect(m_where, &QLineEdit::textEdited, this, [this] {
        markWrong(*m_where, {});
        m_problem->clear();
    });
    change();
}

void MapDialog::addKinds()
{
    const auto add = [this](const QString& text, int kind) { m_kind->addItem(text, kind); };
    add(tr("Terrain (DTM)"), int(MapKind::Dtm));
    add(tr("Surface (DSM)"), int(MapKind::Dsm));
    add(tr("Heights above ground (CHM)"), int(MapKind::Chm));
    add(tr("Hillshade"), int(MapKind::Hillshade));
    add(tr("Slope"), int(MapKind::Slope));
    add(tr("Aspect"), int(MapKind::Aspect));
    add(tr("Density of points"), int(MapKind::Density));
    add(tr("An attribute"), int(MapKind::Attribute));
    add(tr("Contours"), kContourKind);
    add(tr("Outlines"), kOutlineKind);
    add(tr("List of trees"), kTreeKind);
    m_kind->setAccessibleName(tr("Map"));
    m_kind->setObjectName(QStringLiteral("mapKind"));
    m_kind->setMaxVisibleItems(m_kind->count());
    m_form->addRow(tr("&Map"), m_kind);
}

void MapDialog::addAttributes(const Document& document)
{
    for (const Attribute& attribute : document.attributes())
        if (attribute.components == 1 && attribute.kind != AttributeKind::Opaque &&
            attribute.columns[0]->components() == 1)
            m_attribute->addItem(toQString(attribute.name));
    m_attribute->setCurrentText(QStringLiteral("Z"));
    m_attribute->setAccessibleName(tr("Attribute"));
    m_form->addRow(tr("&Attribute"), m_attribute);
    const std::pair<QString, const char*> words[] = {{tr("greatest value"), "max"},
                                                     {tr("least value"), "min"},
                                                     {tr("mean"), "mean"},
                                                     {tr("median"), "median"},
                                                     {tr("standard deviation"), "stddev"},
                                                     {tr("range"), "range"},
                                                     {tr("number of points"), "count"},
                                                     {tr("most frequent value"), "majority"},
                                                     {tr("5th percentile"), "p5"},
                                                     {tr("95th percentile"), "p95"}};
    for (const auto& [text, word] : words) m_statistic->addItem(text, QLatin1String(word));
    m_statistic->setAccessibleName(tr("Value of a cell"));
    m_form->addRow(tr("&Value of a cell"), m_statistic);
}

QString MapDialog::aboutKind() const
{
    switch (m_kind->currentData().toInt()) {
        case int(MapKind::Dtm):
            return tr("The ground (class 2), triangulated. Written as cloud-optimized GeoTIFF.");
        case int(MapKind::Dsm):
            return tr("The highest first return in each cell; small holes are filled.");
        case int(MapKind::Chm):
            return tr("The surface less the terrain, or the highest HeightAboveGround where it fits the ground.");
        case int(MapKind::Hillshade):
            return tr("The terrain, lit from the north-west.");
        case int(MapKind::Slope):
            return tr("Of the terrain, in degrees from level.");
        case int(MapKind::Aspect):
            return tr("Where the terrain goes downhill, in degrees from north.");
        case int(MapKind::Density):
            return tr("Points in each square unit of length.");
        case int(MapKind::Attribute):
            return tr("One number for each cell, of the values of its points.");
        case kContourKind:
            return tr("Lines of equal height of the terrain, as GeoJSON or DXF.");
        case kTreeKind:
            return tr(
                "Top, height above ground, crown area and points of each tree that has a TreeId, as CSV, "
                "GeoJSON or DXF.");
        default:
            return tr("Around the areas that points cover, such as those of buildings, as GeoJSON or DXF.");
    }
}

void MapDialog::change()
{
    const int kind = m_kind->currentData().toInt();
    const bool attribute = kind == int(MapKind::Attribute), contours = kind == kContourKind,
               outlines = kind == kOutlineKind, trees = kind == kTreeKind;
    for (QWidget* field : {m_attribute, m_statistic}) m_form->setRowVisible(field, attribute);
    m_form->setRowVisible(m_step, contours);
    m_form->setRowVisible(m_cell, !trees);
    m_form->setRowVisible(m_wgs84, contours || outlines || trees);
    m_about->setText(aboutKind());
    m_problem->clear();
    const double cell = m_cell->number().value_or(0.0);
    const glm::dvec2 cells =
        cell > 0.0 ? glm::dvec2(std::ceil(m_extent.x / cell), std::ceil(m_extent.y / cell)) : glm::dvec2(0.0);
    const bool some = cells.x >= 1.0 && cells.y >= 1.0 && cells.x < 1e9 && cells.y < 1e9;
    m_size->setText(
        some && !trees
            ? tr("About %1 × %2 cells.").arg(countText(std::uint64_t(cells.x)), countText(std::uint64_t(cells.y)))
            : QString());
}

QString MapDialog::problem() const
{
    return m_problem->text();
}

std::optional<MapChoice> MapDialog::choice()
{
    const int kind = m_kind->currentData().toInt();
    m_problem->clear();
    for (NumberField* field : {m_cell, m_step}) {
        if (kind == kTreeKind || (field == m_step && kind != kContourKind)) continue;
        if (field->check() && field->number().value_or(0.0) <= 0.0) field->refuse(tr("It must be more than 0."));
        if (field->problem().isEmpty()) continue;
        m_problem->setText(QStringLiteral("%1: %2").arg(field->accessibleName(), field->problem()));
        field->setFocus();
        return std::nullopt;
    }
    if (kind == kTreeKind && !m_trees) {
        m_problem->setText(
            tr("No trees are numbered here: run the step Trees first, which gives the attribute TreeId."));
        return std::nullopt;
    }
    MapChoice choice;
    choice.request.cell = m_cell->number().value_or(0.0);
    choice.request.where = m_where->text().trimmed().toStdString();
    if (!choice.request.where.empty()) {
        try {
            expression::Condition::check(choice.request.where);
        } catch (const Error& error) {
            markWrong(*m_where, toQString(std::string(error.what())));
            m_problem->setText(toQString(std::string(error.what())));
            m_where->setFocus();
            return std::nullopt;
        }
    }
    choice.wgs84 = m_wgs84->isChecked();
    if (kind == kContourKind) {
        choice.form = MapChoice::Form::Contours;
        choice.request.kind = MapKind::Dtm;
        choice.contours.step = *m_step->number();
    } else if (kind == kOutlineKind) {
        choice.form = MapChoice::Form::Outlines;
    } else if (kind == kTreeKind) {
        choice.form = MapChoice::Form::Trees;
    } else {
        choice.request.kind = MapKind(kind);
        choice.request.attribute = m_attribute->currentText().toStdString();
        if (const auto statistic = parseStatistic(m_statistic->currentData().toString().toStdString()))
            choice.request.statistic = *statistic;
    }
    return choice;
}

void MapDialog::accepted()
{
    const auto chosen = choice();
    if (!chosen) return;
    accept();
    emit wanted(*chosen);
}

}  // namespace punctum::ui
