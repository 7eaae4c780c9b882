// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"

#include <QObject>
#include <QString>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace punctum::ui
{

class Document;
class ViewRenderer;
class ViewSettings;
class Workspace;

/// Keeps the view's filter, a condition over attributes, applied to all open documents: finds the points for which
/// it does not hold by a job, tells the renderer, and does so again when values change. A document without one of
/// the attributes is shown whole. Points of files of a survey that are not to be seen, and deleted ones, are hidden
/// in any case.
///
/// GUI thread only; borrows all three, which must outlive it.
class ViewFilter final : public QObject
{
    Q_OBJECT
public:
    ViewFilter(Workspace& workspace, ViewRenderer& renderer, ViewSettings& settings, QObject* parent = nullptr);

    /// Empty: no filter. What is wrong with it comes by changed(), in error().
    void setText(const QString& text);
    const QString& text() const noexcept { return m_text; }
    /// Why the active document is shown whole; empty when it is not.
    QString error() const;
    /// Points of the active document that the filter hides; no number while it is worked out.
    std::optional<quint64> hiddenCount() const;

    /// The points of some document are being looked for; changed() comes when they are found.
    bool looking() const;

    /// All that the view hides of a document: classes, clip, files and filter. Edits by hand must leave those
    /// points alone: ask hiddenPoints() in a job.
    Visibility visibility(const Document& document) const;

signals:
    void changed();

private:
    struct State {
        std::shared_ptr<const PointSet> hidden;  ///< files not shown and deleted points among them
        quint64 count = 0;
        QString error;
        std::vector<std::string> attributes;  ///< that the condition reads
        quint64 job = 0;                      ///< 0: none runs
        quint64 version = 0;                  ///< of the wish that the job, or the set, answers
        bool again = false;                   ///< values changed while it ran
    };
    void apply(Document& document);
    void applyAnew(Document& document);
    const State* activeState() const;

    Workspace& m_workspace;
    ViewRenderer& m_renderer;
    ViewSettings& m_settings;
    QString m_text;
    quint64 m_version = 0;
    std::map<const Document*, State> m_states;
};

}  // namespace punctum::ui
