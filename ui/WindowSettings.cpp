// SPDX-License-Identifier: MIT
#include "ui/WindowSettings.h"

#include "ui/Text.h"
#include "ui/ViewSettings.h"

#include <QFileInfo>
#include <QMainWindow>
#include <QScreen>
#include <QSettings>
#include <QStandardPaths>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kRecentFiles = 10;
constexpr int kLayoutVersion = 1;  // raise when docks come or go

const QString kGeometry = QStringLiteral("window/geometry");
const QString kLayout = QStringLiteral("window/state");
const QString kAppearance = QStringLiteral("window/appearance");
const QString kBackend = QStringLiteral("view/backend");
const QString kPointSize = QStringLiteral("view/pointSize");
const QString kSamples = QStringLiteral("view/samples");
const QString kColorMap = QStringLiteral("view/colorMap");
const QString kBackground = QStringLiteral("view/background");
const QString kRecent = QStringLiteral("files/recent");
const QString kFolder = QStringLiteral("files/folder");

}  // namespace

WindowSettings::WindowSettings(const QString& file)
    : m_settings(file.isEmpty() ? std::make_unique<QSettings>(QStringLiteral("Punctum"), QStringLiteral("Punctum"))
                                : std::make_unique<QSettings>(file, QSettings::IniFormat))
{
}

WindowSettings::~WindowSettings() = default;

void WindowSettings::restore(QMainWindow& window, ViewSettings& view) const
{
    const QSize room = window.screen() ? window.screen()->availableSize() : QSize(1400, 900);
    window.resize(std::min(1480, room.width() * 9 / 10), std::min(920, room.height() * 9 / 10));
    window.restoreGeometry(m_settings->value(kGeometry).toByteArray());
    window.restoreState(m_settings->value(kLayout).toByteArray(), kLayoutVersion);
    view.setPointSize(m_settings->value(kPointSize, 1.0).toDouble());
    view.setSamples(m_settings->value(kSamples, 1).toInt());
    view.setColorMap(m_settings->value(kColorMap, view.colorMap()).toString());
    view.setBackground(ViewSettings::Background(std::clamp(m_settings->value(kBackground, 0).toInt(), 0, 2)));
}

void WindowSettings::store(const QMainWindow& window, const ViewSettings& view)
{
    m_settings->setValue(kGeometry, window.saveGeometry());
    m_settings->setValue(kLayout, window.saveState(kLayoutVersion));
    m_settings->setValue(kPointSize, view.display().pointSize);
    m_settings->setValue(kSamples, view.display().samples);
    m_settings->setValue(kColorMap, view.colorMap());
    m_settings->setValue(kBackground, int(view.background()));
}

Appearance WindowSettings::appearance() const
{
    return appearanceFromName(m_settings->value(kAppearance).toString());
}

void WindowSettings::setAppearance(Appearance appearance)
{
    m_settings->setValue(kAppearance, nameOf(appearance));
}

std::optional<render::BackendKind> WindowSettings::backend() const
{
    return render::backendFromName(m_settings->value(kBackend).toString().toStdString());
}

void WindowSettings::setBackend(render::BackendKind kind)
{
    m_settings->setValue(kBackend, toQString(render::nameOf(kind)));
}

QStringList WindowSettings::recentFiles() const
{
    return m_settings->value(kRecent).toStringList();
}

void WindowSettings::addRecentFile(const QString& path)
{
    QStringList recent = recentFiles();
    recent.removeAll(path);
    recent.prepend(path);
    m_settings->setValue(kRecent, recent.mid(0, kRecentFiles));
    setFolder(QFileInfo(path).path());
}

void WindowSettings::clearRecentFiles()
{
    m_settings->remove(kRecent);
}

QString WindowSettings::folder() const
{
    return m_settings->value(kFolder, QStandardPaths::writableLocation(QStandardPaths::HomeLocation)).toString();
}

void WindowSettings::setFolder(const QString& folder)
{
    m_settings->setValue(kFolder, folder);
}

}  // namespace punctum::ui
