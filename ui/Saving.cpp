// SPDX-License-Identifier: MIT
#include "ui/Saving.h"

#include "core/Error.h"
#include "core/edit/History.h"
#include "core/task/Progress.h"
#include "ui/Document.h"
#include "ui/Recovery.h"
#include "ui/Text.h"

#include <QCoreApplication>
#include <QStringList>

#include <algorithm>

namespace punctum::ui
{

namespace
{

QString tr(const char* text)
{
    return QCoreApplication::translate("Saving", text);
}

/// For a look ahead: it shows an upgrade, whoever has to be asked for it.
las::WriteOptions optionsFor(const std::filesystem::path& target)
{
    las::WriteOptions options;
    options.upgrade = true;
    options.compressed = las::isCompressedName(target);
    return options;
}

std::uint64_t editsOf(OpenCloud& data)
{
    const std::lock_guard gate(data.editGate);
    return data.edits;
}

QString notesText(const std::vector<std::string>& notes)
{
    QStringList sentences;
    for (const std::string& note : notes) sentences << toQString(note);
    return sentences.join(QLatin1Char(' '));
}

}  // namespace

Forecast foresee(OpenCloud& data, const std::filesystem::path& original, const std::filesystem::path& target,
                 Progress& progress)
{
    Forecast forecast;
    forecast.edits = editsOf(data);
    forecast.preview = las::previewSave(*data.cloud, original, target, optionsFor(target), progress);
    return forecast;
}

QString unsavedChanges(OpenCloud& data, const std::filesystem::path& original, Progress& progress)
{
    const auto changes = data.history->changes(progress);
    const las::SavePreview preview = las::previewSave(*data.cloud, original, original, optionsFor(original),
                                                      progress, changes ? &*changes : nullptr);
    return toQString(las::summary(preview.difference));
}

SaveOutcome saveCloud(OpenCloud& data, const std::filesystem::path& original, const std::filesystem::path& target,
                      std::optional<Forecast> forecast, las::WriteOptions options, Progress& progress)
{
    const std::uint64_t edits = editsOf(data);
    if (!forecast || forecast->edits != edits) {
        try {
            forecast = foresee(data, original, target, progress);
        } catch (const Error&) {
            forecast.reset();  // what cannot be written either is told by write()
        }
    }
    SaveOutcome outcome;
    options.compressed = las::isCompressedName(target);
    outcome.report = las::write(*data.cloud, target, options, progress);
    const std::lock_guard gate(data.editGate);
    outcome.disturbed = data.edits != edits;
    if (outcome.disturbed)
        data.history->forgetSaved();
    else
        data.history->markSaved();
    Recovery::dropJournal(data);
    data.journalTold = outcome.disturbed;  // the message says so
    outcome.compared = !outcome.disturbed && forecast && forecast->edits == edits;
    if (outcome.compared) outcome.preview = std::move(forecast->preview);
    return outcome;
}

QString savedText(const SaveOutcome& outcome, const std::filesystem::path& target)
{
    QStringList sentences{
        tr("Saved %1: %2, %3, read back and compared.")
            .arg(toQString(target.filename()), pointsText(outcome.report.points), bytesText(outcome.report.bytes))};
    if (outcome.compared) {
        const QString changes = toQString(las::summary(outcome.preview.difference));
        sentences << (changes.isEmpty() ? tr("Nothing in it changed.") : tr("Changes: %1.").arg(changes));
    }
    if (!outcome.compared || las::dropsOrUpgrades(outcome.preview.difference)) {
        const QString notes = notesText(outcome.report.notes);
        if (!notes.isEmpty()) sentences << notes;
    }
    return sentences.join(QLatin1Char(' '));
}

QString savedDetails(const SaveOutcome& outcome, const std::filesystem::path& original,
                     const std::filesystem::path& target)
{
    if (!outcome.compared) return {};
    std::string a = original.filename().string(), b = target.filename().string();
    if (original == target) {
        a += " before";
        b += " now";
    } else if (a == b) {
        a = original.string();
        b = target.string();
    }
    QString text = toQString(las::report(outcome.preview.difference, a, b));
    text += QLatin1Char('\n') + tr("The written file was read back: every record is as it was meant.") +
            QLatin1Char('\n');
    for (const std::string& note : outcome.report.notes) text += toQString(note) + QLatin1Char('\n');
    return text;
}

bool upgrades(const las::SavePreview& preview)
{
    return std::any_of(
        preview.difference.header.begin(), preview.difference.header.end(),
        [](const las::FieldDifference& f) { return f.name == "point_format" || f.name == "version_minor"; });
}

QString savingQuestion(const las::SavePreview& preview)
{
    if (!las::dropsOrUpgrades(preview.difference)) return {};
    QString text =
        tr("Compared with the file that was opened: %1.").arg(toQString(las::summary(preview.difference)));
    const QString notes = notesText(preview.notes);
    if (!notes.isEmpty()) text += QStringLiteral("\n\n") + notes;
    return text;
}

}  // namespace punctum::ui
