// SPDX-License-Identifier: MIT
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

namespace punctum::ui
{

class ViewSettings;
class Viewport;
class Workspace;

/// Tells the files that are being read what the view looks at, so that it comes first (ReadingOrder). While the
/// view shows all, they are read as if nobody looked: spread over all of it. Some times a second at most. GUI
/// thread only; borrows all that it is given.
class ReadingSight final : public QObject
{
    Q_OBJECT
public:
    ReadingSight(Workspace& workspace, Viewport& viewport, const ViewSettings& settings, QObject* parent = nullptr);

private:
    void moved();
    void tell();

    Workspace& m_workspace;
    Viewport& m_viewport;
    const ViewSettings& m_settings;
    QTimer m_pause;
    QElapsedTimer m_told;  ///< since it was told last
};

}  // namespace punctum::ui
