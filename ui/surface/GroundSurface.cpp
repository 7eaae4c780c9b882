// SPDX-License-Identifier: MIT
#include "ui/surface/GroundSurface.h"

#include "core/Error.h"
#include "core/process/Values.h"
#include "core/surface/SurfaceHeights.h"
#include "core/surface/Volume.h"
#include "core/task/Progress.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/menu/Menus.h"
#include "ui/section/Sections.h"
#include "ui/select/Selection.h"
#include "ui/style/NumberField.h"
#include "ui/surface/ContourMenu.h"
#include "ui/surface/SurfaceLine.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"

#include <QAction>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMainWindow>
#include <QMenu>
#include <QPushButton>
#include <QStatusBar>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();

QString classesText(const std::bitset<256>& classes)
{
    QStringList codes;
    for (std::size_t code = 0; code < classes.size(); ++code)
        if (classes[code]) codes << QString::number(code);
    return codes.join(QStringLiteral(", "));
}

/// Heights along the line of a section, in pieces where there is surface.
std::vector<std::vector<glm::dvec3>> lineOf(const Surface& surface, const Section& section,
                                            const Progress& progress)
{
    constexpr int kPlaces = 2000;
    const CoordinateScale& grid = surface.cloud().coordinates();
    std::vector<std::vector<glm::dvec3>> pieces;
    surface.withTiles([&](const SurfaceTiles& tiles) {
        std::size_t tile = tiles.size();
        SurfaceNet net;
        std::uint32_t near = 0;
        bool on = false;
        for (int k = 0; k <= kPlaces; ++k) {
            progress.check();
            const glm::dvec2 place = section.from + (section.to - section.from) * (double(k) / kPlaces);
            const double x = (place.x - grid.offset.x) / grid.scale.x, y = (place.y - grid.offset.y) / grid.scale.y;
            const auto at = tiles.tileAt(x, y);
            if (at && *at != tile) {
                tile = *at;
                net = tiles.net(tile);
                near = 0;
            }
            const auto z = at ? net.height(x, y, near) : std::nullopt;
            if (z && !on) pieces.emplace_back();
            on = z.has_value();
            if (on) pieces.back().push_back({place, *z * grid.scale.z + grid.offset.z});
        }
    });
    return pieces;
}

/// "1,234.5 m", with four digits.
QString amountText(double amount, const QString& unit)
{
    const double size = std::abs(amount);
    const int decimals = size == 0 ? 0 : std::clamp(3 - int(std::floor(std::log10(size))), 0, 6);
    const QString number = localNumber(QString::number(amount, 'f', decimals));
    return unit.isEmpty() ? number : number + QLatin1Char(' ') + unit;
}

}  // namespace

GroundSurface::GroundSurface(const MainView& main, Menus& menus, Selection& selection)
    : QObject(&menus.window()), m_main(main), m_menus(menus), m_selection(selection), m_state(new QLabel)
{
    m_state->setObjectName(QStringLiteral("groundState"));
    m_state->hide();
    menus.window().statusBar()->addPermanentWidget(m_state);
    constexpr int kTick = 100;  // ms
    m_ticks.setInterval(kTick);
    connect(&m_ticks, &QTimer::timeout, this, &GroundSurface::tellState);
    addMenu(menus);
    Workspace& workspace = m_main.workspace;
    connect(&workspace, &Workspace::documentLoaded, this, [this](Document* document) {
        if (m_on) ensure(*document);
    });
    connect(&workspace, &Workspace::activeChanged, this, &GroundSurface::tellHeights);
    connect(&workspace, &Workspace::documentRemoved, this, [this](const Document* document) { forget(document); });
    connect(&workspace, &Workspace::cloudChanged, this,
            [this](Document* document, const ChangeNotice& notice) { take(*document, notice); });
}

