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
#include <future>
#include <shared_mutex>

namespace punctum::ui
{

namespace
{

/// Between two frames of a still camera while points arrive: most of the processor belongs to loading then.
constexpr std::chrono::milliseconds kLoadingPause(60);
/// Nobody waits for a picture: time to measure what draws fastest.
constexpr std::chrono::seconds kQuiet(3);

using StoreChange = render::ProgressiveRenderer::StoreChange;

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

/// One view, as the render thread knows it.
struct ViewRenderer::Picture {
    struct Capture {
        bool transparent = false;
        CaptureDone done;
    };
    struct Snapshot {
        std::shared_ptr<const PointCloud> cloud;
        std::function<void(std::shared_ptr<const ViewSnapshot>)> done;
    };

    ViewRenderer* view = nullptr;
    std::unique_ptr<render::ProgressiveRenderer> renderer;  ///< null while the view is off
    std::vector<Capture> captures;
    std::vector<Snapshot> snapshots;
    Wish known;           ///< the newest of each
    bool fresh = false;   ///< the renderer was told nothing of what is known
    bool dirty = false;   ///< something changed what is to be seen
    bool broken = false;  ///< the backend failed; wait for a change
    std::uint64_t frames = 0;
    std::optional<QString> failure;  ///< what happened in attempt(), until it is settled

    /// Whatever goes wrong is this view's failure.
    template <typename Work>
    void attempt(Work work)
    {
        try {
            work();
        } catch (const std::exception& e) {
            failure = QString::fromLocal8Bit(e.what());
        }
    }
    void apply(const Wish& wish)
    {
        if (wish.size) renderer->setSize(wish.size->first, wish.size->second);
        if (wish.camera) renderer->setCamera(*wish.camera);
        if (wish.display) renderer->setDisplay(*wish.display);
        dirty = true;
    }
    bool finished() const { return broken || !renderer || (!dirty && renderer->converged()); }
    /// While files load, there may be more to draw at any time.
    bool wantsFrame(bool loading) const { return !finished() || (loading && renderer && !broken); }
    void refuse()
    {
        for (const Snapshot& wanted : std::exchange(snapshots, {})) wanted.done(nullptr);
        for (const Capture& wanted : std::exchange(captures, {})) wanted.done(nullptr);
    }
};

/// What only the render thread touches.
struct ViewRenderer::Thread {
    struct Cloud {
        std::shared_ptr<render::PointStore> store;
        bool loading = true;
    };

    // Before the pictures: the first one's backend needs it to the end. Empty on the CPU.
    render::EglContext context;
    std::vector<std::unique_ptr<Picture>> pictures;  ///< the first view's first
    render::BackendKind kind = render::BackendKind::Cpu;
    FastestBackend fastest;
    std::optional<render::BackendKind> chosen;              ///< by the user; none: the fastest
    render::BackendKind wanted = render::BackendKind::Cpu;  ///< what applyChoice() asked for; `kind` draws
    bool measured = false;                                  ///< `fastest` is known to be of this machine
    std::vector<Cloud> clouds;                              ///< in the renderers' order
    double budget = 0.0166;                                 ///< s: sixty pictures a second

