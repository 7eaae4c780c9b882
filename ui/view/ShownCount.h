// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "core/task/Jobs.h"

#include <QObject>
#include <QStringList>
#include <QTimer>

namespace punctum::render
{
struct FrameReport;
}

namespace punctum::ui
{

class ViewFilter;
class ViewSettings;
class Workspace;

/// How many points a view shows of those that there are, and why not all.
struct ShownState {
    PointIndex all = 0;      ///< of the files that are loaded, deleted points among them
    PointIndex shown = 0;    ///< of them
    bool known = true;       ///< false: `shown` is being counted
    QStringList reasons;     ///< choices that hide some, and can be taken back: "filter", "2 classes"
    PointIndex deleted = 0;  ///< that is a reason, too

    /// Whether some points are hidden, or may be.
    bool some() const noexcept { return (!reasons.isEmpty() || deleted != 0) && (!known || shown != all); }
    /// "26,107 of 110,000 shown: filter, 1 class"; empty when all are shown.
    QString text() const;
};

/// How many points of the open files the view shows, and what hides the others: filter, files, box, cuts, classes,
/// and that they are deleted. Counted anew by a job, a moment after anything of it has changed. GUI thread only;
/// borrows all that it is given.
class ShownCount final : public QObject
{
    Q_OBJECT
public:
    ShownCount(Workspace& workspace, const ViewSettings& settings, const ViewFilter& filter,
               QObject* parent = nullptr);

    const ShownState& state() const noexcept { return m_state; }
    /// What the status bar says of a picture.
    QString progressText(const render::FrameReport& report) const;

signals:
    void changed();

private:
    void lookAtSettings();
    void ask();
    void count();
    void publish(ShownState state);

    Workspace& m_workspace;
    const ViewSettings& m_settings;
    const ViewFilter& m_filter;
    ShownState m_state;
    std::array<bool, 256> m_classes{};  ///< as they were last looked at
    Clip m_clip;
    QTimer m_pause;
    JobId m_job = 0;
    bool m_again = false;
};

}  // namespace punctum::ui
