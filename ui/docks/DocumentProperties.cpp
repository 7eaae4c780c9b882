// SPDX-License-Identifier: MIT
#include "ui/docks/DocumentProperties.h"

#include "core/cloud/ValueText.h"
#include "ui/Document.h"
#include "ui/Numbers.h"
#include "ui/Text.h"

#include <QCoreApplication>

namespace punctum::ui
{

namespace
{

QString tr(const char* text)
{
    return QCoreApplication::translate("DocumentProperties", text);
}

// x, y and z one below the other: side by side they wrap in a narrow dock.

QString vectorText(const glm::dvec3& v)
{
    const auto text = [](double x) { return localNumber(toQString(shortestText(x))); };
    if (v.x == v.y && v.y == v.z) return text(v.x);
    return QStringLiteral("%1\n%2\n%3").arg(text(v.x), text(v.y), text(v.z));
}

/// Of a corner of the box, or of its extent.
QString axesText(const glm::dvec3& v, const CoordinateScale& coordinates)
{
    return QStringLiteral("%1\n%2\n%3")
        .arg(shownCoordinate(coordinates, 0, v.x), shownCoordinate(coordinates, 1, v.y),
             shownCoordinate(coordinates, 2, v.z));
}

}  // namespace

std::vector<PropertySection> documentProperties(const Document& document)
{
    const las::SourceFile& source = document.source();
    const CoordinateScale& coordinates = document.cloud()->coordinates();
    std::vector<PropertySection> sections;

    if (document.recovered()) {
        PropertySection missing{tr("Missing or damaged"), {}};
        for (const QString& loss : document.losses()) missing.rows.push_back({{}, loss});
        missing.rows.push_back(
            {{}, tr("Save is off, so that the file keeps what could not be read: use Save As.")});
        sections.push_back(missing);
    }
    if (!document.warnings().isEmpty()) {
        PropertySection warnings{tr("Warnings"), {}};
        for (const QString& warning : document.warnings()) warnings.rows.push_back({{}, warning});
        sections.push_back(warnings);
    }
    if (!document.unsavedChanges().isEmpty())
        sections.push_back({tr("Unsaved changes"), {{{}, document.unsavedChanges(), {}}}});
    if (const auto& save = document.lastSave()) {
        PropertySection saved{tr("Last save"), {{{}, save->sentence, {}}}};
        if (!save->details.isEmpty()) saved.rows.push_back({{}, tr("Show exactly what differs"), save->details});
        sections.push_back(saved);
    }
    QString points = countText(document.points());
    if (document.missingPoints() != 0)
        points = tr("%1, of which %2 could not be read").arg(points, countText(document.missingPoints()));
    if (document.deletedPoints() != 0)
        points = tr("%1, %2 of them deleted").arg(points, countText(document.deletedPoints()));
    sections.push_back({tr("File"),
                        {{tr("Name"), document.name()},
                         {tr("Folder"), document.path().section(QLatin1Char('/'), 0, -2)},
                         {tr("Size"), bytesText(source.fileSize)},
                         {tr("Points"), points}}});
    sections.push_back({tr("Format"),
                        {{tr("LAS version"), toQString(source.header.version())},
                         {tr("Point format"), source.layout.compatible ? tr("%1, stored as %2 (compatibility mode)")
                                                                             .arg(source.layout.shownFormat())
                                                                             .arg(source.layout.format)
                                                                       : QString::number(source.layout.format)},
                         {tr("Record length"), tr("%1 bytes").arg(source.layout.length)},
                         {tr("Compressed"), source.compressed ? tr("yes, LAZ") : tr("no")}}});
    PropertySection place{
        tr("Coordinates"),
        {{tr("Scale"), vectorText(coordinates.scale)}, {tr("Offset"), vectorText(coordinates.offset)}}};
    if (!document.bounds().empty()) {
        place.rows.push_back({tr("Lowest"), axesText(document.bounds().min, coordinates)});
        place.rows.push_back({tr("Highest"), axesText(document.bounds().max, coordinates)});
        place.rows.push_back({tr("Extent"), axesText(document.bounds().max - document.bounds().min, coordinates)});
    }
    place.rows.push_back({tr("System"), source.crs.empty() ? tr("not stated") : toQString(source.crs)});
    sections.push_back(place);

    PropertySection records{tr("Records"), {}};
    const auto list = [&](const std::vector<las::Vlr>& vlrs) {
        for (const las::Vlr& vlr : vlrs)
            records.rows.push_back(
                {QStringLiteral("%1 / %2").arg(toQString(vlr.user())).arg(vlr.recordId),
                 vlr.extended ? tr("%1, extended").arg(bytesText(vlr.data.size())) : bytesText(vlr.data.size())});
    };
    list(source.vlrs);
    list(source.evlrs);
    if (records.rows.empty()) records.rows.push_back({{}, tr("none")});
    sections.push_back(records);
    return sections;
}

}  // namespace punctum::ui
