// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/HistoryRoom.h"
#include "ui/settings/ScreenshotOptions.h"
#include "ui/style/Theme.h"
#include "ui/view/ViewRenderer.h"

#include <QString>
#include <QStringList>
#include <QVariantMap>

#include <functional>
#include <memory>
#include <optional>

class QMainWindow;

namespace punctum::ui
{

class ViewSettings;

/// What is remembered from one start to the next: the window's place, recent files, how points are shown.
/// GUI thread only. Read from the disk once, when made; what changes later is written by `inBackground`, because a
/// busy disk would keep the window waiting. Without it, and for store(), it is written at once.
class WindowSettings
{
public:
    /// Where unsaved edits are noted down, and what undo needs is kept that does not fit into memory: beside the
    /// settings of this file; empty: in the user's data. How much memory it is, is a setting.
    static HistoryRoom historyRoom(const QString& file);

    using RunInBackground = std::function<void(std::function<void()>)>;

    /// `file`: an .ini file; empty: the user's own settings.
    explicit WindowSettings(const QString& file, RunInBackground inBackground = {});
    /// Writes what the background has not come to.
    ~WindowSettings();
    WindowSettings(const WindowSettings&) = delete;
    WindowSettings& operator=(const WindowSettings&) = delete;

    /// False: there is no layout of panels to restore.
    bool restore(QMainWindow& window, ViewSettings& view) const;
    /// How points are shown, alone.
    void restoreView(ViewSettings& view) const;
    void store(const QMainWindow& window, const ViewSettings& view);

    Appearance appearance() const;
    void setAppearance(Appearance appearance);
    /// What the user chose to draw with; none: the fastest.
    std::optional<render::BackendKind> backend() const;
    void setBackend(std::optional<render::BackendKind> kind);
    render::OrderKind order() const;
    void setOrder(render::OrderKind order);
    /// Which was the fastest when it was last measured, and on which device.
    FastestBackend fastestBackend() const;
    void setFastestBackend(const FastestBackend& fastest);

    /// Newest first.
    QStringList recentFiles() const;
    /// Document::origin() of what was opened, the newest last.
    void addRecentFiles(const QStringList& paths);
    void clearRecentFiles();
    /// Chosen last in files with this unit of length (Document::lengthUnit()); 0: none was chosen yet.
    double sectionWidth(const QString& unit) const;
    void setSectionWidth(double width, const QString& unit);
    /// Sections open beside the main view instead of below it.
    bool sectionBeside() const;
    void setSectionBeside(bool beside);
    /// Whether the view has axes in its corner.
    bool axes() const;
    void setAxes(bool shown);
    /// Views that were saved, as SavedViews writes them.
    QString savedViews() const;
    void setSavedViews(const QString& text);
    /// How pictures were saved last; without view and size.
    ScreenshotOptions screenshot() const;
    void setScreenshot(const ScreenshotOptions& options);
    /// Where dialogs begin.
    QString folder() const;
    void setFolder(const QString& folder);

private:
    void set(const QString& key, const QVariant& value);

    struct Unwritten;

    QString m_file;
    RunInBackground m_inBackground;
    std::shared_ptr<Unwritten> m_unwritten;
    QVariantMap m_values;
};

}  // namespace punctum::ui
