// SPDX-License-Identifier: MIT
#include "ui/settings/WindowSettings.h"

#include "ui/basic/Text.h"
#include "ui/view/ViewSettings.h"

#include <QColor>
#include <QFileInfo>
#include <QMainWindow>
#include <QScreen>
#include <QSettings>
#include <QStandardPaths>

#include <algorithm>
#include <memory>
#include <mutex>

namespace punctum::ui
{

namespace
{

constexpr int kRecentFiles = 10;
constexpr int kLayoutVersion = 4;  // raise when docks come or go

const QString kGeometry = QStringLiteral("window/geometry");
const QString kLayout = QStringLiteral("window/state");
const QString kAppearance = QStringLiteral("window/appearance");
const QString kBackend = QStringLiteral("view/drawWith");
const QString kOrder = QStringLiteral("view/order");
const QString kFastest = QStringLiteral("view/fastestInMotion");
const QString kFastestDevice = QStringLiteral("view/fastestInMotionOn");
const QString kAutomatic = QStringLiteral("auto");
const QString kPointSize = QStringLiteral("view/pointSize");
const QString kSizing = QStringLiteral("view/sizing");
const QString kWorldSize = QStringLiteral("view/worldSize");
const QString kSpacings = QStringLiteral("view/spacings");
const QString kRound = QStringLiteral("view/round");
const QString kAveraged = QStringLiteral("view/averaged");
const QString kNormals = QStringLiteral("view/normals");
const QString kOwnBackground = QStringLiteral("view/ownBackground");
const QString kSamples = QStringLiteral("view/samples");
const QString kEyeDome = QStringLiteral("view/eyeDome");
const QString kGroundReplaced = QStringLiteral("view/groundReplaced");
const QString kContours = QStringLiteral("view/contours");
const QString kBands = QStringLiteral("view/bands");
const QString kColorMap = QStringLiteral("view/colorMap");
const QString kBackground = QStringLiteral("view/background");
const QString kSectionWidth = QStringLiteral("section/width_%1");
const QString kSectionBeside = QStringLiteral("section/beside");
const QString kAxes = QStringLiteral("view/axes");
const QString kSavedViews = QStringLiteral("view/saved");
const QString kScreenshot = QStringLiteral("screenshot/%1");
const QString kUndoMemory = QStringLiteral("edit/undoMemory");  // MiB
const QString kRecent = QStringLiteral("files/recent");
const QString kFolder = QStringLiteral("files/folder");

std::unique_ptr<QSettings> openSettings(const QString& file)
{
    return file.isEmpty() ? std::make_unique<QSettings>(QStringLiteral("Punctum"), QStringLiteral("Punctum"))
                          : std::make_unique<QSettings>(file, QSettings::IniFormat);
}

}  // namespace

/// What has been set and is not on the disk. Jobs that write come in any order, or too late: each of them writes
/// the newest of all.
struct WindowSettings::Unwritten {
    void add(const QString& key, const QVariant& value)
    {
        const std::lock_guard lock(m_mutex);
        m_values[key] = value;
    }
    /// One at a time; nobody who sets a value waits for the disk.
    void write(const QString& file)
    {
        const std::lock_guard one(m_writing);
        QVariantMap values;
        {
            const std::lock_guard lock(m_mutex);
            values.swap(m_values);
        }
        if (values.isEmpty()) return;
        const auto settings = openSettings(file);
        for (auto value = values.cbegin(); value != values.cend(); ++value)
            settings->setValue(value.key(), value.value());
    }

private:
    std::mutex m_writing, m_mutex;
    QVariantMap m_values;
};

HistoryRoom WindowSettings::historyRoom(const QString& file)
{
    const QString beside = file.isEmpty() ? QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation) +
                                                QStringLiteral("/Punctum")
                                          : QFileInfo(file).absolutePath();
    HistoryRoom room;
    room.folder = toPath(beside + QStringLiteral("/journals"));
    bool given = false;
    const qulonglong megabytes = openSettings(file)->value(kUndoMemory).toULongLong(&given);
    constexpr qulonglong kMost = qulonglong(1) << 24;  // 16 TiB
    if (given) room.memory = std::size_t(std::min(megabytes, kMost)) << 20;
    return room;
}

