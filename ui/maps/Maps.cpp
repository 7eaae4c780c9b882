// SPDX-License-Identifier: MIT
#include "ui/maps/Maps.h"

#include "core/Error.h"
#include "core/raster/TreeList.h"
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/maps/MapDialog.h"
#include "ui/settings/WindowSettings.h"

#include <QFileDialog>
#include <QFileInfo>

namespace punctum::ui
{

namespace
{

/// Makes and writes it; gives what was written in a few words. In a job.
QString makeAndWrite(const PointCloud& cloud, const MapChoice& choice, const std::filesystem::path& path,
                     Progress& progress)
{
    const MapCrs crs = mapCrs(cloud);
    if (choice.form == MapChoice::Form::Raster) {
        const MapOutcome map = makeMap(cloud, choice.request, progress);
        const std::uint64_t bytes = writeGeoTiff(path, map.raster, crs, map.options, progress);
        const QString size =
            Maps::tr("%1 × %2 cells, %3")
                .arg(countText(map.raster.columns()), countText(map.raster.rows()), bytesText(bytes));
        const QString found =
            map.finding.empty() ? QString() : QStringLiteral(". ") + toQString(map.finding).chopped(1);
        return (crs.known() ? size : size + Maps::tr("; the coordinate system is not known")) + found;
    }
    VectorMap map;
    VectorOptions options;
    options.wgs84 = choice.wgs84 && path.extension() != ".dxf" && path.extension() != ".csv";
    if (choice.form == MapChoice::Form::Trees) {
        TreeListRequest request;
        request.where = choice.request.where;
        const TreeList list = listTrees(cloud, request, progress);
        map.table = treeTable(list);
        writeVectors(path, map, crs, options, progress);
        const QString trees =
            list.trees.size() == 1 ? Maps::tr("1 tree") : Maps::tr("%1 trees").arg(countText(list.trees.size()));
        return list.finding.empty() ? trees : trees + QStringLiteral(". ") + toQString(list.finding).chopped(1);
    }
    if (choice.form == MapChoice::Form::Contours) {
        map.lines = contoursOf(smoothed(makeMap(cloud, choice.request, progress).raster, 1, progress),
                               choice.contours, progress);
        writeVectors(path, map, crs, options, progress);
        return map.lines.size() == 1 ? Maps::tr("1 contour")
                                     : Maps::tr("%1 contours").arg(countText(map.lines.size()));
    }
    OutlineRequest request;
    request.where = choice.request.where;
    request.cell = choice.request.cell;
    map.areas = outlinesOf(cloud, request, progress);
    writeVectors(path, map, crs, options, progress);
    return map.areas.size() == 1 ? Maps::tr("1 area") : Maps::tr("%1 areas").arg(countText(map.areas.size()));
}

}  // namespace

Maps::Maps(QWidget& window, Workspace& workspace, WindowSettings& settings)
    : QObject(&window), m_window(window), m_workspace(workspace), m_settings(settings)
{
}

void Maps::choose()
{
    const Document* const active = m_workspace.active();
    if (!active) return;
    auto* const dialog = new MapDialog(*active, &m_window);
    connect(dialog, &MapDialog::wanted, this, [this](const MapChoice& choice) {
        const Document* const document = m_workspace.active();
        if (!document) return;
        const bool raster = choice.form == MapChoice::Form::Raster;
        const QString base = QFileInfo(document->fileName()).completeBaseName();
        QString what = toQString(std::string(nameOf(choice.request.kind)));
        if (choice.request.kind == MapKind::Attribute) what = toQString(choice.request.attribute);
        if (choice.form == MapChoice::Form::Contours) what = QStringLiteral("contours");
        if (choice.form == MapChoice::Form::Outlines) what = QStringLiteral("outlines");
        const bool trees = choice.form == MapChoice::Form::Trees;
        if (trees) what = QStringLiteral("trees");
        const QString vectors = tr("GeoJSON (*.geojson *.json);;DXF (*.dxf)");
        const QString ending = raster  ? QStringLiteral(".tif")
                               : trees ? QStringLiteral(".csv")
                                       : QStringLiteral(".geojson");
        const QString path = QFileDialog::getSaveFileName(
            &m_window, tr("Save the map"),
            m_settings.folder() + QLatin1Char('/') + base + QLatin1Char('-') + what + ending,
            raster  ? tr("GeoTIFF (*.tif *.tiff)")
            : trees ? tr("CSV (*.csv)") + QStringLiteral(";;") + vectors
                    : vectors);
        if (path.isEmpty()) return;
        save(QFileInfo(path).suffix().isEmpty() ? path + ending : path, choice);
    });
    dialog->open();
}

void Maps::save(const QString& path, const MapChoice& choice)
{
    Document* const document = m_workspace.active();
    if (!document) return;
    Workspace& workspace = m_workspace;
    const QString name = QFileInfo(path).fileName();
    const auto written = std::make_shared<QString>();
    const JobId job = workspace.startJob(
        tr("Export %1").arg(name),
        [session = document->session(), choice, target = findPath(path), written](Progress& progress) {
            *written = makeAndWrite(*session->cloud(), choice, target, progress);
        },
        [&workspace, name, written](const JobInfo& info) {
            if (info.state == JobState::Failed) workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished)
                workspace.say(MessageKind::Info, tr("Saved %1: %2.").arg(name, *written));
        });
    workspace.tie(*document, job);
}

}  // namespace punctum::ui
