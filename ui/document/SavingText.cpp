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

constexpr qsizetype kMostNotes = 3;  ///< of a survey of many files; the details have them all

/// A note without the file that it is of: those of a survey begin with "name.laz: ".
QString withoutFile(const QString& note)
{
    const qsizetype end = note.indexOf(QStringLiteral(": "));
    const QString name = note.left(end).toLower();
    const bool file = end > 0 && (name.endsWith(QStringLiteral(".las")) || name.endsWith(QStringLiteral(".laz")));
    return file ? note.mid(end + 2) : note;
}

/// So many of the notes at most; what is the same of several files is said once, and first.
QString notesText(const std::vector<std::string>& notes, qsizetype most)
{
    struct Group {
        QString note, text;
        int files = 0;
    };
    std::vector<Group> groups;
    for (const std::string& one : notes) {
        const QString note = toQString(one), text = withoutFile(note);
        const auto same =
            std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.text == text; });
        if (same == groups.end())
            groups.push_back({note, text, 1});
        else
            ++same->files;
    }
    std::stable_sort(groups.begin(), groups.end(),
                     [](const Group& a, const Group& b) { return a.files > b.files; });
    QStringList sentences;
    for (const Group& group : groups) {
        if (sentences.size() == most) break;
        sentences << (group.files == 1 ? group.note : tr("%1 files: %2").arg(group.files).arg(group.text));
    }
    if (const auto rest = qsizetype(groups.size()) - sentences.size(); rest > 0)
        sentences << tr("%1 more in the details.").arg(countText(std::uint64_t(rest)));
    return sentences.join(QLatin1Char(' '));
}

/// "%1: 1,204 points, 6 kB, read back and compared." and what follows.
QString withFigures(const QString& saved, const SaveOutcome& outcome)
{
    QStringList sentences{tr("%1: %2, %3, read back and compared.")
                              .arg(saved, pointsText(outcome.report.points), bytesText(outcome.report.bytes))};
    if (outcome.compared) {
        const QString changes = toQString(las::summary(outcome.preview.difference));
        sentences << (changes.isEmpty() ? tr("Nothing in it changed.") : tr("Changes: %1.").arg(changes));
    }
    if (!outcome.compared || las::dropsOrUpgrades(outcome.preview.difference)) {
        const QString notes = notesText(outcome.report.notes, kMostNotes);
        if (!notes.isEmpty()) sentences << notes;
    }
    return sentences.join(QLatin1Char(' '));
}

}  // namespace

QString savedText(const SaveOutcome& outcome, const std::filesystem::path& target)
{
    return withFigures(tr("Saved %1").arg(toQString(target.filename())), outcome);
}

QString savedPartsText(const SaveOutcome& outcome, const std::vector<SessionPart>& files, bool inPlace,
                       const std::filesystem::path& target)
{
    constexpr std::size_t kNamed = 4;
    const std::size_t count = outcome.parts.size();
    if (count == 0) return tr("None of the %1 files changed, and none was written.").arg(countText(files.size()));
    QStringList names;
    for (std::size_t k = 0; k < std::min(kNamed, count); ++k)
        names << toQString(files[outcome.parts[k]].path.filename());
    QString list = names.join(QStringLiteral(", "));
    if (count > kNamed) list += tr(" and %1 more").arg(countText(count - kNamed));
    QString saved = count == 1
                        ? tr("Saved %1 of %2 files").arg(list, countText(files.size()))
                        : tr("Saved %1 of %2 files (%3)").arg(countText(count), countText(files.size()), list);
    if (!inPlace) saved += tr(" in %1").arg(toQString(target.filename()));
    return withFigures(saved, outcome);
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
    const QString notes = notesText(preview.notes, qsizetype(preview.notes.size()));
    if (!notes.isEmpty()) text += QStringLiteral("\n\n") + notes;
    return text;
}

}  // namespace punctum::ui
