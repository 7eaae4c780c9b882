// SPDX-License-Identifier: MIT
#include "ui/window/MainMenu.h"

#include "core/steps/Steps.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/menu/Menus.h"
#include "ui/select/UndoOrder.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QActionGroup>
#include <QColorDialog>
#include <QDockWidget>
#include <QMainWindow>
#include <QMenu>
#include <QToolBar>

namespace punctum::ui
{

namespace
{

/// Stands for no kind among the values of BackendKind.
constexpr int kFastestBackend = -1;

}  // namespace

MainMenu::MainMenu(Menus& menus, UndoOrder& undoOrder, Viewport& viewport, ViewSettings& settings,
                   const QList<QDockWidget*>& panels)
    : QObject(&menus.window()), m_menus(menus), m_undoOrder(undoOrder), m_viewport(viewport), m_settings(settings)
{
    makeFile();
    makeEdit();
    makeView(panels);
    QMenu& process = makeProcess();
    makeHelp();
    m_menus.addMenusBefore(process);
    makeToolBar();
    update(nullptr);
    setRecentFiles({});
}

void MainMenu::makeFile()
{
    QMenu* menu = &m_menus.addMenu(tr("&File"));
    open = m_menus.add(menu, tr("&Open..."), QStringLiteral("open"), {QKeySequence::Open},
                       tr("Open LAS or LAZ files"), [this] { emit openWanted(); });
    m_menus.add(menu, tr("Open &Folder..."), {}, {QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_O)},
                tr("Open all LAS and LAZ files of a folder and of those in it as one survey"),
                [this] { emit openFolderWanted(); });
    m_recent = menu->addMenu(tr("Open &Recent"));
    menu->addSeparator();
    save = m_menus.add(menu, tr("&Save"), QStringLiteral("save"), {QKeySequence::Save}, tr("Save the active file"),
                       [this] { emit saveWanted(); });
    saveAs = m_menus.add(
        menu, tr("Save &As..."), {}, {QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_S)},
        tr("Save the active file under another name, as LAS or LAZ, or the files of a survey into another folder"),
        [this] { emit saveAsWanted(); });
    saveAsOneFile = m_menus.add(menu, tr("Save as O&ne File..."), {}, {},
                                tr("Write all files of the survey into one; they stay open as they are"),
                                [this] { emit saveAsOneFileWanted(); });
    QAction* recover = m_menus.add(menu, tr("Reco&ver Edits..."), {}, {},
                                   tr("List the edits that were not saved before the program ended"),
                                   [this] { emit recoverWanted(); });
    recover->setObjectName(QStringLiteral("recoverEdits"));
    menu->addSeparator();
    screenshot =
        m_menus.add(menu, tr("&Export Screenshot..."), QStringLiteral("screenshot"), {QKeySequence(Qt::Key_F12)},
                    tr("Save a picture of the view or of the section, of any size, with legend and scale bar"),
                    [this] { emit screenshotWanted(); });
    QAction* map = m_menus.add(menu, tr("Export &Map..."), {}, {QKeySequence(Qt::CTRL | Qt::Key_M)},
                               tr("Make a map of the active file: terrain, surface, canopy, relief, an attribute, "
                                  "contours, outlines"),
                               [this] { emit mapWanted(); });
    menu->addSeparator();
    close = m_menus.add(menu, tr("&Close"), {}, {QKeySequence(Qt::CTRL | Qt::Key_W)}, tr("Close the active file"),
                        [this] { emit closeWanted(); });
    m_menus.add(menu, tr("&Quit"), {}, {QKeySequence(Qt::CTRL | Qt::Key_Q)}, {}, [this] { emit quitWanted(); });
    for (QAction* action : {saveAs, screenshot, map, close}) m_menus.needsDocument(action);
}

