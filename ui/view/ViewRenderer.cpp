// SPDX-License-Identifier: MIT
#include "ui/view/ViewRenderer.h"

#include "core/Error.h"
#include "render/backends/BackendChoice.h"
#include "render/backends/Backends.h"
#include "render/gl/EglContext.h"
#include "render/store/Arrangement.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"
#include "ui/view/FrameShares.h"
#include "ui/view/Still.h"
#include "ui/view/ViewPicture.h"

#include <QPointer>

#include <algorithm>
#include <chrono>
#include <deque>
#include <future>

namespace punctum::ui
{

namespace
{

/// Between two frames of a still camera while points arrive: most of the processor belongs to loading then.
constexpr std::chrono::milliseconds kLoadingPause(60);
/// Seconds for a part of a still while the views are finished: short enough that they answer at once.
constexpr double kStillFrame = 0.03;
/// Nobody waits for a picture: time to measure what draws fastest.
constexpr std::chrono::seconds kQuiet(3);

using StoreChange = render::ProgressiveRenderer::StoreChange;

}  // namespace

/// What only the render thread touches.
struct ViewRenderer::Thread {
    // Before the pictures: the first one's backend needs it to the end. Empty on the CPU.
    render::EglContext context;                          ///< empty, too, where the shared one is used
    bool shared = false;                                 ///< the backend draws in ViewRenderer::m_shared
    std::vector<std::unique_ptr<ViewPicture>> pictures;  ///< the first view's first
    render::BackendKind kind = render::BackendKind::Cpu;
    FastestBackend fastest;
    std::optional<render::BackendKind> chosen;              ///< by the user; none: the fastest
    render::BackendKind wanted = render::BackendKind::Cpu;  ///< what applyChoice() asked for; `kind` draws
    bool measured = false;                                  ///< `fastest` is known to be of this machine
    std::vector<DrawnCloud> clouds;
    std::deque<std::unique_ptr<StillDrawing>> stills;  ///< the first is being drawn
    double budget = render::kFrameSeconds;

    ViewPicture& first() { return *pictures.front(); }
    /// Calls change(renderer) for all that draw, and has their pictures made anew.
    template <typename Change>
    void forAll(Change change)
    {
        for (const auto& picture : pictures) {
            if (!picture->renderer) continue;
            picture->dirty = true;
            picture->attempt([&] { change(*picture->renderer); });
        }
        for (const auto& still : stills) still->follow(change);
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
};

ViewRenderer::ViewRenderer(std::optional<render::BackendKind> backend, FastestBackend fastest, QObject* parent,
                           std::unique_ptr<SharedContext> shared, const QString& whyNotShared)
    : QObject(parent),
      m_first(*this),
      m_views{this},
      m_shared(std::move(shared)),
      m_whyNotShared(whyNotShared),
      m_thread([this, backend, fastest = std::move(fastest)] {
          run(backend, fastest);
          if (m_shared) m_shared->end();
      })
{
}

ViewRenderer::ViewRenderer(ViewRenderer& first, QObject* parent) : QObject(parent), m_first(first), m_on(false)
{
    const std::lock_guard lock(m_first.m_mutex);
    m_first.m_views.push_back(this);
    m_first.m_commands.push_back({&m_first, [this](Thread& thread) { thread.pictures.push_back(makePicture()); }});
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
                                      [this](const auto& picture) { return picture->view() == this; });
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
        ViewPicture& picture = pictureOf(thread);
        if (!on) {
            picture.attempt([&] { picture.finishAndServe(thread.clouds); });
            picture.refuse();
            picture.renderer = nullptr;
            return;
        }
        picture.renderer =
            std::make_unique<render::ProgressiveRenderer>(render::makeBackend(render::BackendKind::Cpu));
        picture.renderer->setPointsAFrame(thread.first().renderer->pointsAFrame());
        for (const DrawnCloud& cloud : thread.clouds) {
            picture.renderer->addCloud(cloud.store);
            if (!cloud.loading) picture.renderer->loadingEnded(cloud.store->cloud(), cloud.store->bounds());
            picture.renderer->setSurface(cloud.store->cloud(), cloud.surface);
        }
        // Told when the newest wishes are known: the one before might show another attribute, in all views.
        picture.fresh = picture.dirty = true;
    });
}

void ViewRenderer::setSize(int widthPx, int heightPx)
{
    wish([&](ViewWish& wish) { wish.size = {widthPx, heightPx}; });
}