WindowSettings::WindowSettings(const QString& file, RunInBackground inBackground)
    : m_file(file), m_inBackground(std::move(inBackground)), m_unwritten(std::make_shared<Unwritten>())
{
    const auto settings = openSettings(file);
    for (const QString& key : settings->allKeys()) m_values[key] = settings->value(key);
}

WindowSettings::~WindowSettings()
{
    m_unwritten->write(m_file);
}

void WindowSettings::set(const QString& key, const QVariant& value)
{
    if (m_values.value(key) == value) return;
    m_values[key] = value;
    m_unwritten->add(key, value);
    auto write = [file = m_file, unwritten = m_unwritten] { unwritten->write(file); };
    if (m_inBackground)
        m_inBackground(write);
    else
        write();
}

bool WindowSettings::restore(QMainWindow& window, ViewSettings& view) const
{
    const QSize room = window.screen() ? window.screen()->availableSize() : QSize(1400, 900);
    window.resize(std::min(1480, room.width() * 9 / 10), std::min(920, room.height() * 9 / 10));
    window.restoreGeometry(m_values.value(kGeometry).toByteArray());
    const bool arranged = window.restoreState(m_values.value(kLayout).toByteArray(), kLayoutVersion);
    restoreView(view);
    return arranged;
}

void WindowSettings::restoreView(ViewSettings& view) const
{
    view.setPointSize(m_values.value(kPointSize, 1.0).toDouble());
    view.setSizing(
        render::PointSizing(std::clamp(m_values.value(kSizing, int(view.display().sizing)).toInt(), 0, 2)));
    view.setWorldSize(m_values.value(kWorldSize, view.display().worldSize).toDouble());
    view.setSpacings(m_values.value(kSpacings, view.display().spacings).toDouble());
    view.setRound(m_values.value(kRound, false).toBool());
    view.setAveraged(m_values.value(kAveraged, false).toBool());
    view.setNormals(render::NormalLook(std::clamp(m_values.value(kNormals, 0).toInt(), 0, 1)));
    if (const QColor own(m_values.value(kOwnBackground).toString()); own.isValid())
        view.setOwnBackground({std::uint8_t(own.red()), std::uint8_t(own.green()), std::uint8_t(own.blue()), 255});
    view.setSamples(m_values.value(kSamples, 1).toInt());
    view.setEyeDome(m_values.value(kEyeDome, 0.0).toDouble());
    view.setBands(m_values.value(kBands, 0).toInt());
    view.setGroundReplaced(m_values.value(kGroundReplaced, true).toBool());
    view.setContourChoice(m_values.value(kContours, ViewSettings::kNoContours).toDouble());
    view.setColorMap(m_values.value(kColorMap, view.colorMap()).toString());
    view.setBackground(ViewSettings::Background(std::clamp(m_values.value(kBackground, 0).toInt(), 0, 3)));
}

void WindowSettings::store(const QMainWindow& window, const ViewSettings& view)
{
    const auto settings = openSettings(m_file);
    settings->setValue(kGeometry, window.saveGeometry());
    settings->setValue(kLayout, window.saveState(kLayoutVersion));
    settings->setValue(kPointSize, view.display().pointSize);
    settings->setValue(kSizing, int(view.display().sizing));
    settings->setValue(kWorldSize, view.display().worldSize);
    settings->setValue(kSpacings, view.display().spacings);
    settings->setValue(kRound, view.display().round);
    settings->setValue(kAveraged, view.display().averaged);
    settings->setValue(kNormals, int(view.display().normals));
    const render::Rgba8 own = view.ownBackground();
    settings->setValue(kOwnBackground, QColor(own.r, own.g, own.b).name());
    settings->setValue(kSamples, view.display().samples);
    settings->setValue(kEyeDome, view.display().eyeDome);
    settings->setValue(kBands, view.display().bands);
    settings->setValue(kGroundReplaced, view.groundReplaced());
    settings->setValue(kContours, view.contourChoice());
    settings->setValue(kColorMap, view.colorMap());
    settings->setValue(kBackground, int(view.background()));
}

Appearance WindowSettings::appearance() const
{
    return appearanceFromName(m_values.value(kAppearance).toString());
}

void WindowSettings::setAppearance(Appearance appearance)
{
    set(kAppearance, nameOf(appearance));
}

