// SPDX-License-Identifier: MIT
#include "ui/docks/DocumentProperties.h"

#include "core/cloud/ValueText.h"
#include "core/session/FileFacts.h"
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

PropertySection doctorSection(const std::vector<FileFault>& faults)
{
    PropertySection section{tr("Doctor"), {}};
    for (const FileFault& f : faults) {
        const QString mend = toQString(f.mend);
        section.rows.push_back(
            {{}, toQString(f.fault) + QLatin1Char('\n') + (f.repairable ? tr("Repair: %1").arg(mend) : mend)});
    }
    return section;
}

/// Who made the file, and what its encoding bits say.
PropertySection originSection(const FileFacts& facts)
{
    const auto orElse = [](const std::string& text, const QString& otherwise) {
        return text.empty() ? otherwise : toQString(text);
    };
    QStringList words;
    for (const std::string& word : facts.encoding) words << toQString(word);
    if (facts.gpsTimes)
        words << tr("GPS times by the header: %1 to %2")
                     .arg(localNumber(toQString(shortestText(facts.gpsTimes->first))),
                          localNumber(toQString(shortestText(facts.gpsTimes->second))));
    return {tr("Origin"),
            {{tr("Created"), orElse(facts.created, tr("not said"))},
             {tr("Software"), orElse(facts.software, tr("not said"))},
             {tr("System"), orElse(facts.system, tr("not said"))},
             {tr("Project id"), orElse(facts.projectId, tr("none"))},
             {tr("Encoding"), words.join(QLatin1Char('\n'))}}};
}

/// Two or three digits of an estimate.
QString estimateText(double value)
{
    const int decimals = value > 0 ? std::max(0, 2 - int(std::floor(std::log10(value)))) : 0;
    return localNumber(toQString(roundedText(value, decimals)));
}

/// Counts and density of the points of the file.
void addFigures(std::vector<PropertySection>& sections, const Document& document, const Inspection& found)
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
        const QString first = toQString(found.firstDay), last = toQString(found.lastDay);
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

std::vector<PropertySection> documentProperties(const Document& document, const Inspection* inspection)
{
    // After a save another file holds the points.
    const FileFacts& facts = inspection && !document.many() ? inspection->facts : document.facts();
    const CoordinateScale& coordinates = document.cloud()->coordinates();
    std::vector<PropertySection> sections;

    if (document.recovered() || !document.losses().isEmpty()) {
        PropertySection missing{tr("Missing or damaged"), {}};
        for (const QString& loss : document.losses()) missing.rows.push_back({{}, loss});
        if (document.recovered())
            missing.rows.push_back(
                {{},
                 document.many()
                     ? tr("Damaged files keep what could not be read: they are saved into another folder "
                          "only, by Save As.")
                     : tr("Save is off, so that the file keeps what could not be read: use Save As.")});
        sections.push_back(missing);
    }
    PropertySection warnings{tr("Warnings"), {}};
    for (const std::string& warning : facts.warnings) warnings.rows.push_back({{}, toQString(warning)});
    if (!warnings.rows.empty()) sections.push_back(warnings);
    if (inspection && !inspection->faults.empty()) sections.push_back(doctorSection(inspection->faults));
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
    PropertySection file{document.many() ? tr("Survey") : tr("File"), {{tr("Name"), document.name()}}};
    if (document.many()) {
        file.rows.push_back({tr("Folder"), document.path()});
        file.rows.push_back({tr("Files"), countText(document.parts().size())});
    } else {
        file.rows.push_back({tr("Folder"), document.path().section(QLatin1Char('/'), 0, -2)});
    }
    file.rows.push_back({tr("Size"), bytesText(facts.bytes)});
    file.rows.push_back({tr("Points"), points});
    sections.push_back(file);
    sections.push_back({tr("Format"),
                        {{tr("LAS version"), toQString(facts.version)},
                         {tr("Point format"),
                          facts.shownFormat != facts.format
                              ? tr("%1, stored as %2 (compatibility mode)").arg(facts.shownFormat).arg(facts.format)
                              : QString::number(facts.format)},
                         {tr("Record length"), tr("%1 bytes").arg(facts.recordLength)},
                         {tr("Compressed"), facts.compressed ? tr("yes, LAZ") : tr("no")}}});
    PropertySection place{
        tr("Coordinates"),
        {{tr("Scale"), vectorText(coordinates.scale)}, {tr("Offset"), vectorText(coordinates.offset)}}};
    if (!document.bounds().empty()) {
        place.rows.push_back({tr("Lowest"), axesText(document.bounds().min, coordinates)});
        place.rows.push_back({tr("Highest"), axesText(document.bounds().max, coordinates)});
        place.rows.push_back({tr("Extent"), extentText(document.bounds(), coordinates)});
    }
    place.rows.push_back({tr("Units"), toQString(facts.units)});
    place.rows.push_back({tr("System"), facts.crs.empty() ? tr("not stated") : toQString(facts.crs)});
    sections.push_back(place);

    sections.push_back(originSection(facts));
    if (inspection) addFigures(sections, document, *inspection);

    PropertySection records{tr("Records"), {}};
    for (const FileFacts::Record& record : facts.records) {
        QString value = record.extended ? tr("%1, extended").arg(bytesText(record.bytes)) : bytesText(record.bytes);
        if (!record.words.empty()) value += QLatin1Char('\n') + toQString(record.words);
        records.rows.push_back({toQString(record.name), value});
    }
    if (records.rows.empty()) records.rows.push_back({{}, tr("none")});
    sections.push_back(records);
    return sections;
}

}  // namespace punctum::ui
