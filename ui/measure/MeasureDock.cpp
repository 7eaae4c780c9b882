// SPDX-License-Identifier: MIT
#include "ui/measure/MeasureDock.h"

#include "ui/basic/Text.h"
#include "ui/measure/MeasureTools.h"
#include "ui/measure/Measurements.h"
#include "ui/measure/VolumeFields.h"
#include "ui/menu/Menus.h"
#include "ui/style/Icons.h"
#include "ui/style/Widgets.h"
#include "ui/view/Viewport.h"

#include <QActionGroup>
#include <QApplication>
#include <QClipboard>
#include <QFileDialog>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QPushButton>
#include <QToolBar>
#include <QToolButton>
#include <QTreeWidget>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kIdRole = Qt::UserRole;

}  // namespace

MeasureDock::MeasureDock(Measurements& measurements, QWidget* parent)
    : QDockWidget(tr("Measure"), parent),
      m_measurements(measurements),
      m_volume(new VolumeFields),
      m_list(new QTreeWidget),
      m_hint(new QLabel(tr("Choose a tool of the menu Measure, then click points in the view."))),
      m_copy(new QPushButton(tr("Copy"))),
      m_export(new QPushButton(tr("Export CSV..."))),
      m_remove(new QPushButton(tr("Remove")))
{
    setObjectName(QStringLiteral("measurements"));
    m_list->setColumnCount(2);
    m_list->setHeaderHidden(true);
    m_list->setStyleSheet(QStringLiteral("QTreeWidget::item { padding: 2px 0; }"));
    m_list->setSelectionMode(QAbstractItemView::SingleSelection);
    m_list->setIndentation(14);
    m_list->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    m_list->header()->setSectionResizeMode(QHeaderView::Fixed);
    m_list->header()->setMinimumSectionSize(0);
    m_list->header()->setStretchLastSection(false);
    m_list->setAccessibleName(tr("Measurements"));
    m_hint->setProperty("dim", true);
    m_hint->setWordWrap(true);
    m_copy->setToolTip(tr("Copy the chosen measurement as text, or all of them when none is chosen"));
    m_export->setToolTip(tr("Write all measurements to a file for spreadsheets"));
    m_remove->setToolTip(tr("Remove the chosen measurement (Delete); the menu Measure removes all"));

    connect(m_copy, &QPushButton::clicked, this,
            [this] { QApplication::clipboard()->setText(m_measurements.text(chosen())); });
    connect(m_remove, &QPushButton::clicked, this, [this] { m_measurements.remove(chosen()); });
    connect(m_list, &QTreeWidget::currentItemChanged, this, &MeasureDock::choose);
    connect(m_volume, &VolumeFields::wishChanged, this,
            [this](const VolumeWish& wish) { m_measurements.setVolumeWish(chosen(), wish); });
    m_list->installEventFilter(this);
    m_list->viewport()->installEventFilter(this);
    for (const auto folded : {&QTreeWidget::itemExpanded, &QTreeWidget::itemCollapsed})
        connect(m_list, folded, this, &MeasureDock::fitColumns);
    connect(m_export, &QPushButton::clicked, this, &MeasureDock::exportWanted);
    connect(&m_measurements, &Measurements::changed, this, &MeasureDock::fill);
    connect(&m_measurements, &Measurements::added, this, [this](quint64 id) {
        for (int k = 0; k < m_list->topLevelItemCount(); ++k) {
            QTreeWidgetItem* const item = m_list->topLevelItem(k);
            if (item->data(0, kIdRole).toULongLong() != id) continue;
            m_list->setCurrentItem(item);
            item->setExpanded(true);
            m_list->scrollToItem(item, QAbstractItemView::PositionAtTop);
        }
        show();
        raise();
    });

    auto* content = new QWidget;
    auto* buttons = new FoldingRow(8);
    buttons->first().addWidget(m_copy, 1);
    buttons->first().addWidget(m_export, 2);
    buttons->second().addStretch(1);
    buttons->second().addWidget(m_remove, 2);
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(10, 8, 10, 8);
    column->setSpacing(8);
    column->addWidget(m_volume);
    column->addWidget(m_hint);
    column->addWidget(m_list, 1);
    column->addWidget(buttons);
    setWidget(content);
    fill();
}