void MainMenu::makeEdit()
{
    QMenu* menu = &m_menus.addMenu(tr("&Edit"));
    undo = m_menus.add(menu, tr("&Undo"), QStringLiteral("undo"), {QKeySequence(Qt::CTRL | Qt::Key_Z)}, {},
                       [this] { m_undoOrder.undo(); });
    redo = m_menus.add(menu, tr("&Redo"), QStringLiteral("redo"),
                       {QKeySequence(Qt::CTRL | Qt::Key_Y), QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_Z)}, {},
                       [this] { m_undoOrder.redo(); });
    Menus::setLastingName(*undo, tr("Undo"));
    Menus::setLastingName(*redo, tr("Redo"));
    connect(&m_undoOrder, &UndoOrder::changed, this, &MainMenu::takeUndo);
}

void MainMenu::makeView(const QList<QDockWidget*>& panels)
{
    QMenu* menu = &m_menus.addMenu(tr("&View"));
    m_menus.setViewMenu(*menu);
    Viewport& viewport = m_viewport;
    ViewSettings& settings = m_settings;

    fit = m_menus.add(menu, tr("&Fit All"), QStringLiteral("fit"), {QKeySequence(Qt::Key_F)},
                      tr("Show all points that are shown, without strays far away; once more, with them"),
                      [this] { emit fitAllWanted(); });
    QAction* fitActive = m_menus.add(menu, tr("Fit Acti&ve File"), {}, {QKeySequence(Qt::SHIFT | Qt::Key_F)},
                                     tr("The same of the active file"), [this] { emit fitActiveWanted(); });
    m_menus.needsDocument(fitActive);
    QMenu* standard = menu->addMenu(tr("&Standard Views"));
    m_views = new QActionGroup(this);
    const struct {
        const char* view;
        QString text;
        QString icon;
        Qt::Key key;
    } views[] = {{"top", tr("&Top"), QStringLiteral("view-top"), Qt::Key_1},
                 {"front", tr("&Front"), QStringLiteral("view-front"), Qt::Key_2},
                 {"left", tr("&Left"), QStringLiteral("view-left"), Qt::Key_3},
                 {"iso", tr("&Isometric"), QStringLiteral("view-iso"), Qt::Key_4},
                 {"back", tr("&Back"), {}, Qt::Key_5},
                 {"right", tr("&Right"), {}, Qt::Key_6},
                 {"bottom", tr("B&ottom"), {}, Qt::Key_7}};
    for (const auto& each : views) {
        const QString name = QLatin1String(each.view);
        QAction* action =
            m_menus.add(standard, each.text, each.icon, {QKeySequence(Qt::CTRL | each.key)},
                        tr("View from: %1").arg(QString(each.text).remove(QLatin1Char('&')).toLower()),
                        [&viewport, name] { viewport.setStandardView(name); });
        m_views->addAction(action);
        m_menus.needsDocument(action);
    }
    m_views->setExclusive(false);
    m_menus.needsDocument(fit);
    m_menus.setPlacesEnd(menu->addSeparator());

    m_colorBy = menu->addMenu(tr("&Color by"));
    QAction* next = m_menus.add(menu, tr("&Next Attribute"), {}, {QKeySequence(Qt::SHIFT | Qt::Key_Down)}, {},
                                [this] { emit attributeStepped(1); });
    QAction* previous = m_menus.add(menu, tr("&Previous Attribute"), {}, {QKeySequence(Qt::SHIFT | Qt::Key_Up)}, {},
                                    [this] { emit attributeStepped(-1); });
    for (QAction* action : {next, previous}) m_menus.needsDocument(action);
    menu->addSeparator();

    m_menus.add(menu, tr("&Larger Points"), {}, {QKeySequence(Qt::Key_Plus), QKeySequence(Qt::Key_Equal)}, {},
                [&settings] { settings.enlargePoints(true); });
    m_menus.add(menu, tr("S&maller Points"), {}, {QKeySequence(Qt::Key_Minus)}, {},
                [&settings] { settings.enlargePoints(false); });
    const auto choice = [this](QMenu* into, QActionGroup* group, const QString& text, const QVariant& value) {
        QAction* action = into->addAction(text);
        action->setCheckable(true);
        action->setData(value);
        group->addAction(action);
    };
    QMenu* sizing = menu->addMenu(tr("Point Si&ze by"));
    m_sizings = new QActionGroup(this);
    choice(sizing, m_sizings, tr("&Pixels"), int(render::PointSizing::Pixels));
    choice(sizing, m_sizings, tr("&Length in the World"), int(render::PointSizing::World));
    choice(sizing, m_sizings, tr("&Spacing of the Points"), int(render::PointSizing::Density));
    connect(m_sizings, &QActionGroup::triggered, &settings,
            [&settings](const QAction* a) { settings.setSizing(render::PointSizing(a->data().toInt())); });
    const auto flag = [this, menu](const QString& text, const QList<QKeySequence>& keys, const QString& tip,
                                   std::function<void(bool)> act) {
        QAction* action = m_menus.add(menu, text, {}, keys, tip, [] {});
        action->setCheckable(true);
        connect(action, &QAction::triggered, this, std::move(act));
        return action;
    };
    m_round = flag(tr("&Round Points"), {}, tr("Points are circles instead of squares"),
                   [&settings](bool on) { settings.setRound(on); });
    m_averaged = flag(tr("A&verage Near Points"), {},
                      tr("Each pixel shows the mean color of all points near its front: less noise"),
                      [&settings](bool on) { settings.setAveraged(on); });
    QMenu* samples = menu->addMenu(tr("S&amples a Pixel"));
    m_samples = new QActionGroup(this);
    choice(samples, m_samples, tr("&1, fast"), 1);
    choice(samples, m_samples, tr("&4, smooth"), 4);
    choice(samples, m_samples, tr("&8, smoother"), 8);
    choice(samples, m_samples, tr("1&6, smoothest, slow"), 16);
    connect(m_samples, &QActionGroup::triggered, &settings,
            [&settings](const QAction* a) { settings.setSamples(a->data().toInt()); });
    m_eyeDome = flag(tr("Eye-Dome &Lighting"), {QKeySequence(Qt::Key_L)},
                     tr("Shades each point by how far it lies behind its neighbors, so that shapes stand out"),
                     [&settings](bool on) { settings.setEyeDome(on ? 1.0 : 0.0); });
    m_litNormals = flag(tr("L&it Normals"), {}, tr("Shows directions as lit surfaces instead of colors"),
                        [&settings](bool on) {
                            settings.setNormals(on ? render::NormalLook::Lit : render::NormalLook::Direction);
                        });
    QMenu* background = menu->addMenu(tr("&Background"));
    m_backgrounds = new QActionGroup(this);
    choice(background, m_backgrounds, tr("&Dark"), int(ViewSettings::Background::Dark));
    choice(background, m_backgrounds, tr("&Gray"), int(ViewSettings::Background::Gray));
    choice(background, m_backgrounds, tr("&White"), int(ViewSettings::Background::White));
    choice(background, m_backgrounds, tr("&Other Color..."), int(ViewSettings::Background::Own));
    connect(m_backgrounds, &QActionGroup::triggered, this, [this, &settings](const QAction* a) {
        const auto chosen = ViewSettings::Background(a->data().toInt());
        settings.setBackground(chosen);
        if (chosen == ViewSettings::Background::Own) chooseBackground();
    });
    QMenu* drawing = menu->addMenu(tr("&Draw with"));
    m_backends = new QActionGroup(this);
    choice(drawing, m_backends, tr("What Is &Fastest Here"), kFastestBackend);
    choice(drawing, m_backends, tr("&CPU"), int(render::BackendKind::Cpu));
    choice(drawing, m_backends, tr("OpenGL Com&pute"), int(render::BackendKind::GlCompute));
    choice(drawing, m_backends, tr("&OpenGL Points"), int(render::BackendKind::GlPoints));
    connect(m_backends, &QActionGroup::triggered, this, [this](const QAction* a) {
        const int data = a->data().toInt();
        emit backendChosen(data == kFastestBackend ? std::nullopt : std::optional(render::BackendKind(data)));
    });
    drawing->addSection(tr("Order, in Files Opened Next"));
    m_orders = new QActionGroup(this);
    choice(drawing, m_orders, tr("&Stratified"), int(render::OrderKind::Stratified));
    choice(drawing, m_orders, tr("P&rime"), int(render::OrderKind::Prime));
    connect(m_orders, &QActionGroup::triggered, this,
            [this](const QAction* a) { emit orderChosen(render::OrderKind(a->data().toInt())); });
    menu->addSeparator();

    QMenu* panelMenu = menu->addMenu(tr("Pa&nels"));
    m_menus.add(panelMenu, tr("&Hide or Show All Panels"), {}, {QKeySequence(Qt::Key_F9)},
                tr("Give the view all of the window"), [this] { emit panelsToggled(); });
    panelMenu->addSeparator();
    for (QDockWidget* dock : panels) panelMenu->addAction(dock->toggleViewAction());
    QMenu* appearance = menu->addMenu(tr("App&earance"));
    m_appearances = new QActionGroup(this);
    choice(appearance, m_appearances, tr("As the &System"), int(Appearance::System));
    choice(appearance, m_appearances, tr("&Dark"), int(Appearance::Dark));
    choice(appearance, m_appearances, tr("&Light"), int(Appearance::Light));
    connect(m_appearances, &QActionGroup::triggered, this,
            [this](const QAction* a) { emit appearanceChosen(Appearance(a->data().toInt())); });
    fullScreen = m_menus.add(menu, tr("F&ull Screen"), {}, {QKeySequence(Qt::Key_F11)}, {}, [this] {
        QWidget& window = m_menus.window();
        window.setWindowState(window.windowState() ^ Qt::WindowFullScreen);
        fullScreen->setChecked(window.isFullScreen());
    });
    fullScreen->setCheckable(true);
    takeViewSettings(settings);
    connect(&settings, &ViewSettings::changed, this, [this, &settings] { takeViewSettings(settings); });
}

