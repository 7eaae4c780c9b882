// SPDX-License-Identifier: MIT
#include "ui/window/Opener.h"

#include "core/FindFiles.h"
#include "core/Memory.h"
#include "core/cloud/Residency.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/settings/WindowSettings.h"
#include "ui/view/Overlays.h"
#include "ui/view/StartPage.h"
#include "ui/view/Viewport.h"

#include <QCoreApplication>
#include <QDir>
#include <QDropEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QMimeData>
#include <QUrl>

#include <filesystem>
#include <memory>
#include <vector>

namespace punctum::ui
{

namespace
{

constexpr int kRememberPause = 200;  // ms: files that are opened together are written down together

QStringList localFiles(const QMimeData& data)
{
    QStringList paths;
    for (const QUrl& url : data.urls())
        if (url.isLocalFile()) paths << url.toLocalFile();
    return paths;
}

}  // namespace

/// What the user named, and what that stands for.
struct Opener::Search {
    QStringList places;  ///< folders and virtual point clouds among what was named
    QStringList files;   ///< named, or found
    FoundFiles found;    ///< in those places alone
    std::uint64_t bytes = 0,
                  memory = 0;  ///< of all of them: on the disk, and about what they need once they are read
    bool alone = false;        ///< one thing was named
};

Opener::Opener(QWidget& window, Workspace& workspace, Viewport& view, WindowSettings& settings)
    : QObject(&window),
      m_window(window),
      m_workspace(workspace),
      m_view(view),
      m_settings(settings),
      m_memory(memoryBudget())
{
    // Of the whole program: fields that take text would else take the name of a file that is dropped on them.
    QCoreApplication::instance()->installEventFilter(this);
    m_window.setAcceptDrops(true);
    m_rememberTimer.setSingleShot(true);
    connect(&m_rememberTimer, &QTimer::timeout, this, [this] {
        m_settings.addRecentFiles(std::exchange(m_remembered, {}));
        showRecent();
    });
    connect(&workspace, &Workspace::documentLoaded, this, [this](const Document* d) { remember(*d); });
    connect(&workspace, &Workspace::saved, this, [this](const Document* d) { remember(*d); });
    StartPage& page = m_view.startPage();
    connect(&page, &StartPage::openRequested, this, &Opener::chooseFiles);
    connect(&page, &StartPage::folderRequested, this, &Opener::chooseFolder);
    connect(&page, &StartPage::recentChosen, this, [this](const QString& origin) { openOrigin(origin); });
    showRecent();
}

// -- dialogs

void Opener::chooseFiles()
{
    const QStringList files =
        QFileDialog::getOpenFileNames(&m_window, tr("Open point clouds"), m_settings.folder(),
                                      tr("Point clouds (*.las *.laz *.vpc *.LAS *.LAZ *.VPC);;All files (*)"));
    if (files.isEmpty()) return;
    m_settings.setFolder(QFileInfo(files.front()).path());
    open(files);
}

void Opener::chooseFolder()
{
    const QString folder = QFileDialog::getExistingDirectory(
        &m_window, tr("Open all point clouds of a folder as one survey"), m_settings.folder());
    if (folder.isEmpty()) return;
    m_settings.setFolder(folder);
    open({folder});
}

// -- files and folders

void Opener::open(const QStringList& paths)
{
    if (paths.isEmpty()) return;
    const auto search = std::make_shared<Search>();
    search->alone = paths.size() == 1;
    QStringList absolute;
    for (const QString& path : paths) absolute << QDir::cleanPath(QDir::current().absoluteFilePath(path));
    m_workspace.startJob(
        absolute.size() == 1 ? tr("Look for files in %1").arg(QFileInfo(absolute.front()).fileName())
                             : tr("Look for files"),
        [absolute, search](Progress& progress) {
            for (const QString& path : absolute) {
                progress.check();
                const std::filesystem::path place = findPath(path);
                if (!standsForFiles(place)) {
                    search->files << path;
                    std::error_code unknown;  // what is not there is said when it is opened
                    if (const auto size = std::filesystem::file_size(place, unknown); !unknown) {
                        search->bytes += size;
                        search->memory += likelyMemory(place, size);
                    }
                    continue;
                }
                const auto first = search->found.files.size();
                addFilesOf(place, search->found, progress);
                search->places << path;
                for (std::size_t k = first; k < search->found.files.size(); ++k)
                    search->files << toQString(search->found.files[k]);
            }
            search->bytes += search->found.bytes;
            search->memory += search->found.memory;
        },
        [this, search](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished) openFound(*search);
        },
        true);
}

