// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/CommandPreview.h"
#include "core/session/Session.h"
#include "core/task/Jobs.h"

#include <QObject>
#include <QString>

#include <memory>
#include <optional>

namespace punctum::ui
{

class Document;
class ViewRenderer;
class ViewSettings;
class Workspace;
struct StepWish;

/// Makes a step's command by a job, and shows in all views how the points would look after it, until it is ended:
/// by end(), by any change of the document, by another document or another attribute that is shown. What was made
/// is handed out to be done, as long as it is true. And shows the state before: while a preview stands, the points
/// as they are; else as they were before the last edit.
///
/// GUI thread only; every call returns at once.
class StepPreview final : public QObject
{
    Q_OBJECT
public:
    StepPreview(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings,
                QObject* parent = nullptr);

    /// Instead of the one before.
    void begin(Document& document, const StepWish& wish);
    void end();
    /// It is shown, or being worked out.
    bool on() const noexcept { return m_cloud != nullptr; }
    bool shown() const noexcept { return m_found != nullptr; }
    JobId job() const noexcept { return m_job; }
    /// The command of what is shown; the preview ends. Nothing when none is.
    std::optional<MadeEdit> take();

    /// As long as somebody wants to see what was before.
    void showBefore(bool on);
    bool showsBefore() const noexcept { return m_before; }

signals:
    /// What would change, or why nothing can be shown.
    void told(const QString& sentence);
    void failed(const QString& sentence);
    void toggled(bool on);
    void beforeToggled(bool on);

private:
    struct Found {
        MadeEdit made;
        CommandPreview preview;
    };
    void show();
    void display(const std::shared_ptr<PointCloud>& cloud, const CommandPreview* preview);
    void tell();
    void showLastEdit();
    void endLastEdit();

    Workspace& m_workspace;
    ViewRenderer& m_renderer;
    std::shared_ptr<PointCloud> m_cloud;
    std::shared_ptr<Found> m_found;
    JobId m_job = 0;
    std::uint64_t m_number = 0;  ///< of the preview: what a job brings for one before is dropped
    bool m_before = false;
    std::shared_ptr<PointCloud> m_beforeCloud;  ///< of which the state before the last edit is shown
    JobId m_beforeJob = 0;
    std::uint64_t m_beforeNumber = 0;
};

}  // namespace punctum::ui