void MainMenu::chooseBackground()
{
    ViewSettings& settings = m_settings;
    const render::Rgba8 now = settings.ownBackground();
    auto* dialog = new QColorDialog(QColor(now.r, now.g, now.b), &m_menus.window());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Background"));
    const auto take = [&settings](const QColor& c) {
        if (c.isValid())
            settings.setOwnBackground(
                {std::uint8_t(c.red()), std::uint8_t(c.green()), std::uint8_t(c.blue()), 255});
    };
    connect(dialog, &QColorDialog::currentColorChanged, this, take);
    connect(dialog, &QColorDialog::rejected, this, [&settings, now] { settings.setOwnBackground(now); });
    dialog->open();
}

QMenu& MainMenu::makeProcess()
{
    QMenu* menu = &m_menus.addMenu(tr("&Process"));
    QMenu* group = nullptr;
    const StepDescription* before = nullptr;
    for (const Step* step : allSteps()) {
        const StepDescription& about = step->description();
        if (before == nullptr || before->group != about.group) {
            group = menu->addMenu(toQString(nameOf(about.group)));
            group->setToolTipsVisible(true);
        }
        before = &about;
        const QString name = toQString(step->name());
        QAction* action = m_menus.add(group, toQString(step->title()) + QStringLiteral("..."), {}, {},
                                      toQString(step->help()), [this, name] { emit stepChosen(name); });
        m_menus.needsDocument(action);
    }
    menu->addSeparator();
    QAction* strays =
        m_menus.add(menu, tr("&Remove Strays"), {}, {},
                    tr("Delete the points that are so far away that fitting the view leaves them out"),
                    [this] { emit removeStraysWanted(); });
    strays->setObjectName(QStringLiteral("removeStrays"));
    m_menus.needsDocument(strays);
    menu->setToolTipsVisible(true);
    return *menu;
}

