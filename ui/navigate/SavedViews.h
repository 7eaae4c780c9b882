// SPDX-License-Identifier: MIT
#pragma once

#include <QString>
#include <QStringList>

#include <vector>

namespace punctum::ui
{

/// Views under names, of each file those that were saved while it was active. A value; written as JSON text, in
/// which each camera is the text of a camera file (render/camera/CameraFile.h). GUI thread or any other, one at a
/// time.
class SavedViews
{
public:
    static constexpr std::size_t kMostOfFile = 30, kMostFiles = 200;
    static constexpr qsizetype kMostName = 80;  ///< characters

    struct View {
        QString file;    ///< its path
        QString name;    ///< no other of the file has it
        QString camera;  ///< text of a camera file
        friend bool operator==(const View&, const View&) = default;
    };

    /// Leaves out what is no view: broken settings cost these and nothing else.
    static SavedViews fromText(const QString& text);
    QString text() const;

    /// Of these files, in their order.
    std::vector<View> of(const QStringList& files) const;
    /// "View 3": a name that none of the file's views has.
    QString freshName(const QString& file) const;
    bool full(const QString& file) const;
    /// Where the name is taken, it gets a number. The file becomes the newest; of too many files, the oldest is
    /// forgotten. False: the file has as many as there can be.
    bool add(View view);
    /// False when it is not there, or the name is empty or taken.
    bool rename(const View& view, const QString& name);
    bool remove(const View& view);

private:
    struct File {
        QString path;
        std::vector<View> views;
    };
    File* find(const QString& path);
    const File* find(const QString& path) const;

    std::vector<File> m_files;  ///< the newest last
};

}  // namespace punctum::ui
