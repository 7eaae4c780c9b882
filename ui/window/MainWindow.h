// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/FrameCostModel.h"
#include "render/raster/Backend.h"
#include "ui/style/Theme.h"
#include "ui/window/SaveDialogs.h"

#include <QMainWindow>
#include <QStringList>
#include <QTimer>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

class QApplication;
class QLabel;

namespace punctum::ui
{

class AttributesDock;
class ClassesDock;
class Document;
class FilesDock;
class Framing;
class JobsDock;
class MainMenu;
class MeasureDock;
class MeasureTools;
class Measurements;
class Menus;
class Opener;
class Panels;
class Places;
class ProcessingDock;
class PropertiesDock;
class EditDock;
class HistoryDock;
class SelectBar;
class SelectTools;
class Screenshots;
class GroundSurface;
class Sections;
class Selection;
class ViewRenderer;
class ViewFilter;
class ViewScope;
class ViewSettings;
class Viewport;
class ShownCount;
class ShownPill;
class SurveyCommands;
class UndoOrder;
class VisibilityDock;
class WindowSettings;
class Workspace;
struct PickedPoint;

/// What brings the picture to the screen.
enum class ViewKind {
    Automatic,  ///< OpenGL, but not where it is a software renderer: that would take the processor from the points
    OpenGl,     ///< OpenGL where there is any
    Raster,     ///< never OpenGL
};

/// How the window is to start.
struct WindowOptions {
    QString settingsFile;  ///< an .ini file to keep settings in; empty: the user's own settings
    std::optional<render::BackendKind> backend;  ///< none: as the settings say, else the fastest
    std::optional<render::OrderKind> order;      ///< none: as the settings say
    ViewKind view = ViewKind::Automatic;
    double frameSeconds = render::kFrameSeconds;  ///< time of a frame while the view moves
    PointIndex pointsAFrame = 0;                  ///< drawn in each frame; 0: as many as there is time for
};

/// The window: the view in the middle, docks around it, menus. It makes these parts and wires them; it does no work
/// itself, and no part knows it. What it hands out is for the program that shows it, and for tests.
///
/// GUI thread only. Owns the workspace (documents, jobs) and the render thread; both end with it.
class MainWindow final : public QMainWindow
{
    Q_OBJECT
public:
    explicit MainWindow(const WindowOptions& options = {}, QWidget* parent = nullptr);
    ~MainWindow() override;

    /// Opens these files, and those in these folders, by jobs; returns at once.
    void openFiles(const QStringList& files);

    Workspace& workspace() noexcept { return *m_workspace; }
    Opener& opener() noexcept { return *m_opener; }
    Panels& panels() noexcept { return *m_panels; }
    Screenshots& screenshots() noexcept { return *m_screenshots; }
    Viewport& viewport() noexcept { return *m_viewport; }
    ViewSettings& viewSettings() noexcept { return *m_view; }
    ViewRenderer& renderer() noexcept { return *m_renderer; }
    AttributesDock& attributesDock() noexcept { return *m_attributes; }
    ClassesDock& classesDock() noexcept { return *m_classes; }
    ProcessingDock& processingDock() noexcept { return *m_processing; }
    PropertiesDock& propertiesDock() noexcept { return *m_properties; }
    Measurements& measurements() noexcept { return *m_measurements; }
    MeasureTools& measureTools() noexcept { return *m_measureTools; }
    MeasureDock& measureDock() noexcept { return *m_measureDock; }
    JobsDock& jobsDock() noexcept { return *m_jobs; }
    VisibilityDock& visibilityDock() noexcept { return *m_visibility; }
    ViewFilter& viewFilter() noexcept { return *m_filter; }
    MainMenu& menu() noexcept { return *m_menu; }
    Menus& menus() noexcept { return *m_menus; }
    Selection& selection() noexcept { return *m_selection; }
    SelectTools& selectTools() noexcept { return *m_selectTools; }
    SelectBar& selectBar() noexcept { return *m_selectBar; }
    UndoOrder& undoOrder() noexcept { return *m_undoOrder; }
    ShownCount& shownCount() noexcept { return *m_shown; }
    ShownPill& shownPill() noexcept { return *m_shownPill; }
    Framing& framing() noexcept { return *m_framing; }
    ViewScope& viewScope() noexcept { return *m_viewScope; }
    Sections& sections() noexcept { return *m_sections; }
    GroundSurface& ground() noexcept { return *m_ground; }
    Places& places() noexcept { return *m_places; }
    EditDock& editDock() noexcept { return *m_edit; }
    HistoryDock& historyDock() noexcept { return *m_history; }
    FilesDock& filesDock() noexcept { return *m_files; }
    /// Keys go to the view.
    void focusView();