void GroundSurface::addMenu(Menus& menus)
{
    QMenu* const menu = menus.viewMenu().addMenu(tr("Gr&ound Surface"));
    menu->setToolTipsVisible(true);
    m_show = menus.add(menu, tr("&Show Ground Surface"), {}, {QKeySequence(Qt::Key_G)},
                       tr("Shows the ground points as a lit surface that follows every edit of classes"), [] {});
    m_show->setCheckable(true);
    connect(m_show, &QAction::triggered, this, &GroundSurface::setOn);
    m_tint = menus.add(menu, tr("&Tint by Height"), {}, {}, tr("Low ground is green, high ground light"), [] {});
    m_tint->setCheckable(true);
    m_tint->setChecked(m_tinted);
    connect(m_tint, &QAction::triggered, this, &GroundSurface::setTinted);
    m_onTop = menus.add(menu, tr("&Points on Top"), {}, {QKeySequence(Qt::SHIFT | Qt::Key_G)},
                        tr("Points below or behind the surface are seen through it"), [] {});
    m_onTop->setCheckable(true);
    connect(m_onTop, &QAction::triggered, this, &GroundSurface::setPointsOnTop);
    m_hideOwn = menus.add(menu, tr("&Hide Its Own Points"), {}, {},
                          tr("Where the surface is, it is seen instead of the points it is made of; selected ones "
                             "stay to be seen"),
                          [] {});
    m_hideOwn->setCheckable(true);
    m_hideOwn->setChecked(m_main.settings.groundReplaced());
    connect(m_hideOwn, &QAction::triggered, this, &GroundSurface::setOwnPointsHidden);
    m_contours = new ContourMenu(m_main.settings, menus, *menu, this);
    connect(m_contours, &ContourMenu::wanted, this, [this] {
        if (!m_on) setOn(true);
    });
    connect(&m_main.settings, &ViewSettings::changed, this, &GroundSurface::tellState);
    // as it was remembered
    connect(&m_main.settings, &ViewSettings::changed, this, [this] {
        if (m_hideOwn->isChecked() == m_main.settings.groundReplaced()) return;
        m_hideOwn->setChecked(m_main.settings.groundReplaced());
        applyLook();
    });
    menu->addSeparator();
    menus.add(menu, tr("&Classes That Are Ground..."), {}, {}, tr("Of which points the surface is made"),
              [this] { chooseClasses(); });
    menu->addSeparator();
    menus.needsDocument(menus.add(menu, tr("S&elect by Height above It..."), {}, {},
                                  tr("Selects points above, below or close to the surface"),
                                  [this] { askSelection(); }));
    menus.needsDocument(
        menus.add(menu, tr("&Volume to a Height..."), {}, {},
                  tr("Cut and fill between the surface and a level, within the selection's outline"),
                  [this] { askVolume(); }));
}

void GroundSurface::showIn(Sections& sections)
{
    m_sections = &sections;
    m_line = new SurfaceLine(sections.viewport());
    connect(&sections, &Sections::sectionChanged, this, &GroundSurface::findLine);
    connect(this, &GroundSurface::updated, this, &GroundSurface::findLine);
}

void GroundSurface::findLine()
{
    if (!m_line) return;
    const Document* const document = m_main.workspace.active();
    const auto surface = this->surface(document);
    if (!m_on || !surface || !m_sections->section()) return m_line->setPieces({});
    m_lineAgain = m_lineJob != 0;
    if (m_lineAgain) return;
    const auto pieces = std::make_shared<std::vector<std::vector<glm::dvec3>>>();
    m_lineJob = m_main.workspace.startJob(
        tr("Ground in the section"),
        [pieces, surface, section = *m_sections->section()](Progress& progress) {
            *pieces = lineOf(*surface, section, progress);
        },
        [this, pieces](const JobInfo& info) {
            m_lineJob = 0;
            if (info.state == JobState::Finished && m_line && m_on && m_sections->section())
                m_line->setPieces(std::move(*pieces));
            if (std::exchange(m_lineAgain, false)) findLine();
        },
        true);
}

void GroundSurface::setOn(bool on)
{
    m_on = on;
    m_show->setChecked(on);
    applyLook();
    findLine();
    if (on)
        for (Document* document : m_main.workspace.documents()) ensure(*document);
    tellState();
}

void GroundSurface::setTinted(bool tinted)
{
    m_tinted = tinted;
    m_tint->setChecked(tinted);
    applyLook();
}

void GroundSurface::setPointsOnTop(bool onTop)
{
    m_pointsOnTop = onTop;
    m_onTop->setChecked(onTop);
    applyLook();
}

void GroundSurface::setOwnPointsHidden(bool hidden)
{
    m_main.settings.setGroundReplaced(hidden);
    m_hideOwn->setChecked(hidden);
    applyLook();
}

void GroundSurface::applyLook()
{
    using render::SurfaceLook;
    m_main.settings.setSurface(!m_on      ? SurfaceLook::None
                               : m_tinted ? SurfaceLook::Heights
                                          : SurfaceLook::Gray,
                               m_pointsOnTop, m_main.settings.groundReplaced() ? m_classes : std::bitset<256>());
}

