// SPDX-License-Identifier: MIT
#pragma once

#include <QObject>
#include <QStringList>
#include <QTimer>

#include <cstddef>

class QMimeData;
class QWidget;

namespace punctum::ui
{

class Document;
class Viewport;
class WindowSettings;
class Workspace;

/// How the user opens files: by dialogs, by dropping them anywhere on the window, from the list of recent ones, on
/// the command line. What is named together is one document. Folders stand for the LAS and LAZ files in them and in
/// all folders inside, virtual point clouds for the files that they name; they are searched by a job. Files that
/// are likely to need more than half of the memory are asked about first.
///
/// GUI thread only. A child of the window; borrows what it is made with.
class Opener final : public QObject
{
    Q_OBJECT
public:
    Opener(QWidget& window, Workspace& workspace, Viewport& view, WindowSettings& settings);

    /// Files and folders, in any mix. Returns at once.
    void open(const QStringList& paths);
    /// What Document::origin() said.
    void openOrigin(const QString& origin);
    void chooseFiles();
    void chooseFolder();
    /// Newest first.
    QStringList recentFiles() const;
    void clearRecentFiles();

    /// Bytes, in place of memoryBudget().
    void setMemory(std::uint64_t bytes) { m_memory = bytes; }

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void recentFilesChanged();

private:
    struct Search;
    void openFound(const Search& search);
    void remember(const Document& document);
    void showRecent();
    /// Says over the view what dropping this would do; false: nothing.
    bool hint(const QMimeData& mime);

    QWidget& m_window;
    Workspace& m_workspace;
    Viewport& m_view;
    WindowSettings& m_settings;
    std::uint64_t m_memory;    ///< bytes that points may keep; 0: not known
    QStringList m_remembered;  ///< newest last, not yet written down
    QTimer m_rememberTimer;
};

}  // namespace punctum::ui
