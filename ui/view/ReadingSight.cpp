// SPDX-License-Identifier: MIT
#include "ui/view/ReadingSight.h"

#include "core/session/Session.h"
#include "render/camera/Sight.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <utility>

namespace punctum::ui
{

namespace
{

constexpr int kTellEvery = 100;  // ms: those who read sort anew each time

}  // namespace

ReadingSight::ReadingSight(Workspace& workspace, Viewport& viewport, const ViewSettings& settings, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_viewport(viewport), m_settings(settings)
{
    m_pause.setSingleShot(true);
    connect(&m_pause, &QTimer::timeout, this, &ReadingSight::tell);
    connect(&viewport, &Viewport::cameraChanged, this, &ReadingSight::moved);
    connect(&settings, &ViewSettings::changed, this, &ReadingSight::moved);
    connect(&workspace, &Workspace::documentAdded, this, &ReadingSight::moved);
}

void ReadingSight::moved()
{
    const qint64 since = m_told.isValid() ? m_told.elapsed() : kTellEvery;
    if (since >= kTellEvery)
        tell();
    else if (!m_pause.isActive())
        m_pause.start(int(kTellEvery - since));
}

void ReadingSight::tell()
{
    m_pause.stop();
    ReadingOrder::Sight sight;
    bool made = false;
    for (const auto& document : m_workspace.documents()) {
        if (!document->loading()) continue;
        if (!std::exchange(made, true) && !m_viewport.fitted()) {
            const QSize size = m_viewport.pictureSize();
            sight = render::sightOf(m_viewport.camera(), {size.width(), size.height()}, m_settings.display().clip);
        }
        document->session()->readingOrder()->look(sight);
        m_told.start();
    }
}

}  // namespace punctum::ui
