// SPDX-License-Identifier: MIT
#pragma once

#include <QWidget>

class QLabel;
class QVBoxLayout;

namespace punctum::ui
{

/// What the view shows while nothing is open: how to open files, and those that were open before. GUI thread only.
class StartPage final : public QWidget
{
    Q_OBJECT
public:
    explicit StartPage(QWidget* parent);

    /// Newest first; files or folders.
    void setRecentFiles(const QStringList& paths);

signals:
    void openRequested();
    void folderRequested();
    void recentChosen(const QString& path);

private:
    QWidget* m_recent;
    QVBoxLayout* m_recentColumn;
};

}  // namespace punctum::ui