void Opener::openOrigin(const QString& origin)
{
    open(origin.split(QLatin1Char('\n'), Qt::SkipEmptyParts));
}

void Opener::openFound(const Search& search)
{
    const bool one = search.places.size() == 1;
    const QString name = one ? QFileInfo(search.places.front()).fileName() : QString();
    if (!search.places.isEmpty() && search.found.files.empty())
        m_workspace.say(MessageKind::Warning, one ? tr("There is no LAS or LAZ file in %1.").arg(name)
                                                  : tr("There is no LAS or LAZ file in these folders."));
    if (search.found.closedFolders != 0)
        m_workspace.say(MessageKind::Warning, search.found.closedFolders == 1
                                                  ? tr("One folder could not be read; its files are left out.")
                                                  : tr("%1 folders could not be read; their files are left out.")
                                                        .arg(countText(search.found.closedFolders)));
    if (search.found.remote != 0) {
        const QString where = one ? name : tr("virtual point clouds");
        m_workspace.say(MessageKind::Warning,
                        search.found.remote == 1
                            ? tr("One file of %1 lies on a server and is left out; download it first.").arg(where)
                            : tr("%1 files of %2 lie on servers and are left out; download them first.")
                                  .arg(countText(search.found.remote), where));
    }
    const auto openAll = [this, files = search.files,
                          origin = search.alone && one ? search.places.front() : QString()] {
        m_workspace.open(files, origin);
    };
    const bool large = m_memory != 0 && search.memory > m_memory / 4 * 3;
    if (!large || search.files.isEmpty() || !m_workspace.askQuestion) return openAll();
    const auto files = std::size_t(search.files.size());
    m_workspace.askQuestion(
        {files == 1 ? tr("%1 may not fit into memory.").arg(QFileInfo(search.files.front()).fileName())
         : one      ? tr("%1 may not fit into memory.").arg(name)
                    : tr("These files may not fit into memory."),
         (files == 1 ? tr("The file takes %1 on the disk, and about %2 once it is read; points may keep %3 in "
                          "memory. What goes beyond lies in %4 while it is open, which is slower.")
                     : tr("The %1 files take %2 on the disk, and about %3 once they are read; points may keep %4 "
                          "in memory. What goes beyond lies in %5 while they are open, which is slower.")
                           .arg(countText(files)))
             .arg(bytesText(search.bytes), bytesText(search.memory), bytesText(m_memory),
                  toQString(Residency::folder())),
         files == 1 ? tr("&Open") : tr("&Open All")},
        [openAll, guard = QPointer<Opener>(this)](bool wanted) {
            if (wanted && guard) openAll();
        });
}

// -- recent ones

void Opener::remember(const Document& document)
{
    const QString origin = document.origin();
    if (origin.isEmpty()) return;
    m_remembered.removeAll(origin);
    m_remembered << origin;
    m_rememberTimer.start(m_workspace.opening() ? kRememberPause : 0);
}

QStringList Opener::recentFiles() const
{
    return m_settings.recentFiles();
}

void Opener::clearRecentFiles()
{
    m_settings.clearRecentFiles();
    showRecent();
}

void Opener::showRecent()
{
    m_view.startPage().setRecentFiles(recentFiles());
    emit recentFilesChanged();
}

// -- dropping

bool Opener::hint(const QMimeData& mime)
{
    const QStringList files = localFiles(mime);
    if (files.isEmpty()) return false;
    m_view.showDropHint(files.size() == 1 ? tr("Open %1").arg(QUrl::fromLocalFile(files.front()).fileName())
                                          : tr("Open %1 files together").arg(countText(std::size_t(files.size()))));
    return true;
}

bool Opener::eventFilter(QObject* watched, QEvent* event)
{
    switch (event->type()) {
        case QEvent::DragEnter:
        case QEvent::DragMove:
        case QEvent::DragLeave:
        case QEvent::Drop:
            break;
        default:
            return false;
    }
    const auto* const widget = qobject_cast<QWidget*>(watched);
    if (!widget || widget->window() != &m_window) return false;
    if (event->type() == QEvent::DragLeave) {
        m_view.hideDropHint();
        return false;
    }
    auto& drop = *static_cast<QDropEvent*>(event);
    if (event->type() == QEvent::DragEnter && !hint(*drop.mimeData())) return false;
    const QStringList files = localFiles(*drop.mimeData());
    if (files.isEmpty()) return false;
    drop.acceptProposedAction();
    if (event->type() == QEvent::Drop) {
        m_view.hideDropHint();
        open(files);
    }
    return true;
}

}  // namespace punctum::ui
