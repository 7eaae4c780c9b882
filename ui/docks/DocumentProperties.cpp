// SPDX-License-Identifier: MIT
#include "ui/docks/DocumentProperties.h"

#include "core/Text.h"
#include "core/cloud/ValueText.h"
#include "core/las/Doctor.h"
#include "core/las/HeaderWords.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"

#include <QCoreApplication>

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Of a corner of the box.
QString axesText(const glm::dvec3& v, const CoordinateScale& coordinates)
{
    return QStringLiteral("%1\n%2\n%3")
        .arg(shownCoordinate(coordinates, 0, v.x), shownCoordinate(coordinates, 1, v.y),
             shownCoordinate(coordinates, 2, v.z));
}

QString extentText(const WorldBounds& box, const CoordinateScale& coordinates)
{
    QStringList axes;
    for (int axis = 0; axis < 3; ++axis)
        axes << localNumber(toQString(differenceText(coordinates, axis, box.max[axis] - box.min[axis])));
    return axes.join(QLatin1Char('\n'));
}

PropertySection doctorSection(const std::vector<las::Finding>& findings)
{
    PropertySection section{tr("Doctor"), {}};
    for (const las::Finding& f : findings) {
        const QString mend = toQString(f.mend);
        section.rows.push_back(
            {{}, toQString(f.fault) + QLatin1Char('\n') + (f.repairable ? tr("Repair: %1").arg(mend) : mend)});
    }
    return section;
}

/// Who made the file, and what its encoding bits say.
PropertySection originSection(const las::Header& header)
{
    const auto orElse = [](const std::string& text, const QString& otherwise) {
        return text.empty() ? otherwise : toQString(text);
    };
    QStringList words;
    for (const std::string& word : las::encodingWords(header)) words << toQString(word);
    if (header.versionMinor() >= 5)
        words << tr("GPS times by the header: %1 to %2")
                     .arg(localNumber(toQString(shortestText(header.get(las::at::kMinGpsTime)))),
                          localNumber(toQString(shortestText(header.get(las::at::kMaxGpsTime)))));
    return {tr("Origin"),
            {{tr("Created"), orElse(las::creationText(header), tr("not said"))},
             {tr("Software"), orElse(las::headerText(header, las::at::kSoftware), tr("not said"))},
             {tr("System"), orElse(las::headerText(header, las::at::kSystemId), tr("not said"))},
             {tr("Project id"), orElse(las::guidText(header), tr("none"))},
             {tr("Encoding"), words.join(QLatin1Char('\n'))}}};
}

/// Two or three digits of an estimate.
QString estimateText(double value)
{
    const int decimals = value > 0 ? std::max(0, 2 - int(std::floor(std::log10(value)))) : 0;
    return localNumber(toQString(roundedText(value, decimals)));
}

/// Counts and density of the points of the file.
void addFigures(std::vector<PropertySection>& sections, const Document& document, const las::Examination& found)
{
    const PointFigures& f = found.figures;
    const glm::dvec3 stretch = document.viewStretch(document.bounds());
    const double area = stretch.x * stretch.y;
    PropertySection figures{tr("Points"), {}};
    const QString unit = document.lengthUnit();
    if (f.density > 0 && area > 0) {
        const QString square = unit.isEmpty() ? tr("square unit") : unit + QStringLiteral("²");
        figures.rows.push_back({tr("Density"), tr("%1 points/%2").arg(estimateText(f.density / area), square)});
        figures.rows.push_back(
            {tr("Spacing"), estimateText(f.spacing * std::sqrt(area)) + QLatin1Char(' ') + unit});
    }
    if (f.gpsTime) {
        QString text = localNumber(toQString(shortestText(f.gpsTime->first))) + QLatin1Char('\n') +
                       localNumber(toQString(shortestText(f.gpsTime->second)));
        const las::Header& header = found.source->header;
        const QString first = toQString(las::gpsDay(header, f.gpsTime->first));
        const QString last = toQString(las::gpsDay(header, f.gpsTime->second));
        if (!first.isEmpty() && !last.isEmpty())
            text += QLatin1Char('\n') + (first == last ? first : tr("%1 to %2").arg(first, last));
        figures.rows.push_back({tr("GPS time"), text});
    }
    for (std::size_t k = 0; k < f.returns.size(); ++k)
        if (f.returns[k] != 0) figures.rows.push_back({tr("Return %1").arg(k), countText(f.returns[k])});
    const std::pair<const char*, std::uint64_t> flags[] = {{"Synthetic", f.synthetic},
                                                           {"KeyPoint", f.keyPoint},
                                                           {"Withheld", f.withheld},
                                                           {"Overlap", f.overlap},
                                                           {"ScanDirectionFlag", f.scanDirection},
                                                           {"EdgeOfFlightLine", f.edgeOfFlightLine}};
    for (const auto& [name, count] : flags)
        if (count != 0) figures.rows.push_back({toQString(std::string_view(name)), countText(count)});
    if (!figures.rows.empty()) sections.push_back(figures);
    PropertySection classes{tr("Classes"), {}};
    for (unsigned code = 0; code < f.classes.size(); ++code)
        if (f.classes[code] != 0) classes.rows.push_back({classText(code), countText(f.classes[code])});
    if (!classes.rows.empty()) sections.push_back(classes);
}

}  // namespace

std::vector<PropertySection> documentProperties(const Document& document, const las::Examination* examination)
{
    // After a save another file holds the points.
    const las::SourceFile& source = examination ? *examination->source : document.source();
    const CoordinateScale& coordinates = document.cloud()->coordinates();
    std::vector<PropertySection> sections;

    if (document.recovered()) {
        PropertySection missing{tr("Missing or damaged"), {}};
        for (const QString& loss : document.losses()) missing.rows.push_back({{}, loss});
        missing.rows.push_back(
            {{}, tr("Save is off, so that the file keeps what could not be read: use Save As.")});
        sections.push_back(missing);
    }
    PropertySection warnings{tr("Warnings"), {}};
    for (const QString& warning : warningsOf(source)) warnings.rows.push_back({{}, warning});
    if (!warnings.rows.empty()) sections.push_back(warnings);
    if (examination && !examination->diagnosis.findings.empty())
        sections.push_back(doctorSection(examination->diagnosis.findings));
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
        place.rows.push_back({tr("Extent"), extentText(document.bounds(), coordinates)});
    }
    place.rows.push_back({tr("Units"), toQString(las::unitsText(source.units))});
    place.rows.push_back({tr("System"), source.crs.empty() ? tr("not stated") : toQString(source.crs)});
    sections.push_back(place);

    sections.push_back(originSection(source.header));
    if (examination) addFigures(sections, document, *examination);

    PropertySection records{tr("Records"), {}};
    const auto list = [&](const std::vector<las::Vlr>& vlrs) {
        for (const las::Vlr& vlr : vlrs) {
            QString value =
                vlr.extended ? tr("%1, extended").arg(bytesText(vlr.data.size())) : bytesText(vlr.data.size());
            if (const QString words = toQString(las::recordWords(vlr)); !words.isEmpty())
                value += QLatin1Char('\n') + words;
            records.rows.push_back(
                {QStringLiteral("%1 / %2").arg(toQString(printable(vlr.user()))).arg(vlr.recordId), value});
        }
    };
    list(source.vlrs);
    list(source.evlrs);
    if (records.rows.empty()) records.rows.push_back({{}, tr("none")});
    sections.push_back(records);
    return sections;
}

}  // namespace punctum::ui
