// SPDX-License-Identifier: MIT
#include "ui/window/SurveyCommands.h"

#include "ui/document/Workspace.h"
#include "ui/view/Framing.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QPointer>

#include <algorithm>

namespace punctum::ui
{

SurveyCommands::SurveyCommands(QWidget& window, Workspace& workspace, Framing& framing)
    : QObject(&window), m_window(window), m_workspace(workspace), m_framing(framing)
{
}

void SurveyCommands::saveIntoFolder(Document& document)
{
    const QPointer<Document> target(&document);
    const QString folder = QFileDialog::getExistingDirectory(
        &m_window, tr("Save the files of %1 into a folder").arg(document.name()), document.path());
    if (!folder.isEmpty() && target) m_workspace.save(*target, folder);
}

void SurveyCommands::saveAsOneFile(Document& document)
{
    const QPointer<Document> target(&document);
    const QString las = tr("LAS point cloud (*.las)"), laz = tr("Compressed LAZ point cloud (*.laz)");
    QString filter = laz;
    const QString base = document.origin().contains(QLatin1Char('\n'))
                             ? tr("survey")
                             : QFileInfo(document.origin()).completeBaseName();
    QString path = QFileDialog::getSaveFileName(
        &m_window, tr("Save all files of %1 as one").arg(document.name()),
        document.path() + QLatin1Char('/') + (base.isEmpty() ? tr("survey") : base) + QStringLiteral(".laz"),
        laz + QStringLiteral(";;") + las, &filter);
    if (path.isEmpty() || !target) return;
    if (QFileInfo(path).suffix().isEmpty()) path += filter == las ? QStringLiteral(".las") : QStringLiteral(".laz");
    m_workspace.merge(*target, path);
}

void SurveyCommands::remove(Document& document, const std::vector<std::size_t>& parts)
{
    QStringList rest;
    for (std::size_t k = 0; k < document.parts().size(); ++k)
        if (std::find(parts.begin(), parts.end(), k) == parts.end()) rest << document.parts()[k].path;
    if (rest.isEmpty()) return;
    m_framing.keepViewOnce();
    m_workspace.close(document);
    m_workspace.open(rest);
}

}  // namespace punctum::ui
