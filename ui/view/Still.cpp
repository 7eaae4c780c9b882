// SPDX-License-Identifier: MIT
#include "ui/view/Still.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <new>

namespace punctum::ui
{

namespace
{

constexpr std::uint64_t kParts = 1000;  ///< of a picture, as progress is told

}  // namespace

StillPicture Still::wait(Progress& progress)
{
    progress.begin("Drawing all points", kParts);
    std::uint64_t told = 0;
    std::unique_lock lock(m_mutex);
    while (!m_arrived.wait_for(lock, std::chrono::milliseconds(50),
                               [this] { return m_picture.has_value() || !m_failure.empty(); })) {
        if (progress.cancelled()) m_cancelled = true;
        progress.check();
        const auto now = std::uint64_t(m_share * kParts);
        if (now > told) progress.add(now - told);
        told = std::max(told, now);
    }
    if (!m_picture) throw Error(m_failure);
    StillPicture picture = std::move(*m_picture);
    return picture;
}

void Still::deliver(StillPicture picture)
{
    {
        const std::lock_guard lock(m_mutex);
        m_picture = std::move(picture);
    }
    m_arrived.notify_all();
}

void Still::refuse(const std::string& sentence)
{
    {
        const std::lock_guard lock(m_mutex);
        m_failure = sentence;
    }
    m_arrived.notify_all();
}

StillDrawing::StillDrawing(std::shared_ptr<Still> still, std::span<const DrawnCloud> clouds)
    : m_still(std::move(still)), m_renderer(render::makeBackend(render::BackendKind::Cpu))
{
    m_renderer.setDisplay(m_still->request().display);
    m_renderer.setCamera(m_still->request().camera);
    for (const DrawnCloud& cloud : clouds) {
        m_renderer.addCloud(cloud.store);
        if (!cloud.loading) m_renderer.loadingEnded(cloud.store->cloud(), cloud.store->bounds());
        m_renderer.setSurface(cloud.store->cloud(), cloud.surface);
    }
}

StillDrawing::~StillDrawing()
{
    refuse("The view ended before its picture was finished.");
}

void StillDrawing::attributeChosen(const std::string& name)
{
    if (name != m_still->request().display.attribute)
        refuse("Another attribute was chosen before the picture was finished; export it again.");
}

void StillDrawing::refuse(const std::string& sentence)
{
    if (!std::exchange(m_over, true)) m_still->refuse(sentence);
}

bool StillDrawing::draw(std::span<const DrawnCloud> clouds, double seconds)
{
    if (m_over || m_still->cancelled()) return m_over = true;
    if (anyLoading(clouds)) return false;
    try {
        const StillRequest& request = m_still->request();
        if (!m_picture) m_picture.emplace(m_renderer, request.width, request.height);
        const bool finished = m_picture->draw(seconds);
        m_still->setShare(m_picture->share());
        if (!finished) return false;
        m_still->deliver({m_picture->takeImage(), m_renderer.range(), toQString(m_renderer.shownAttribute())});
        m_over = true;
    } catch (const std::bad_alloc&) {
        refuse("There is not enough memory for a picture of this size.");
    } catch (const std::exception& e) {
        refuse(e.what());
    }
    return true;
}

}  // namespace punctum::ui
