// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <QObject>

#include <cstdint>
#include <map>
#include <utility>

namespace punctum::ui
{

class Document;
class Viewport;
class Workspace;

/// Sees to it that the main view shows what is open: a file that is opened, what is left when one is closed. A view
/// that the user has turned is the user's.
///
/// GUI thread only; borrows both.
class Framing final : public QObject
{
    Q_OBJECT
public:
    Framing(Workspace& workspace, Viewport& viewport, QObject* parent = nullptr);

    /// Shows the whole active document.
    void fitActive();

private:
    void updateSceneBounds();
    void fitFor(const Document& document);
    bool showsAnything() const;
    void documentAdded(Document* document);
    void documentLoaded(Document* document);
    void documentRemoved(Document* document, bool openingFailed);

    Workspace& m_workspace;
    Viewport& m_viewport;
    /// Where the camera was before a file began to open, in case that fails; and how often the user had moved it.
    std::map<Document*, std::pair<render::Camera, std::uint64_t>> m_camerasBefore;
};

}  // namespace punctum::ui