    Picture& first() { return *pictures.front(); }
    bool loading() const
    {
        return std::any_of(clouds.begin(), clouds.end(), [](const Cloud& c) { return c.loading; });
    }
    /// Calls change(renderer) for all that draw, and has their pictures made anew.
    template <typename Change>
    void forAll(Change change)
    {
        for (const auto& picture : pictures) {
            if (!picture->renderer) continue;
            picture->dirty = true;
            picture->attempt([&] { change(*picture->renderer); });
        }
    }
    /// Lets the first renderer change the stores, and tells the others.
    template <typename Change>
    void changeStores(render::ProgressiveRenderer::StoreChange what, Change change)
    {
        first().attempt([&] { change(*first().renderer); });
        forAll([&](render::ProgressiveRenderer& renderer) {
            if (&renderer != first().renderer.get()) renderer.storesChanged(what);
        });
    }
    ~Thread()
    {
        for (const auto& picture : pictures) picture->refuse();
    }
};

ViewRenderer::ViewRenderer(std::optional<render::BackendKind> backend, FastestBackend fastest, QObject* parent)
    : QObject(parent),
      m_first(*this),
      m_pool(std::make_shared<Pool>()),
      m_views{this},
      m_thread([this, backend, fastest = std::move(fastest)] { run(backend, fastest); })
{
}

ViewRenderer::ViewRenderer(ViewRenderer& first, QObject* parent)
    : QObject(parent), m_first(first), m_pool(std::make_shared<Pool>()), m_on(false)
{
    const std::lock_guard lock(m_first.m_mutex);
    m_first.m_views.push_back(this);
    m_first.m_commands.push_back({&m_first, [this](Thread& thread) {
                                      thread.pictures.push_back(std::make_unique<Picture>());
                                      thread.pictures.back()->view = this;
                                  }});
}

ViewRenderer::~ViewRenderer()
{
    if (&m_first == this) {
        {
            const std::lock_guard lock(m_mutex);
            m_stop = true;
        }
        m_wake.notify_one();
        m_thread.join();
        return;
    }
    const auto forgotten = std::make_shared<std::promise<void>>();
    {
        const std::lock_guard lock(m_first.m_mutex);
        std::erase(m_first.m_views, this);
    }
    m_first.post([this, forgotten](Thread& thread) {
        const auto own = std::find_if(thread.pictures.begin(), thread.pictures.end(),
                                      [this](const auto& picture) { return picture->view == this; });
        (*own)->refuse();
        thread.pictures.erase(own);
        forgotten->set_value();
    });
    forgotten->get_future().wait();
}

// -- the GUI thread's side

void ViewRenderer::post(std::function<void(Thread&)> command)
{
    {
        const std::lock_guard lock(m_first.m_mutex);
        m_first.m_commands.push_back({this, std::move(command)});
    }
    m_first.m_wake.notify_one();
}

template <typename Change>
void ViewRenderer::wish(Change change)
{
    {
        const std::lock_guard lock(m_first.m_mutex);
        change(m_wish);
    }
    m_first.m_wake.notify_one();
}

void ViewRenderer::setOn(bool on)
{
    {
        const std::lock_guard lock(m_first.m_mutex);
        if (m_on == on) return;
        m_on = on;
        if (!on) m_frame = nullptr;
    }
    post([this, on](Thread& thread) {
        Picture& picture = pictureOf(thread);
        if (!on) {
            picture.attempt([&] { finishAndServe(thread, picture); });
            picture.refuse();
            picture.renderer = nullptr;
            return;
        }
        picture.renderer =
            std::make_unique<render::ProgressiveRenderer>(render::makeBackend(render::BackendKind::Cpu));
        picture.renderer->setPointsAFrame(thread.first().renderer->pointsAFrame());
        for (const Thread::Cloud& cloud : thread.clouds) {
            picture.renderer->addCloud(cloud.store);
            if (!cloud.loading) picture.renderer->loadingEnded(cloud.store->cloud(), cloud.store->bounds());
        }
        // Told when the newest wishes are known: the one before might show another attribute, in all views.
        picture.fresh = picture.dirty = true;
    });
}

void ViewRenderer::setSize(int widthPx, int heightPx)
{
    wish([&](Wish& wish) { wish.size = {widthPx, heightPx}; });
}

void ViewRenderer::setCamera(const render::Camera& camera)
{
    wish([&](Wish& wish) { wish.camera = camera; });
}

void ViewRenderer::setDisplay(const render::DisplaySettings& display)
{
    wish([&](Wish& wish) { wish.display = display; });
}

void ViewRenderer::setBackend(std::optional<render::BackendKind> kind)
{
    post([this, kind](Thread& thread) {
        thread.chosen = kind;
        applyChoice(thread);
        thread.first().dirty = true;
    });
}

void ViewRenderer::setBudget(double seconds, PointIndex points)
{
    post([seconds, points](Thread& thread) {
        thread.budget = seconds;
        for (const auto& picture : thread.pictures)
            if (picture->renderer) picture->renderer->setPointsAFrame(points);
    });
}

void ViewRenderer::addCloud(std::shared_ptr<render::PointStore> store)
{
    post([store = std::move(store)](Thread& thread) {
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.addCloud(store); });
        thread.clouds.push_back({store, true});
    });
}