void GroundSurface::setClasses(const std::bitset<256>& classes)
{
    if (classes == m_classes) return;
    m_classes = classes;
    for (auto& [document, entry] : m_entries) {
        if (entry.job != 0) m_main.workspace.cancel(entry.job);
        if (entry.document) m_main.renderer.setSurface(entry.document->cloud(), nullptr);
    }
    m_entries.clear();
    tellHeights();
    applyLook();
    if (m_on) setOn(true);
}

bool GroundSurface::busy() const
{
    return std::any_of(m_entries.begin(), m_entries.end(), [](const auto& each) {
        const Entry& entry = each.second;
        return entry.job != 0 || entry.changed || entry.all;
    });
}

std::shared_ptr<const Surface> GroundSurface::surface(const Document* document) const
{
    const auto found = m_entries.find(document);
    return found == m_entries.end() ? nullptr : found->second.surface;
}

void GroundSurface::forget(const Document* document)
{
    const auto found = m_entries.find(document);
    if (found == m_entries.end()) return;
    if (found->second.job != 0) m_main.workspace.cancel(found->second.job);
    m_entries.erase(found);
    tellHeights();
}

/// Where nothing of it is left, it is off: a check mark would promise what does not come.
void GroundSurface::lose(const Document* document)
{
    m_entries.erase(document);
    tellHeights();
    if (m_on && m_entries.empty()) setOn(false);
}

void GroundSurface::tellHeights()
{
    const auto unitOf = [](const PointCloud& cloud) { return toQString(cloud.units().vertical); };
    const Document* const active = m_main.workspace.active();
    double range = 0;
    QString unit = active ? unitOf(*active->cloud()) : QString();
    for (const auto& [document, entry] : m_entries) {
        if (!entry.surface) continue;
        const auto view = entry.surface->view();
        const double own = (view->high - view->low) * entry.surface->cloud().coordinates().scale.z;
        if (own < range) continue;
        range = own;
        unit = unitOf(entry.surface->cloud());
    }
    m_contours->setHeights(range, unit);
    tellState();
}

void GroundSurface::tellState()
{
    constexpr double kSorting = 0.2;  // of the time that it takes, about
    double share = 0;
    int made = 0;
    const std::vector<JobInfo> running = m_main.workspace.jobs().running();
    for (const auto& [document, entry] : m_entries) {
        if (!entry.beingMade()) continue;
        ++made;
        for (const JobInfo& job : running)
            if (job.id == entry.job)
                share += job.stage == Surface::kTilesStage ? kSorting + (1 - kSorting) * job.fraction
                                                           : kSorting * job.fraction;
    }
    QString text;
    if (m_on && made > 0)
        text = tr("Making the ground surface: %1 %").arg(int(100 * share / made));
    else if (m_on && !m_entries.empty())
        text = m_contours->text();
    if (made > 0 && !m_ticks.isActive()) m_ticks.start();
    if (made == 0) m_ticks.stop();
    m_state->setText(text);
    m_state->setVisible(!text.isEmpty());
}

void GroundSurface::ensure(Document& document)
{
    if (document.loading()) return;
    Entry& entry = m_entries[&document];
    entry.document = &document;
    if (entry.surface) {
        show(entry);
        return update(entry);
    }
    if (entry.job != 0) return;
    const auto made = std::make_shared<std::shared_ptr<Surface>>();
    SurfaceSettings settings;
    settings.classes = m_classes;
    entry.job = m_main.workspace.startJob(
        tr("Ground surface"),
        [cloud = document.cloud(), settings, made](Progress& progress) {
            *made = std::make_shared<Surface>(cloud, settings, progress);
        },
        [this, made, key = static_cast<const Document*>(&document)](const JobInfo& info) {
            const auto found = m_entries.find(key);
            if (found == m_entries.end() || found->second.job != info.id) return;
            found->second.job = 0;
            if (info.state == JobState::Failed) m_main.workspace.say(MessageKind::Warning, toQString(info.error));
            if (info.state != JobState::Finished) return lose(key);
            found->second.surface = *made;
            show(found->second);
            update(found->second);
        });
    tellState();
}

