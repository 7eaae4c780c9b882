// SPDX-License-Identifier: MIT
#include "ui/ViewRenderer.h"

#include "core/Error.h"
#include "render/gl/EglContext.h"
#include "render/raster/BackendChoice.h"
#include "render/store/PointStore.h"
#include "ui/Text.h"

#include <QPointer>

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <shared_mutex>

namespace punctum::ui
{

namespace
{

/// Between two frames of a still camera while points arrive: most of the processor belongs to loading then.
constexpr std::chrono::milliseconds kLoadingPause(60);
/// Nobody waits for a picture: time to measure what draws fastest.
constexpr std::chrono::seconds kQuiet(3);

QString pickedValue(const Attribute& attribute, PointIndex index)
{
    QStringList parts;
    for (std::uint32_t c = 0; c < attribute.components; ++c)
        parts << (attribute.kind == AttributeKind::Vector ? QString::number(attribute.number(index, c), 'f', 3)
                                                          : valueText(attribute.value(index, c)));
    return parts.join(QStringLiteral(", "));
}

}  // namespace

/// Frames that nobody looks at any more, to be filled again: a picture is some megabytes, sixty times a second.
struct ViewRenderer::Pool {
    std::mutex mutex;
    std::vector<std::unique_ptr<Frame>> free;

    static std::shared_ptr<Frame> take(const std::shared_ptr<Pool>& pool)
    {
        std::unique_ptr<Frame> frame;
        {
            const std::lock_guard lock(pool->mutex);
            if (!pool->free.empty()) {
                frame = std::move(pool->free.back());
                pool->free.pop_back();
            }
        }
        if (!frame) frame = std::make_unique<Frame>();
        return {frame.release(), [pool](Frame* used) {
                    std::unique_ptr<Frame> back(used);
                    const std::lock_guard lock(pool->mutex);
                    if (pool->free.size() < 3) pool->free.push_back(std::move(back));
                }};
    }
};

/// What only the render thread touches.
struct ViewRenderer::Thread {
    struct Cloud {
        std::shared_ptr<render::PointStore> store;
        bool loading = true;
    };
    struct Capture {
        bool transparent = false;
        CaptureDone done;
    };

    render::EglContext context;  // before renderer: its backend needs the context to the end; empty on the CPU
    std::unique_ptr<render::ProgressiveRenderer> renderer;
    render::BackendKind kind = render::BackendKind::Cpu;
    FastestBackend fastest;
    std::optional<render::BackendKind> chosen;              ///< by the user; none: the fastest
    render::BackendKind wanted = render::BackendKind::Cpu;  ///< what applyChoice() asked for; `kind` draws
    bool measured = false;                                  ///< `fastest` is known to be of this machine
    std::vector<Cloud> clouds;                              ///< in the renderer's order
    struct Snapshot {
        std::shared_ptr<const PointCloud> cloud;
        std::function<void(std::shared_ptr<const ViewSnapshot>)> done;
    };
    std::vector<Capture> captures;
    std::vector<Snapshot> snapshots;
    double budget = 0.0166;  ///< s: sixty pictures a second
    bool dirty = false;      ///< a command changed what is to be seen
    bool broken = false;     ///< the backend failed; wait for a command
    std::uint64_t frames = 0;

