// SPDX-License-Identifier: MIT
#pragma once

#include <QObject>

#include <cstddef>
#include <vector>

class QWidget;

namespace punctum::ui
{

class Document;
class Framing;
class Workspace;

/// What the window does with a survey as a whole, beside what it does with any document: save it into a folder or
/// as one file, and go on without some of its files. GUI thread only; a child of the window, borrows the others.
class SurveyCommands final : public QObject
{
    Q_OBJECT
public:
    SurveyCommands(QWidget& window, Workspace& workspace, Framing& framing);

    /// Asks for a folder, where each file is written under its name.
    void saveIntoFolder(Document& document);
    /// Asks for a file, into which all points are written.
    void saveAsOneFile(Document& document);
    /// Closes the survey, which has no unsaved changes, and opens it again without these files; the view stays
    /// where it is.
    void remove(Document& document, const std::vector<std::size_t>& parts);

private:
    QWidget& m_window;
    Workspace& m_workspace;
    Framing& m_framing;
};

}  // namespace punctum::ui
