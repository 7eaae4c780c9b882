// SPDX-License-Identifier: MIT
#pragma once

#include "ui/maps/MapChoice.h"

#include <QObject>
#include <QString>

class QWidget;

namespace punctum::ui
{

class WindowSettings;
class Workspace;

/// Maps of the active document as files: what a dialog asks for, made and written by a job, whole or not at all.
///
/// GUI thread only; every call returns at once. A child of the window; borrows what it is made with.
class Maps final : public QObject
{
    Q_OBJECT
public:
    Maps(QWidget& window, Workspace& workspace, WindowSettings& settings);

    /// Asks which map it is to be, then where to put it.
    void choose();
    /// Of the active document.
    void save(const QString& path, const MapChoice& choice);

private:
    QWidget& m_window;
    Workspace& m_workspace;
    WindowSettings& m_settings;
};

}  // namespace punctum::ui