void ViewRenderer::setCamera(const render::Camera& camera)
{
    wish([&](ViewWish& wish) { wish.camera = camera; });
}

void ViewRenderer::setDisplay(const render::DisplaySettings& display)
{
    wish([&](ViewWish& wish) { wish.display = display; });
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
        for (DrawnCloud& entry : thread.clouds)
            if (&entry.store->cloud() == cloud.get()) entry.loading = false;
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.loadingEnded(*cloud, bounds); });
    });
}

void ViewRenderer::arrange(std::shared_ptr<const PointCloud> cloud,
                           std::shared_ptr<render::Arrangement> arrangement)
{
    post([cloud = std::move(cloud), arrangement = std::move(arrangement)](Thread& thread) {
        thread.changeStores(StoreChange::Slots, [&](render::ProgressiveRenderer& renderer) {
            renderer.arrange(*cloud, std::move(*arrangement));
        });
    });
}

void ViewRenderer::removeCloud(std::shared_ptr<const PointCloud> cloud)
{
    post([cloud = std::move(cloud)](Thread& thread) {
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.removeCloud(*cloud); });
        std::erase_if(thread.clouds, [&](const DrawnCloud& entry) { return &entry.store->cloud() == cloud.get(); });
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

void ViewRenderer::setSurface(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const SurfaceView> surface)
{
    post([cloud = std::move(cloud), surface = std::move(surface)](Thread& thread) {
        for (DrawnCloud& entry : thread.clouds)
            if (&entry.store->cloud() == cloud.get()) entry.surface = surface;
        thread.forAll([&](render::ProgressiveRenderer& renderer) { renderer.setSurface(*cloud, surface); });
    });
}

void ViewRenderer::snapshot(std::shared_ptr<const PointCloud> cloud, QObject* receiver, SnapshotReply reply)
{
    post([this, cloud = std::move(cloud), target = QPointer<QObject>(receiver),
          reply = std::move(reply)](Thread& thread) {
        pictureOf(thread).askSnapshot(cloud, [this, target, reply](std::shared_ptr<const ViewSnapshot> view) {
            // by way of this object, as in pick()
            QMetaObject::invokeMethod(
                this,
                [target, reply, view = std::move(view)] {
                    if (target) reply(view);
                },
                Qt::QueuedConnection);
        });
    });
}

void ViewRenderer::pick(int x, int y, QObject* receiver, PickReply reply, int radius)
{
    post([x, y, radius, target = QPointer<QObject>(receiver), reply = std::move(reply), this](Thread& thread) {
        const auto picked = pictureOf(thread).pick(x, y, radius, thread.clouds);
        // By way of this object: it outlives the thread, the receiver need not.
        QMetaObject::invokeMethod(
            this,
            [target, reply, picked] {
                if (target) reply(picked);
            },
            Qt::QueuedConnection);
    });
}

void ViewRenderer::draw(std::shared_ptr<Still> still)
{
    post([still = std::move(still)](Thread& thread) {
        try {
            thread.stills.push_back(std::make_unique<StillDrawing>(still, thread.clouds));
        } catch (const std::exception& e) {
            still->refuse(e.what());
        }
    });
}

std::shared_ptr<const Frame> ViewRenderer::frame() const
{
    const std::lock_guard lock(m_first.m_mutex);
    return m_frame;
}

// -- the render thread

ViewPicture& ViewRenderer::pictureOf(Thread& thread) const
{
    return **std::find_if(thread.pictures.begin(), thread.pictures.end(),
                          [this](const auto& picture) { return picture->view() == this; });
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
    bool shared = false;
    if (render::needsGl(kind) && m_shared) {
        try {
            if (thread.context) thread.context.doneCurrent();
            m_shared->makeCurrent();
            backend = render::makeBackend(kind);
            shared = true;
        } catch (const std::exception& e) {
            m_whyNotShared = QString::fromLocal8Bit(e.what());
            m_shared->doneCurrent();
        }
    }
    try {
        if (!shared && render::needsGl(kind)) context = render::EglContext::create();
        if (!shared) backend = render::makeBackend(kind);
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
        if (context && thread.shared) context.doneCurrent();
        makeCurrent(thread);
        renderer->setBackend(std::move(backend));
        if (shared != thread.shared && thread.context) thread.context.doneCurrent();
        if (shared != thread.shared && thread.shared) m_shared->doneCurrent();
    } else {
        renderer = std::make_unique<render::ProgressiveRenderer>(std::move(backend));
    }
    std::swap(thread.context, context);
    thread.shared = shared;
    makeCurrent(thread);
    renderer->keepOnDevice(shared);
    thread.first().setTextures(shared ? &m_shared->textures() : nullptr);
    thread.kind = kind;
    thread.first().broken = false;
    // Somebody wanted pictures to stay on the device, and they do not.
    const QString copied = render::needsGl(kind) && !shared && !m_whyNotShared.isEmpty()
                               ? tr(", pictures copied: %1").arg(m_whyNotShared)
                               : QString();
    QMetaObject::invokeMethod(
        this,
        [this, kind, text = toQString(renderer->backend().description()) + copied] {
            emit backendChanged(kind, text);
        },
        Qt::QueuedConnection);
}

void ViewRenderer::makeCurrent(Thread& thread)
{
    if (thread.shared)
        m_shared->makeCurrent();
    else if (thread.context)
        thread.context.makeCurrent();
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
    // It makes contexts of its own, and a thread has one at a time.
    if (thread.shared) m_shared->doneCurrent();
    if (thread.context) thread.context.doneCurrent();
    const render::BackendMeasurement measurement =
        render::measureBackends({thread.first().renderer->display(), bool(m_shared)}, thread.fastest.device);
    makeCurrent(thread);
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
    thread.pictures.push_back(makePicture());
    thread.fastest = std::move(fastest);
    thread.chosen = backend;
    applyChoice(thread);
    bool idle = true;
    bool calm = false;
    for (;;) {
        std::vector<Command> commands;
        std::vector<std::pair<ViewRenderer*, ViewWish>> wishes;
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
            ViewPicture& picture = view->pictureOf(thread);
            if (wish.size) picture.known.size = wish.size;
            if (wish.camera) picture.known.camera = wish.camera;
            if (wish.display) {
                picture.known.display = wish.display;
                for (const auto& still : thread.stills) still->attributeChosen(wish.display->attribute);
            }
            if (!picture.renderer || picture.fresh) continue;  // it could not be made, or is told all below
            picture.attempt([&, &wish = wish] { picture.apply(wish); });
            moved = moved || wish.camera;
        }
        settleFailures(thread);
        for (const auto& picture : thread.pictures)
            if (picture->dirty) picture->broken = false;
        drawFrames(thread);
        const bool loading = anyLoading(thread.clouds);
        idle = !loading && thread.stills.empty() &&
               std::all_of(thread.pictures.begin(), thread.pictures.end(),
                           [](const auto& picture) { return picture->finished(); });
        calm = loading && !moved;
    }
}