std::optional<render::BackendKind> WindowSettings::backend() const
{
    return render::backendFromName(m_values.value(kBackend).toString().toStdString());
}

void WindowSettings::setBackend(std::optional<render::BackendKind> kind)
{
    set(kBackend, kind ? toQString(render::nameOf(*kind)) : kAutomatic);
}

render::OrderKind WindowSettings::order() const
{
    return render::orderFromName(m_values.value(kOrder).toString().toStdString())
        .value_or(render::OrderKind::Stratified);
}

void WindowSettings::setOrder(render::OrderKind order)
{
    set(kOrder, toQString(render::nameOf(order)));
}

FastestBackend WindowSettings::fastestBackend() const
{
    const auto kind = render::backendFromName(m_values.value(kFastest).toString().toStdString());
    if (!kind) return {};
    return {*kind, m_values.value(kFastestDevice).toString().toStdString()};
}

void WindowSettings::setFastestBackend(const FastestBackend& fastest)
{
    set(kFastest, toQString(render::nameOf(fastest.kind)));
    set(kFastestDevice, toQString(fastest.device.value_or("")));
}

QStringList WindowSettings::recentFiles() const
{
    return m_values.value(kRecent).toStringList();
}

void WindowSettings::addRecentFiles(const QStringList& paths)
{
    if (paths.isEmpty()) return;
    QStringList recent = recentFiles();
    for (const QString& path : paths) {
        recent.removeAll(path);
        recent.prepend(path);
    }
    set(kRecent, recent.mid(0, kRecentFiles));
    setFolder(folderOf(paths.back()));
}

void WindowSettings::clearRecentFiles()
{
    set(kRecent, QStringList());
}

double WindowSettings::sectionWidth(const QString& unit) const
{
    return m_values.value(kSectionWidth.arg(unit), 0.0).toDouble();
}

void WindowSettings::setSectionWidth(double width, const QString& unit)
{
    set(kSectionWidth.arg(unit), width);
}

bool WindowSettings::sectionBeside() const
{
    return m_values.value(kSectionBeside, false).toBool();
}

void WindowSettings::setSectionBeside(bool beside)
{
    set(kSectionBeside, beside);
}

bool WindowSettings::axes() const
{
    return m_values.value(kAxes, true).toBool();
}

void WindowSettings::setAxes(bool shown)
{
    set(kAxes, shown);
}

QString WindowSettings::savedViews() const
{
    return m_values.value(kSavedViews).toString();
}

void WindowSettings::setSavedViews(const QString& text)
{
    set(kSavedViews, text);
}

ScreenshotOptions WindowSettings::screenshot() const
{
    const ScreenshotOptions fresh{
        .legend = true, .scaleBar = true, .northArrow = true, .measurements = true, .ruler = true};
    const auto read = [this](const char* key, bool otherwise) {
        return m_values.value(kScreenshot.arg(QLatin1String(key)), otherwise).toBool();
    };
    ScreenshotOptions options;
    options.samples = m_values.value(kScreenshot.arg(QLatin1String("samples")), fresh.samples).toInt();
    options.transparent = read("transparent", fresh.transparent);
    options.legend = read("legend", fresh.legend);
    options.scaleBar = read("scaleBar", fresh.scaleBar);
    options.northArrow = read("northArrow", fresh.northArrow);
    options.measurements = read("measurements", fresh.measurements);
    options.ruler = read("ruler", fresh.ruler);
    return options;
}

void WindowSettings::setScreenshot(const ScreenshotOptions& options)
{
    const auto write = [this](const char* key, const QVariant& value) {
        set(kScreenshot.arg(QLatin1String(key)), value);
    };
    write("samples", options.samples);
    write("transparent", options.transparent);
    write("legend", options.legend);
    write("scaleBar", options.scaleBar);
    write("northArrow", options.northArrow);
    write("measurements", options.measurements);
    write("ruler", options.ruler);
}

QString WindowSettings::folder() const
{
    return m_values.value(kFolder, QStandardPaths::writableLocation(QStandardPaths::HomeLocation)).toString();
}

void WindowSettings::setFolder(const QString& folder)
{
    set(kFolder, folder);
}

}  // namespace punctum::ui
