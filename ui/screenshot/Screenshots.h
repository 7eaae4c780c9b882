// SPDX-License-Identifier: MIT
#pragma once

#include "core/task/Jobs.h"
#include "ui/settings/ScreenshotOptions.h"

#include <QImage>
#include <QObject>
#include <QString>

#include <functional>
#include <memory>

class QWidget;

namespace punctum::ui
{

class Measurements;
class Sections;
class Viewport;
class WindowSettings;
class Workspace;

/// Pictures of the views as files: what a dialog asks for, drawn by the render thread beside the view, and written
/// by a job, whole or not at all.
///
/// GUI thread only; every call returns at once. A child of the window; borrows what it is made with.
class Screenshots final : public QObject
{
    Q_OBJECT
public:
    Screenshots(QWidget& window, Workspace& workspace, Viewport& view, Sections& sections,
                const Measurements& measurements, WindowSettings& settings);

    /// Asks how the picture is to be, then where to put it.
    void choose();
    /// As they were chosen last, for the view that has the keys, in its size.
    ScreenshotOptions preset() const;
    /// Whether a section is open, so that there are two views to choose from.
    bool hasSection() const;
    /// In px, as it is on the screen.
    QSize viewSize(bool section) const;
    void save(const QString& path, const ScreenshotOptions& options);
    /// The whole picture, but drawn in `size`: `done` is called with it unless the job is cancelled or fails.
    JobId preview(const ScreenshotOptions& options, QSize size, std::function<void(const QImage&)> done);
    void cancel(JobId job);

private:
    struct Order;
    Viewport& viewport(bool section) const;
    /// Begins to draw. `shrink`: px of the drawn picture for each of the options' size.
    std::shared_ptr<Order> order(const ScreenshotOptions& options, QSize size, double shrink);

    QWidget& m_window;
    Workspace& m_workspace;
    Viewport& m_view;
    Sections& m_sections;
    const Measurements& m_measurements;
    WindowSettings& m_settings;
};

}  // namespace punctum::ui