void ViewRenderer::drawFrames(Thread& thread)
{
    const bool loading = anyLoading(thread.clouds);
    const auto wants = [&](const auto& picture) { return picture->wantsFrame(loading); };
    auto waiting = std::count_if(thread.pictures.begin(), thread.pictures.end(), wants);
    const bool all = waiting == 0;
    const FrameShares shares(thread.budget);
    for (const auto& picture : thread.pictures) {
        if (picture->renderer && !picture->broken) {
            const double seconds = shares.next(std::max<long>(waiting, 1));
            if (wants(picture)) --waiting;
            picture->attempt([&] { picture->renderNext(thread.clouds, seconds); });
        }
        settleFailures(thread);
        if (picture->broken || !picture->renderer) picture->refuse();
    }
    // Nobody moves the view: whoever waits for a still gets all of the time.
    if (!thread.stills.empty() && thread.stills.front()->draw(thread.clouds, all ? kStillFrame : thread.budget))
        thread.stills.pop_front();
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
            announceFailure(picture.get() == &thread.first() ? sentence
                                                             : tr("The section is not drawn: %1").arg(sentence));
            picture->broken = true;
            picture->dirty = false;
        }
    }
}

std::unique_ptr<ViewPicture> ViewRenderer::makePicture()
{
    return std::make_unique<ViewPicture>(this,
                                         [this](std::shared_ptr<const Frame> frame) { publish(std::move(frame)); });
}

void ViewRenderer::publish(std::shared_ptr<const Frame> frame)
{
    bool announce = false;
    {
        const std::lock_guard lock(m_first.m_mutex);
        if (!m_on) return;
        m_frame = std::move(frame);
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
