// SPDX-License-Identifier: MIT
#include "ui/window/MainWindow.h"

#include "render/store/Arrangement.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/FilesDock.h"
#include "ui/docks/HistoryDock.h"
#include "ui/docks/JobsDock.h"
#include "ui/docks/JobsModel.h"
#include "ui/docks/PropertiesDock.h"
#include "ui/docks/VisibilityDock.h"
#include "ui/document/FileDoctor.h"
#include "ui/document/Recovery.h"
#include "ui/document/Workspace.h"
#include "ui/maps/Maps.h"
#include "ui/measure/MeasureDock.h"
#include "ui/measure/MeasureTools.h"
#include "ui/measure/Measurements.h"
#include "ui/menu/Menus.h"
#include "ui/navigate/Places.h"
#include "ui/process/ProcessingDock.h"
#include "ui/screenshot/Screenshots.h"
#include "ui/section/SectionTool.h"
#include "ui/section/Sections.h"
#include "ui/select/EditDock.h"
#include "ui/select/SelectBar.h"
#include "ui/select/SelectTools.h"
#include "ui/select/Selection.h"
#include "ui/select/UndoOrder.h"
#include "ui/settings/WindowSettings.h"
#include "ui/style/Icons.h"
#include "ui/surface/GroundSurface.h"
#include "ui/view/ClipFrame.h"
#include "ui/view/Framing.h"
#include "ui/view/MessageArea.h"
#include "ui/view/ReadingSight.h"
#include "ui/view/ShownCount.h"
#include "ui/view/ShownPill.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewScope.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/ViewSurface.h"
#include "ui/view/Viewport.h"
#include "ui/window/HelpPages.h"
#include "ui/window/MainMenu.h"
#include "ui/window/Opener.h"
#include "ui/window/Panels.h"
#include "ui/window/PlainKeys.h"
#include "ui/window/RecoveryList.h"
#include "ui/window/SaveDialogs.h"
#include "ui/window/SurveyCommands.h"

#include <QApplication>
#include <QCloseEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QMessageBox>
#include <QSplitter>
#include <QStatusBar>

#include <algorithm>
#include <functional>