void MainMenu::makeHelp()
{
    QMenu* menu = &m_menus.addMenu(tr("&Help"));
    m_menus.add(menu, tr("&Mouse and Keyboard"), {}, {QKeySequence(Qt::Key_F1)}, {},
                [this] { emit shortcutsWanted(); });
    m_menus.add(menu, tr("&About Punctum"), {}, {}, {}, [this] { emit aboutWanted(); });
}

void MainMenu::makeToolBar()
{
    QToolBar& bar = m_menus.toolBar();
    bar.addActions({open, save});
    bar.addSeparator();
    bar.addActions({undo, redo});
    bar.addSeparator();
    bar.addAction(fit);
    for (QAction* view : m_views->actions())
        if (!view->icon().isNull()) bar.addAction(view);
    bar.addSeparator();
    bar.addAction(screenshot);
}

void MainMenu::update(const Document* document)
{
    const bool ready = document && !document->loading();
    m_menus.setDocumentOpen(document != nullptr);
    saveAs->setEnabled(ready);
    saveAsOneFile->setEnabled(ready && document->many());
    save->setEnabled(ready && document->replaceable());
    save->setToolTip(document && !document->replaceable()
                         ? tr("This file is damaged and may not be overwritten: use Save As.")
                     : !document || document->unsavedChanges().isEmpty()
                         ? tr("Save the active file (%1)").arg(save->shortcut().toString(QKeySequence::NativeText))
                         : tr("Save: %1").arg(document->unsavedChanges()));
    takeUndo();
}

