// SPDX-License-Identifier: MIT
#include "ui/document/SavingText.h"

#include "ui/basic/Text.h"

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

QString notesText(const std::vector<std::string>& notes)
{
    QStringList sentences;
    for (const std::string& note : notes) sentences << toQString(note);
    return sentences.join(QLatin1Char(' '));
}

}  // namespace

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