namespace punctum::ui
{

MainWindow::MainWindow(const WindowOptions& options, QWidget* parent)
    : QMainWindow(parent),
      m_workspace(new Workspace(WindowSettings::historyRoom(options.settingsFile), this)),
      m_settings(std::make_unique<WindowSettings>(options.settingsFile, [this](std::function<void()> write) {
          m_workspace->startJob(
              tr("Settings"), [write = std::move(write)](Progress&) { write(); }, {}, true);
      }))
{
    setWindowIcon(programIcon());
    setDockOptions(AnimatedDocks | AllowTabbedDocks | AllowNestedDocks);
    setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
    askUnsaved = std::bind_front(askAboutUnsaved, this);
    m_workspace->askQuestion = [this](const Question& question, std::function<void(bool)> answer) {
        punctum::ui::askQuestion(this, question, std::move(answer));
    };
    m_workspace->recovery().ask = std::bind_front(askRecovery, this);

    const auto backend = options.backend ? options.backend : m_settings->backend();
    m_view = new ViewSettings(this);
    const bool openGl = options.view != ViewKind::Raster && openGlWidgetsWork(options.view == ViewKind::OpenGl);
    QString whyNotShared;
    std::unique_ptr<SharedContext> shared;
    if (openGl) shared = SharedContext::create(whyNotShared);
    m_renderer = new ViewRenderer(backend, m_settings->fastestBackend(), this, std::move(shared), whyNotShared);
    m_renderer->setBudget(options.frameSeconds, options.pointsAFrame);
    m_viewport = new Viewport(*m_renderer, *m_view, openGl);
    auto* const views = new QSplitter;
    views->addWidget(m_viewport);
    views->setCollapsible(0, false);
    setCentralWidget(views);
    m_filter = new ViewFilter(*m_workspace, *m_renderer, *m_view, this);
    m_framing = new Framing(*m_workspace, *m_filter, *m_viewport, this);
    m_survey = new SurveyCommands(*this, *m_workspace, *m_framing);
    m_selection = new Selection(*m_workspace, *m_renderer, *m_view, *m_filter, this);
    m_undoOrder = new UndoOrder(*m_workspace, *m_selection, this);
    m_shown = new ShownCount(*m_workspace, *m_view, *m_filter, this);
    m_viewScope = new ViewScope(*m_workspace, *m_view, *m_filter, this);
    new ReadingSight(*m_workspace, *m_viewport, *m_view, m_workspace);  // goes with it
    m_shownPill = new ShownPill(*m_viewport, *m_viewScope);
    m_selectTools = new SelectTools(*m_viewport, *m_selection, this);
    m_measurements = new Measurements(*m_workspace, this);
    m_measureTools = new MeasureTools(*m_viewport, *m_workspace, *m_measurements, this);
    addDocks();
    addMenus();
    m_selectBar = new SelectBar(*m_menus, *m_workspace, *m_selection, *m_selectTools, *m_edit);
    addMeasureMenu(*m_menus, *m_measureTools, *m_measurements, *m_measureDock);
    const MainView main{*m_workspace, *m_renderer, *m_view, *m_filter, *m_viewScope, *m_shown, *m_viewport};
    m_ground = new GroundSurface(main, *m_menus, *m_selection);
    m_sections = new Sections(main, *m_menus, *m_selectTools, *m_measureTools, *views, *m_settings);
    m_ground->showIn(*m_sections);
    m_measurements->setVolumeScope([this](const Document& document) {
        return VolumeScope{m_ground->classes(), m_filter->visibility(document)};
    });
    m_places = new Places(*m_menus, *m_workspace, *m_viewport, *m_settings);
    m_screenshots = new Screenshots(*this, *m_workspace, *m_viewport, *m_sections, *m_measurements, *m_settings);

    m_readOut = new QLabel;
    m_viewState = new QLabel;
    m_backend = new QLabel;
    statusBar()->addWidget(m_readOut, 1);
    statusBar()->addPermanentWidget(m_viewState);
    statusBar()->addPermanentWidget(m_backend);
    statusBar()->setSizeGripEnabled(false);

    new PlainKeys(*this);
    connectParts();
    if (!m_settings->restore(*this, *m_view)) m_panels->arrange();
    m_menu->setAppearance(m_settings->appearance());
    m_menu->setBackend(backend);
    const render::OrderKind order = options.order.value_or(m_settings->order());
    m_menu->setOrder(order);
    m_workspace->setOrder(order);
    m_viewport->setDocument(nullptr, 0);
    m_viewport->setFocus();
    updateTitle();
}

MainWindow::~MainWindow()
{
    // Jobs, then the render thread, then what they send to: nothing may arrive at half a window.
    delete m_workspace;
    delete m_sections;
    delete m_viewport;
    delete m_renderer;
}

void MainWindow::addDocks()
{
    m_attributes = new AttributesDock(*m_workspace, *m_view, this);
    m_classes = new ClassesDock(*m_view, this);
    connect(m_classes, &ClassesDock::selectWanted, m_selection, &Selection::selectClass);
    m_processing = new ProcessingDock(*m_workspace, *m_renderer, *m_view, *m_selection, *m_filter, this);
    m_edit = new EditDock(*m_workspace, *m_selection, *m_renderer, *m_view, this);
    m_history = new HistoryDock(*m_workspace, this);
    m_files = new FilesDock(*m_workspace, this);
    m_properties = new PropertiesDock(*new FileDoctor(*m_workspace, this), this);
    m_measureDock = new MeasureDock(*m_measurements, this);
    m_jobs = new JobsDock(*m_workspace, this);
    m_visibility = new VisibilityDock(*m_filter, *m_view, *m_viewport, this);
    m_panels = new Panels(*this);
    m_panels->addLeft({m_attributes, m_classes});
    m_panels->addRight({m_processing, m_edit, m_properties, m_visibility, m_measureDock});
    m_panels->addRight({m_jobs, m_history, m_files});
}

void MainWindow::addMenus()
{
    m_menus = new Menus(*this);
    m_menu = new MainMenu(*m_menus, *m_undoOrder, *m_viewport, *m_view,
                          {m_attributes, m_classes, m_files, m_processing, m_edit, m_properties, m_visibility,
                           m_measureDock, m_history, m_jobs});
    m_opener = new Opener(*this, *m_workspace, *m_viewport, *m_settings);
    connect(m_menus, &Menus::viewWanted, this, &MainWindow::focusView);
    connect(m_menu, &MainMenu::openWanted, m_opener, &Opener::chooseFiles);
    connect(m_menu, &MainMenu::openFolderWanted, m_opener, &Opener::chooseFolder);
    connect(m_menu, &MainMenu::recentChosen, m_opener, &Opener::openOrigin);
    connect(m_menu, &MainMenu::recentCleared, m_opener, &Opener::clearRecentFiles);
    const auto showRecent = [this] { m_menu->setRecentFiles(m_opener->recentFiles()); };
    connect(m_opener, &Opener::recentFilesChanged, m_menu, showRecent);
    showRecent();
    connect(m_menu, &MainMenu::saveWanted, this, &MainWindow::save);
    connect(m_menu, &MainMenu::saveAsWanted, this, &MainWindow::saveAs);
    connect(m_menu, &MainMenu::saveAsOneFileWanted, this, &MainWindow::saveAsOneFile);
    connect(m_menu, &MainMenu::recoverWanted, this, [this] { (new RecoveryList(*m_workspace, this))->show(); });
    connect(m_menu, &MainMenu::screenshotWanted, this, [this] { m_screenshots->choose(); });
    connect(m_menu, &MainMenu::mapWanted, new Maps(*this, *m_workspace, *m_settings), &Maps::choose);
    connect(m_menu, &MainMenu::closeWanted, this, &MainWindow::closeActive);
    connect(m_menu, &MainMenu::quitWanted, this, &MainWindow::close);
    connect(m_menu, &MainMenu::fitAllWanted, m_framing, &Framing::fitAll);
    connect(m_menu, &MainMenu::fitActiveWanted, m_framing, &Framing::fitActive);
    connect(m_menu, &MainMenu::removeStraysWanted, m_framing, &Framing::removeStrays);
    connect(m_menu, &MainMenu::attributeStepped, this, &MainWindow::stepAttribute);
    connect(m_menu, &MainMenu::attributeChosen, this, &MainWindow::showAttribute);
    connect(m_menu, &MainMenu::panelsToggled, m_panels, &Panels::toggle);
    connect(m_menu, &MainMenu::stepChosen, this, [this](const QString& name) {
        m_processing->chooseStep(name);
        m_processing->show();
        m_processing->raise();
    });
    connect(m_menu, &MainMenu::shortcutsWanted, this, [this] { showShortcutsPage(this, m_menus->shortcuts()); });
    connect(m_menu, &MainMenu::aboutWanted, this,
            [this] { showAboutPage(this, m_backend->text(), m_viewport->usesOpenGl()); });
}

void MainWindow::connectParts()
{
    // One tool has the mouse.
    const auto showHandles = [this] {
        const bool free =
            !m_measureTools->tool() && m_selectTools->tool() == SelectTools::Tool::None && !m_sections->tool().on();
        for (Viewport* view : {m_viewport, &m_sections->viewport()}) view->clipFrame().showHandles(free);
    };
    connect(&m_sections->tool(), &SectionTool::toggled, this, showHandles);
    connect(m_measureTools, &MeasureTools::toolChanged, this, [this, showHandles] {
        if (m_measureTools->tool()) m_selectTools->setTool(SelectTools::Tool::None);
        showHandles();
    });
    connect(m_selectTools, &SelectTools::toolChanged, this, [this, showHandles](SelectTools::Tool tool) {
        if (tool != SelectTools::Tool::None) m_measureTools->setTool({});
        showHandles();
    });
    connect(m_workspace, &Workspace::documentAdded, this, &MainWindow::documentAdded);
    connect(m_workspace, &Workspace::documentLoaded, this, &MainWindow::documentLoaded);
    connect(m_workspace, &Workspace::documentRemoved, this, &MainWindow::documentRemoved);
    connect(m_workspace, &Workspace::documentStateChanged, this, [this](const Document* document) {
        if (document == m_workspace->active()) updateTitle();
    });
    m_titleTimer.setSingleShot(true);
    connect(&m_titleTimer, &QTimer::timeout, this, &MainWindow::updateTitle);
    connect(m_workspace, &Workspace::message, this,
            [this](MessageKind kind, const QString& text, const QString& details, const Document* about) {
                m_viewport->messages().add(kind, text, details, about);
            });
    const auto showDetails = [this](const QString& text) { showReport(this, tr("Details"), text); };
    connect(&m_viewport->messages(), &MessageArea::detailsWanted, this, showDetails);
    connect(m_properties, &PropertiesDock::detailsWanted, this, showDetails);
    connect(m_workspace, &Workspace::cloudChanged, this,
            [this](const Document* document, const ChangeNotice& notice) {
                m_renderer->valuesChanged(document->cloud(), notice);
                for (Viewport* view : {m_viewport, &m_sections->viewport()}) view->hoverAnew();
                updateTitle();
            });
    connect(m_workspace, &Workspace::activeChanged, this, [this](Document* document) {
        m_attributes->setDocument(document);
        m_classes->setDocument(document);
        m_processing->setDocument(document);
        m_edit->setDocument(document);
        m_history->setDocument(document);
        m_files->setDocument(document);
        m_properties->setDocument(document);
        m_visibility->setDocument(document);
        updateTitle();
    });
    connect(&m_jobs->model(), &JobsModel::ticked, this, [this] {
        m_viewport->updateTitle();
        showViewState();
        m_processing->updateProgress();
    });

    for (Viewport* view : {m_viewport, &m_sections->viewport()}) {
        connect(view, &Viewport::attributeDropped, this, &MainWindow::showAttribute);
        connect(view, &Viewport::hovered, this, &MainWindow::showReadOut);
    }
    connect(m_viewport, &Viewport::frameShown, this, &MainWindow::showViewState);
    connect(m_shown, &ShownCount::changed, this, [this] {
        m_shownPill->take(m_shown->state());
        showViewState();
    });
    connect(m_attributes, &AttributesDock::attributeChosen, this, &MainWindow::showAttribute);
    connect(m_processing, &ProcessingDock::showAttribute, this, &MainWindow::showAttribute);
    connect(m_files, &FilesDock::zoomWanted, this,
            [this](const WorldBounds& bounds) { m_viewport->fitTo(bounds); });
    connect(m_files, &FilesDock::removeWanted, this,
            [this](Document* document, const std::vector<std::size_t>& parts) { removeFiles(*document, parts); });
    connect(m_edit, &EditDock::begun, this, &MainWindow::focusView);

    connect(m_renderer, &ViewRenderer::failed, this,
            [this](const QString& text) { m_viewport->messages().add(MessageKind::Warning, text); });
    connect(m_renderer, &ViewRenderer::backendChanged, this,
            [this](render::BackendKind, const QString& description) {
                m_backend->setText(description);
                m_backend->setToolTip(tr("What draws the points"));
            });
    connect(m_renderer, &ViewRenderer::backendsMeasured, this,
            [this](const FastestBackend& fastest) { m_settings->setFastestBackend(fastest); });
    connect(m_menu, &MainMenu::backendChosen, this, [this](std::optional<render::BackendKind> kind) {
        m_renderer->setBackend(kind);
        m_settings->setBackend(kind);
    });
    connect(m_menu, &MainMenu::orderChosen, this, [this](render::OrderKind order) {
        m_workspace->setOrder(order);
        m_settings->setOrder(order);
    });
    connect(m_menu, &MainMenu::appearanceChosen, this, &MainWindow::setAppearance);
}

// -- documents

void MainWindow::openFiles(const QStringList& files)
{
    m_opener->open(files);
}

void MainWindow::documentAdded(Document* document)
{
    m_renderer->addCloud(document->store());
    if (document->many()) m_panels->bring(*m_files, m_files->heightFor(document->parts().size()));
    m_titleTimer.start();
}

void MainWindow::documentLoaded(Document* document)
{
    m_renderer->loadingEnded(document->cloud(), document->rawBounds());
    arrange(*document);
}

/// Slots in an order that views of parts profit from. Where it pays not, or fails, the view goes on as it is.
void MainWindow::arrange(Document& document)
{
    if (document.cloud()->size() < render::PointStore::kWorthSparing) return;
    const auto made = std::make_shared<std::shared_ptr<render::Arrangement>>();
    const JobId job = m_workspace->startJob(
        tr("Arrange %1").arg(document.name()),
        [made, store = document.store(), bounds = document.rawBounds()](Progress& progress) {
            *made = store->arrangement(bounds, progress);
        },
        [this, made, cloud = document.cloud()](const JobInfo&) {
            if (*made) m_renderer->arrange(cloud, std::move(*made));
        },
        true, JobTurn::Queued);
    m_workspace->tie(document, job);
}

void MainWindow::documentRemoved(Document* document)
{
    m_renderer->removeCloud(document->cloud());
    m_titleTimer.start();
}

void MainWindow::updateTitle()
{
    Document* active = m_workspace->active();
    m_viewport->setDocument(active, int(m_workspace->documents().size()));
    m_menu->update(active);
    m_menu->setAttributes(active, m_attributes->model().shown());
    setWindowTitle(active ? tr("%1[*] - Punctum").arg(titleText(active->name())) : tr("Punctum"));
    setWindowModified(active && active->modified());
    if (!active) {
        m_readOut->clear();
        m_viewState->clear();
    }
}

void MainWindow::save()
{
    Document* active = m_workspace->active();
    if (!active) return;
    if (!active->replaceable())
        saveAs();
    else
        saveTo(*active, active->path());
}

void MainWindow::saveAsOneFile()
{
    Document* active = m_workspace->active();
    if (active && active->many()) m_survey->saveAsOneFile(*active);
}

void MainWindow::saveAs()
{
    Document* active = m_workspace->active();
    if (!active) return;
    if (active->many()) return m_survey->saveIntoFolder(*active);
    const QString las = tr("LAS point cloud (*.las)"), laz = tr("Compressed LAZ point cloud (*.laz)");
    QString filter = active->path().endsWith(QLatin1String(".las"), Qt::CaseInsensitive) ? las : laz;
    const QPointer<Document> document(active);
    QString path = QFileDialog::getSaveFileName(this, tr("Save %1 as").arg(active->name()), active->path(),
                                                laz + QStringLiteral(";;") + las, &filter);
    if (path.isEmpty() || !document) return;
    if (QFileInfo(path).suffix().isEmpty()) path += filter == las ? QStringLiteral(".las") : QStringLiteral(".laz");
    const QString name = QFileInfo(path).fileName();
    m_workspace->save(*document, path, {}, [this, name](const QString& what, std::function<void(bool)> answer) {
        askBeforeSaving(this, name, what, std::move(answer));
    });
}

void MainWindow::saveTo(Document& document, const QString& path)
{
    m_workspace->save(document, path);
}

bool MainWindow::confirmClose(Document& document, std::function<void()> afterSaving)
{
    if (!document.modified()) return true;
    m_workspace->setActive(&document);
    switch (askUnsaved(document.name(), document.unsavedChanges())) {
        case UnsavedAnswer::Discard:
            return true;
        case UnsavedAnswer::Cancel:
            return false;
        case UnsavedAnswer::Save:
            break;
    }
    if (!document.replaceable()) {
        saveAs();  // it needs another name first; closing is asked for anew then
        return false;
    }
    m_workspace->save(document, document.path(), [then = std::move(afterSaving)](bool done) {
        if (done) then();
    });
    return false;
}

void MainWindow::closeActive()
{
    Document* active = m_workspace->active();
    if (!active) return;
    const QPointer<Document> document(active);
    const auto closeIt = [this, document] {
        if (document) m_workspace->close(*document);
    };
    if (confirmClose(*active, closeIt)) closeIt();
}

void MainWindow::removeFiles(Document& document, const std::vector<std::size_t>& parts)
{
    const auto removeThem = [this, alive = QPointer<Document>(&document), parts] {
        if (alive) m_survey->remove(*alive, parts);
    };
    if (confirmClose(document, removeThem)) removeThem();
}

void MainWindow::closeEvent(QCloseEvent* event)
{
    for (Document* document : std::vector<Document*>(m_workspace->documents())) {
        if (!document->modified()) continue;
        if (!confirmClose(*document, [this] { close(); })) {
            event->ignore();
            return;
        }
        m_workspace->close(*document);
    }
    m_settings->store(*this, *m_view);
    event->accept();
}

// -- the view

void MainWindow::focusView()
{
    m_viewport->setFocus();
}

void MainWindow::showAttribute(const QString& name)
{
    m_view->setAttribute(name);
}

void MainWindow::stepAttribute(int direction)
{
    const QString name = m_attributes->model().neighbor(direction);
    if (!name.isEmpty()) showAttribute(name);
}

void MainWindow::showReadOut(const std::optional<PickedPoint>& point)
{
    m_readOut->setText(point ? readOutText(*point) : QString());
}

void MainWindow::showViewState()
{
    const auto frame = m_renderer->frame();
    if (!frame) return;
    const bool other = m_attributes->model().shown() != frame->attribute;
    m_attributes->setFrame(*frame);
    if (other) m_menu->setAttributes(m_workspace->active(), frame->attribute);
    if (m_workspace->active()) m_viewState->setText(m_shown->progressText(frame->report));
}

// -- settings and help

void MainWindow::setAppearance(Appearance appearance)
{
    m_settings->setAppearance(appearance);
    applyTheme(*qApp, appearance);
    m_menu->setAppearance(appearance);
}

int runWindow(QApplication& application, const QStringList& files, const WindowOptions& options)
{
    QApplication::setApplicationDisplayName(QString());
    QApplication::setWindowIcon(programIcon());
    applyTheme(application, WindowSettings(options.settingsFile).appearance());
    MainWindow window(options);
    window.show();
    window.openFiles(files);
    return QApplication::exec();
}

}  // namespace punctum::ui