    /// Asks about unsaved changes, told in one line; replaced by tests. The default shows a message box.
    std::function<UnsavedAnswer(const QString& fileName, const QString& changes)> askUnsaved;

public slots:
    void save();
    void saveAs();
    void saveAsOneFile();
    void closeActive();
    void saveTo(Document& document, const QString& path);
    /// Shows the next (1) or previous (-1) attribute of the active document.
    void stepAttribute(int direction);
    void showAttribute(const QString& name);

protected:
    void closeEvent(QCloseEvent* event) override;

private:
    void connectParts();
    void addDocks();
    void addMenus();
    void updateTitle();
    void documentAdded(Document* document);
    void documentLoaded(Document* document);
    void arrange(Document& document);
    void documentRemoved(Document* document);
    void showReadOut(const std::optional<PickedPoint>& point);
    void showViewState();
    void setBackend(render::BackendKind kind);
    void setAppearance(Appearance appearance);
    void removeFiles(Document& document, const std::vector<std::size_t>& parts);
    /// True: go on at once. False: not now; after a save that was asked for, `afterSaving` is called.
    bool confirmClose(Document& document, std::function<void()> afterSaving);

    Workspace* m_workspace = nullptr;
    std::unique_ptr<WindowSettings> m_settings;
    ViewSettings* m_view = nullptr;
    ViewRenderer* m_renderer = nullptr;
    Viewport* m_viewport = nullptr;
    Framing* m_framing = nullptr;
    AttributesDock* m_attributes = nullptr;
    ClassesDock* m_classes = nullptr;
    ProcessingDock* m_processing = nullptr;
    PropertiesDock* m_properties = nullptr;
    Measurements* m_measurements = nullptr;
    MeasureTools* m_measureTools = nullptr;
    MeasureDock* m_measureDock = nullptr;
    JobsDock* m_jobs = nullptr;
    ViewFilter* m_filter = nullptr;
    VisibilityDock* m_visibility = nullptr;
    Menus* m_menus = nullptr;
    MainMenu* m_menu = nullptr;
    Panels* m_panels = nullptr;
    Opener* m_opener = nullptr;
    Screenshots* m_screenshots = nullptr;
    Selection* m_selection = nullptr;
    SelectTools* m_selectTools = nullptr;
    SelectBar* m_selectBar = nullptr;
    UndoOrder* m_undoOrder = nullptr;
    ShownCount* m_shown = nullptr;
    ViewScope* m_viewScope = nullptr;
    ShownPill* m_shownPill = nullptr;
    Sections* m_sections = nullptr;
    GroundSurface* m_ground = nullptr;
    Places* m_places = nullptr;
    EditDock* m_edit = nullptr;
    HistoryDock* m_history = nullptr;
    FilesDock* m_files = nullptr;
    SurveyCommands* m_survey = nullptr;
    QLabel* m_readOut = nullptr;
    QLabel* m_viewState = nullptr;
    QLabel* m_backend = nullptr;
    QTimer m_titleTimer;  ///< files come by the hundred: their number is shown once for all that come together
};

/// Shows the window with these files and runs the event loop; the exit code of the program.
int runWindow(QApplication& application, const QStringList& files, const WindowOptions& options = {});

}  // namespace punctum::ui
