// SPDX-License-Identifier: MIT
#include "ui/docks/VisibilityDock.h"

#include "render/raster/Backend.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QCheckBox>
#include <QGridLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kPartSpacing = 8;  // px

}  // namespace

VisibilityDock::VisibilityDock(ViewFilter& filter, ViewSettings& settings, Viewport& viewport, QWidget* parent)
    : QDockWidget(tr("Filter"), parent),
      m_filter(filter),
      m_settings(settings),
      m_viewport(viewport),
      m_condition(new QLineEdit),
      m_state(dimLabel({})),
      m_useBox(new QCheckBox(tr("Only what lies in the box"))),
      m_boxProblem(dimLabel({})),
      m_boxOfView(new QPushButton(tr("Box of the View"))),
      m_boxOfFile(new QPushButton(tr("Box of the File"))),
      m_cut(new QPushButton(tr("Cut Here"))),
      m_uncut(new QPushButton(tr("Remove Cuts")))
{
    setObjectName(QStringLiteral("visibility"));
    m_condition->setPlaceholderText(tr("Intensity > 2000"));
    m_condition->setClearButtonEnabled(true);
    m_condition->setAccessibleName(tr("Filter"));
    m_condition->setToolTip(
        tr("A condition over attributes; points for which it does not hold are hidden. Press Enter. Numbers are "
           "written with a point here, whatever the language."));
    m_state->setWordWrap(true);
    connect(m_condition, &QLineEdit::editingFinished, this, [this] { m_filter.setText(m_condition->text()); });
    connect(m_condition, &QLineEdit::textChanged, this, [this](const QString& text) {
        if (text.isEmpty()) m_filter.setText({});
    });
    connect(&m_filter, &ViewFilter::changed, this, &VisibilityDock::takeFilter);

    auto* fields = new QGridLayout;
    fields->setHorizontalSpacing(6);
    fields->setVerticalSpacing(6);
    for (int axis = 0; axis < 3; ++axis) {
        fields->addWidget(dimLabel(QString(QChar(u'X' + axis))), axis, 0);
        for (int side = 0; side < 2; ++side) {
            auto*& field = m_fields[std::size_t(axis) + 3 * std::size_t(side)];
            field = new NumberField;
            field->setMinimumWidth(60);
            field->setPlaceholderText(side == 0 ? tr("least") : tr("most"));
            field->setAccessibleName((side == 0 ? tr("Least %1") : tr("Most %1")).arg(QChar(u'X' + axis)));
            field->setToolTip(
                tr("Up and Down move the face by a hundredth of the box; in the view, drag its handle"));
            field->installEventFilter(this);
            connect(field, &QLineEdit::editingFinished, this, &VisibilityDock::applyBox);
            connect(field, &NumberField::problemChanged, this, [this] {
                QString problem;
                for (const NumberField* each : m_fields)
                    if (each && problem.isEmpty()) problem = each->problem();
                m_boxProblem->setText(problem);
                m_boxProblem->setVisible(!problem.isEmpty());
            });
            fields->addWidget(field, axis, 1 + side);
        }
    }
    m_boxProblem->setWordWrap(true);
    m_boxProblem->hide();
    connect(m_useBox, &QCheckBox::toggled, this, [this](bool on) {
        if (on && m_document && m_fields[0]->text().isEmpty()) fillBox(m_document->bounds());
        applyBox();
    });
    m_boxOfView->setToolTip(tr("A box around the pivot, as large as the view is there"));
    m_boxOfFile->setToolTip(tr("The box of the active file's points"));
    connect(m_boxOfView, &QPushButton::clicked, this, [this] {
        const auto box = boxOfView();
        if (!box) return;
        fillBox(*box);
        m_useBox->setChecked(true);
        applyBox();
    });
    connect(m_boxOfFile, &QPushButton::clicked, this, [this] {
        if (!m_document) return;
        fillBox(m_document->bounds());
        applyBox();
    });
    m_cut->setToolTip(tr("Hides what lies before the pivot as you look now; up to six cuts"));
    m_uncut->setToolTip(tr("Shows what the cuts hide"));
    connect(m_cut, &QPushButton::clicked, this, &VisibilityDock::cutHere);
    connect(m_uncut, &QPushButton::clicked, this, [this] {
        Clip clip = m_settings.display().clip;
        clip.planes.clear();
        m_settings.setClip(clip);
    });

    const auto pair = [](QWidget* a, QWidget* b) {
        auto* row = new FoldingRow(8);
        row->first().addWidget(a, 1);
        row->second().addWidget(b, 1);
        return row;
    };
    auto* body = new QWidget;
    auto* column = new QVBoxLayout(body);
    column->setContentsMargins(12, 8, 12, 8);
    column->setSpacing(8);
    column->addWidget(heading(tr("Filter")));
    column->addWidget(m_condition);
    column->addWidget(m_state);
    column->addSpacing(kPartSpacing);
    column->addWidget(heading(tr("Box")));
    column->addWidget(m_useBox);
    column->addLayout(fields);
    column->addWidget(m_boxProblem);
    column->addWidget(pair(m_boxOfView, m_boxOfFile));
    column->addSpacing(kPartSpacing);
    column->addWidget(heading(tr("Cuts")));
    column->addWidget(pair(m_cut, m_uncut));
    column->addStretch();
    setWidget(scrollColumn(body));
    connect(&m_settings, &ViewSettings::changed, this, &VisibilityDock::takeClip);
    setDocument(nullptr);
    takeClip();
}

