// SPDX-License-Identifier: MIT
#include "ui/navigate/SavedViews.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QObject>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr qsizetype kMostCamera = 4096;  // characters; a camera has some hundred

const QString kFile = QStringLiteral("file");
const QString kViews = QStringLiteral("views");
const QString kName = QStringLiteral("name");
const QString kCamera = QStringLiteral("camera");

bool has(const std::vector<SavedViews::View>& views, const QString& name)
{
    return std::any_of(views.begin(), views.end(), [&](const SavedViews::View& v) { return v.name == name; });
}

}  // namespace

SavedViews SavedViews::fromText(const QString& text)
{
    SavedViews result;
    const QJsonArray files = QJsonDocument::fromJson(text.toUtf8()).array();
    for (const QJsonValue file : files) {
        const QString path = file[kFile].toString();
        if (path.isEmpty() || result.find(path)) continue;
        File known{path, {}};
        const QJsonArray views = file[kViews].toArray();
        for (const QJsonValue each : views) {
            View view{path, each[kName].toString().left(kMostName), each[kCamera].toString()};
            if (view.name.isEmpty() || has(known.views, view.name)) continue;
            if (view.camera.isEmpty() || view.camera.size() > kMostCamera) continue;
            if (known.views.size() < kMostOfFile) known.views.push_back(std::move(view));
        }
        if (!known.views.empty()) result.m_files.push_back(std::move(known));
    }
    if (result.m_files.size() > kMostFiles)
        result.m_files.erase(result.m_files.begin(), result.m_files.end() - std::ptrdiff_t(kMostFiles));
    return result;
}

QString SavedViews::text() const
{
    QJsonArray files;
    for (const File& file : m_files) {
        QJsonArray views;
        for (const View& view : file.views) views.append(QJsonObject{{kName, view.name}, {kCamera, view.camera}});
        files.append(QJsonObject{{kFile, file.path}, {kViews, views}});
    }
    return QString::fromUtf8(QJsonDocument(files).toJson(QJsonDocument::Compact));
}

SavedViews::File* SavedViews::find(const QString& path)
{
    const auto found =
        std::find_if(m_files.begin(), m_files.end(), [&](const File& file) { return file.path == path; });
    return found == m_files.end() ? nullptr : &*found;
}

const SavedViews::File* SavedViews::find(const QString& path) const
{
    return const_cast<SavedViews*>(this)->find(path);
}

std::vector<SavedViews::View> SavedViews::of(const QStringList& files) const
{
    std::vector<View> views;
    for (const QString& path : files)
        if (const File* const file = find(path)) views.insert(views.end(), file->views.begin(), file->views.end());
    return views;
}

QString SavedViews::freshName(const QString& file) const
{
    const File* const known = find(file);
    const std::vector<View> views = known ? known->views : std::vector<View>();
    for (std::size_t number = views.size() + 1;; ++number) {
        QString name = QObject::tr("View %1").arg(number);
        if (!has(views, name)) return name;
    }
}

bool SavedViews::full(const QString& file) const
{
    const File* const known = find(file);
    return known && known->views.size() >= kMostOfFile;
}

bool SavedViews::add(View view)
{
    if (full(view.file)) return false;
    if (const File* const known = find(view.file)) {
        const auto at = m_files.begin() + (known - m_files.data());
        std::rotate(at, at + 1, m_files.end());
    } else {
        m_files.push_back({view.file, {}});
    }
    std::vector<View>& views = m_files.back().views;
    const QString name = view.name.simplified().left(kMostName);
    view.name = name.isEmpty() ? freshName(view.file) : name;
    for (int number = 2; has(views, view.name); ++number)
        view.name = QStringLiteral("%1 (%2)").arg(name).arg(number);
    views.push_back(std::move(view));
    if (m_files.size() > kMostFiles) m_files.erase(m_files.begin());
    return true;
}

bool SavedViews::rename(const View& view, const QString& name)
{
    const QString now = name.simplified().left(kMostName);
    File* const file = find(view.file);
    if (!file || now.isEmpty() || has(file->views, now)) return false;
    const auto found = std::find(file->views.begin(), file->views.end(), view);
    if (found == file->views.end()) return false;
    found->name = now;
    return true;
}

bool SavedViews::remove(const View& view)
{
    File* const file = find(view.file);
    if (!file) return false;
    const auto found = std::find(file->views.begin(), file->views.end(), view);
    if (found == file->views.end()) return false;
    file->views.erase(found);
    if (file->views.empty()) m_files.erase(m_files.begin() + (file - m_files.data()));
    return true;
}

}  // namespace punctum::ui
