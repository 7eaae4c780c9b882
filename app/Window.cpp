// SPDX-License-Identifier: MIT
#include "app/Window.h"

#include "app/Cli.h"
#include "app/Console.h"
#include "app/MemoryOption.h"
#include "ui/basic/Text.h"
#include "ui/settings/WindowSettings.h"
#include "ui/view/ViewSettings.h"
#include "ui/window/MainWindow.h"

#include <CLI/CLI.hpp>

#include <QApplication>

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace punctum::app
{

namespace
{

/// What the words after the program's name ask for.
struct WindowRequest {
    QStringList files;
    bool platformGiven = false;
    ui::WindowOptions options;
    std::string wrong;  ///< a sentence when the words make no sense
};

/// Options of Qt itself that take a value; QApplication understands them, we only step over them.
bool isQtOption(std::string_view word)
{
    while (word.starts_with('-')) word.remove_prefix(1);
    for (const std::string_view name :
         {"platform", "platformtheme", "platformpluginpath", "style", "stylesheet", "display", "name", "title",
          "icon", "qwindowtitle", "qwindowicon", "qwindowgeometry", "geometry", "session"})
        if (word == name) return true;
    return false;
}

WindowRequest understand(int argc, char** argv)
{
    WindowRequest request;
    bool onlyFiles = false;
    for (int k = 1; k < argc; ++k) {
        const std::string_view word = argv[k];
        if (onlyFiles || !word.starts_with('-')) {
            // what is neither there nor looks like a file was meant as a command
            std::error_code error;
            const bool fileLike = word.find_first_of("./") != std::string_view::npos;
            if (k == 1 && !fileLike && !std::filesystem::exists(word, error))
                request.wrong = "There is no command and no file \"" + std::string(word) + "\".";
            request.files << ui::toQString(std::filesystem::path(argv[k]));
        } else if (word == "--") {
            onlyFiles = true;
        } else if (word == "--backend") {
            const std::string name = k + 1 < argc ? argv[++k] : "";
            request.options.backend = render::backendFromName(name);
            if (!request.options.backend)
                request.wrong = "There is no backend \"" + name + "\"; there are cpu, gl-compute and gl-points.";
        } else if (word == "--order") {
            const std::string name = k + 1 < argc ? argv[++k] : "";
            request.options.order = render::orderFromName(name);
            if (!request.options.order)
                request.wrong = "There is no order \"" + name + "\"; there are stratified and prime.";
        } else if (word == "--budget" || word == "--budget-points") {
            const std::string text = k + 1 < argc ? argv[++k] : "";
            double number = 0;
            const bool fine = CLI::detail::lexical_cast(text, number);
            if (word == "--budget" && fine && number >= 1 && number <= 1000)
                request.options.frameSeconds = number * 1e-3;
            else if (word == "--budget-points" && fine && number >= 1 && number <= 4e9)
                request.options.pointsAFrame = PointIndex(number);
            else
                request.wrong = "\"" + text +
                                "\" is no budget; write --budget with 1 to 1000 ms a frame, or "
                                "--budget-points with a number of points.";
        } else if (word == "--memory") {
            if (std::string wrong = takeMemoryBudget(k + 1 < argc ? argv[++k] : ""); !wrong.empty())
                request.wrong = std::move(wrong);
        } else if (isQtOption(word)) {
            request.platformGiven |= word.ends_with("platform");
            ++k;
        } else {
            request.wrong = "There is no option " + std::string(word) + ".";
        }
    }
    return request;
}

/// Qt's last words are a page on platform plugins, then abort(): one sentence helps more.
void sayInsteadOfQt(QtMsgType type, const QMessageLogContext&, const QString&)
{
    if (type != QtFatalMsg) return;
    complain(
        "The display cannot be reached, so no window opens; punctum render FILE -o picture.png draws without one.");
    std::_Exit(kFailed);
}

bool given(const char* variable)
{
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

}  // namespace

WindowLook windowLook()
{
    const ui::WindowSettings settings{QString()};
    ui::ViewSettings view;
    settings.restoreView(view);
    return {view.display(), settings.backend().value_or(settings.fastestBackend().kind)};
}

int runWindowed(int argc, char** argv)
{
    const WindowRequest request = understand(argc, argv);
    if (!request.wrong.empty()) {
        complain(request.wrong + " See punctum --help.");
        return kUsage;
    }
    // Qt would abort with a message of its own
    if (!request.platformGiven && !given("DISPLAY") && !given("WAYLAND_DISPLAY") && !given("QT_QPA_PLATFORM")) {
        complain("There is no display to open a window on; punctum render FILE -o picture.png draws without one.");
        return kFailed;
    }
    QCoreApplication::setOrganizationName(QStringLiteral("Punctum"));
    QCoreApplication::setApplicationName(QStringLiteral("punctum"));
    QCoreApplication::setApplicationVersion(QStringLiteral(PUNCTUM_VERSION));
    QGuiApplication::setDesktopFileName(QStringLiteral("punctum"));
    // fractional scales as they are, so that a px of the picture is a px of the screen
    QGuiApplication::setHighDpiScaleFactorRoundingPolicy(Qt::HighDpiScaleFactorRoundingPolicy::PassThrough);
    // so that what the render thread draws can be shown where it is
    QCoreApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
    const QtMessageHandler handler = qInstallMessageHandler(sayInsteadOfQt);
    QApplication application(argc, argv);
    qInstallMessageHandler(handler);
    return ui::runWindow(application, request.files, request.options);
}

}  // namespace punctum::app
