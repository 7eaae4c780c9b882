// SPDX-License-Identifier: MIT
#include "ui/document/FileDoctor.h"

#include "core/session/Session.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"

#include <QDir>
#include <QPointer>

#include <optional>

namespace punctum::ui
{

namespace
{

/// What was done and what was not, in lines.
QString details(const RepairOutcome& report)
{
    QString text;
    const auto list = [&](const QString& heading, const std::vector<FileFault>& faults) {
        if (faults.empty()) return;
        text += (text.isEmpty() ? QString() : QStringLiteral("\n")) + heading + QLatin1Char('\n');
        for (const FileFault& f : faults)
            text += QStringLiteral("- ") + toQString(f.fault) + QStringLiteral("\n  ") + toQString(f.mend) +
                    QLatin1Char('\n');
    };
    list(FileDoctor::tr("Mended"), report.mended);
    list(FileDoctor::tr("Left as it is"), report.left);
    return text;
}

}  // namespace

FileDoctor::FileDoctor(Workspace& workspace, QObject* parent) : QObject(parent), m_workspace(workspace)
{
    connect(&workspace, &Workspace::documentLoaded, this, [this](Document* document) { examine(*document); });
    connect(&workspace, &Workspace::documentRemoved, this,
            [this](const Document* document, bool) { m_looks.erase(document); });
    connect(&workspace, &Workspace::saved, this, [this](Document* document) {
        if (m_workspace.find(document->cloud().get())) examine(*document);  // not closed while it was saved
    });
}

const Inspection* FileDoctor::of(const Document& document) const
{
    const auto look = m_looks.find(&document);
    return look == m_looks.end() ? nullptr : look->second.found.get();
}

void FileDoctor::examine(Document& document)
{
    const auto result = std::make_shared<std::optional<Inspection>>();
    const JobId job = m_workspace.startJob(
        tr("Look through %1").arg(document.name()),
        [session = document.session(), result](Progress& progress) { *result = inspect(*session, progress); },
        [self = QPointer(this), target = QPointer(&document), result](const JobInfo& info) {
            if (!self || !target) return;
            const auto look = self->m_looks.find(target.data());
            if (look == self->m_looks.end() || look->second.job != info.id) return;  // a later save is looked at
            look->second.job = 0;
            if (*result) look->second.found = std::make_shared<const Inspection>(std::move(**result));
            emit self->examined(target.data());
        },
        true);
    m_workspace.tie(document, job);
    // What was found before is about a file that the document is no longer kept in, or as it was before the save.
    m_looks[&document] = {job, nullptr};
    emit examined(&document);
}

void FileDoctor::repair(const Document& document, const QString& path)
{
    const std::filesystem::path target = toPath(QDir::cleanPath(QDir::current().absoluteFilePath(path)));
    const auto report = std::make_shared<RepairOutcome>();
    m_workspace.startJob(
        tr("Repair %1").arg(document.name()),
        [in = toPath(document.path()), target, report](Progress& progress) {
            *report = repairFile(in, target, progress);
        },
        [workspace = QPointer(&m_workspace), target, report](const JobInfo& info) {
            if (!workspace) return;
            if (info.state == JobState::Failed) workspace->say(MessageKind::Error, toQString(info.error));
            if (info.state != JobState::Finished) return;
            const auto mended = report->mended.size(), left = report->left.size();
            QString sentence = tr("There is nothing to mend without guessing; nothing was written.");
            if (report->written)
                sentence =
                    mended + left == 1
                        ? tr("The fault is mended in %1, whose points are those of the file.")
                              .arg(toQString(target.filename()))
                        : tr("%1 of %2 faults are mended in %3, whose points are those of the file.")
                              .arg(countText(mended), countText(mended + left), toQString(target.filename()));
            for (const std::string& note : report->notes) sentence += QLatin1Char(' ') + toQString(note);
            workspace->say(MessageKind::Info, sentence, details(*report));
        });
}

}  // namespace punctum::ui
