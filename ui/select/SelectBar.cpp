// SPDX-License-Identifier: MIT
#include "ui/select/SelectBar.h"

#include "core/measure/Spacing.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/menu/Menus.h"
#include "ui/select/EditDock.h"
#include "ui/select/Selection.h"
#include "ui/style/Icons.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"

#include <QActionGroup>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QPointer>
#include <QToolBar>

#include <glm/geometric.hpp>

#include <utility>

namespace punctum::ui
{

namespace
{

constexpr double kSlabSpacings = 10.0;  // between points: as thick as a wall, or a row of trees
constexpr double kSlabShare = 0.05;     // of the extent, while the spacing is not known

}  // namespace

SelectBar::SelectBar(Menus& menus, Workspace& workspace, Selection& selection, SelectTools& tools, EditDock& edit)
    : QObject(&menus.window()),
      m_menus(menus),
      m_workspace(workspace),
      m_selection(selection),
      m_tools(tools),
      m_edit(edit),
      m_select(&menus.addMenu(tr("&Select"))),
      m_bar(new QToolBar(tr("Select"))),
      m_toolActions(new QActionGroup(this)),
      m_mode(new QComboBox),
      m_depth(new QComboBox),
      m_slab(new NumberSpin),
      m_count(new QLabel)
{
    m_bar->setObjectName(QStringLiteral("select"));
    m_bar->setMovable(false);
    m_bar->setIconSize(QSize(20, 20));
    menus.window().addToolBarBreak();
    menus.window().addToolBar(m_bar);

    using Tool = SelectTools::Tool;
    addTool(Tool::Rectangle, tr("&Rectangle"), QStringLiteral("select-rectangle"), Qt::Key_R,
            tr("Select with a rectangle: drag over the view"));
    addTool(Tool::Polygon, tr("&Polygon"), QStringLiteral("select-polygon"), Qt::Key_P,
            tr("Select with a polygon: click its corners; Enter or the right button closes it"));
    addTool(Tool::Lasso, tr("&Lasso"), QStringLiteral("select-lasso"), Qt::Key_O,
            tr("Select with a line drawn by hand"));
    addTool(Tool::Brush, tr("&Brush"), QStringLiteral("select-brush"), Qt::Key_B,
            tr("Select by painting; the wheel changes the size of the brush"));
    addTool(
        Tool::AboveLine, tr("&Above a Line"), QStringLiteral("select-above"), QKeySequence(Qt::Key_A),
        tr("Select what lies above a line, in a section above all: click its corners; Enter or the right button "
           "ends it"));
    addTool(Tool::BelowLine, tr("Bel&ow a Line"), QStringLiteral("select-below"),
            QKeySequence(Qt::SHIFT | Qt::Key_A),
            tr("Select what lies below a line: click its corners; Enter or the right button ends it"));
    addActions();
    addChoices();

    connect(&m_selection, &Selection::changed, this, &SelectBar::takeCount);
    connect(&m_selection, &Selection::settingsChanged, this, &SelectBar::takeSettings);
    connect(&m_tools, &SelectTools::toolChanged, this, [this](Tool tool) {
        for (QAction* action : m_toolActions->actions()) action->setChecked(Tool(action->data().toInt()) == tool);
    });
    takeSettings();
    takeCount();
}

void SelectBar::addTool(SelectTools::Tool tool, const QString& text, const QString& icon, const QKeySequence& key,
                        const QString& tip)
{
    m_bar->addAction(
        m_menus.addTool(m_select, m_toolActions, int(tool), text, icon, {key}, tip, [this, tool](bool on) {
            if (on)
                m_tools.setTool(tool);
            else if (m_tools.tool() == tool)
                m_tools.setTool(SelectTools::Tool::None);
        }));
}

void SelectBar::addActions()
{
    m_select->addSeparator();
    const auto add = [this](const QString& text, const QKeySequence& keys, const QString& tip,
                            std::function<void()> act) {
        m_menus.needsDocument(m_menus.add(m_select, text, {}, keys.isEmpty() ? QList<QKeySequence>() : QList{keys},
                                          tip, std::move(act)));
    };
    add(tr("Select &All"), QKeySequence(QKeySequence::SelectAll),
        tr("Select all points that are shown and not locked"), [this] { m_selection.selectAll(); });
    add(tr("Select &None"), QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_A), {}, [this] { m_selection.clear(); });
    add(tr("&Invert"), QKeySequence(Qt::CTRL | Qt::Key_I), tr("Select what is not selected"),
        [this] { m_selection.invert(); });
    m_select->addSeparator();
    add(tr("&Delete"), QKeySequence(Qt::Key_Delete),
        tr("Delete the selected points; the file lacks them once it is saved"),
        [this] { m_edit.deleteSelected(); });
    add(tr("&Restore All Deleted"), QKeySequence(Qt::SHIFT | Qt::Key_Delete),
        tr("Take back all points of this file that were deleted since it was opened"),
        [this] { m_edit.restoreDeleted(); });
    add(tr("Set &Withheld"), {}, tr("Set the flag that the standard has for deleted points; the file keeps them"),
        [this] { m_edit.setWithheld(true); });
    add(tr("Clear Wit&hheld"), {}, tr("Clear that flag of the selected points"),
        [this] { m_edit.setWithheld(false); });
    add(tr("&Save Selected Points As..."), {}, tr("Write the selected points alone to another file"),
        [this] { saveSelected(); });
    QMenu* classes = m_select->addMenu(tr("Set &Class"));
    for (unsigned code = 0; code < 10; ++code) {
        QAction* action = m_menus.add(
            classes, tr("Set class %1").arg(classText(code)), {}, {QKeySequence(Qt::Key(Qt::Key_0 + int(code)))},
            tr("Give the selected points this class"), [this, code] { m_edit.setClass(code); });
        m_menus.needsDocument(action);
    }
}

