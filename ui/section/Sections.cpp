// SPDX-License-Identifier: MIT
#include "ui/section/Sections.h"

#include "core/measure/Spacing.h"
#include "core/task/Progress.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/measure/MeasureTools.h"
#include "ui/menu/Menus.h"
#include "ui/section/SectionOverlays.h"
#include "ui/section/SectionPane.h"
#include "ui/section/SectionTool.h"
#include "ui/select/SelectTools.h"
#include "ui/settings/WindowSettings.h"
#include "ui/view/ClipFrame.h"
#include "ui/view/Overlays.h"
#include "ui/view/ShownCount.h"
#include "ui/view/ShownPill.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QActionGroup>
#include <QDoubleSpinBox>
#include <QKeyEvent>
#include <QMainWindow>
#include <QMenu>
#include <QSplitter>
#include <QToolBar>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace punctum::ui
{

namespace
{

constexpr double kWidthStep = 1.15;    // a notch of the wheel
constexpr double kFirstWidth = 20.0;   // part of the line's length, until a width was chosen
constexpr int kCountPause = 150;       // ms without a change, then points are counted
constexpr double kMainShare = 0.62;    // of the window, when the pane first opens
constexpr double kLeastHeight = 1e-3;  // of the line's length: flat sections have a height, too

/// Lengths as one reads them: four digits, from 1000 on all before the point.
QString lengthText(double length, const QString& unit)
{
    const QString number = localNumber(QString::number(length, 'g', length < 1000.0 ? 4 : 7));
    return unit.isEmpty() ? number : number + QLatin1Char(' ') + unit;
}

}  // namespace

Sections::Sections(const MainView& main, Menus& menus, SelectTools& select, MeasureTools& measure,
                   QSplitter& splitter, WindowSettings& settings)
    : QObject(&menus.window()),
      m_main(main),
      m_select(select),
      m_measure(measure),
      m_splitter(splitter),
      m_settings(settings),
      m_renderer(std::make_unique<ViewRenderer>(main.renderer)),
      m_pane(new SectionPane(*m_renderer, main.settings, main.viewport.usesOpenGl())),
      m_band(new SectionBand(main.viewport)),
      m_tool(new SectionTool(main.viewport, *m_band, this)),
      m_ruler(new SectionRuler(m_pane->viewport())),
      m_pill(new ShownPill(m_pane->viewport(), main.scope)),
      m_mainMark(new PointMark(main.viewport)),
      m_sectionMark(new PointMark(m_pane->viewport()))
{
    m_pane->hide();
    m_splitter.addWidget(m_pane);
    m_splitter.setCollapsible(1, false);
    place(m_settings.sectionBeside());
    m_select.addView(viewport());
    m_measure.addView(viewport());
    viewport().installEventFilter(this);
    m_main.viewport.installEventFilter(this);
    addMenu(menus);
    linkPoints();

    connect(m_tool, &SectionTool::drawn, this, &Sections::draw);
    connect(m_pane, &SectionPane::widthChosen, this, &Sections::setWidth);
    connect(m_pane, &SectionPane::exaggerationChosen, this, &Sections::setExaggeration);
    connect(m_pane, &SectionPane::walked, this, &Sections::walk);
    connect(m_pane, &SectionPane::turnWanted, this, &Sections::turn);
    connect(m_pane, &SectionPane::fitWanted, this, &Sections::fit);
    connect(m_pane, &SectionPane::closeWanted, this, &Sections::close);
    connect(m_pane, &SectionPane::moveWanted, this, [this] {
        const bool beside = m_splitter.orientation() == Qt::Vertical;
        m_settings.setSectionBeside(beside);
        place(beside);
    });

    Workspace& workspace = m_main.workspace;
    connect(&workspace, &Workspace::activeChanged, this, [this, &workspace](Document* active) {
        viewport().setDocument(active, int(workspace.documents().size()));
    });
    connect(&workspace, &Workspace::documentRemoved, this, [this](const Document* document) {
        if (document == m_document) return close();
        if (m_section) m_countTimer.start();
    });
    m_countTimer.setSingleShot(true);
    m_countTimer.setInterval(kCountPause);
    connect(&m_countTimer, &QTimer::timeout, this, &Sections::count);
    const auto countLater = [this] {
        if (m_section) m_countTimer.start();
    };
    connect(&workspace, &Workspace::documentLoaded, this, countLater);
    connect(&workspace, &Workspace::cloudChanged, this, countLater);
    connect(&m_main.filter, &ViewFilter::changed, this, countLater);
    const ShownCount& shown = m_main.shown;
    connect(&shown, &ShownCount::changed, this, [this, &shown, countLater] {
        if (shown.state().reasons.isEmpty()) m_pill->take({});
        if (shown.state().reasons != m_countedReasons) countLater();
    });
    const ViewSettings& view = m_main.settings;
    connect(&view, &ViewSettings::changed, this, [this, &view, countLater] {
        if (view.display().classVisible != m_countedClasses || !(view.display().clip == m_countedClip))
            countLater();
    });
}

Sections::~Sections()
{
    delete m_pane;  // before the renderer that it draws with
}

Viewport& Sections::viewport() noexcept
{
    return m_pane->viewport();
}

std::optional<RulerMarks> Sections::rulerMarks() const
{
    return m_ruler->marks();
}

void Sections::addMenu(Menus& menus)
{
    QMenu& sections = menus.addMenu(tr("Se&ction"));
    auto* const group = new QActionGroup(this);
    QAction* const tool = menus.addTool(&sections, group, 0, tr("&Draw a Section"), QStringLiteral("section"),
                                        {QKeySequence(Qt::Key_X)},
                                        tr("Draw a line, two clicks or a drag, to see the section along it"),
                                        [this](bool on) { m_tool->setOn(on); });
    menus.toolBar().addAction(tool);
    sections.addSeparator();
    std::vector<QAction*> needSection;
    const auto add = [&](const QString& text, const QString& tip, std::function<void()> act) {
        needSection.push_back(menus.add(&sections, text, {}, {}, tip, std::move(act)));
    };
    add(tr("Walk &Ahead"), tr("Up or Right in the view does it, too"), [this] { walk(1.0); });
    add(tr("Walk &Back"), tr("Down or Left in the view does it, too"), [this] { walk(-1.0); });
    add(tr("Look from the &Other Side"), {}, [this] { turn(); });
    add(tr("&Fit the Section"), {}, [this] { fit(); });
    add(tr("&Close the Section"), {}, [this] { close(); });
    const auto update = [this, needSection] {
        for (QAction* action : needSection) action->setEnabled(m_section.has_value());
    };
    update();
    connect(&sections, &QMenu::aboutToShow, this, update);

    // One tool has the mouse.
    connect(m_tool, &SectionTool::toggled, this, [this, tool](bool on) {
        tool->setChecked(on);
        if (!on) return;
        m_select.setTool(SelectTools::Tool::None);
        m_measure.setTool({});
    });
    connect(&m_select, &SelectTools::toolChanged, this, [this](SelectTools::Tool chosen) {
        if (chosen != SelectTools::Tool::None) m_tool->setOn(false);
    });
    connect(&m_measure, &MeasureTools::toolChanged, this, [this] {
        if (m_measure.tool()) m_tool->setOn(false);
    });
}

void Sections::linkPoints()
{
    const auto link = [this](Viewport& from, PointMark& own, Viewport& other, PointMark& mark) {
        connect(&from, &Viewport::hovered, this,
                [this, &own, &other, &mark](const std::optional<PickedPoint>& point) {
                    own.setPlace({});
                    const bool seen = m_section && point && other.keeps(point->world);
                    mark.setPlace(seen ? std::optional(point->world) : std::nullopt);
                });
    };
    link(m_main.viewport, *m_mainMark, viewport(), *m_sectionMark);
    link(viewport(), *m_sectionMark, m_main.viewport, *m_mainMark);
}

// -- opening and closing

double Sections::firstWidth(double length, const QString& unit) const
{
    const double chosen = unit.isEmpty() ? 0.0 : m_settings.sectionWidth(unit);
    return chosen > 0.0 ? chosen : roundLength(length / kFirstWidth);
}

void Sections::draw(const glm::dvec3& from, const glm::dvec3& to)
{
    const Document* const active = m_main.workspace.active();
    if (!active) return;
    Section section;
    section.from = from;
    section.to = to;
    section.stretch = m_main.viewport.camera().stretch;
    section.width = firstWidth(section.length(), active->lengthUnit());
    if (!section.usable()) {
        m_main.workspace.say(MessageKind::Info,
                             tr("A section is drawn between two places that differ on the map."));
        return;
    }
    open(section, from.z, to.z);
}

void Sections::open(const Section& section, double fromHeight, double toHeight)
{
    Workspace& workspace = m_main.workspace;
    if (!workspace.active()) return;
    change(section);
    m_document = workspace.active();
    m_fromHeight = fromHeight;
    m_toHeight = toHeight;
    m_heightsKnown = false;
    m_points.reset();
    m_pill->take({});
    m_low = m_document->bounds().min.z;
    m_high = m_document->bounds().max.z;
    viewport().setDocument(m_document, int(workspace.documents().size()));
    if (!m_pane->isVisible()) {
        m_pane->show();
        const int room = m_splitter.orientation() == Qt::Vertical ? m_splitter.height() : m_splitter.width();
        if (m_splitter.sizes().value(1) < room / 10)
            m_splitter.setSizes({int(room * kMainShare), int(room * (1.0 - kMainShare))});
    }
    m_renderer->setOn(true);
    show();
    fit();
    count();
    viewport().setFocus();
}

void Sections::close()
{
    if (!m_section) return;
    change({});
    m_document.clear();
    m_countTimer.stop();
    if (m_job != 0) m_main.workspace.cancel(m_job);
    m_renderer->setOn(false);
    m_pane->hide();
    m_band->setSection({});
    m_mainMark->setPlace({});
    m_sectionMark->setPlace({});
    m_main.viewport.setFocus();
}

void Sections::place(bool beside)
{
    m_splitter.setOrientation(beside ? Qt::Horizontal : Qt::Vertical);
}

void Sections::change(const std::optional<Section>& section)
{
    m_select.giveUp();  // it was drawn on what is no longer seen
    m_section = section;
    emit sectionChanged();
}

void Sections::show()
{
    const auto sides = m_section->sides();
    viewport().setCuts({sides.begin(), sides.end()});
    // of the file it was drawn in, whichever is active now
    const QString unit = m_document ? m_document->lengthUnit() : QString();
    const Attribute* const z = m_document ? m_document->findAttribute(QStringLiteral("Z")) : nullptr;
    m_band->setSection(m_section, m_fromHeight, m_toHeight);
    m_ruler->setSection(m_section, unit, z ? toQString(z->unit) : QString());
    m_pane->setWidth(m_section->width, unit);
    m_pane->setExaggeration(m_exaggeration);
    const QString title =
        tr("%1 long, %2 wide").arg(lengthText(m_section->length(), unit), lengthText(m_section->width, unit));
    m_pane->setTitle(!m_points        ? title
                     : *m_points == 0 ? tr("%1  ·  no points shown").arg(title)
                                      : tr("%1  ·  %2").arg(title, pointsText(*m_points)));
}

// -- what the view looks at

void Sections::fit()
{
    if (!m_section) return;
    const double least = m_section->length() * kLeastHeight / m_section->stretch.z;
    const double middle = (m_low + m_high) / 2, half = std::max((m_high - m_low) / 2, least);
    const QSize size = viewport().pictureSize();
    const render::Camera camera = render::sectionCamera(*m_section, middle - half, middle + half,
                                                        {size.width(), size.height()}, m_exaggeration);
    viewport().setSceneBounds(m_section->box(middle - half, middle + half), camera.stretch);
    viewport().setCamera(camera);
    viewport().fit(false);
}

void Sections::setWidth(double width)
{
    if (!m_section) return;
    Section other = *m_section;
    other.width = std::clamp(width, m_pane->widthField().minimum(), m_pane->widthField().maximum());
    change(other);
    // a number without its unit means nothing in another file
    if (const QString unit = m_document ? m_document->lengthUnit() : QString(); !unit.isEmpty())
        m_settings.setSectionWidth(m_section->width, unit);
    show();
    m_countTimer.start();
}

void Sections::setExaggeration(double times)
{
    if (!m_section) return;
    m_exaggeration =
        std::clamp(times, m_pane->exaggerationField().minimum(), m_pane->exaggerationField().maximum());
    show();
    if (viewport().fitted()) return fit();
    render::Camera camera = viewport().camera();
    camera.stretch.z = m_section->stretch.z * m_exaggeration;
    viewport().setCamera(camera);
}

void Sections::walk(double steps)
{
    if (!m_section) return;
    const Section next = m_section->walked(steps * m_section->width);
    const glm::dvec3 way(next.from - m_section->from, 0.0);
    change(next);
    show();
    m_countTimer.start();
    if (viewport().fitted()) return fit();
    render::Camera camera = viewport().camera();
    camera.eye += way;
    camera.pivot += way;
    viewport().setCamera(camera);
}

void Sections::turn()
{
    if (!m_section) return;
    change(m_section->turned());
    std::swap(m_fromHeight, m_toHeight);
    if (m_job != 0) m_countTimer.start();  // what is being counted is the section before
    show();
    fit();
}

// -- how many points it has, and how high they reach

void Sections::count()
{
    if (!m_section) return;
    Workspace& workspace = m_main.workspace;
    if (m_job != 0) workspace.cancel(m_job);
    m_countedClasses = m_main.settings.display().classVisible;
    m_countedClip = m_main.settings.display().clip;
    m_countedReasons = m_main.shown.state().reasons;
    std::vector<std::pair<std::shared_ptr<const PointCloud>, Visibility>> clouds;
    const auto sides = m_section->sides();
    Visibility slab;
    slab.clip.planes.assign(sides.begin(), sides.end());
    for (const Document* document : workspace.documents()) {
        if (document->loading()) continue;
        clouds.emplace_back(document->cloud(), m_main.filter.visibility(*document));
        auto& planes = clouds.back().second.clip.planes;
        planes.insert(planes.end(), sides.begin(), sides.end());
    }
    if (clouds.empty()) return;  // all are being read
    struct Found {
        ShownHeights shown;
        PointIndex all = 0;
    };
    const auto found = std::make_shared<Found>();
    m_job = workspace.startJob(
        tr("Section"),
        [clouds, found, slab, chosen = !m_countedReasons.isEmpty()](Progress& progress) {
            for (const auto& [cloud, visibility] : clouds) {
                const auto hidden = hiddenPoints(*cloud, visibility, progress);
                found->shown.include(shownHeights(*cloud, hidden.get(), progress));
                if (chosen) found->all += cloud->size() - hiddenPoints(*cloud, slab, progress)->count();
            }
        },
        [this, found, asked = *m_section](const JobInfo& info) {
            if (info.id == m_job) m_job = 0;
            if (info.state == JobState::Finished && m_section == asked) take(found->shown, found->all);
        },
        true);
}

void Sections::take(const ShownHeights& found, PointIndex all)
{
    m_points = found.points;
    m_pill->take(m_countedReasons.isEmpty() ? ShownState{}
                                            : ShownState{all, found.points, true, m_countedReasons, 0});
    const std::pair before(m_low, m_high);
    if (found.points != 0) {
        // the scale stays as one walks; only what would be cut off makes the view wider
        const bool first = !std::exchange(m_heightsKnown, true);
        m_low = first ? found.low : std::min(m_low, found.low);
        m_high = first ? found.high : std::max(m_high, found.high);
    }
    show();
    if (viewport().fitted() && before != std::pair(m_low, m_high)) fit();
}

// -- keys and wheel of both views

bool Sections::eventFilter(QObject* watched, QEvent* event)
{
    if (!m_section) return false;
    const bool own = watched == &viewport();
    if (event->type() == QEvent::Wheel && own) {
        const auto& wheel = *static_cast<QWheelEvent*>(event);
        if (!wheel.modifiers().testFlag(Qt::ControlModifier)) return false;
        setWidth(m_section->width * std::pow(kWidthStep, wheel.angleDelta().y() / 120.0));
        return true;
    }
    if (event->type() == QEvent::ShortcutOverride && own) {
        const auto& key = *static_cast<QKeyEvent*>(event);
        if (key.key() == Qt::Key_F && key.modifiers() == Qt::NoModifier) event->accept();
        return false;
    }
    if (event->type() != QEvent::KeyPress) return false;
    const auto& key = *static_cast<QKeyEvent*>(event);
    const auto modifiers = key.modifiers() & ~Qt::KeypadModifier;
    if (modifiers != Qt::NoModifier && modifiers != Qt::ShiftModifier) return false;
    const double step = modifiers == Qt::ShiftModifier ? 0.5 : 1.0;
    switch (key.key()) {
        case Qt::Key_Up:
        case Qt::Key_Right:
            walk(step);
            return true;
        case Qt::Key_Down:
        case Qt::Key_Left:
            walk(-step);
            return true;
        case Qt::Key_F:
            if (!own) return false;
            fit();
            return true;
        case Qt::Key_Escape:
            if (!own || viewport().clipFrame().dragging() || m_tool->on() || m_measure.tool() ||
                m_select.tool() != SelectTools::Tool::None)
                return false;
            close();
            return true;
        default:
            return false;
    }
}

}  // namespace punctum::ui
