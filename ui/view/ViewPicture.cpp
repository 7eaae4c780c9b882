// SPDX-License-Identifier: MIT
#include "ui/view/ViewPicture.h"

#include "render/store/PointStore.h"
#include "ui/basic/Numbers.h"
#include "ui/basic/Text.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>
#include <shared_mutex>
#include <utility>
#include <vector>

namespace punctum::ui
{

namespace
{

constexpr double kWaitedFrame = 0.05;     // s: a picture that somebody waits for, whatever the budget of frames
constexpr double kLoadingPatience = 0.3;  // s

QString pickedValue(const Attribute& attribute, PointIndex index)
{
    QStringList parts;
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        parts << (attribute.kind == AttributeKind::Vector
                      ? localNumber(QString::number(attribute.number(index, c), 'f', 3))
                      : shownValueOf(attribute, index, c));
    return parts.join(QStringLiteral(", "));
}

template <typename Item>
Item takeFirst(std::vector<Item>& list)
{
    Item first = std::move(list.front());
    list.erase(list.begin());
    return first;
}

}  // namespace

/// Frames that nobody looks at any more, to be filled again: a picture is some megabytes, sixty times a second.
/// Frames come back from any thread.
class FramePool
{
public:
    static std::shared_ptr<Frame> take(const std::shared_ptr<FramePool>& pool)
    {
        std::unique_ptr<Frame> frame;
        {
            const std::lock_guard lock(pool->m_mutex);
            if (!pool->m_free.empty()) {
                frame = std::move(pool->m_free.back());
                pool->m_free.pop_back();
            }
        }
        if (!frame) frame = std::make_unique<Frame>();
        return {frame.release(), [pool](Frame* used) {
                    std::unique_ptr<Frame> back(used);
                    const std::lock_guard lock(pool->m_mutex);
                    if (pool->m_free.size() < 3) pool->m_free.push_back(std::move(back));
                }};
    }

private:
    std::mutex m_mutex;
    std::vector<std::unique_ptr<Frame>> m_free;
};

bool anyLoading(std::span<const DrawnCloud> clouds)
{
    return std::any_of(clouds.begin(), clouds.end(), [](const DrawnCloud& c) { return c.loading; });
}

ViewPicture::ViewPicture(const ViewRenderer* view, Publish publish)
    : m_view(view), m_publish(std::move(publish)), m_pool(std::make_shared<FramePool>())
{
}

ViewPicture::~ViewPicture()
{
    refuse();
}

void ViewPicture::apply(const ViewWish& wish)
{
    if (wish.size) renderer->setSize(wish.size->first, wish.size->second);
    if (wish.camera) renderer->setCamera(*wish.camera);
    if (wish.display) renderer->setDisplay(*wish.display);
    dirty = true;
}

void ViewPicture::askSnapshot(std::shared_ptr<const PointCloud> cloud, SnapshotDone done)
{
    m_snapshots.push_back({std::move(cloud), std::move(done)});
}

void ViewPicture::refuse()
{
    for (const Snapshot& wanted : std::exchange(m_snapshots, {})) wanted.done(nullptr);
}

void ViewPicture::renderNext(std::span<const DrawnCloud> clouds, double seconds)
{
    if (std::exchange(fresh, false)) apply(known);
    const bool loading = anyLoading(clouds);
    if (wantsFrame(loading)) {
        dirty = false;
        const render::FrameReport report = renderer->renderFrame(seconds);
        if (renderer->hasPicture()) publish(report);
    }
    if (!renderer->converged()) return;
    serveSnapshots(clouds);
}

void ViewPicture::finishAndServe(std::span<const DrawnCloud> clouds)
{
    if (m_snapshots.empty() || !renderer || broken) return;
    if (std::exchange(fresh, false)) apply(known);
    // While points arrive no picture is ever finished: what is there is what was drawn on.
    converge(anyLoading(clouds) ? kLoadingPatience : std::numeric_limits<double>::infinity());
    serveSnapshots(clouds);
}

void ViewPicture::converge(double most)
{
    const auto start = std::chrono::steady_clock::now();
    while (!renderer->renderFrame(kWaitedFrame).converged &&
           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < most) {
    }
}

void ViewPicture::publish(const render::FrameReport& report)
{
    const auto frame = FramePool::take(m_pool);
    frame->texture = nullptr;
    if (m_textures != nullptr && renderer->onDevice()) {
        const render::TargetSize size = renderer->backend().target();
        const std::shared_ptr<FrameTexture> texture = m_textures->take(size.width, size.height);
        if (renderer->copyPicture(texture->id())) frame->texture = texture;
    }
    if (frame->texture)
        frame->image = {};
    else
        frame->image = renderer->image();
    frame->camera = renderer->camera();
    frame->report = report;
    frame->range = renderer->range();
    frame->attribute = toQString(renderer->shownAttribute());
    frame->number = ++m_frames;
    m_publish(frame);
}

void ViewPicture::serveSnapshots(std::span<const DrawnCloud> clouds)
{
    while (!m_snapshots.empty()) {
        // Each is answered, whatever fails: somebody waits for it. Those after it are refused then.
        const Snapshot wanted = takeFirst(m_snapshots);
        std::shared_ptr<ViewSnapshot> view;
        try {
            for (const DrawnCloud& entry : clouds)
                if (&entry.store->cloud() == wanted.cloud.get()) view = snapshotOf(wanted.cloud);
        } catch (...) {
            wanted.done(nullptr);
            throw;
        }
        wanted.done(std::move(view));
    }
}

std::shared_ptr<ViewSnapshot> ViewPicture::snapshotOf(const std::shared_ptr<const PointCloud>& cloud)
{
    auto view = std::make_shared<ViewSnapshot>();
    view->cloud = cloud;
    view->projection = renderer->projectionOf(*cloud);
    const PictureProjection& p = view->projection;
    const glm::dvec3 pivot = cloud->coordinates().toRaw(renderer->camera().pivot) - p.base;
    view->pivotDepth = glm::dot(glm::dvec3(p.rowD), pivot) + p.rowD.w;
    view->visible = std::make_shared<PointSet>(renderer->visiblePoints(*cloud));
    return view;
}

std::optional<PickedPoint> ViewPicture::pick(int x, int y, int radius, std::span<const DrawnCloud> clouds) const
{
    const auto hit = renderer ? renderer->pick(x, y, radius) : std::nullopt;
    if (!hit || hit->cloud >= clouds.size()) return std::nullopt;
    const auto& store = clouds[hit->cloud].store;
    const PointCloud& cloud = store->cloud();
    PickedPoint picked;
    picked.cloud = std::shared_ptr<const PointCloud>(store, &cloud);
    picked.index = hit->index;
    picked.world = hit->world;
    const std::shared_lock lock(cloud.mutex());
    if (const Attribute* classes = cloud.findAttribute("Classification"))
        picked.classCode = unsigned(std::clamp(classes->number(hit->index), 0.0, 255.0));
    const std::string shown = renderer->shownAttribute();
    if (const Attribute* attribute = cloud.findAttribute(shown)) {
        picked.attribute = toQString(shown);
        picked.value = pickedValue(*attribute, hit->index);
    }
    return picked;
}

}  // namespace punctum::ui
