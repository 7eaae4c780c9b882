// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"

#include <QMainWindow>
#include <QStringList>

#include <functional>
#include <memory>
#include <optional>

class QApplication;
class QLabel;
class QSettings;

namespace punctum::ui
{

class AttributesDock;
class ClassesDock;
class Document;
class JobsDock;
class MainMenu;
class ProcessingDock;
class PropertiesDock;
class ViewRenderer;
class ViewSettings;
class Viewport;
class Workspace;

/// How the window is to start.
struct WindowOptions {
    QString settingsFile;  ///< an .ini file to keep settings in; empty: the user's own settings
    std::optional<render::BackendKind> backend;  ///< none: as the settings say, else CPU
    bool rasterView = false;                     ///< paint without OpenGL even where there is a context
};

/// The window: the view in the middle, docks around it, menus. It wires these parts; it does no work itself.
///
/// GUI thread only. Owns the workspace (documents, jobs) and the render thread; both end with it.
class MainWindow final : public QMainWindow
{
    Q_OBJECT
public:
    /// What to do with a document that has unsaved changes and is to be closed.
    enum class Unsaved { Save, Discard, Cancel };

    explicit MainWindow(const WindowOptions& options = {}, QWidget* parent = nullptr);
    ~MainWindow() override;

    /// Opens these files, each as a job; returns at once.
    void openFiles(const QStringList& files);

    Workspace& workspace() noexcept { return *m_workspace; }
    Viewport& viewport() noexcept { return *m_viewport; }
    ViewSettings& viewSettings() noexcept { return *m_view; }
    ViewRenderer& renderer() noexcept { return *m_renderer; }

    /// Asks about unsaved changes; replaced by tests. The default shows a message box.
    std::function<Unsaved(const QString& fileName)> askUnsaved;

public slots:
    void chooseFiles();
    void save();
    void saveAs();
    void closeActive();
    void exportScreenshot();
    /// Writes the finished picture of the view as PNG, in a job.
    void exportScreenshotTo(const QString& path);
    void saveTo(Document& document, const QString& path);
    /// Shows the next (1) or previous (-1) attribute of the active document.
    void stepAttribute(int direction);
    void showAttribute(const QString& name);
    void showAbout();
    void showShortcuts();
    void reset3dView(const QString& view);

protected:
    void closeEvent(QCloseEvent* event) override;
    void changeEvent(QEvent* event) override;

private:
    void connectParts();
    void addDocks();
    void restoreSettings();
    void storeSettings();
    void updateTitle();
    void updateReadOut();
    void rememberFile(const QString& path);
    bool confirmClose(Document& document, const std::function<void()>& afterSaving);
    void applyAppearance();
    QString startFolder() const;

    std::unique_ptr<QSettings> m_settings;
    Workspace* m_workspace = nullptr;
    ViewSettings* m_view = nullptr;
    ViewRenderer* m_renderer = nullptr;
    Viewport* m_viewport = nullptr;
    AttributesDock* m_attributes = nullptr;
    ClassesDock* m_classes = nullptr;
    ProcessingDock* m_processing = nullptr;
    PropertiesDock* m_properties = nullptr;
    JobsDock* m_jobs = nullptr;
    MainMenu* m_menu = nullptr;
    QLabel* m_readOut = nullptr;
    QLabel* m_viewState = nullptr;
};

/// Shows the window with these files and runs the event loop; the exit code of the program.
int runWindow(QApplication& application, const QStringList& files, const WindowOptions& options = {});

}  // namespace punctum::ui