    bool loading() const
    {
        return std::any_of(clouds.begin(), clouds.end(), [](const Cloud& c) { return c.loading; });
    }
    ~Thread()
    {
        for (Capture& capture : captures) capture.done(nullptr);
    }
};

ViewRenderer::ViewRenderer(std::optional<render::BackendKind> backend, FastestBackend fastest, QObject* parent)
    : QObject(parent),
      m_pool(std::make_shared<Pool>()),
      m_thread([this, backend, fastest = std::move(fastest)] { run(backend, fastest); })
{
}

ViewRenderer::~ViewRenderer()
{
    {
        const std::lock_guard lock(m_mutex);
        m_pending.stop = true;
    }
    m_wake.notify_one();
    m_thread.join();
}

// -- the GUI thread's side

void ViewRenderer::post(Command command)
{
    {
        const std::lock_guard lock(m_mutex);
        m_pending.commands.push_back(std::move(command));
    }
    m_wake.notify_one();
}

void ViewRenderer::setSize(int widthPx, int heightPx)
{
    {
        const std::lock_guard lock(m_mutex);
        m_pending.size = {widthPx, heightPx};
    }
    m_wake.notify_one();
}

void ViewRenderer::setCamera(const render::Camera& camera)
{
    {
        const std::lock_guard lock(m_mutex);
        m_pending.camera = camera;
    }
    m_wake.notify_one();
}

void ViewRenderer::setDisplay(const render::DisplaySettings& display)
{
    {
        const std::lock_guard lock(m_mutex);
        m_pending.display = display;
    }
    m_wake.notify_one();
}

void ViewRenderer::setBackend(std::optional<render::BackendKind> kind)
{
    post([this, kind](Thread& thread) {
        thread.chosen = kind;
        applyChoice(thread);
        thread.dirty = true;
    });
}

void ViewRenderer::setBudget(double seconds, PointIndex points)
{
    post([seconds, points](Thread& thread) {
        thread.budget = seconds;
        thread.renderer->setPointsAFrame(points);
    });
}

void ViewRenderer::addCloud(std::shared_ptr<render::PointStore> store)
{
    post([store = std::move(store)](Thread& thread) {
        thread.renderer->addCloud(store);
        thread.clouds.push_back({store, true});
        thread.dirty = true;
    });
}

void ViewRenderer::loadingEnded(std::shared_ptr<const PointCloud> cloud, const RawBounds& bounds)
{
    post([cloud = std::move(cloud), bounds](Thread& thread) {
        for (Thread::Cloud& entry : thread.clouds)
            if (&entry.store->cloud() == cloud.get()) entry.loading = false;
        thread.renderer->loadingEnded(*cloud, bounds);
        thread.dirty = true;
    });
}

void ViewRenderer::removeCloud(std::shared_ptr<const PointCloud> cloud)
{
    post([cloud = std::move(cloud)](Thread& thread) {
        thread.renderer->removeCloud(*cloud);
        std::erase_if(thread.clouds,
                      [&](const Thread::Cloud& entry) { return &entry.store->cloud() == cloud.get(); });
        thread.dirty = true;
    });
}

void ViewRenderer::valuesChanged(std::shared_ptr<const PointCloud> cloud, const ChangeNotice& notice)
{
    post([cloud = std::move(cloud), notice](Thread& thread) {
        thread.renderer->valuesChanged(*cloud, notice);
        thread.dirty = true;
    });
}

void ViewRenderer::hide(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> points)
{
    post([cloud = std::move(cloud), points = std::move(points)](Thread& thread) {
        thread.renderer->hide(*cloud, points.get());
        thread.dirty = true;
    });
}

void ViewRenderer::setSelection(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> selection)
{
    post([cloud = std::move(cloud), selection = std::move(selection)](Thread& thread) {
        thread.renderer->setSelection(*cloud, selection);
        thread.dirty = true;
    });
}

void ViewRenderer::snapshot(std::shared_ptr<const PointCloud> cloud, QObject* receiver, SnapshotReply reply)
{
    post([this, cloud = std::move(cloud), target = QPointer<QObject>(receiver),
          reply = std::move(reply)](Thread& thread) {
        thread.snapshots.push_back({cloud, [this, target, reply](std::shared_ptr<const ViewSnapshot> view) {
                                        // by way of this object, as in pick()
                                        QMetaObject::invokeMethod(
                                            this,
                                            [target, reply, view = std::move(view)] {
                                                if (target) reply(view);
                                            },
                                            Qt::QueuedConnection);
                                    }});
    });
}

void ViewRenderer::pick(int x, int y, QObject* receiver, PickReply reply)
{
    post([x, y, target = QPointer<QObject>(receiver), reply = std::move(reply), this](Thread& thread) {
        std::optional<PickedPoint> picked;
        if (const auto hit = thread.renderer->pick(x, y); hit && hit->cloud < thread.clouds.size()) {
            const auto& store = thread.clouds[hit->cloud].store;
            const PointCloud& cloud = store->cloud();
            picked.emplace();
            picked->cloud = std::shared_ptr<const PointCloud>(store, &cloud);
            picked->index = hit->index;
            picked->world = hit->world;
            const std::shared_lock lock(cloud.mutex());
            if (const Attribute* classes = cloud.findAttribute("Classification"))
                picked->classCode = unsigned(std::clamp(classes->number(hit->index), 0.0, 255.0));
            const std::string shown = thread.renderer->shownAttribute();
            if (const Attribute* attribute = cloud.findAttribute(shown)) {
                picked->attribute = toQString(shown);
                picked->value = pickedValue(*attribute, hit->index);
            }
        }
        // By way of this object: it outlives the thread, the receiver need not.
        QMetaObject::invokeMethod(
            this,
            [target, reply, picked] {
                if (target) reply(picked);
            },
            Qt::QueuedConnection);
    });
}

void ViewRenderer::capture(bool transparent, CaptureDone done)
{
    post([transparent, done = std::move(done)](Thread& thread) { thread.captures.push_back({transparent, done}); });
}

std::shared_ptr<const Frame> ViewRenderer::frame() const
{
    const std::lock_guard lock(m_mutex);
    return m_frame;
}

// -- the render thread

void ViewRenderer::announceFailure(const QString& sentence)
{
    QMetaObject::invokeMethod(
        this, [this, sentence] { emit failed(sentence); }, Qt::QueuedConnection);
}

void ViewRenderer::useBackend(Thread& thread, render::BackendKind kind)
{
    render::EglContext context;
    std::unique_ptr<render::RasterBackend> backend;
    try {
        if (render::needsGl(kind)) context = render::EglContext::create();
        backend = render::makeBackend(kind);
    } catch (const std::exception& e) {
        announceFailure(
            tr("OpenGL drawing is not possible here, so the CPU draws: %1").arg(QString::fromLocal8Bit(e.what())));
        context = render::EglContext();
        kind = render::BackendKind::Cpu;
        backend = render::makeBackend(kind);
    }
    if (thread.renderer) {
        // What the old backend has on the device goes while its own context is current.
        if (thread.context) thread.context.makeCurrent();
        thread.renderer->setBackend(std::move(backend));
        if (context) context.makeCurrent();
    } else {
        thread.renderer = std::make_unique<render::ProgressiveRenderer>(std::move(backend));
    }
    std::swap(thread.context, context);
    thread.kind = kind;
    thread.broken = false;
    QMetaObject::invokeMethod(
        this,
        [this, kind, text = toQString(thread.renderer->backend().description())] {
            emit backendChanged(kind, text);
        },
        Qt::QueuedConnection);
}

void ViewRenderer::applyChoice(Thread& thread)
{
    using render::BackendKind;
    BackendKind kind = thread.chosen.value_or(thread.fastest.device ? thread.fastest.kind : BackendKind::Cpu);
    if (thread.renderer && thread.renderer->display().averaged) kind = BackendKind::Cpu;  // it alone averages
    if (thread.renderer && thread.wanted == kind) return;
    thread.wanted = kind;
    if (!thread.renderer || thread.kind != kind) useBackend(thread, kind);
}

void ViewRenderer::measureBackends(Thread& thread)
{
    thread.measured = true;
    const render::BackendMeasurement measurement = render::measureBackends(thread.fastest.device);
    if (thread.context) thread.context.makeCurrent();
    if (measurement.device == thread.fastest.device) return;
    thread.fastest = {measurement.fastest, measurement.device};
    QMetaObject::invokeMethod(
        this, [this, fastest = thread.fastest] { emit backendsMeasured(fastest); }, Qt::QueuedConnection);
    const render::BackendKind before = thread.kind;
    applyChoice(thread);
    thread.dirty = thread.dirty || thread.kind != before;
}

void ViewRenderer::run(std::optional<render::BackendKind> backend, FastestBackend fastest)
{
    Thread thread;
    thread.fastest = std::move(fastest);
    thread.chosen = backend;
    applyChoice(thread);
    bool idle = true;
    bool calm = false;
    for (;;) {
        Pending pending;
        {
            std::unique_lock lock(m_mutex);
            const auto wanted = [this] { return m_pending.any(); };
            if (idle && !thread.chosen && !thread.measured) {
                if (!m_wake.wait_for(lock, kQuiet, wanted)) {
                    lock.unlock();
                    measureBackends(thread);
                    idle = !thread.dirty;
                    continue;
                }
            } else if (idle)
                m_wake.wait(lock, wanted);
            else if (calm)
                m_wake.wait_for(lock, kLoadingPause, wanted);
            std::swap(pending, m_pending);
        }
        if (pending.stop) return;
        try {
            for (Command& command : pending.commands) command(thread);
            if (pending.size) thread.renderer->setSize(pending.size->first, pending.size->second);
            if (pending.camera) thread.renderer->setCamera(*pending.camera);
            if (pending.display) {
                thread.renderer->setDisplay(*pending.display);
                applyChoice(thread);
            }
            thread.dirty = thread.dirty || pending.size || pending.camera || pending.display;
            if (thread.dirty) thread.broken = false;
            if (!thread.broken) renderNext(thread);
        } catch (const std::exception& e) {
            if (thread.kind != render::BackendKind::Cpu) {
                announceFailure(tr("OpenGL drawing failed, so the CPU draws from here on: %1")
                                    .arg(QString::fromLocal8Bit(e.what())));
                useBackend(thread, render::BackendKind::Cpu);
                thread.dirty = true;
            } else {
                announceFailure(QString::fromLocal8Bit(e.what()));
                thread.broken = true;
                thread.dirty = false;
            }
        }
        if (thread.broken)
            for (const Thread::Snapshot& wanted : std::exchange(thread.snapshots, {})) wanted.done(nullptr);
        const bool loading = thread.loading();
        idle = thread.broken || (!thread.dirty && !loading && thread.renderer->converged());
        calm = loading && !pending.camera;
    }
}

void ViewRenderer::renderNext(Thread& thread)
{
    const bool finished = thread.renderer->converged() && !thread.dirty;
    if (!finished || thread.loading()) {
        thread.dirty = false;
        const render::FrameReport report = thread.renderer->renderFrame(thread.budget);
        if (thread.renderer->image().width > 0) publish(thread, report);
    }
    if (thread.renderer->converged()) serveSnapshots(thread);
    if (!thread.captures.empty() && thread.renderer->converged() && !thread.loading()) serveCaptures(thread);
}

void ViewRenderer::serveSnapshots(Thread& thread)
{
    for (const Thread::Snapshot& wanted : std::exchange(thread.snapshots, {})) {
        std::shared_ptr<ViewSnapshot> view;
        for (const Thread::Cloud& entry : thread.clouds) {
            if (&entry.store->cloud() != wanted.cloud.get()) continue;
            view = std::make_shared<ViewSnapshot>();
            view->cloud = wanted.cloud;
            view->projection = thread.renderer->projectionOf(*wanted.cloud);
            const PictureProjection& p = view->projection;
            const glm::dvec3 pivot = wanted.cloud->coordinates().toRaw(thread.renderer->camera().pivot) - p.base;
            view->pivotDepth = glm::dot(glm::dvec3(p.rowD), pivot) + p.rowD.w;
            view->visible = std::make_shared<PointSet>(thread.renderer->visiblePoints(*wanted.cloud));
        }
        wanted.done(std::move(view));
    }
}

void ViewRenderer::serveCaptures(Thread& thread)
{
    const render::DisplaySettings shown = thread.renderer->display();
    for (Thread::Capture& capture : std::exchange(thread.captures, {})) {
        if (capture.transparent) {
            render::DisplaySettings bare = shown;
            bare.backgroundTop.a = bare.backgroundBottom.a = 0;
            thread.renderer->setDisplay(bare);
            while (!thread.renderer->renderFrame(thread.budget).converged) {
            }
        }
        capture.done(std::make_shared<render::Image>(thread.renderer->image()));
        if (capture.transparent) {
            thread.renderer->setDisplay(shown);
            while (!thread.renderer->renderFrame(thread.budget).converged) {
            }
        }
    }
}

void ViewRenderer::publish(Thread& thread, const render::FrameReport& report)
{
    const auto frame = Pool::take(m_pool);
    frame->image = thread.renderer->image();
    frame->camera = thread.renderer->camera();
    frame->report = report;
    frame->range = thread.renderer->range();
    frame->attribute = toQString(thread.renderer->shownAttribute());
    frame->number = ++thread.frames;
    bool announce = false;
    {
        const std::lock_guard lock(m_mutex);
        m_frame = frame;
        announce = !std::exchange(m_announced, true);
    }
    if (!announce) return;
    QMetaObject::invokeMethod(
        this,
        [this] {
            {
                const std::lock_guard lock(m_mutex);
                m_announced = false;
            }
            emit frameReady();
        },
        Qt::QueuedConnection);
}

}  // namespace punctum::ui
