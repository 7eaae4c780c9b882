// SPDX-License-Identifier: MIT
#pragma once

#include "MadeSurvey.h"

#include "ui/document/Document.h"
#include "ui/view/ViewRenderer.h"
#include "ui/window/MainWindow.h"

#include <QImage>
#include <QString>
#include <QTemporaryDir>
#include <QTest>

#include <functional>
#include <memory>

namespace punctum::ui::test
{

/// Runs a test object in an application that uses the display where there is one, else none.
int runUiTest(int argc, char** argv, const std::function<std::unique_ptr<QObject>()>& make);

/// Full path of a file of the shared data; empty when it is not there.
QString dataFile(const QString& name);

/// A window of its own settings, shown, with a known size.
struct TestWindow {
    QTemporaryDir folder;
    std::unique_ptr<MainWindow> window;

    /// `settings`: an .ini file; empty: one of its own.
    explicit TestWindow(ViewKind view = ViewKind::Automatic, const QString& settings = {});
    /// Opens and waits until all is loaded and drawn; null on failure.
    Document* open(const QString& path);
    /// The same with a made survey of so many points.
    Document* openSample(std::uint64_t points);
    /// Waits until the picture is finished, shows `attribute` (when not empty), no job runs, and the camera rests.
    bool settle(const QString& attribute = {}, int timeoutMs = 200000);
    std::shared_ptr<const Frame> frame() const { return window->renderer().frame(); }
    /// Sends the events of files being dropped on the view.
    void dropFiles(const QStringList& paths);
    /// The same of anything; `over` is called while it hovers.
    void drop(const QMimeData& mime, const std::function<void()>& over = {});
};

/// Lets the event loop run until `done` says so; false after the time.
bool waitFor(const std::function<bool()>& done, int timeoutMs = 200000);

/// Presses the mouse on one widget, moves in steps, and lets go on another.
void dragWithMouse(QWidget& from, QPoint start, QWidget& to, QPoint end);

/// Share of pixels that differ.
double difference(const render::Image& a, const render::Image& b);

/// Writes a synthetic survey to `path`.
void writeSample(const QString& path, std::uint64_t points);

}  // namespace punctum::ui::test