void VisibilityDock::setDocument(Document* document)
{
    if (document != m_document && !m_settings.display().clip.box)
        for (NumberField* field : m_fields) field->put({});  // the numbers of another file
    m_document = document;
    widget()->setEnabled(document != nullptr);
    takeFilter();
}

void VisibilityDock::takeFilter()
{
    if (!m_condition->hasFocus() && m_condition->text() != m_filter.text()) m_condition->setText(m_filter.text());
    const QString error = m_filter.error();
    const auto hidden = m_filter.hiddenCount();
    m_state->setText(
        m_filter.text().isEmpty() || !m_document ? QString()
        : !error.isEmpty()                       ? error
        : !hidden                                ? tr("Looking for the points...")
                  : tr("%1 of %2 points are hidden.").arg(countText(*hidden), countText(m_document->points())));
    m_state->setVisible(!m_state->text().isEmpty());
    markWrong(*m_condition, error);
}

void VisibilityDock::takeClip()
{
    const Clip& clip = m_settings.display().clip;
    const QSignalBlocker quiet(m_useBox);
    m_useBox->setChecked(clip.box.has_value());
    if (clip.box) fillBox(*clip.box);
    m_cut->setEnabled(clip.planes.size() < render::kMostCuts);
    m_uncut->setEnabled(!clip.planes.empty());
}

void VisibilityDock::putFace(const WorldBounds& box, std::size_t field)
{
    const std::size_t axis = field % 3;
    const double value = (field < 3 ? box.min : box.max)[int(axis)];
    if (m_document)
        m_fields[field]->put(value, plainCoordinate(m_document->cloud()->coordinates(), int(axis), value));
}

void VisibilityDock::fillBox(const WorldBounds& box)
{
    if (box.empty()) return;
    for (std::size_t field = 0; field < m_fields.size(); ++field) putFace(box, field);
}

std::optional<WorldBounds> VisibilityDock::typedBox()
{
    bool fine = true;
    for (NumberField* field : m_fields) fine = field->check() && fine;
    if (!fine) return std::nullopt;
    WorldBounds box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.min[int(axis)] = *m_fields[axis]->number();
        box.max[int(axis)] = *m_fields[axis + 3]->number();
        if (box.min[int(axis)] <= box.max[int(axis)]) continue;
        m_fields[axis + 3]->refuse(tr("The most must not be below the least."));
        fine = false;
    }
    return fine ? std::optional(box) : std::nullopt;
}

void VisibilityDock::applyBox()
{
    Clip clip = m_settings.display().clip;
    if (!m_useBox->isChecked()) {
        clip.box.reset();
    } else if (const auto box = typedBox()) {
        clip.box = *box;
        for (NumberField* field : m_fields) field->setModified(false);
    } else if (!clip.box) {
        const QSignalBlocker quiet(m_useBox);
        m_useBox->setChecked(false);  // no box is in force
    }
    m_settings.setClip(clip);
}

void VisibilityDock::nudge(std::size_t field, bool up)
{
    applyBox();  // what was typed
    Clip clip = m_settings.display().clip;
    if (!clip.box || !m_document) return;
    const int axis = int(field % 3);
    WorldBounds& box = *clip.box;
    const WorldBounds& all = m_document->bounds();
    const double extent = box.max[axis] > box.min[axis] ? box.max[axis] - box.min[axis]  //
                                                        : all.max[axis] - all.min[axis];
    const double step = (up ? extent : -extent) / 100;
    if (field < 3)
        box.min[axis] = std::min(box.min[axis] + step, box.max[axis]);
    else
        box.max[axis] = std::max(box.max[axis] + step, box.min[axis]);
    m_settings.setClip(clip);
    putFace(box, field);
}

bool VisibilityDock::eventFilter(QObject* watched, QEvent* event)
{
    if (event->type() != QEvent::KeyPress) return QDockWidget::eventFilter(watched, event);
    const int key = static_cast<QKeyEvent*>(event)->key();
    const auto field = std::find(m_fields.begin(), m_fields.end(), watched);
    if (field == m_fields.end() || (key != Qt::Key_Up && key != Qt::Key_Down)) return false;
    nudge(std::size_t(field - m_fields.begin()), key == Qt::Key_Up);
    return true;
}

std::optional<WorldBounds> VisibilityDock::boxOfView() const
{
    if (!m_document) return std::nullopt;
    const render::Camera& camera = m_viewport.camera();
    const QSize size = m_viewport.pictureSize();
    const glm::dvec3 half =
        glm::dvec3(camera.unitsPerPixel(size.height()) * std::min(size.width(), size.height()) / 2) /
        camera.stretch;
    WorldBounds box{camera.pivot - half, camera.pivot + half};
    const WorldBounds& all = m_document->bounds();
    box.min = glm::max(box.min, all.min);
    box.max = glm::min(box.max, all.max);
    if (glm::any(glm::greaterThan(box.min, box.max))) return std::nullopt;
    return box;
}

void VisibilityDock::cutHere()
{
    Clip clip = m_settings.display().clip;
    const render::Camera& camera = m_viewport.camera();
    const glm::dvec3 normal = camera.forward() * camera.stretch;
    clip.planes.push_back({normal, glm::dot(normal, camera.pivot)});
    m_settings.setClip(clip);
}

}  // namespace punctum::ui