void ViewRenderer::loadingEnded(std::shared_ptr<const PointCloud> cloud, const RawBounds& bounds)
{
    post([cloud = std::move(cloud), bounds](Thread& thread) {
        for (Thread::Cloud& entry : thread.clouds)
            if (&entry.store->cloud() == cloud.get()) entry.loading = false;
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.loadingEnded(*cloud, bounds); });
    });
}

void ViewRenderer::removeCloud(std::shared_ptr<const PointCloud> cloud)
{
    post([cloud = std::move(cloud)](Thread& thread) {
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.removeCloud(*cloud); });
        std::erase_if(thread.clouds,
                      [&](const Thread::Cloud& entry) { return &entry.store->cloud() == cloud.get(); });
    });
}

void ViewRenderer::valuesChanged(std::shared_ptr<const PointCloud> cloud, const ChangeNotice& notice)
{
    post([cloud = std::move(cloud), notice](Thread& thread) {
        thread.changeStores(StoreChange::Values,
                            [&](render::ProgressiveRenderer& renderer) { renderer.valuesChanged(*cloud, notice); });
    });
}

void ViewRenderer::hide(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> points)
{
    post([cloud = std::move(cloud), points = std::move(points)](Thread& thread) {
        thread.changeStores(StoreChange::Hidden,
                            [&](render::ProgressiveRenderer& renderer) { renderer.hide(*cloud, points.get()); });
    });
}

void ViewRenderer::setSelection(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> selection)
{
    post([cloud = std::move(cloud), selection = std::move(selection)](Thread& thread) {
        thread.changeStores(StoreChange::Selection, [&](render::ProgressiveRenderer& renderer) {
            renderer.setSelection(*cloud, selection);
        });
    });
}

void ViewRenderer::setPreview(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const Preview> preview)
{
    post([cloud = std::move(cloud), preview = std::move(preview)](Thread& thread) {
        thread.changeStores(StoreChange::Values,
                            [&](render::ProgressiveRenderer& renderer) { renderer.setPreview(*cloud, preview); });
    });
}