void GroundSurface::take(Document& document, const ChangeNotice& notice)
{
    const auto found = m_entries.find(&document);
    if (found == m_entries.end()) return;
    Entry& entry = found->second;
    const bool concerned =
        notice.kind == ChangeNotice::Kind::Deleted ||
        std::find(notice.attributes.begin(), notice.attributes.end(), "Classification") != notice.attributes.end();
    if (!concerned) return;
    if (!notice.points) {
        entry.all = true;
    } else if (!entry.changed) {
        entry.changed = std::make_shared<PointSet>(*notice.points);
    } else {
        entry.changed->insert(*notice.points);
    }
    if (m_on) update(entry);
}

void GroundSurface::update(Entry& entry)
{
    if (entry.job != 0 || !entry.surface || (!entry.changed && !entry.all)) return;
    const std::shared_ptr<const PointSet> changed = entry.all ? nullptr : entry.changed;
    entry.changed = nullptr;
    entry.all = false;
    entry.job = m_main.workspace.startJob(
        tr("Ground surface"),
        [surface = entry.surface, changed](Progress& progress) { surface->update(changed.get(), progress); },
        [this, key = static_cast<const Document*>(entry.document)](const JobInfo& info) {
            const auto found = m_entries.find(key);
            if (found == m_entries.end() || found->second.job != info.id) return;
            found->second.job = 0;
            if (info.state == JobState::Failed) m_main.workspace.say(MessageKind::Warning, toQString(info.error));
            if (info.state != JobState::Finished) {
                m_main.renderer.setSurface(found->second.document->cloud(), nullptr);
                return lose(key);  // it is not known any longer what it shows
            }
            show(found->second);
            update(found->second);
        },
        true);
}

void GroundSurface::show(const Entry& entry)
{
    if (!entry.document || !entry.surface) return;
    tellHeights();
    m_main.renderer.setSurface(entry.document->cloud(), entry.surface->view());
    emit updated();
}

std::function<std::shared_ptr<const Surface>(Progress&)> GroundSurface::source(Document& document)
{
    const auto found = m_entries.find(&document);
    SurfaceSettings settings;
    settings.classes = m_classes;
    std::shared_ptr<const Surface> ready;
    if (found != m_entries.end() && found->second.job == 0 && !found->second.changed && !found->second.all)
        ready = found->second.surface;
    return [ready, settings, cloud = document.cloud()](Progress& progress) -> std::shared_ptr<const Surface> {
        return ready ? ready : std::make_shared<Surface>(cloud, settings, progress);
    };
}

void GroundSurface::select(double low, double high)
{
    Document* const document = m_main.workspace.active();
    if (!document || document->loading()) return;
    m_selection.selectFound(tr("Select by height above ground"),
                            [source = source(*document), low, high](const PointCloud& cloud, Progress& progress) {
                                PointSet among(cloud.size());
                                among.invert();
                                if (const auto deleted = deletedPoints(cloud)) among.remove(*deleted);
                                return source(progress)->withTiles([&](const SurfaceTiles& tiles) {
                                    return pointsBetween(tiles, cloud, among, low, high, progress);
                                });
                            });
}

void GroundSurface::measureVolume(double height)
{
    Document* const document = m_main.workspace.active();
    if (!document || document->loading()) return;
    const auto found = std::make_shared<Volume>();
    const auto selected = m_selection.points(document);
    const QString unit = document->lengthUnit();
    m_main.workspace.tie(
        *document,
        m_main.workspace.startJob(
            tr("Volume"),
            [found, selected, height, source = source(*document), cloud = document->cloud()](Progress& progress) {
                VolumeQuestion question;
                question.height = height;
                if (selected) {
                    question.within = {outlineOf(*cloud, *selected)};
                    if (question.within.front().size() < 3) throw Error("The selected points enclose no area.");
                }
                const auto surface = source(progress);
                *found = surface->withTiles(
                    [&](const SurfaceTiles& tiles) { return volumeOf(*cloud, tiles, question, progress); });
            },
            [this, found, unit, height](const JobInfo& info) {
                if (info.state == JobState::Failed)
                    m_main.workspace.say(MessageKind::Warning, toQString(info.error));
                if (info.state != JobState::Finished) return;
                const QString cubic = unit.isEmpty() ? QString() : unit + QStringLiteral("\u00b3");
                const QString square = unit.isEmpty() ? QString() : unit + QStringLiteral("\u00b2");
                m_main.workspace.say(
                    MessageKind::Info,
                    tr("Volume to the height %1: cut %2, fill %3, net %4 (standard deviation %5) on %6.")
                        .arg(amountText(height, {}), amountText(found->cut, cubic), amountText(found->fill, cubic),
                             amountText(found->net(), cubic), amountText(found->deviation, cubic),
                             amountText(found->area, square)),
                    tr("Ground points in the area: %1\nDeviation of one from the surface of its neighbors: %2\n"
                       "The standard deviation is that times the area over the root of their number; errors that "
                       "many points share are not in it.\nArea asked for without surface: %3")
                        .arg(QString::number(found->points), amountText(found->residual, unit),
                             amountText(found->lacking, square)));
            }));
}

