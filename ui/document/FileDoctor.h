// SPDX-License-Identifier: MIT
#pragma once

#include "core/session/FileFacts.h"
#include "core/task/Jobs.h"

#include <QObject>
#include <QString>

#include <map>
#include <memory>

namespace punctum::ui
{

class Document;
class Workspace;

/// Looks through each file once it is loaded, and again when it is saved: the figures of its points, and what is
/// wrong with it, by a quiet job. Repairs to a new file by a job, too. GUI thread only; owned by the window, and
/// outlived by the workspace.
class FileDoctor final : public QObject
{
    Q_OBJECT
public:
    explicit FileDoctor(Workspace& workspace, QObject* parent = nullptr);

    /// Of the file that holds the document now. Null while not known, and where an edit came first: then the points
    /// are no longer those of the file.
    const Inspection* of(const Document& document) const;

    /// Writes what repairFile() makes of the document's file, and says what was mended and what was left. The open
    /// document stays as it is.
    void repair(const Document& document, const QString& path);

signals:
    void examined(const punctum::ui::Document* document);

private:
    void examine(Document& document);

    Workspace& m_workspace;
    struct Look {
        JobId job = 0;  ///< that looks; 0: none
        std::shared_ptr<const Inspection> found;
    };
    std::map<const Document*, Look> m_looks;
};

}  // namespace punctum::ui
