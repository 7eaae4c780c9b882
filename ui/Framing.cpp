// SPDX-License-Identifier: MIT
#include "ui/Framing.h"

#include "ui/Viewport.h"
#include "ui/Workspace.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr double kNeighbors = 20.0;  // times the largest file's extent
constexpr double kSpeck = 8.0;       // px: what is smaller cannot be seen

}  // namespace

Framing::Framing(Workspace& workspace, Viewport& viewport, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_viewport(viewport)
{
    connect(&workspace, &Workspace::documentAdded, this, &Framing::documentAdded);
    connect(&workspace, &Workspace::documentLoaded, this, &Framing::documentLoaded);
    connect(&workspace, &Workspace::documentRemoved, this, &Framing::documentRemoved);
    connect(&workspace, &Workspace::documentStateChanged, this, &Framing::updateSceneBounds);
}

void Framing::updateSceneBounds()
{
    WorldBounds all;
    for (const Document* document : m_workspace.documents()) all.include(document->bounds());
    const auto& documents = m_workspace.documents();
    m_viewport.setSceneBounds(all, documents.empty() ? glm::dvec3(1.0) : documents.front()->viewStretch(all));
}

void Framing::fitFor(const Document& document)
{
    // Neighbors are shown together; of surveys far apart this one, because both would be specks.
    WorldBounds all = document.bounds();
    double largest = 0.0;
    for (const Document* other : m_workspace.documents()) {
        all.include(other->bounds());
        if (!other->bounds().empty())
            largest = std::max(largest, glm::length(other->bounds().max - other->bounds().min));
    }
    const bool together = all.empty() || glm::length(all.max - all.min) <= kNeighbors * largest;
    m_viewport.fitTo(together ? all : document.bounds(), false);
}

bool Framing::showsAnything() const
{
    const QSize size = m_viewport.pictureSize();
    const auto& documents = m_workspace.documents();
    return std::any_of(documents.begin(), documents.end(), [&](const Document* document) {
        return m_viewport.camera().seenSize(document->bounds(), {size.width(), size.height()}) >= kSpeck;
    });
}

void Framing::fitActive()
{
    if (const Document* active = m_workspace.active()) m_viewport.fitTo(active->bounds());
}

void Framing::documentAdded(Document* document)
{
    m_camerasBefore[document] = {m_viewport.camera(), m_viewport.userMoves()};
    updateSceneBounds();
    fitFor(*document);
}

void Framing::documentLoaded(Document* document)
{
    updateSceneBounds();
    // The header's box was only a first idea.
    if (m_camerasBefore[document].second == m_viewport.userMoves()) fitFor(*document);
    m_camerasBefore.erase(document);
}

void Framing::documentRemoved(Document* document, bool openingFailed)
{
    updateSceneBounds();
    const auto found = m_camerasBefore.find(document);
    const auto before =
        found == m_camerasBefore.end() ? std::pair(render::Camera(), ~std::uint64_t(0)) : found->second;
    m_camerasBefore.erase(document);
    if (openingFailed && before.second == m_viewport.userMoves())
        m_viewport.setCamera(before.first);
    else if (m_workspace.active() && !showsAnything())  // of files far apart the one that was looked at is gone
        fitFor(*m_workspace.active());
}

}  // namespace punctum::ui