void ViewRenderer::snapshot(std::shared_ptr<const PointCloud> cloud, QObject* receiver, SnapshotReply reply)
{
    post([this, cloud = std::move(cloud), target = QPointer<QObject>(receiver),
          reply = std::move(reply)](Thread& thread) {
        pictureOf(thread).snapshots.push_back(
            {cloud, [this, target, reply](std::shared_ptr<const ViewSnapshot> view) {
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
        render::ProgressiveRenderer* const renderer = pictureOf(thread).renderer.get();
        const auto hit = renderer ? renderer->pick(x, y) : std::nullopt;
        if (hit && hit->cloud < thread.clouds.size()) {
            const auto& store = thread.clouds[hit->cloud].store;
            const PointCloud& cloud = store->cloud();
            picked.emplace();
            picked->cloud = std::shared_ptr<const PointCloud>(store, &cloud);
            picked->index = hit->index;
            picked->world = hit->world;
            const std::shared_lock lock(cloud.mutex());
            if (const Attribute* classes = cloud.findAttribute("Classification"))
                picked->classCode = unsigned(std::clamp(classes->number(hit->index), 0.0, 255.0));
            const std::string shown = renderer->shownAttribute();
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
    post([this, transparent, done = std::move(done)](Thread& thread) {
        pictureOf(thread).captures.push_back({transparent, done});
    });
}

std::shared_ptr<const Frame> ViewRenderer::frame() const
{
    const std::lock_guard lock(m_first.m_mutex);
    return m_frame;
}

// -- the render thread

ViewRenderer::Picture& ViewRenderer::pictureOf(Thread& thread) const
{
    return **std::find_if(thread.pictures.begin(), thread.pictures.end(),
                          [this](const auto& picture) { return picture->view == this; });
}

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
    std::unique_ptr<render::ProgressiveRenderer>& renderer = thread.first().renderer;
    if (renderer) {
        // What the old backend has on the device goes while its own context is current.
        if (thread.context) thread.context.makeCurrent();
        renderer->setBackend(std::move(backend));
        if (context) context.makeCurrent();
    } else {
        renderer = std::make_unique<render::ProgressiveRenderer>(std::move(backend));
    }
    std::swap(thread.context, context);
    thread.kind = kind;
    thread.first().broken = false;
    QMetaObject::invokeMethod(
        this,
        [this, kind, text = toQString(renderer->backend().description())] { emit backendChanged(kind, text); },
        Qt::QueuedConnection);
}

void ViewRenderer::applyChoice(Thread& thread)
{
    using render::BackendKind;
    BackendKind kind = thread.chosen.value_or(thread.fastest.device ? thread.fastest.kind : BackendKind::Cpu);
    const auto& renderer = thread.first().renderer;
    if (renderer && thread.wanted == kind) return;
    thread.wanted = kind;
    if (!renderer || thread.kind != kind) useBackend(thread, kind);
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
    if (thread.kind != before) thread.first().dirty = true;
}

void ViewRenderer::run(std::optional<render::BackendKind> backend, FastestBackend fastest)
{
    Thread thread;
    thread.pictures.push_back(std::make_unique<Picture>());
    thread.first().view = this;
    thread.fastest = std::move(fastest);
    thread.chosen = backend;
    applyChoice(thread);
    bool idle = true;
    bool calm = false;
    for (;;) {
        std::vector<Command> commands;
        std::vector<std::pair<ViewRenderer*, Wish>> wishes;
        {
            std::unique_lock lock(m_mutex);
            const auto wanted = [this] {
                return m_stop || !m_commands.empty() ||
                       std::any_of(m_views.begin(), m_views.end(),
                                   [](const ViewRenderer* view) { return view->m_on && view->m_wish.any(); });
            };
            if (idle && !thread.chosen && !thread.measured) {
                if (!m_wake.wait_for(lock, kQuiet, wanted)) {
                    lock.unlock();
                    measureBackends(thread);
                    idle = !thread.first().dirty;
                    continue;
                }
            } else if (idle)
                m_wake.wait(lock, wanted);
            else if (calm)
                m_wake.wait_for(lock, kLoadingPause, wanted);
            if (m_stop) return;
            std::swap(commands, m_commands);
            for (ViewRenderer* view : m_views)
                if (view->m_on && view->m_wish.any()) wishes.emplace_back(view, std::exchange(view->m_wish, {}));
        }
        for (const Command& command : commands) {
            command.view->pictureOf(thread).attempt([&] { command.act(thread); });
            settleFailures(thread);
        }
        bool moved = false;
        for (const auto& [view, wish] : wishes) {
            Picture& picture = view->pictureOf(thread);
            if (wish.size) picture.known.size = wish.size;
            if (wish.camera) picture.known.camera = wish.camera;
            if (wish.display) picture.known.display = wish.display;
            if (!picture.renderer || picture.fresh) continue;  // it could not be made, or is told all below
            picture.attempt([&, &wish = wish] { picture.apply(wish); });
            moved = moved || wish.camera;
        }
        settleFailures(thread);
        for (const auto& picture : thread.pictures)
            if (picture->dirty) picture->broken = false;
        const bool loading = thread.loading();
        const auto drawn = std::count_if(thread.pictures.begin(), thread.pictures.end(),
                                         [&](const auto& picture) { return picture->wantsFrame(loading); });
        for (const auto& picture : thread.pictures) {
            if (picture->renderer && !picture->broken)
                picture->attempt([&] {
                    if (std::exchange(picture->fresh, false)) picture->apply(picture->known);
                    renderNext(thread, *picture, thread.budget / double(std::max<long>(drawn, 1)));
                });
            settleFailures(thread);
            if (picture->broken || !picture->renderer) picture->refuse();
        }
        idle = !loading && std::all_of(thread.pictures.begin(), thread.pictures.end(),
                                       [](const auto& picture) { return picture->finished(); });
        calm = loading && !moved;
    }
}

void ViewRenderer::settleFailures(Thread& thread)
{
    for (const auto& picture : thread.pictures) {
        if (!picture->failure) continue;
        const QString sentence = *std::exchange(picture->failure, std::nullopt);
        if (picture.get() == &thread.first() && thread.kind != render::BackendKind::Cpu) {
            announceFailure(tr("OpenGL drawing failed, so the CPU draws from here on: %1").arg(sentence));
            useBackend(thread, render::BackendKind::Cpu);
            picture->dirty = true;
        } else {
            announceFailure(sentence);
            picture->broken = true;
            picture->dirty = false;
        }
    }
}

/// What waits for a finished picture gets it now, before the view is switched off.
void ViewRenderer::finishAndServe(Thread& thread, Picture& picture)
{
    if (picture.snapshots.empty() && picture.captures.empty()) return;
    if (!picture.renderer || picture.broken || thread.loading()) return;
    if (std::exchange(picture.fresh, false)) picture.apply(picture.known);
    while (!picture.renderer->renderFrame(thread.budget).converged) {
    }
    serveSnapshots(thread, picture);
    serveCaptures(thread, picture);
}

void ViewRenderer::renderNext(Thread& thread, Picture& picture, double budget)
{
    if (picture.wantsFrame(thread.loading())) {
        picture.dirty = false;
        const render::FrameReport report = picture.renderer->renderFrame(budget);
        if (picture.renderer->image().width > 0) picture.view->publish(picture, report);
    }
    if (!picture.renderer->converged()) return;
    serveSnapshots(thread, picture);
    if (!picture.captures.empty() && !thread.loading()) serveCaptures(thread, picture);
}

void ViewRenderer::serveSnapshots(Thread& thread, Picture& picture)
{
    for (const Picture::Snapshot& wanted : std::exchange(picture.snapshots, {})) {
        std::shared_ptr<ViewSnapshot> view;
        for (const Thread::Cloud& entry : thread.clouds) {
            if (&entry.store->cloud() != wanted.cloud.get()) continue;
            view = std::make_shared<ViewSnapshot>();
            view->cloud = wanted.cloud;
            view->projection = picture.renderer->projectionOf(*wanted.cloud);
            const PictureProjection& p = view->projection;
            const glm::dvec3 pivot = wanted.cloud->coordinates().toRaw(picture.renderer->camera().pivot) - p.base;
            view->pivotDepth = glm::dot(glm::dvec3(p.rowD), pivot) + p.rowD.w;
            view->visible = std::make_shared<PointSet>(picture.renderer->visiblePoints(*wanted.cloud));
        }
        wanted.done(std::move(view));
    }
}

void ViewRenderer::serveCaptures(Thread& thread, Picture& picture)
{
    render::ProgressiveRenderer& renderer = *picture.renderer;
    const render::DisplaySettings shown = renderer.display();
    for (const Picture::Capture& capture : std::exchange(picture.captures, {})) {
        if (capture.transparent) {
            render::DisplaySettings bare = shown;
            bare.backgroundTop.a = bare.backgroundBottom.a = 0;
            renderer.setDisplay(bare);
            while (!renderer.renderFrame(thread.budget).converged) {
            }
        }
        capture.done(std::make_shared<render::Image>(renderer.image()));
        if (capture.transparent) {
            renderer.setDisplay(shown);
            while (!renderer.renderFrame(thread.budget).converged) {
            }
        }
    }
}

void ViewRenderer::publish(Picture& picture, const render::FrameReport& report)
{
    const auto frame = Pool::take(m_pool);
    frame->image = picture.renderer->image();
    frame->camera = picture.renderer->camera();
    frame->report = report;
    frame->range = picture.renderer->range();
    frame->attribute = toQString(picture.renderer->shownAttribute());
    frame->number = ++picture.frames;
    bool announce = false;
    {
        const std::lock_guard lock(m_first.m_mutex);
        if (!m_on) return;
        m_frame = frame;
        announce = !std::exchange(m_announced, true);
    }
    if (!announce) return;
    QMetaObject::invokeMethod(
        this,
        [this] {
            {
                const std::lock_guard lock(m_first.m_mutex);
                m_announced = false;
            }
            emit frameReady();
        },
        Qt::QueuedConnection);
}

}  // namespace punctum::ui