void SelectBar::saveSelected()
{
    Document* const document = m_workspace.active();
    const auto points = m_selection.points(document);
    if (!points) return m_workspace.say(MessageKind::Info, tr("Select the points first."));
    const QFileInfo file(document->parts().front().path);
    const QString base = document->many() ? tr("selected") : file.completeBaseName() + tr("-part");
    const QPointer<Document> target(document);
    const QString path =
        QFileDialog::getSaveFileName(&m_menus.window(), tr("Save selected points as"),
                                     (document->many() ? document->path() : file.path()) + QLatin1Char('/') + base +
                                         QLatin1Char('.') + file.suffix(),
                                     tr("LAS/LAZ point clouds (*.las *.laz)"));
    if (!path.isEmpty() && target) m_workspace.extract(*target, points, path);
}

void SelectBar::addChoices()
{
    const auto word = [this](const QString& text) {
        QLabel* const label = dimLabel(text);
        label->setContentsMargins(10, 0, 4, 0);
        m_bar->addWidget(label);
    };
    m_bar->addSeparator();
    m_mode->addItem(tr("Replace"), int(SelectMode::Replace));
    m_mode->addItem(tr("Add"), int(SelectMode::Add));
    m_mode->addItem(tr("Subtract"), int(SelectMode::Subtract));
    m_mode->addItem(tr("Intersect"), int(SelectMode::Intersect));
    m_mode->setAccessibleName(tr("How shapes change the selection"));
    m_mode->setToolTip(tr("How shapes change the selection; Shift adds and Ctrl subtracts for one shape"));
    m_mode->setFocusPolicy(Qt::TabFocus);
    m_bar->addWidget(m_mode);
    connect(m_mode, &QComboBox::activated, this,
            [this] { m_selection.setMode(SelectMode(m_mode->currentData().toInt())); });

    word(tr("Depth"));
    m_depth->addItem(tr("Through everything"), int(Selection::Depth::Through));
    m_depth->addItem(tr("Visible points"), int(Selection::Depth::Visible));
    m_depth->addItem(tr("Slab at the pivot"), int(Selection::Depth::Slab));
    m_depth->setAccessibleName(tr("How deep shapes reach"));
    m_depth->setToolTip(tr("How deep shapes reach into the picture; a double-click without a tool sets the pivot"));
    m_depth->setFocusPolicy(Qt::TabFocus);
    m_bar->addWidget(m_depth);
    connect(m_depth, &QComboBox::activated, this,
            [this] { m_selection.setDepth(Selection::Depth(m_depth->currentData().toInt())); });
    m_slab->setRange(0.01, 1e6);
    m_slab->setKeyboardTracking(false);
    m_slab->setDecimals(2);
    m_slab->setAccessibleName(tr("Thickness of the slab"));
    m_slab->setToolTip(tr("Thickness of the slab; half of it lies before the pivot, half behind it"));
    m_slabAction = m_bar->addWidget(m_slab);
    connect(m_slab, &QDoubleSpinBox::valueChanged, this, [this](double thickness) {
        m_slabIsOwn = true;
        m_selection.setSlabThickness(thickness);
    });
    const Workspace& workspace = m_workspace;
    connect(&workspace, &Workspace::activeChanged, this, [this] {
        m_slabIsOwn = false;  // what was typed was about another file
        m_slabPreset = 0.0;
        presetSlab();
    });
    connect(&workspace, &Workspace::documentStateChanged, this, &SelectBar::presetSlab);

    auto* space = new QWidget;
    space->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
    m_bar->addWidget(space);
    m_count->setContentsMargins(0, 0, 10, 0);
    m_bar->addWidget(m_count);
}

void SelectBar::presetSlab()
{
    const Document* const document = m_workspace.active();
    if (!document) return;
    const QString unit = document->lengthUnit();
    m_slab->setSuffix(QLatin1Char(' ') + (unit.isEmpty() ? tr("units") : unit));
    const WorldBounds& bounds = document->bounds();
    if (m_slabIsOwn || bounds.empty()) return;
    const double extent = glm::length((bounds.max - bounds.min) * document->viewStretch(bounds));
    const double preset =
        roundLength(document->spacing() > 0.0 ? kSlabSpacings * document->spacing() : kSlabShare * extent);
    if (preset != std::exchange(m_slabPreset, preset)) m_selection.setSlabThickness(preset);
}

void SelectBar::takeSettings()
{
    m_mode->setCurrentIndex(m_mode->findData(int(m_selection.mode())));
    m_depth->setCurrentIndex(m_depth->findData(int(m_selection.depth())));
    m_slabAction->setVisible(m_selection.depth() == Selection::Depth::Slab);
    putLength(*m_slab, m_selection.slabThickness(), 2);
}

QString SelectBar::countText() const
{
    return m_count->text();
}

void SelectBar::takeCount()
{
    const PointIndex count = m_selection.count(), hidden = m_selection.hiddenCount();
    if (count == 0)
        m_count->setText(m_workspace.active() ? tr("Nothing selected") : QString());
    else if (hidden == 0)
        m_count->setText(tr("%1 selected").arg(pointsText(count)));
    else
        m_count->setText(
            tr("%1 selected, %2 of them not visible").arg(pointsText(count), punctum::ui::countText(hidden)));
    m_count->setToolTip(hidden == 0
                            ? QString()
                            : tr("Not visible: behind other points, or outside of the picture. They change, too."));
}

}  // namespace punctum::ui