void MeasureDock::setMeasuringVolumes(bool on)
{
    m_measuringVolumes = on;
    choose();
}

/// The fields of volumes are those of the chosen one.
void MeasureDock::choose()
{
    const quint64 id = chosen();
    m_remove->setEnabled(id != 0);
    const auto& all = m_measurements.entries();
    const auto entry = std::find_if(all.begin(), all.end(), [id](const auto& each) { return each.id == id; });
    const bool volume = entry != all.end() && entry->measurement.kind == MeasureKind::Volume;
    if (volume) m_measurements.setVolumeWish(id, entry->wish);  // and the next one is measured alike
    m_volume->setWish(m_measurements.volumeWish());
    m_volume->setVisible(volume || m_measuringVolumes);
}

quint64 MeasureDock::chosen() const
{
    const QTreeWidgetItem* item = m_list->currentItem();
    while (item != nullptr && item->parent() != nullptr) item = item->parent();
    return item == nullptr ? 0 : item->data(0, kIdRole).toULongLong();
}

bool MeasureDock::eventFilter(QObject* watched, QEvent* event)
{
    if (watched == m_list->viewport() && event->type() == QEvent::Resize) fitColumns();
    if (watched != m_list || event->type() != QEvent::KeyPress) return QDockWidget::eventFilter(watched, event);
    if (static_cast<QKeyEvent*>(event)->key() != Qt::Key_Delete) return false;
    m_measurements.remove(chosen());
    return true;
}

void MeasureDock::fill()
{
    const quint64 before = chosen();
    QList<quint64> closed;
    for (int k = 0; k < m_list->topLevelItemCount(); ++k)
        if (!m_list->topLevelItem(k)->isExpanded())
            closed << m_list->topLevelItem(k)->data(0, kIdRole).toULongLong();
    m_list->clear();
    int number = 0;
    for (const Measurements::Entry& entry : m_measurements.entries()) {
        const Measurement& m = entry.measurement;
        const bool point = m.kind == MeasureKind::Point;
        const QString title = QStringLiteral("%1  %2").arg(++number).arg(kindText(m.kind));
        const QString value = entry.job != 0 ? tr("is being measured")
                              : point        ? QString::number(m.points.front().index)
                                             : quantityText(m.quantities.front(), m.length);
        auto* item = new QTreeWidgetItem(m_list, {title, value});
        item->setData(0, kIdRole, entry.id);
        item->setToolTip(0, toQString(m.file));
        const auto row = [&](const QString& name, const QString& text) {
            auto* child = new QTreeWidgetItem(item, {name, text});
            child->setToolTip(0, name);
            child->setToolTip(1, text);
        };
        if (!point)
            for (std::size_t k = 1; k < m.quantities.size(); ++k)
                row(toQString(m.quantities[k].name), quantityText(m.quantities[k], m.length));
        for (const auto& [name, text] : m.facts) row(toQString(name), toQString(text));
        for (const auto& [name, text] : entry.attributes) row(name, text);
        for (const NearPoint& n : entry.nearest)
            row(tr("Neighbor %1").arg(n.index), quantityText({"", n.distance}, m.length));
        item->setExpanded(!closed.contains(entry.id));
        if (entry.id == before) m_list->setCurrentItem(item);
    }
    const bool some = number != 0;
    m_hint->setVisible(!some);
    for (QPushButton* button : {m_copy, m_export}) button->setEnabled(some);
    fitColumns();
    choose();
}

/// Names and values side by side. Where there is no room for both, values are seen in full if they can, since names
/// are known by how they begin.
void MeasureDock::fitColumns()
{
    const QAbstractItemView& list = *m_list;  // where the hints are public
    const int room = m_list->viewport()->width();
    const int names = list.sizeHintForColumn(0), values = list.sizeHintForColumn(1);
    const int leastNames = room * 2 / 5;
    const int width = std::clamp(room - values, std::min(leastNames, names), names);
    m_list->setColumnWidth(0, width);
    m_list->setColumnWidth(1, std::max(0, room - width));
}

