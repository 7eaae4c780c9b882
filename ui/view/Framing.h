// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/ShownExtent.h"
#include "core/task/Jobs.h"
#include "render/camera/Camera.h"

#include <QObject>
#include <QPointer>
#include <QTimer>

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace punctum::ui
{

class Document;
class ViewFilter;
class Viewport;
class Workspace;

/// Sees to it that the main view shows what is open: a file that is opened, what is left when one is closed, and
/// what *Fit* asks for. A view that the user has turned is the user's.
///
/// Fitting goes by the points that are shown, which a job looks at, and leaves out strays (ShownExtent): a second
/// *Fit* brings them into the view. GUI thread only; borrows all.
class Framing final : public QObject
{
    Q_OBJECT
public:
    Framing(Workspace& workspace, const ViewFilter& filter, Viewport& viewport, QObject* parent = nullptr);

    /// Shows all points of all files that are shown; where the view does so already, strays as well, and back.
    void fitAll();
    /// The same of the active document.
    void fitActive();
    /// Deletes the strays of the active document, by a job, as a step that can be undone; the view is fitted to
    /// what is left of it.
    void removeStrays();
    /// The document that is opened next leaves the view where it is: it goes on with one that is closed for it.
    void keepViewOnce() { m_keepOnce = true; }

private:
    using Found = std::function<void(const ShownExtent&)>;
    /// Looks at the shown points of these documents; `found` is not called when that is cancelled, or another fit
    /// was asked for meanwhile.
    void find(const std::vector<Document*>& documents, JobTurn turn, Found found);
    void fitTo(const ShownExtent& extent);
    void fitShown(const std::vector<Document*>& documents);
    /// Of a document, without strays as far as they are known.
    WorldBounds boundsOf(const Document& document) const;
    void updateSceneBounds();
    void fitFor(const Document& document);
    /// After a file came or changed: updateSceneBounds(), and fitFor() it where `fit` is set. Once for all that
    /// happens together where many files are open, as each looks at all of them.
    void refresh(Document* fit);
    bool showsAnything() const;
    void documentAdded(Document* document);
    void documentLoaded(Document* document);
    void documentRemoved(Document* document, bool openingFailed);

    Workspace& m_workspace;
    const ViewFilter& m_filter;
    Viewport& m_viewport;
    /// Where the camera was before a file began to open, in case that fails; and how often the user had moved it.
    std::map<Document*, std::pair<render::Camera, std::uint64_t>> m_camerasBefore;
    std::map<const Document*, ShownExtent> m_extents;  ///< as they were found when the file had been read
    ShownExtent m_fitted;                              ///< what was fitted last
    bool m_fittedAll = false;                          ///< with its strays
    std::uint64_t m_request = 0;                       ///< the newest fit
    bool m_keepOnce = false;
    QTimer m_refresh;
    QPointer<Document> m_refreshFit;   ///< that the view is fitted for then, unless the user ...
    std::uint64_t m_refreshMoves = 0;  ///< ... has moved it since
};

}  // namespace punctum::ui