void MainMenu::takeUndo()
{
    const auto label = [](const QString& verb, const QString& what) {
        return what.isEmpty() ? verb : QStringLiteral("%1 %2").arg(verb, what);
    };
    const auto put = [&](QAction* action, const QString& verb, const UndoOrder::Next& next) {
        action->setEnabled(next.possible);
        action->setText(label(verb, menuText(next.name)));
        action->setToolTip(QStringLiteral("%1 (%2)").arg(label(QString(verb).remove(QLatin1Char('&')), next.name),
                                                         action->shortcut().toString(QKeySequence::NativeText)));
    };
    put(undo, tr("&Undo"), m_undoOrder.nextUndo());
    put(redo, tr("&Redo"), m_undoOrder.nextRedo());
}

void MainMenu::setRecentFiles(const QStringList& paths)
{
    m_recent->clear();
    for (const QString& path : paths) {
        QAction* action = m_recent->addAction(menuText(pathsText(path)));
        action->setToolTip(path);
        connect(action, &QAction::triggered, this, [this, path] { emit recentChosen(path); });
    }
    m_recent->setToolTipsVisible(true);
    m_recent->setEnabled(!paths.isEmpty());
    if (paths.isEmpty()) return;
    m_recent->addSeparator();
    connect(m_recent->addAction(tr("&Clear This List")), &QAction::triggered, this, &MainMenu::recentCleared);
}

void MainMenu::setAttributes(const Document* document, const QString& shown)
{
    QString key = shown;
    if (document)
        for (const Attribute& attribute : document->attributes())
            key += QLatin1Char('\n') + toQString(attribute.name);
    m_colorBy->setEnabled(document != nullptr);
    if (key == m_colorKey) return;
    m_colorKey = key;
    m_colorBy->clear();
    if (!document) return;
    for (const Attribute& attribute : document->attributes()) {
        if (attribute.kind == AttributeKind::Opaque) continue;
        const QString name = toQString(attribute.name);
        QAction* action = m_colorBy->addAction(menuText(name));
        action->setCheckable(true);
        action->setChecked(name == shown);
        connect(action, &QAction::triggered, this, [this, name] { emit attributeChosen(name); });
    }
}

namespace
{
void checkBy(const QActionGroup& group, int value)
{
    for (QAction* action : group.actions()) action->setChecked(action->data().toInt() == value);
}
}  // namespace

void MainMenu::setBackend(std::optional<render::BackendKind> kind)
{
    checkBy(*m_backends, kind ? int(*kind) : kFastestBackend);
}

void MainMenu::setOrder(render::OrderKind order)
{
    checkBy(*m_orders, int(order));
}

void MainMenu::setAppearance(Appearance appearance)
{
    checkBy(*m_appearances, int(appearance));
}

void MainMenu::takeViewSettings(const ViewSettings& settings)
{
    checkBy(*m_samples, settings.display().samples);
    m_eyeDome->setChecked(settings.display().eyeDome > 0);
    checkBy(*m_sizings, int(settings.display().sizing));
    m_round->setChecked(settings.display().round);
    m_averaged->setChecked(settings.display().averaged);
    m_litNormals->setChecked(settings.display().normals == render::NormalLook::Lit);
    checkBy(*m_backgrounds, int(settings.background()));
}

}  // namespace punctum::ui