void addMeasureMenu(Menus& menus, MeasureTools& tools, Measurements& measurements, MeasureDock& dock)
{
    QMainWindow& window = menus.window();
    QMenu& measure = menus.addMenu(MeasureDock::tr("&Measure"));
    auto* group = new QActionGroup(&window);
    const auto addTool = [&](MeasureKind kind, const QString& text, const QList<QKeySequence>& keys,
                             const QString& tip) {
        menus.addTool(&measure, group, int(kind), text, {}, keys, tip, [&tools, kind](bool on) {
            if (on)
                tools.setTool(kind);
            else if (tools.tool() == kind)
                tools.setTool({});
        });
    };
    using Kind = MeasureKind;
    addTool(Kind::Point, MeasureDock::tr("&Inspect Point"), {QKeySequence(Qt::Key_I)},
            MeasureDock::tr("Click a point to see all that it holds"));
    addTool(Kind::Distance, MeasureDock::tr("&Distance"), {QKeySequence(Qt::Key_D)},
            MeasureDock::tr("Click two points to measure how far they are apart"));
    addTool(Kind::Height, MeasureDock::tr("&Height"), {QKeySequence(Qt::Key_H)},
            MeasureDock::tr("Click two points to measure how much the second is above the first"));
    addTool(Kind::Angle, MeasureDock::tr("&Angle"), {},
            MeasureDock::tr("Click three points to measure the angle at the second"));
    addTool(Kind::Area, MeasureDock::tr("A&rea"), {},
            MeasureDock::tr("Click the corners of an area; Enter or a click on the first closes it"));
    addTool(Kind::Box, MeasureDock::tr("&Box"), {},
            MeasureDock::tr("Click two opposite corners to measure the box between them"));
    addTool(Kind::Volume, MeasureDock::tr("&Volume"), {QKeySequence(Qt::Key_U)},
            MeasureDock::tr("Click the corners around a pile or pit; Enter or a click on the first closes it"));
    QObject::connect(&tools, &MeasureTools::toolChanged, &dock, [&tools, &dock] {
        const bool volumes = tools.tool() == MeasureKind::Volume;
        dock.setMeasuringVolumes(volumes);
        if (!volumes) return;
        dock.show();  // where the base is chosen
        dock.raise();
    });
    QObject::connect(&tools, &MeasureTools::toolChanged, group, [group, &tools] {
        for (QAction* action : group->actions())
            action->setChecked(tools.tool() && int(*tools.tool()) == action->data().toInt());
    });
    measure.addSeparator();
    const auto exportCsv = [&window, &measurements, &dock] {
        const QString path = QFileDialog::getSaveFileName(&window, MeasureDock::tr("Export Measurements"),
                                                          QStringLiteral("measurements.csv"),
                                                          MeasureDock::tr("Comma-separated values (*.csv)"));
        if (!path.isEmpty()) measurements.exportTo(path);
        dock.raise();
    };
    QObject::connect(&dock, &MeasureDock::exportWanted, &window, exportCsv);
    menus.needsDocument(menus.add(&measure, MeasureDock::tr("&Export CSV..."), {}, {}, {}, exportCsv));
    menus.needsDocument(
        menus.add(&measure, MeasureDock::tr("Remove A&ll"), {}, {}, {}, [&measurements] { measurements.clear(); }));

    auto* button = new QToolButton;
    button->setIcon(lineIcon(QStringLiteral("measure")));
    button->setMenu(&measure);
    button->setPopupMode(QToolButton::InstantPopup);
    button->setToolTip(MeasureDock::tr("Inspect points and measure"));
    button->setAccessibleName(MeasureDock::tr("Measure"));
    // Lit while one of its tools has the mouse, and says which.
    button->setObjectName(QStringLiteral("measure"));
    button->setCheckable(true);
    QObject::connect(&tools, &MeasureTools::toolChanged, button, [button, &tools] {
        button->setChecked(tools.tool().has_value());
        button->setToolTip(tools.tool() ? MeasureDock::tr("Measuring: %1").arg(kindText(*tools.tool()))
                                        : MeasureDock::tr("Inspect points and measure"));
    });
    menus.toolBar().addWidget(button);
}

}  // namespace punctum::ui