// -- dialogs

void GroundSurface::chooseClasses()
{
    auto* const dialog = new QDialog(&m_menus.window());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Classes That Are Ground"));
    auto* const form = new QFormLayout(dialog);
    auto* const field = new QLineEdit(classesText(m_classes));
    field->setObjectName(QStringLiteral("classes"));
    field->setToolTip(tr("Codes with commas, such as 2, 8"));
    form->addRow(tr("&Classes"), field);
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
    form->addRow(buttons);
    const auto read = [field] {
        const QString text = QString(field->text()).remove(QLatin1Char(' '));
        const auto classes = parseClasses(text.toStdString());
        return classes && classes->any() ? classes : std::nullopt;
    };
    connect(field, &QLineEdit::textChanged, dialog,
            [buttons, read] { buttons->button(QDialogButtonBox::Ok)->setEnabled(read().has_value()); });
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, dialog, [this, dialog, read] {
        if (const auto classes = read()) setClasses(*classes);
        dialog->accept();
    });
    dialog->open();
}

void GroundSurface::askSelection()
{
    const Document* const document = m_main.workspace.active();
    if (!document) return;
    if (m_dialog) return m_dialog->raise();
    m_dialog = new QDialog(&m_menus.window());
    m_dialog->setObjectName(QStringLiteral("selectBySurface"));
    m_dialog->setAttribute(Qt::WA_DeleteOnClose);
    m_dialog->setWindowTitle(tr("Select by Height above Ground"));
    auto* const form = new QFormLayout(m_dialog);
    auto* const distance = new NumberSpin;
    distance->setRange(0.0, 1e6);
    putLength(*distance, 0.2, 2);
    if (!document->lengthUnit().isEmpty()) distance->setSuffix(QLatin1Char(' ') + document->lengthUnit());
    form->addRow(tr("&Distance"), distance);
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    const auto add = [&](const QString& text, const QString& tip, const std::function<void(double)>& act) {
        QPushButton* const button = buttons->addButton(text, QDialogButtonBox::ActionRole);
        button->setToolTip(tip);
        connect(button, &QPushButton::clicked, m_dialog, [distance, act] { act(distance->value()); });
    };
    add(tr("&Above"), tr("Points more than this above the surface"),
        [this](double d) { select(std::nextafter(d, kInfinity), kInfinity); });
    add(tr("&Near"), tr("Points not further than this above or below it"), [this](double d) { select(-d, d); });
    add(tr("&Below"), tr("Points more than this below the surface"),
        [this](double d) { select(-kInfinity, std::nextafter(-d, -kInfinity)); });
    connect(buttons, &QDialogButtonBox::rejected, m_dialog, &QDialog::reject);
    form->addRow(
        new QLabel(tr("Put together with what is selected as the tools do: replace, add, subtract, intersect.")));
    form->addRow(buttons);
    m_dialog->show();
}

void GroundSurface::askVolume()
{
    const Document* const document = m_main.workspace.active();
    if (!document) return;
    auto* const dialog = new QDialog(&m_menus.window());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Volume to a Height"));
    auto* const form = new QFormLayout(dialog);
    auto* const height = new NumberSpin;
    height->setRange(-1e7, 1e7);
    height->setDecimals(3);
    height->setValue(document->bounds().empty() ? 0.0 : document->bounds().min.z);
    form->addRow(tr("&Height"), height);
    form->addRow(new QLabel(m_selection.points(document)
                                ? tr("Within the outline of the selected points.")
                                : tr("Of all of the surface: select points to measure within their outline.")));
    auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
    form->addRow(buttons);
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, dialog, [this, dialog, height] {
        measureVolume(height->value());
        dialog->accept();
    });
    dialog->open();
}

}  // namespace punctum::ui
